#include "tables/trigonometry.h"

#include <cmath>
#include <numbers>

namespace welkin::tables {
namespace {

/// Taylor series on [0, pi/4]; the first term left out is below 2e-18.
SineCosine in_first_octant(double x) noexcept {
  const double x2 = x * x;
  double sine = 0.0;
  double cosine = 0.0;
  // Horner from x^17/17! and x^16/16!: each step divides by the two next factors of the factorial.
  for (int n = 16; n >= 2; n -= 2) {
    sine = (1.0 + sine) * (-x2 / static_cast<double>(n * (n + 1)));
    cosine = (1.0 + cosine) * (-x2 / static_cast<double>(n * (n - 1)));
  }
  return {x * (1.0 + sine), 1.0 + cosine};
}

}  // namespace

SineCosine sine_cosine_of_turns(double turns) noexcept {
  // Eighths of a turn split off exactly: multiplication by 8, floor and the subtraction do not round.
  const double eighths = turns * 8.0;
  const double whole = std::floor(eighths);
  const double rest = eighths - whole;
  const auto octant = static_cast<unsigned>(static_cast<long long>(whole) & 7);
  const bool odd = (octant & 1U) != 0;
  const SineCosine base = in_first_octant((odd ? 1.0 - rest : rest) * (std::numbers::pi / 4.0));
  // Odd octants run backwards from the next quarter: sine and cosine change places.
  const double along = odd ? base.sine : base.cosine;
  const double across = odd ? base.cosine : base.sine;
  switch (octant >> 1U) {
    case 0: return {across, along};
    case 1: return {along, -across};
    case 2: return {-across, -along};
    default: return {-along, across};
  }
}

}  // namespace welkin::tables
