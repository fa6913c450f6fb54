// The floating-point environment of 64-bit ARM: what float_environment.h declares.
#pragma once

#include <cstdint>

namespace welkin::platform {

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

}  // namespace welkin::platform
