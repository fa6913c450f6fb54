// The natural logarithm, with the same last bit on every machine.
#pragma once

namespace welkin::tables {

/// ln x for finite, normal x > 0. Absolute error below 4e-16 + 2e-16 |ln x|. Uses + - * / and the number's own
/// exponent.
[[nodiscard]] double logarithm(double x) noexcept;

}  // namespace welkin::tables
