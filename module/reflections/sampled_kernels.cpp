// Sums of taps. Where each tap falls is found for 16 taps at once. What lies there is then read tap by tap, the four
// texels of a look-up side by side in the 16 lanes, which takes two to four loads; gathers would fetch each float
// alone.
#include "reflections/sampled_kernels.h"

#include <cstddef>

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kWidth, simd::Lanes, simd::Quad, simd::Texels;
using Indices = xsimd::batch<std::int32_t, Lanes::arch_type>;

/// Where directions meet the cube: the face, and -1 to 1 along its rows and its columns, as `CubemapView` has them.
struct OnCube {
  Lanes face, u, v;
};

WELKIN_INLINE OnCube on_cube(Lanes x, Lanes y, Lanes z) {
  const Lanes wide = xsimd::abs(x);
  const Lanes tall = xsimd::abs(y);
  const Lanes deep = xsimd::abs(z);
  const auto on_x = wide >= tall && wide >= deep;
  const auto on_y = tall >= deep;  // where it is not on x
  const Lanes across = xsimd::select(on_x, x, xsimd::select(on_y, y, z));
  const Lanes inverse = Lanes(1.0F) / across;
  const Lanes size = xsimd::abs(inverse);
  const Lanes first = xsimd::select(on_x, Lanes(0.0F), xsimd::select(on_y, Lanes(2.0F), Lanes(4.0F)));
  const Lanes u_on_x = (Lanes(0.0F) - z) * inverse;
  const Lanes u = xsimd::select(on_x, u_on_x, x * xsimd::select(on_y, size, inverse));
  const Lanes v_on_y = z * inverse;
  const Lanes v_elsewhere = (Lanes(0.0F) - y) * size;
  return {first + xsimd::select(across < Lanes(0.0F), Lanes(1.0F), Lanes(0.0F)), u,
          xsimd::select(on_x, v_elsewhere, xsimd::select(on_y, v_on_y, v_elsewhere))};
}

/// Of 16 look-ups: the upper left texel's place in the level, texels from one row to the next, and the weights of
/// upper left, upper right, lower left and lower right.
struct Footprints {
  alignas(64) std::int32_t place[kLanes];
  alignas(64) std::int32_t row[kLanes];
  alignas(64) float weights[4][kLanes];
};

/// The place along an edge, from 0.5 (the edge, half a texel beyond the first centre) to size + 0.5.
WELKIN_INLINE Lanes texels_along(Lanes u, Lanes size) {
  const Lanes place = (u + Lanes(1.0F)) * Lanes(0.5F) * size + Lanes(0.5F);
  return xsimd::min(xsimd::max(place, Lanes(0.5F)), size + Lanes(0.5F));
}

WELKIN_INLINE void place_taps(const TapLevel& level, int k, const OnCube& place, Footprints& to) {
  const Lanes size = Lanes::load_aligned(level.size + k);
  const Lanes column = texels_along(place.u, size);
  const Lanes row = texels_along(place.v, size);
  const Indices left = xsimd::to_int(column);
  const Indices top = xsimd::to_int(row);
  const Lanes right_share = column - xsimd::to_float(left);
  const Lanes lower_share = row - xsimd::to_float(top);
  const Indices edge = xsimd::to_int(size) + Indices(2);
  ((xsimd::to_int(place.face) * edge + top) * edge + left).store_aligned(to.place + k);
  edge.store_aligned(to.row + k);
  const Lanes weight = Lanes::load_aligned(level.weight + k);
  const Lanes lower = weight * lower_share;
  const Lanes upper = weight - lower;
  const Lanes upper_right = upper * right_share;
  const Lanes lower_right = lower * right_share;
  (upper - upper_right).store_aligned(to.weights[0] + k);
  upper_right.store_aligned(to.weights[1] + k);
  (lower - lower_right).store_aligned(to.weights[2] + k);
  lower_right.store_aligned(to.weights[3] + k);
}

/// The four texels of each look-up times their weights, summed over all 16: of four look-ups by pairs, then four by
/// four, so that as few roundings as can be add up where all taps have the same weight.
WELKIN_INLINE Texels sum_of_footprints(const TapLevel& level, const Footprints& taps) {
  Texels sum;
  for (int four = 0; four < kLanes; four += 4) {
    Quad weights[4];
    for (int i = 0; i < 4; ++i) weights[i] = Quad::load_aligned(taps.weights[i] + four);
    simd::transpose(weights);
    alignas(64) float by_tap[4][4];
    for (int i = 0; i < 4; ++i) weights[i].store_aligned(by_tap[i]);
    const auto weighted = [&](int i) WELKIN_INLINE_LAMBDA {
      const float* const upper = level.texels[four + i] + static_cast<std::ptrdiff_t>(taps.place[four + i]) * 4;
      const float* const lower = upper + static_cast<std::ptrdiff_t>(taps.row[four + i]) * 4;
      return simd::weighted_columns(simd::load_texel_pairs(upper, lower), by_tap[i]);
    };
    const Texels here = simd::sum(simd::sum(weighted(0), weighted(1)), simd::sum(weighted(2), weighted(3)));
    sum = four == 0 ? here : simd::sum(sum, here);
  }
  return sum;
}

void sum_taps(const TapGroup* groups, int count, const TapFrame& frame, float* rgb) {
  const auto component = [&frame](const TapGroup& group, int k, int axis) WELKIN_INLINE_LAMBDA {
    return Lanes::load_aligned(group.x + k) * Lanes(frame.x[axis]) +
           Lanes::load_aligned(group.y + k) * Lanes(frame.y[axis]) +
           Lanes::load_aligned(group.z + k) * Lanes(frame.z[axis]);
  };
  double sums[3] = {};
  for (int i = 0; i < count; ++i) {
    const TapGroup& group = groups[i];
    Footprints in_fine;
    Footprints in_coarse;
    for (int k = 0; k < kLanes; k += kWidth) {
      const OnCube place = on_cube(component(group, k, 0), component(group, k, 1), component(group, k, 2));
      place_taps(group.fine, k, place, in_fine);
      if (group.two_levels) place_taps(group.coarse, k, place, in_coarse);
    }
    Texels sum = sum_of_footprints(group.fine, in_fine);
    if (group.two_levels) sum = simd::sum(sum, sum_of_footprints(group.coarse, in_coarse));
    alignas(16) float four[4];
    simd::folded(sum).store_aligned(four);
    for (int c = 0; c < 3; ++c) sums[c] += static_cast<double>(four[c]);
  }
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(sums[c]);
}

}  // namespace

const SampledKernels sampled_kernels_table = {.sum_taps = sum_taps};

}  // namespace welkin::reflections::WELKIN_ISA
