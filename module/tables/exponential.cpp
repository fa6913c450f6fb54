#include "tables/exponential.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace welkin::tables {
namespace {

constexpr double kLowest = -746.0;   // below: less than half of the least denormal
constexpr double kHighest = 709.79;  // above: more than the largest number
// ln 2 in two parts: the first has 21 trailing zero bits, so that its multiples by up to 2^11 do not round.
constexpr double kLnTwoHigh = 0x1.62e42feep-1;
constexpr double kLnTwoLow = 0x1.a39ef35793c76p-33;
constexpr int kTerms = 13;
constexpr double kLeastNormal = -1021.0;  // powers of two below are put on slowly

/// 1 / k!
constexpr std::array<double, kTerms + 1> inverse_factorials() {
  std::array<double, kTerms + 1> values{};
  double factorial = 1.0;
  for (std::size_t k = 0; k <= kTerms; ++k) {
    if (k > 0) factorial *= static_cast<double>(k);
    values[k] = 1.0 / factorial;
  }
  return values;
}

constexpr std::array<double, kTerms + 1> kInverseFactorials = inverse_factorials();

}  // namespace

// x = n ln 2 + r, |r| <= ln(2) / 2: the first term left out of the series of e^r is r^14 / 14! < 4e-18.
double exponential(double x) noexcept {
  if (x < kLowest) return 0.0;
  if (x > kHighest) return std::numeric_limits<double>::infinity();
  const double n = std::floor(x * std::numbers::log2e + 0.5);
  const double r = (x - n * kLnTwoHigh) - n * kLnTwoLow;
  double series = kInverseFactorials[kTerms];
  for (std::size_t k = kTerms; k-- > 2;) series = series * r + kInverseFactorials[k];
  const double mantissa = 1.0 + (r + r * r * series);
  if (n < kLeastNormal) return std::ldexp(mantissa, static_cast<int>(n));
  return 2.0 * mantissa * std::bit_cast<double>(static_cast<std::uint64_t>(n + 1022.0) << 52U);
}

}  // namespace welkin::tables
