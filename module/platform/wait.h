// Waiting for an atomic to change: std::atomic's own wait, where that can be relied on.
#pragma once

#include <atomic>

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
