// The floating-point environments that a caller may have.
#pragma once

#include <string_view>

namespace welkin::test {

/// The control bits of both units: MXCSR of SSE, without the flags of past exceptions, and the x87 control word.
struct FloatEnvironment {
  unsigned mxcsr = 0x1F80;
  unsigned short control_word = 0x037F;

  friend bool operator==(const FloatEnvironment&, const FloatEnvironment&) = default;
};

/// Throws `std::invalid_argument` for a name that is none.
[[nodiscard]] FloatEnvironment mode_named(std::string_view name);

[[nodiscard]] FloatEnvironment current_environment() noexcept;

/// Sets an environment, with no flag of a past exception.
void set_environment(const FloatEnvironment& environment) noexcept;

/// Makes a trap (an unmasked exception) end the process with a message that names the public function that was called.
void report_traps() noexcept;

/// What the next trap names; must live until then.
void name_call(const char* name) noexcept;

}  // namespace welkin::test
