// Waiting for another thread: for an atomic to change, by std::atomic's own wait where that can be relied on; and for
// less time than the system takes to put this thread to sleep and to wake it.
#pragma once

#include <atomic>
#include <chrono>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif
#if defined(_WIN32) && defined(__GLIBCXX__)
#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#endif

namespace welkin::platform {

#if defined(_WIN32) && defined(__GLIBCXX__)

// Without futexes libstdc++ 12 looks at the value before it takes the lock that it waits with: a change in between
// wakes nobody.

struct WaitPoint {
  std::mutex mutex;
  std::condition_variable changed;
};

/// Several atomics may share one: who is woken looks again.
inline WaitPoint& wait_point(const void* atomic) noexcept {
  static auto& indices = *new std::array<WaitPoint, 16>;  // never destroyed: threads may outlive main
  return indices[reinterpret_cast<std::uintptr_t>(atomic) / 16 % indices.size()];
}

/// Returns once the atomic has another value than `old`.
template <class Value>
void wait_while(const std::atomic<Value>& atomic, Value old) {
  WaitPoint& index = wait_point(&atomic);
  std::unique_lock lock(index.mutex);
  index.changed.wait(lock, [&] { return atomic.load() != old; });
}

/// After a change: wakes all who wait for one. The atomic may be gone by then; it is not looked at.
template <class Value>
void wake_all(std::atomic<Value>& atomic) {
  WaitPoint& index = wait_point(&atomic);
  const std::lock_guard lock(index.mutex);
  index.changed.notify_all();
}

#else

/// Returns once the atomic has another value than `old`.
template <class Value>
void wait_while(const std::atomic<Value>& atomic, Value old) noexcept {
  atomic.wait(old);
}

/// After a change: wakes all who wait for one.
template <class Value>
void wake_all(std::atomic<Value>& atomic) noexcept {
  atomic.notify_all();
}

#endif

}  // namespace welkin::platform

namespace welkin::detail {

/// Tells the processor that this thread does nothing but look at a value again and again: it leaves the core's units to
/// the other thread of the core, and sees the value change sooner.
inline void pause_processor() noexcept {
#if defined(__SSE2__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  __asm__ volatile("yield");
#endif
}

/// Asks `done()` again and again for about `time`, and keeps the processor meanwhile. Returns the last answer. It is
/// for where another processor does the work: on a machine with a single one, nothing comes of it.
template <class Done>
bool spin_until(const Done& done, std::chrono::nanoseconds time) {
  using Clock = std::chrono::steady_clock;
  constexpr int kLooks = 16;  // between two readings of the clock, which take longer than a look
  const auto end = Clock::now() + time;
  do {
    for (int look = 0; look < kLooks; ++look) {
      if (done()) return true;
      pause_processor();
    }
  } while (Clock::now() < end);
  return done();
}

}  // namespace welkin::detail
