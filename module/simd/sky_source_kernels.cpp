// Radiance about a point to harmonics, folded with phase functions, and back (sky_kernels.h): sixteen suns at a time.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

constexpr int kRegisters = kGroup / kWidth;
constexpr int kValues = 3 * kGroup;  ///< of a pair

}  // namespace

void project_sky_ring(const SkyRing& ring, float* harmonics) {
  int pair = 0;
  for (int m = 0; m < ring.bands; ++m) {
    const float* const cosines = ring.azimuth_cosines + m * ring.azimuths;
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < kRegisters; ++k) {
        const float* const radiance = ring.radiance + c * ring.channel_stride + k * kWidth;
        Lanes sum(0.0F);
        for (int j = 0; j < ring.azimuths; ++j) {
          sum = sum + Lanes(cosines[j]) * Lanes::load_unaligned(radiance + j * ring.azimuth_stride);
        }
        for (int l = m; l < ring.bands; ++l) {
          float* const place = harmonics + (pair + l - m) * kValues + c * kGroup + k * kWidth;
          (Lanes::load_unaligned(place) + Lanes(ring.values[pair + l - m]) * sum).store_unaligned(place);
        }
      }
    }
    pair += ring.bands - m;
  }
}

void fold_sky_orders(const float* harmonics, const float* weights, int bands, int used, float* by_order) {
  int pair = 0;
  for (int m = 0; m < used; ++m) {
    for (int i = 0; i < kValues; i += kWidth) {
      Lanes sum(0.0F);
      for (int l = m; l < used; ++l) {
        sum = sum + Lanes(weights[pair + l - m]) * Lanes::load_unaligned(harmonics + (pair + l - m) * kValues + i);
      }
      sum.store_unaligned(by_order + m * kValues + i);
    }
    pair += bands - m;
  }
}

void sum_sky_orders(const float* by_order, int used, const float* azimuth_cosines, float* out) {
  for (int k = 0; k < kRegisters; ++k) {
    const Lanes cosine = Lanes::load_unaligned(azimuth_cosines + k * kWidth);
    Lanes before = cosine;  // cos(-phi)
    Lanes here(1.0F);
    Lanes sums[3] = {Lanes(0.0F), Lanes(0.0F), Lanes(0.0F)};
    for (int m = 0; m < used; ++m) {
      const float* const values = by_order + m * kValues + k * kWidth;
      for (int c = 0; c < 3; ++c) sums[c] = sums[c] + here * Lanes::load_unaligned(values + c * kGroup);
      const Lanes next = (cosine + cosine) * here - before;
      before = here;
      here = next;
    }
    alignas(64) float colours[3][kWidth];
    for (int c = 0; c < 3; ++c) xsimd::max(sums[c], Lanes(0.0F)).store_aligned(colours[c]);
    for (int i = 0; i < kWidth; ++i) {
      float* const texel = out + 4 * (k * kWidth + i);
      for (int c = 0; c < 3; ++c) texel[c] = colours[c][i];
      texel[3] = 0.0F;
    }
  }
}

}  // namespace welkin::simd::WELKIN_ISA
