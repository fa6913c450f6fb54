// The same floating-point environment for every public call and every task.
#pragma once

#if !defined(__wasm__)
#include <xmmintrin.h>
#endif

#include <cstddef>
#include <cstdint>

namespace welkin::platform {

#if defined(__wasm__)

// WebAssembly always rounds to nearest, keeps denormals and raises nothing.

class FloatingPointScope {
 public:
  FloatingPointScope() noexcept {}  // NOLINT(modernize-use-equals-default): an object that is not unused
};

/// Denormals stay: nothing may depend on them where this lives.
class FlushDenormalsScope {
 public:
  FlushDenormalsScope() noexcept {}  // NOLINT(modernize-use-equals-default): likewise
};

#else

/// Rounds to nearest, keeps denormals and raises nothing while it lives; then puts back what was there, flags of past
/// exceptions included. Engines like to flush denormals or to unmask exceptions on their threads: either would change
/// our bits. Every public function that computes with floats makes one of these before anything else, and so does
/// every task: where both are the default ones already it costs some ten cycles.
///
/// The x87 unit is set too. We compute nothing with it, but the C library asks it how to round numbers in text.
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
  static constexpr unsigned kDefaultEnvironment = 0x1F80;       // MXCSR after reset: all exceptions masked

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
#else  // the compilers of Windows compute text without the x87 unit
  void enter_x87() noexcept {}
  void leave_x87() const noexcept {}
#endif

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

#endif

}  // namespace welkin::platform
