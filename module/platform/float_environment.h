// The same floating-point environment for every public call and every task.
//
// FloatingPointScope rounds to nearest, keeps denormals and raises nothing while it lives; then it puts back what was
// there, flags of past exceptions included. Engines like to flush denormals or to unmask exceptions on their threads:
// either would change our bits. Every public function that computes with floats makes one of these before anything
// else, and so does every task.
//
// FlushDenormalsScope takes denormals for zero while it lives, on top of the default environment: for kernels whose
// functions fade away towards the poles, where each denormal would cost a hundred cycles. Which results count as
// denormal differs between processors, so where it lives nothing that small may matter (transform/spectrum.cpp).
#pragma once

#include <cstddef>
#include <cstdint>

#if !defined(__aarch64__) && !defined(__wasm__)
#include <xmmintrin.h>
#endif

namespace welkin::platform {

#if defined(__aarch64__)

namespace detail {

// FPCR, the control register. Bits 8 to 12 and 15 trap exceptions (where the processor can), 19 flushes denormal
// halves, 22 and 23 say how to round, 24 flushes denormals, operands as well as results, 25 gives one and the same NaN
// always, 26 takes halves for ARM's own format without infinities. All 0: IEEE 754. FPSR: flags of past exceptions.
inline std::uint64_t control_register() noexcept {
  std::uint64_t value = 0;
  __asm__ volatile("mrs %0, fpcr" : "=r"(value) : : "memory");
  return value;
}
inline void set_control_register(std::uint64_t value) noexcept {
  __asm__ volatile("msr fpcr, %0" : : "r"(value) : "memory");
}
inline std::uint64_t status_register() noexcept {
  std::uint64_t value = 0;
  __asm__ volatile("mrs %0, fpsr" : "=r"(value) : : "memory");
  return value;
}
inline void set_status_register(std::uint64_t value) noexcept {
  __asm__ volatile("msr fpsr, %0" : : "r"(value) : "memory");
}

}  // namespace detail

/// Writing the control register makes the processor wait for all instructions before, so it is written only where it is
/// not the default one already.
class FloatingPointScope {
 public:
  FloatingPointScope() noexcept : control_(detail::control_register()), status_(detail::status_register()) {
    if (control_ != kDefaultEnvironment) detail::set_control_register(kDefaultEnvironment);
  }
  ~FloatingPointScope() {
    detail::set_status_register(status_);
    if (control_ != kDefaultEnvironment) detail::set_control_register(control_);
  }
  FloatingPointScope(const FloatingPointScope&) = delete;
  FloatingPointScope& operator=(const FloatingPointScope&) = delete;

 private:
  static constexpr std::uint64_t kDefaultEnvironment = 0;
  std::uint64_t control_;
  std::uint64_t status_;
};

/// NEON flushes results that are denormal before they are rounded, where x86 looks at them afterwards: one that is
/// rounded up to the least normal number is zero here and not there.
class FlushDenormalsScope {
 public:
  FlushDenormalsScope() noexcept : saved_(detail::control_register()) {
    detail::set_control_register(saved_ | kFlushToZero);
  }
  ~FlushDenormalsScope() { detail::set_control_register(saved_); }
  FlushDenormalsScope(const FlushDenormalsScope&) = delete;
  FlushDenormalsScope& operator=(const FlushDenormalsScope&) = delete;

 private:
  static constexpr std::uint64_t kFlushToZero = std::uint64_t{1} << 24U;
  std::uint64_t saved_;
};

#elif defined(__wasm__)

/// The floating-point environment of WebAssembly, which has but one: it always rounds to nearest, keeps denormals and
/// raises nothing.
class FloatingPointScope {
 public:
  FloatingPointScope() noexcept {}  // NOLINT(modernize-use-equals-default): an object that is not unused
};

/// Denormals stay: nothing may depend on them where this lives.
class FlushDenormalsScope {
 public:
  FlushDenormalsScope() noexcept {}  // NOLINT(modernize-use-equals-default): as above
};

#else  // x86-64

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

#endif

}  // namespace welkin::platform
