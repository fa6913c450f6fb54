// The floating-point environments that a caller may have.
#pragma once

#include <cstdint>
#include <string_view>

namespace welkin::test {

#if defined(__aarch64__)
/// The control register, FPCR.
struct FloatEnvironment {
  std::uint64_t control = 0;

  friend bool operator==(const FloatEnvironment&, const FloatEnvironment&) = default;
};
#else
/// The control bits of both units: MXCSR of SSE, without the flags of past exceptions, and the x87 control word.
struct FloatEnvironment {
  unsigned mxcsr = 0x1F80;
  unsigned short control_word = 0x037F;

  friend bool operator==(const FloatEnvironment&, const FloatEnvironment&) = default;
};
#endif

/// Returns the environment of that name. Throws `std::invalid_argument` if there is none.
[[nodiscard]] FloatEnvironment mode_named(std::string_view name);

/// Returns the environment with denormals flushed, both operands and results.
[[nodiscard]] FloatEnvironment flushing(FloatEnvironment environment) noexcept;

[[nodiscard]] FloatEnvironment current_environment() noexcept;

/// Sets an environment, with no flag of a past exception.
void set_environment(const FloatEnvironment& environment) noexcept;

/// Sets the caller's environment, as an engine may have it, and restores the previous one when it is destroyed.
class InEnvironment {
 public:
  explicit InEnvironment(const FloatEnvironment& environment) noexcept : before_(current_environment()) {
    set_environment(environment);
  }
  ~InEnvironment() { set_environment(before_); }
  InEnvironment(const InEnvironment&) = delete;
  InEnvironment& operator=(const InEnvironment&) = delete;

 private:
  FloatEnvironment before_;
};

/// Makes a trap (an unmasked exception) end the process with a message that names the public function that was called.
void report_traps() noexcept;

/// Sets the name that the next trap reports. It must live until then.
void name_call(const char* name) noexcept;

}  // namespace welkin::test
