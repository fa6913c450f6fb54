// Waiting for another thread for less time than the system takes to put this one to sleep and to wake it.
#pragma once

#include <chrono>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

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
