// Functions and sums with the same last bit on every machine: exponential, logarithm, sine and cosine and the ways back
// to the angle, scalar products.
#pragma once

#include <array>
#include <vector>

namespace welkin::math {

/// e^x for any x that is a number; 0 below -745.2, infinity above 709.8. Relative error below 4e-16 where the result is
/// normal. Uses + - * and the number's own exponent.
[[nodiscard]] double exponential(double x) noexcept;
/// Replaces each of four values by its exponential: the same bits as one by one, in less than half of the time.
void exponentials(std::array<double, 4>& values) noexcept;

/// ln x for finite, normal x > 0. Absolute error below 4e-16 + 2e-16 |ln x|. Uses + - * / and the number's own
/// exponent.
[[nodiscard]] double logarithm(double x) noexcept;

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

/// Sum of a[i] b[i] over all of `a`, in eight running sums so that the processor need not wait for each; they are added
/// in order. `b` is at least as long as `a`.
[[nodiscard]] double dot(const std::vector<double>& a, const std::vector<double>& b) noexcept;

}  // namespace welkin::math
