// The same floating-point environment for every tile.
#pragma once

#include <xmmintrin.h>

namespace welkin::platform {

/// Rounds to nearest, keeps denormals and raises nothing while it lives; then puts back what was there.
/// Engines like to flush denormals or to unmask exceptions on their threads: either would change our bits.
class FloatingPointScope {
 public:
  FloatingPointScope() noexcept : saved_(_mm_getcsr()) { _mm_setcsr(kDefaultEnvironment); }
  ~FloatingPointScope() { _mm_setcsr(saved_); }
  FloatingPointScope(const FloatingPointScope&) = delete;
  FloatingPointScope& operator=(const FloatingPointScope&) = delete;

 private:
  static constexpr unsigned kDefaultEnvironment = 0x1F80;  // MXCSR after reset: all exceptions masked
  unsigned saved_;
};

/// Takes denormals for zero while it lives, on top of the default environment: for kernels whose functions fade away
/// towards the poles, where each denormal would cost a hundred cycles. SSE, AVX and AVX-512 flush the same ones.
class FlushDenormalsScope {
 public:
  FlushDenormalsScope() noexcept : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormalsScope() { _mm_setcsr(saved_); }
  FlushDenormalsScope(const FlushDenormalsScope&) = delete;
  FlushDenormalsScope& operator=(const FlushDenormalsScope&) = delete;

 private:
  static constexpr unsigned kFlushToZero = 0x8000;
  static constexpr unsigned kDenormalsAreZero = 0x0040;
  unsigned saved_;
};

}  // namespace welkin::platform
