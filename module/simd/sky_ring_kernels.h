// A sky's light on rings of equal zenith angle, summed over azimuths.
#pragma once

#include <cstddef>

namespace welkin::simd {

inline constexpr int kSkyRings = 16;
inline constexpr int kSkyChannels = 6;  ///< Rayleigh's red, green, blue, then the aerosol's

/// Sixteen rings under one sun. A lane is a ring.
///
/// With x = 1 - cos(angle to the lobe's axis), which is the sun or, where the aerosol scatters backwards, the point
/// opposite: x = nearness + breadth * gap(azimuth), so that it has its digits where the lobe is sharp. Radiance is
///   rayleigh (1 + (1 - x)^2) value(c) + aerosol (value(3 + c) - lobe(c)) (1 + even (1 - x)^2) / d^1.5 + ground(c),
///   d = gap + slope x, value = max(weighted sum of four suns', 0).
struct SkyRings {
  int azimuths;
  int bands;
  const float* values;           ///< of the first of four suns: [azimuths][...][kSkyChannels][kSkyRings]
  std::ptrdiff_t azimuth_step;   ///< floats between azimuths; suns are kSkyChannels * kSkyRings apart
  const float* azimuth_gaps;     ///< [azimuths]: 1 - or 1 + cosine
  const float* azimuth_factors;  ///< [azimuths][bands]: weight times cos(m azimuth)
  const float* nearness;         ///< [kSkyRings]
  const float* breadth;          ///< [kSkyRings]: product of the sines of both zenith angles
  const float* ground;           ///< [azimuths][3][kSkyRings], or null: black
  float sun_weights[4];
  float lobe[3];
  float rayleigh;
  float aerosol;
  float gap;    ///< (1 - |g|)^2
  float slope;  ///< 2 |g|
  float even;   ///< Cornette-Shanks: 1; Henyey-Greenstein: 0
};

/// Adds to sums[bands][3][kSkyRings]: radiance times each azimuth's factors.
using AddSkyRings = void (*)(const SkyRings& rings, float* sums);

/// Adds to sums[kSkyRings]: the aerosol's phase function times each azimuth's first factor.
using AddSkyLobe = void (*)(const SkyRings& rings, float* sums);

struct SkyRingKernels {
  AddSkyRings add_rings;
  AddSkyLobe add_lobe;
};

}  // namespace welkin::simd
