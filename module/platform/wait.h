// Waiting for another thread: for an atomic to change, by std::atomic's wait where that is reliable; and for less time
// than the system takes to put this thread to sleep and to wake it.
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

// Without futexes libstdc++ 12 reads the value before it takes the lock that it waits with: a change in between wakes
// no thread.

struct WaitPoint {
  std::mutex mutex;
  std::condition_variable changed;
};

/// Returns the wait point of an atomic. Several atomics may share one: a woken thread checks its value again.
inline WaitPoint& wait_point(const void* atomic) noexcept {
  static auto& points = *new std::array<WaitPoint, 16>;  // never destroyed: threads may outlive main
  return points[reinterpret_cast<std::uintptr_t>(atomic) / 16 % points.size()];
}

/// Returns once the atomic differs from `old`.
template <class Value>
void wait_while(const std::atomic<Value>& atomic, Value old) {
  WaitPoint& point = wait_point(&atomic);
  std::unique_lock lock(point.mutex);
  point.changed.wait(lock, [&] { return atomic.load() != old; });
}

/// Wakes all threads that wait for a change. The atomic may be gone by then; it is not read.
template <class Value>
void wake_all(std::atomic<Value>& atomic) {
  WaitPoint& point = wait_point(&atomic);
  const std::lock_guard lock(point.mutex);
  point.changed.notify_all();
}

#else

/// Returns once the atomic differs from `old`.
template <class Value>
void wait_while(const std::atomic<Value>& atomic, Value old) noexcept {
  atomic.wait(old);
}

/// Wakes all threads that wait for a change.
template <class Value>
void wake_all(std::atomic<Value>& atomic) noexcept {
  atomic.notify_all();
}

#endif

}  // namespace welkin::platform

namespace welkin::detail {

/// Hints to the processor that this thread only polls a value: the core's other hardware thread gets its units, and the
/// change is seen sooner.
inline void pause_processor() noexcept {
#if defined(__SSE2__) || defined(_M_X64)
  _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
  __asm__ volatile("yield");
#endif
}

/// Polls `done()` for about `time` without yielding the processor. Returns the last result. For work that another
/// processor does: on a machine with a single one it achieves nothing.
template <class Done>
bool spin_until(const Done& done, std::chrono::nanoseconds time) {
  using Clock = std::chrono::steady_clock;
  constexpr int kLooks = 16;  // per reading of the clock, which takes longer than a look
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
