// B-spline coefficients down the rings.
//
// With z = sqrt(3) - 2 and s the shift by a ring, (s^-1 + 4 + s) / 6 = (1 - z s) (1 - z s^-1) / kSplineGain. Its
// inverse is a recursion, which would go ring by ring; but 1 / (1 - z s) is the product of (1 + (z s)^(2^k)) for k = 0,
// 1, 2, ..., and four factors leave out only z^16 = 7e-10. So every ring is served at once.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

constexpr int kRows = 12;   // of a column: two parts of six numbers
constexpr int kReach = 15;  // rings that four factors bring together, each way

/// Where ring pair `pair`, beyond a pole or the equator, is to be found: the pair, and the signs of its parts.
struct Mirrored {
  int pair;
  float even_sign;
  float odd_sign;
};

WELKIN_INLINE Mirrored mirrored(int pair, const SplineRun& run) {
  const int circle = 2 * run.rings;
  int ring = pair;
  while (ring < 0) ring += circle;
  while (ring >= circle) ring -= circle;
  float sign = 1.0F;
  if (ring >= run.rings) {
    ring = circle - 1 - ring;
    if (run.odd_order) sign = -1.0F;
  }
  const bool south = ring >= (run.rings + 1) / 2;
  return {south ? run.rings - 1 - ring : ring, sign, south ? -sign : sign};
}

WELKIN_INLINE void gather_ring(const SplineRun& run, const float* columns, int length, int pair, float* rows) {
  const Mirrored from = mirrored(pair, run);
  const float* const column =
      columns + std::ptrdiff_t{kColumnFloats} * (from.pair / kRingLanes) + from.pair % kRingLanes;
  float* const to = rows + kSplineMargin + pair;
  for (int row = 0; row < kRows; ++row) {
    const float sign = row < kRows / 2 ? from.even_sign : from.odd_sign;
    to[std::ptrdiff_t{length} * row] = sign * column[row * kRingLanes];
  }
}

/// The column numbers as rows of rings, continued by kReach on both sides; the rest of the margins is zero.
WELKIN_INLINE void gather(const SplineRun& run, const float* columns, int length, float* rows) {
  const int pairs = (run.rings + 1) / 2;
  const int whole = pairs / kRingLanes;  // groups without an empty lane
  for (int row = 0; row < kRows; ++row) {
    float* const to = rows + std::ptrdiff_t{length} * row;
    for (int k = 0; k < kSplineMargin; k += kWidth) Lanes(0.0F).store_aligned(to + k);
    for (int group = 0; group < whole; ++group) {
      const float* const from = columns + std::ptrdiff_t{kColumnFloats} * group + row * kRingLanes;
      float* const here = to + kSplineMargin + std::ptrdiff_t{kRingLanes} * group;
      for (int k = 0; k < kRingLanes; k += kWidth) Lanes::load_aligned(from + k).store_aligned(here + k);
    }
    for (int k = kSplineMargin + whole * kRingLanes; k < length; k += kWidth) Lanes(0.0F).store_aligned(to + k);
  }
  for (int pair = -kReach; pair < 0; ++pair) gather_ring(run, columns, length, pair, rows);
  for (int pair = whole * kRingLanes; pair < pairs + kReach; ++pair) gather_ring(run, columns, length, pair, rows);
}

}  // namespace

void spline_rings(const SplineRun& run, float* columns, float* scratch) {
  const int length = run.groups * kRingLanes + 2 * kSplineMargin;
  gather(run, columns, length, scratch);
  constexpr int shifts[4] = {1, 2, 4, 8};
  constexpr float z = -0.267949192431122706F;
  constexpr float powers[4] = {z, z * z, z * z * z * z, z * z * z * z * z * z * z * z};
  // All rows take a step before any takes the next: a load that straddles two stores still on their way would wait.
  const auto each_row = [&](const auto& step) __attribute__((always_inline)) {
    for (int row = 0; row < kRows; ++row) step(scratch + std::ptrdiff_t{length} * row, row);
  };
  for (int k = 0; k < 4; ++k) {
    const Lanes power(powers[k]);
    const int shift = shifts[k];
    each_row([&](float* values, int) __attribute__((always_inline)) {
      for (int i = length - kWidth; i >= kRingLanes; i -= kWidth) {
        const Lanes sum = Lanes::load_aligned(values + i) + power * Lanes::load_unaligned(values + i - shift);
        sum.store_aligned(values + i);
      }
    });
  }
  for (int k = 0; k < 4; ++k) {
    const Lanes power(powers[k]);
    const int shift = shifts[k];
    each_row([&](float* values, int) __attribute__((always_inline)) {
      for (int i = kSplineMargin; i < length - kRingLanes; i += kWidth) {
        const Lanes sum = Lanes::load_aligned(values + i) + power * Lanes::load_unaligned(values + i + shift);
        sum.store_aligned(values + i);
      }
    });
  }
  each_row([&](const float* values, int row) __attribute__((always_inline)) {
    for (int group = 0; group < run.groups; ++group) {
      const float* const from = values + kSplineMargin + std::ptrdiff_t{kRingLanes} * group;
      float* const to = columns + std::ptrdiff_t{kColumnFloats} * group + row * kRingLanes;
      for (int k = 0; k < kRingLanes; k += kWidth) Lanes::load_aligned(from + k).store_aligned(to + k);
    }
  });
}

}  // namespace welkin::simd::WELKIN_ISA
