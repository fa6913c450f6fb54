// The near part of a lobe over texels, by Gauss-Legendre points.
#include "reflections/near_kernels.h"

#include "reflections/narrow_kernels.h"
#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kWidth, simd::Lanes;

template <int count>
struct Rule;
template <>
struct Rule<kNearPoints> {
  static constexpr float points[] = {-0.5773502692F, 0.5773502692F};
  static constexpr float weights[] = {1.0F, 1.0F};
};
template <>
struct Rule<kFineNearPoints> {
  static constexpr float points[] = {-0.8611363116F, -0.3399810436F, 0.3399810436F, 0.8611363116F};
  static constexpr float weights[] = {0.3478548451F, 0.6521451549F, 0.6521451549F, 0.3478548451F};
};

/// (1 - 2 s) (1 / x^2 - P(x)) n^-3 where x < 1. n: the distance of the point in the face's plane; s by the chord, so
/// that it has its digits however small it is.
WELKIN_INLINE Lanes near_part(const NearTexels& texels, Lanes u, Lanes v) {
  const Lanes one(1.0F);
  const Lanes square = one / (one + u * u + v * v);
  const Lanes inverse = xsimd::sqrt(square);
  const Lanes across = u * inverse - Lanes(texels.direction[0]);
  const Lanes down = v * inverse - Lanes(texels.direction[1]);
  const Lanes out = inverse - Lanes(texels.direction[2]);
  const Lanes s = Lanes(0.25F) * (across * across + down * down + out * out);
  const Lanes x = Lanes(texels.offset) + Lanes(texels.inverse_end) * s;
  const Lanes part = (one - Lanes(2.0F) * s) * (one / (x * x) - far_polynomial(x));
  return xsimd::select(x < one, square * inverse * part, Lanes(0.0F));
}

template <int count>
void weigh(const NearTexels& texels, float* weights) {
  for (int k = 0; k < texels.count; k += kWidth) {
    const Lanes column = Lanes::load_unaligned(texels.columns + k);
    const Lanes row = Lanes::load_unaligned(texels.rows + k);
    Lanes sum(0.0F);
    for (int i = 0; i < count; ++i) {
      const Lanes v = row + Lanes(texels.half * Rule<count>::points[i]);
      for (int j = 0; j < count; ++j) {
        const Lanes u = column + Lanes(texels.half * Rule<count>::points[j]);
        const Lanes part = near_part(texels, u, v);
        // a texel's weights add up to 4
        if constexpr (count == kNearPoints) {
          sum += part;
        } else {
          sum += Lanes(Rule<count>::weights[i] * Rule<count>::weights[j]) * part;
        }
      }
    }
    sum.store_unaligned(weights + k);
  }
}

double sum_weights(const float* weights, int count) {
  alignas(64) float sums[kLanes];
  for (int k = 0; k < kLanes; k += kWidth) {
    Lanes sum(0.0F);
    for (int from = k; from < count; from += kLanes) sum += Lanes::load_unaligned(weights + from);
    sum.store_aligned(sums + k);
  }
  double whole = 0.0;
  for (const float sum : sums) whole += static_cast<double>(sum);
  return whole;
}

void write_taps(const float* weights, float scale, std::uint32_t record, int count, RingTap* taps) {
  for (int k = 0; k < count; ++k) taps[k] = {record + static_cast<std::uint32_t>(k), weights[k] * scale};
}

}  // namespace

const NearKernels near_kernels_table = {
    .weigh = weigh<kNearPoints>,
    .weigh_finely = weigh<kFineNearPoints>,
    .sum = sum_weights,
    .write_taps = write_taps,
};

}  // namespace welkin::reflections::WELKIN_ISA
