// Scopes that set one floating-point environment for every public call and every task.
//
// FloatingPointScope rounds to nearest, keeps denormals and raises no exceptions while it lives; then it restores the
// previous environment, flags of past exceptions included. Engines like to flush denormals or to unmask exceptions on
// their threads: either would change our bits. Every public function that computes with floats constructs one first,
// and so does every task.
//
// FlushDenormalsScope treats denormals as zero while it lives, on top of the default environment: for kernels whose
// functions fade towards the poles, where each denormal would cost a hundred cycles. Processors differ in which results
// count as denormal, so within it no result may depend on values that small (transform/spectrum.cpp).
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
// halves, 22 and 23 select the rounding, 24 flushes denormals, operands as well as results, 25 makes every NaN the
// default one, 26 selects ARM's half format without infinities. All 0: IEEE 754. FPSR: flags of past exceptions.
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

/// Writing the control register makes the processor wait for all earlier instructions, so it is written only if it is
/// not the default already.
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

/// NEON flushes results that are denormal before rounding, x86 those that are denormal after it: a result that is
/// rounded up to the smallest normal number becomes zero here only.
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

/// The floating-point environment of WebAssembly, which is fixed: it rounds to nearest, keeps denormals and raises no
/// exceptions.
class FloatingPointScope {
 public:
  FloatingPointScope() noexcept {}  // NOLINT(modernize-use-equals-default): an object that is not unused
};

/// Keeps denormals: nothing may depend on them within this scope.
class FlushDenormalsScope {
 public:
  FlushDenormalsScope() noexcept {}  // NOLINT(modernize-use-equals-default): as above
};

#else  // x86-64

/// Sets MXCSR and the x87 unit, which the C library reads to round numbers in text; we compute nothing with it. If both
/// are the default already, this costs about ten cycles.
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

  // If it is not the default, the whole environment is saved: flags that the C library raises in between would trap as
  // soon as they were unmasked. FNSTENV masks all exceptions, so that nothing traps in between either.
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
#else  // Windows' compilers convert text without the x87 unit
  void enter_x87() noexcept {}
  void leave_x87() const noexcept {}
#endif

  unsigned saved_;
};

/// SSE, AVX and AVX-512 flush the same results: those that are denormal after rounding.
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
