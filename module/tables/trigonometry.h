// Sine, cosine and the ways back to the angle, with the same last bit on every machine.
#pragma once

namespace welkin::tables {

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of 2 pi `turns`, |turns| below 1e6. Absolute error below 3e-16 beyond that of `turns`.
/// A libm picks its code, and so its last bit, by the processor it finds; this uses + - * only.
[[nodiscard]] SineCosine sine_cosine_of_turns(double turns) noexcept;

/// The angle of the point (x, y), finite, in turns: atan2(y, x) / (2 pi), from -0.5 to 0.5, 0 for the origin and -0.5
/// only for y = -0. Absolute error below 1.2e-16; on axes and diagonals none.
[[nodiscard]] double turns_of(double y, double x) noexcept;

/// Arc sine of 0 <= x <= 1, radians; absolute error below 5e-16. Uses + - * / and square roots.
[[nodiscard]] double arc_sine(double x) noexcept;

}  // namespace welkin::tables
