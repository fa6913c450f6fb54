// A sky's light on rings of equal zenith angle, summed over azimuths.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

struct Phases {
  Lanes rayleigh, aerosol;
};

WELKIN_INLINE Phases phases(const SkyRings& rings, Lanes x) {
  const Lanes one(1.0F);
  const Lanes cosine = one - x;
  const Lanes square = cosine * cosine;
  const Lanes d = Lanes(rings.gap) + Lanes(rings.slope) * x;
  return {Lanes(rings.rayleigh) * (one + square),
          Lanes(rings.aerosol) * (one + Lanes(rings.even) * square) / (d * xsimd::sqrt(d))};
}

/// Of one channel between four suns; `values` are the first one's of this register's rings.
WELKIN_INLINE Lanes between_suns(const SkyRings& rings, const float* values) {
  constexpr int sun = kSkyChannels * kSkyRings;
  const Lanes a = Lanes(rings.sun_weights[0]) * Lanes::load_aligned(values);
  const Lanes b = Lanes(rings.sun_weights[1]) * Lanes::load_aligned(values + sun);
  const Lanes c = Lanes(rings.sun_weights[2]) * Lanes::load_aligned(values + 2 * sun);
  const Lanes d = Lanes(rings.sun_weights[3]) * Lanes::load_aligned(values + 3 * sun);
  return xsimd::max((a + b) + (c + d), Lanes(0.0F));
}

}  // namespace

void add_sky_rings(const SkyRings& rings, float* sums) {
  for (int lane = 0; lane < kSkyRings; lane += kWidth) {
    const Lanes nearness = Lanes::load_unaligned(rings.nearness + lane);
    const Lanes breadth = Lanes::load_unaligned(rings.breadth + lane);
    for (int i = 0; i < rings.azimuths; ++i) {
      const Phases phase = phases(rings, nearness + breadth * Lanes(rings.azimuth_gaps[i]));
      const float* const values = rings.values + i * rings.azimuth_step + lane;
      const float* const factors = rings.azimuth_factors + static_cast<std::ptrdiff_t>(i) * rings.bands;
      for (int c = 0; c < 3; ++c) {
        const Lanes rayleigh = between_suns(rings, values + c * kSkyRings);
        const Lanes aerosol = between_suns(rings, values + (3 + c) * kSkyRings) - Lanes(rings.lobe[c]);
        Lanes light = phase.rayleigh * rayleigh + phase.aerosol * aerosol;
        if (rings.ground != nullptr) {
          light = light + Lanes::load_unaligned(rings.ground + (3 * i + c) * kSkyRings + lane);
        }
        for (int m = 0; m < rings.bands; ++m) {
          float* const sum = sums + (3 * m + c) * kSkyRings + lane;
          (Lanes::load_unaligned(sum) + Lanes(factors[m]) * light).store_unaligned(sum);
        }
      }
    }
  }
}

void add_sky_lobe(const SkyRings& rings, float* sums) {
  for (int lane = 0; lane < kSkyRings; lane += kWidth) {
    const Lanes nearness = Lanes::load_unaligned(rings.nearness + lane);
    const Lanes breadth = Lanes::load_unaligned(rings.breadth + lane);
    Lanes sum = Lanes::load_unaligned(sums + lane);
    for (int i = 0; i < rings.azimuths; ++i) {
      const Phases phase = phases(rings, nearness + breadth * Lanes(rings.azimuth_gaps[i]));
      sum = sum + Lanes(rings.azimuth_factors[static_cast<std::ptrdiff_t>(i) * rings.bands]) * phase.aerosol;
    }
    sum.store_unaligned(sums + lane);
  }
}

}  // namespace welkin::simd::WELKIN_ISA
