#include "math/elementary.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include "platform/standard_library.h"

namespace welkin::math {
namespace {

constexpr double kLowest = -746.0;   // below: less than half of the least denormal
constexpr double kHighest = 709.79;  // above: more than the largest number
// ln 2 in two parts: the first has 21 trailing zero bits, so that its multiples by up to 2^11 do not round.
constexpr double kLnTwoHigh = 0x1.62e42feep-1;
constexpr double kLnTwoLow = 0x1.a39ef35793c76p-33;
constexpr int kTerms = 13;
constexpr double kMinNormal = -1021.0;  // powers of two below are put on slowly

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
  // n kLnTwoHigh is exact, and x is from half to one and a half of n ln 2: their difference is exact
  // (Sterbenz's lemma), and kLnTwoLow adds the rest of ln 2 (Cody and Waite 1980).
  const double n = std::floor(x * std::numbers::log2e + 0.5);
  const double r = (x - n * kLnTwoHigh) - n * kLnTwoLow;
  double series = kInverseFactorials[kTerms];
  for (std::size_t k = kTerms; k-- > 2;) series = series * r + kInverseFactorials[k];
  const double mantissa = 1.0 + (r + r * r * series);
  // 2^n by its bits, as 2 2^(n - 1): n reaches 1024, whose exponent is that of infinity.
  if (n < kMinNormal) return std::ldexp(mantissa, static_cast<int>(n));
  return 2.0 * mantissa * platform::bit_cast<double>(static_cast<std::uint64_t>(n + 1022.0) << 52U);
}

// Four series side by side, none of which waits for another's sums.
void exponentials(std::array<double, 4>& values) noexcept {
  std::array<double, 4> n;
  std::array<double, 4> r;
  std::array<double, 4> series;
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = values[i];
    if (!(std::abs(x) < 700.0)) {
      for (double& value : values) value = exponential(value);
      return;
    }
    const double turns = x * std::numbers::log2e + 0.5;
    // floor by a conversion, which truncates: one less where that went up. |x| < 700 keeps n within the exponents of
    // normal numbers.
    const auto whole = static_cast<double>(static_cast<std::int32_t>(turns));
    n[i] = whole > turns ? whole - 1.0 : whole;
    r[i] = (x - n[i] * kLnTwoHigh) - n[i] * kLnTwoLow;
    series[i] = kInverseFactorials[kTerms];
  }
  for (std::size_t k = kTerms; k-- > 2;) {
    for (std::size_t i = 0; i < 4; ++i) series[i] = series[i] * r[i] + kInverseFactorials[k];
  }
  for (std::size_t i = 0; i < 4; ++i) {
    values[i] = 2.0 * (1.0 + (r[i] + r[i] * r[i] * series[i])) *
                platform::bit_cast<double>(static_cast<std::uint64_t>(n[i] + 1022.0) << 52U);
  }
}

// x = 2^e m with m from sqrt(1/2) to sqrt(2); ln m = 2 artanh z, z = (m - 1) / (m + 1), |z| < 0.1716: twelve terms of
// its series leave out less than 1e-18.
double logarithm(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // takes the number apart: exact
  if (mantissa < std::numbers::sqrt2 / 2.0) {
    mantissa *= 2.0;
    --exponent;
  }
  const double z = (mantissa - 1.0) / (mantissa + 1.0);
  const double square = z * z;
  double series = 0.0;
  for (int k = 23; k >= 3; k -= 2) series = (series + 1.0 / k) * square;
  return exponent * std::numbers::ln2 + 2.0 * (z + z * series);
}

namespace {

/// Taylor series on [0, pi/4]; the first term left out is below 2e-18.
SineCosine in_first_octant(double x) noexcept {
  const double x2 = x * x;
  double sine = 0.0;
  double cosine = 0.0;
  // Horner from x^17/17! and x^16/16!: each step divides by the two next factors of the factorial.
  // Left out are x^19 / 19! and x^18 / 18!, at pi / 4 8e-20 and 2e-18.
  for (int n = 16; n >= 2; n -= 2) {
    sine = (1.0 + sine) * (-x2 / static_cast<double>(n * (n + 1)));
    cosine = (1.0 + cosine) * (-x2 / static_cast<double>(n * (n - 1)));
  }
  return {x * (1.0 + sine), 1.0 + cosine};
}

/// atan(k / 16) / (2 pi), rounded from 60 digits.
constexpr std::array<double, 17> kTurnsOfSixteenths{
    0x0.0p+0,
    0x1.4586a1872c4d7p-7,
    0x1.4444750777668p-6,
    0x1.e34ff3a10b9ccp-6,
    0x1.3f670b6bdc73dp-5,
    0x1.8ae6855098eecp-5,
    0x1.d3c3a482f3ab5p-5,
    0x1.0cd98d1293ee4p-4,
    0x1.2e4051d9df308p-4,
    0x1.4e06a7aa3c7dep-4,
    0x1.6c266f6edfc1ep-4,
    0x1.88a15bbbca864p-4,
    0x1.a37f5c4c419efp-4,
    0x1.bccd1dfdd0272p-4,
    0x1.d49ab3ac8b1bbp-4,
    0x1.eafa71eebf23ap-4,
    0x1.0000000000000p-3,
};

/// The angle of (along, across), 0 <= across <= along, along > 0, in turns, up to 1/8. With c the multiple of 1/16
/// nearest to the slope, atan(slope) = atan(c) + atan(s), s = (slope - c) / (1 + slope c), |s| <= 1/32: the first
/// term left out of the series for atan(s) is s^11 / 11 < 3e-18.
double turns_in_first_octant(double along, double across) noexcept {
  const double nearest = std::floor(across / along * 16.0 + 0.5);
  const double c = nearest / 16.0;
  // tan(a - b) = (tan a - tan b) / (1 + tan a tan b), times along above and below: one quotient.
  const double s = (across - c * along) / (along + c * across);
  const double s2 = s * s;
  const double series = s * (1.0 - s2 * (1.0 / 3.0 - s2 * (1.0 / 5.0 - s2 * (1.0 / 7.0 - s2 * (1.0 / 9.0)))));
  return kTurnsOfSixteenths[static_cast<std::size_t>(nearest)] + series * (0.5 / std::numbers::pi);
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

double turns_of(double y, double x) noexcept {
  const double across = std::abs(y);
  const double along = std::abs(x);
  if (across == 0.0 && along == 0.0) return 0.0;
  double turns = across <= along ? turns_in_first_octant(along, across) : 0.25 - turns_in_first_octant(across, along);
  if (x < 0.0) turns = 0.5 - turns;
  return std::signbit(y) ? -turns : turns;
}

// The angle of the point (sqrt(1 - x^2), x). 1 - x is exact from 1/2 on, so the root keeps its digits near x = 1.
double arc_sine(double x) noexcept { return turns_of(x, std::sqrt((1.0 - x) * (1.0 + x))) * (2.0 * std::numbers::pi); }

double dot(const std::vector<double>& a, const std::vector<double>& b) noexcept {
  constexpr std::size_t kSums = 8;
  double sums[kSums] = {};
  std::size_t i = 0;
  for (; i + kSums <= a.size(); i += kSums) {
    for (std::size_t k = 0; k < kSums; ++k) sums[k] += a[i + k] * b[i + k];
  }
  for (std::size_t k = 0; i < a.size(); ++i, ++k) sums[k] += a[i] * b[i];
  double sum = 0.0;
  for (const double one : sums) sum += one;
  return sum;
}

}  // namespace welkin::math
