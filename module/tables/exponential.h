// The exponential function, with the same last bit on every machine.
#pragma once

namespace welkin::tables {

/// e^x for any x that is a number; 0 below -745.2, infinity above 709.8. Relative error below 4e-16 where the result is
/// normal. Uses + - * and the number's own exponent.
[[nodiscard]] double exponential(double x) noexcept;

}  // namespace welkin::tables
