// Sine and cosine with the same last bit on every machine.
#pragma once

namespace welkin::tables {

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of 2 pi `turns`, |turns| below 1e6. Absolute error below 3e-16 beyond that of `turns`.
/// A libm picks its code, and so its last bit, by the processor it finds; this uses + - * only.
[[nodiscard]] SineCosine sine_cosine_of_turns(double turns) noexcept;

}  // namespace welkin::tables
