// Kernels that carry light along a ray through a planet's air, for many suns at once.
//
// A ray's samples are one after the other; the lanes are texels of a table that share the ray and differ in where the
// sun is: its zenith's cosine mu_s where the ray starts, and its cosine nu with the ray. At a sample, with r the radius
// at the start and r' there, s the distance between: mu_s' = (r mu_s + s nu) / r'.
#pragma once

#include <cstddef>
#include <cstdint>

namespace welkin::simd {

/// Suns of a ray. All arrays have `count` entries, a multiple of 16.
struct SkySuns {
  const float* zenith_cosine;  ///< mu_s
  const float* angle_cosine;   ///< nu
  const std::int32_t* row;    ///< where the nearer row of angles starts in a picture of sources: a multiple of its suns
  const float* row_fraction;  ///< towards the next one
  int count;
};

/// A sample that sunlight reaches.
struct SunlitSample {
  float start_ratio;     ///< r / r'
  float distance_ratio;  ///< s / r'
  float horizon;         ///< cosine of the horizon's zenith angle there
  /// Place among the nodes of a row: (rational y / (y + bend) + linear y), y = mu_s' - horizon, at least 0.
  float rational, bend, linear;
  /// Visible share of the disc: t^2 (3 - 2 t), t = slope (mu_s' - horizon) + offset, 0 to 1.
  float disc_slope, disc_offset;
  /// That share is averaged over the stretch of the ray that the sample stands for, from t - w to t + w,
  /// w = |turning (nu - view_cosine mu_s') - sinking|.
  float view_cosine, turning, sinking;
  const float* rows[4];  ///< transmittance to the sun at four heights around: [nodes][4], red, green, blue and 0
  float row_weights[4];
  float transmittance[4];   ///< from the ray's start, and 0
  float rayleigh, aerosol;  ///< density times length
};

/// sums[count][8] += rayleigh times light that the sample sends on before phase functions, red, green, blue and 0, and
/// aerosol times it. slice: scratch, 4 `nodes` floats, nodes a multiple of 4.
using AddSunlight = void (*)(const SunlitSample& sample, int nodes, const SkySuns& suns, float* slice, float* sums);

/// How a sun's zenith cosine maps to its place among nodes (sky/table_mapping.h): d = -mu + sqrt(mu^2 + reach),
/// a = (d - shortest) scale, x = max(1 - a inverse_lowest, 0) / (1 + a); H and T of the top that suns' paths go to.
struct SunAxis {
  float reach;           ///< (H / R)^2
  float shortest;        ///< T / R
  float scale;           ///< R / (H - T)
  float inverse_lowest;  ///< 1 / A
  int nodes;
};

/// A sample that sends on light of a source: the sum of eight pictures of it, [angles][suns][4] each.
struct SourceSample {
  float start_ratio;
  float distance_ratio;
  const float* pictures[8];
  float weights[8][4];  ///< of red, green, blue and nothing
  int count;            ///< of pictures
};

/// sums[count][4] += the source at each sun, linear in angles and suns. picture: scratch, 4 `size` floats; size: angles
/// times suns, a multiple of 4; `next_row`: suns, or 0 if there is but one angle.
using AddSource = void (*)(const SourceSample& sample, const SunAxis& axis, int size, int next_row, const SkySuns& suns,
                           float* picture, float* sums);

/// A ring of directions of one zenith angle, for 16 suns: cosines of whole multiples of the azimuth project it.
struct SkyRing {
  const float* radiance;  ///< [3][azimuths][16], with the strides below
  std::ptrdiff_t channel_stride;
  std::ptrdiff_t azimuth_stride;
  int azimuths;
  const float* azimuth_cosines;  ///< [bands][azimuths]
  const float* values;           ///< harmonics without their azimuth, by m and then l, times the ring's weight
  int bands;
};

/// harmonics[pairs][3][16] += the ring's share.
using ProjectSkyRing = void (*)(const SkyRing& ring, float* harmonics);

/// by_order[m][3][16] = the sum over l < `used`, l >= m, of weights[pair] harmonics[pair], m < `used`.
using FoldSkyOrders = void (*)(const float* harmonics, const float* weights, int bands, int used, float* by_order);

/// out[16][4], red, green, blue and 0: the sum over m < used of by_order[m][c] cos(m phi), not below 0, given cos phi.
using SumSkyOrders = void (*)(const float* by_order, int used, const float* azimuth_cosines, float* out);

struct SkyKernels {
  AddSunlight add_sunlight;
  AddSource add_source;
  ProjectSkyRing project_ring;
  FoldSkyOrders fold_orders;
  SumSkyOrders sum_orders;
};

}  // namespace welkin::simd
