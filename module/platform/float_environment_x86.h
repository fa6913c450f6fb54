// The floating-point environment of x86-64: what float_environment.h declares.
#pragma once

#include <xmmintrin.h>

#include <cstddef>
#include <cstdint>

namespace welkin::platform {

/// MXCSR, and the x87 unit. We compute nothing with the latter, but the C library asks it how to round numbers in text.
/// Where both are the default ones already it costs some ten cycles.
class FloatingPointScope {
 public:
  FloatingPointScope() noexcept : saved_(_mm_getcsr()) {
    _mm_setcsr(kDefaultEnvironment);
    enter_x87();
  }
  ~FloatingPointScope() {
    leave_x87();
    _mm_setcsr(saved_);
  }
  FloatingPointScope(const FloatingPointScope&) = delete;
  FloatingPointScope& operator=(const FloatingPointScope&) = delete;

 private:
  static constexpr unsigned kDefaultEnvironment = 0x1F80;  // MXCSR after reset: all exceptions masked

#if defined(__GNUC__)
  static constexpr std::uint16_t kDefaultControlWord = 0x037F;  // after FNINIT: 64 bits, to nearest, all masked
  static constexpr std::size_t kX87EnvironmentBytes = 28;

  // The whole environment is saved where it is not the default one: flags that the C library raises in between would
  // trap as soon as they were unmasked. FNSTENV masks all exceptions, so that nothing traps in between either.
  void enter_x87() noexcept {
    __asm__ volatile("fnstcw %0" : "=m"(control_word_) : : "memory");
    if (control_word_ != kDefaultControlWord) {
      __asm__ volatile("fnstenv %0\n\tfldcw %1" : "=m"(x87_) : "m"(kDefaultControlWord) : "memory");
    }
  }
  void leave_x87() const noexcept {
    __asm__ volatile("" : : : "memory");
    if (control_word_ != kDefaultControlWord) __asm__ volatile("fldenv %0" : : "m"(x87_) : "memory");
  }

  std::uint16_t control_word_;
  struct X87Environment {
    std::byte bytes[kX87EnvironmentBytes];
  } x87_;  ///< written only if the control word is not the default one
#else      // the compilers of Windows compute text without the x87 unit
  void enter_x87() noexcept {}
  void leave_x87() const noexcept {}
#endif

  unsigned saved_;
};

/// SSE, AVX and AVX-512 flush the same ones: results that are denormal after they were rounded.
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
