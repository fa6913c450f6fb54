// The kernels of skies: light carried along rays through a planet's air, and skies looked up and projected.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/dispatch.h"
#include "sky/table_mapping.h"

namespace welkin::sky {

// Light along a ray, for many suns at once.
//
// A ray's samples are one after the other; the lanes are texels of a table that share the ray and differ in where the
// sun is: its zenith's cosine mu_s where the ray starts, and its cosine nu with the ray. At a sample, with r the radius
// at the start and r' there, s the distance between: mu_s' = (r mu_s + s nu) / r'.

/// Straight pieces between two nodes of suns, of a brightness (sky/sky_geometry.h, resample_log_cubic).
inline constexpr int kSunSteps = 32;

/// Suns of a ray. All arrays have `count` entries, a multiple of 16.
struct SkySuns {
  const float* zenith_cosine;  ///< mu_s
  const float* angle_cosine;   ///< nu
  const std::int32_t* row;     ///< where the nearer row of angles starts in an image of sources: a multiple of its suns
  const float* row_fraction;   ///< towards the next one
  int count;
};

/// A sample that sunlight reaches.
struct SunlitSample {
  float start_ratio;     ///< r / r'
  float distance_ratio;  ///< s / r'
  float horizon;         ///< cosine of the horizon's zenith angle there
  /// Position among the nodes of a row: (rational y / (y + bend) + linear y), y = mu_s' - horizon, at least 0.
  float rational, bend, linear;
  /// Visible share of the disc: t^2 (3 - 2 t), t = slope (mu_s' - horizon) + offset, 0 to 1.
  float disc_slope, disc_offset;
  /// That share is averaged over the stretch of the ray that the sample stands for, from t - w to t + w,
  /// w = |turning (nu - view_cosine mu_s') - sinking|.
  float view_cosine, turning, sinking;
  const float* rows[4];  ///< transmittance to the sun at four heights around: [nodes][4], red, green, blue and 0
  float row_weights[4];
  float rayleigh[4], aerosol[4];  ///< density times length times transmittance from the ray's start, and 0
  bool with_aerosol;              ///< else there is too little of it
};

/// How a sun's zenith cosine maps to its position among a source's nodes (sky/table_mapping.h): d = -mu + sqrt(mu^2 +
/// reach), a = (d - shortest) scale, x = path max(1 - a inverse_lowest, 0) / (1 + bend a) + level max(mu - lowest, 0);
/// H and T of the top that suns' paths go to.
struct SunAxis {
  float reach;           ///< (H / R)^2
  float shortest;        ///< T / R
  float scale;           ///< R / (H - T)
  float inverse_lowest;  ///< 1 / A
  float bend, path, level, lowest, zenith;
  int nodes;
};

/// Rows of molecules' scattered light at a height, [kMoleculeTerms][suns][4]: with mu the cosine of a direction's
/// zenith angle, mu_s the sun's and nu that between both, q = nu - mu mu_s,
///   t0 + (3 mu^2 - 1) / 2 t1 - (1 - mu^2) t2 + mu q t3 + q^2 t4,
/// all that bands 0 and 2 of the light about a point leave; q is the product of both sines and the azimuth's cosine.
inline constexpr int kMoleculeTerms = 5;

/// A sample of light scattered from a source: the molecules' at two heights, and the sum of four images of the
/// aerosol's, [angles][suns][4] each.
struct SourceSample {
  float start_ratio;
  float distance_ratio;
  float view_cosine;          ///< mu of the ray there
  const float* molecules[2];  ///< null: nothing of them
  float molecule_weights[2][4];
  const float* images[4];
  float weights[4][4];  ///< of red, green, blue and nothing
  int count;            ///< of images
  /// The source's brightness between suns at the two heights (ScatteringSource::steps), and the heights' weights.
  const float* steps[2];
  float step_weights[2];
};

/// A ring of directions of one zenith angle, for 16 suns, projected by the cosines of whole multiples of the azimuth.
struct SkyRing {
  const float* radiance;  ///< [3][azimuths][16], with the strides below
  std::ptrdiff_t channel_stride;
  std::ptrdiff_t azimuth_stride;
  int azimuths;
  const float* azimuth_cosines;  ///< [bands][azimuths]
  const float* values;           ///< harmonics without their azimuth, by m and then l, times the ring's weight
  int bands;
  int orders;  ///< m below that, at most the bands: as many as the azimuths resolve
};

struct SolverKernels {
  /// sums[count][8] += rayleigh times the sunlight that reaches the sample, red, green, blue and 0, and aerosol times
  /// it. slice: scratch, 8 `nodes` floats, nodes a multiple of 4.
  void (*add_sunlight)(const SunlitSample& sample, int nodes, const SkySuns& suns, float* slice, float* sums);

  /// sums[count][2][4] += the source at each sun: the brightness there times the ratio to it, which is linear in angles
  /// and suns, not below 0. The two are the parts of the nearer node of suns and of the next one, to be added at the
  /// end. scratch: 4 `size` floats, 16 `axis.nodes` and the steps; size: angles times suns, suns a multiple of 16.
  /// `suns.row` and its fractions count only where there are images.
  void (*add_source)(const SourceSample& sample, const SunAxis& axis, int size, const SkySuns& suns, float* scratch,
                     float* sums);

  /// Finds positions of `count` angles, a multiple of 16, among nodes evenly from 0 to 180 degrees, by their cosines:
  /// `row` times the node below, and the fraction towards the next. Within 1e-4 of the step between nodes; 4e-4 radians
  /// next to 0 and 180 degrees, where a float's cosine has no more digits.
  void (*place_angles)(const float* cosines, int count, int angles, int row, std::int32_t* rows, float* fractions);

  /// harmonics[pairs][3][16] += the ring's contribution.
  void (*project_ring)(const SkyRing& ring, float* harmonics);

  /// by_order[m][3][16] = the sum over l < bands, l >= m, of weights[pair] harmonics[pair], m < bands.
  void (*fold_orders)(const float* harmonics, const float* weights, int bands, float* by_order);

  /// out[16][4], red, green, blue and 0: the sum over m < bands of by_order[m][c] cos(m phi), not below 0, given cos
  /// phi.
  void (*sum_orders)(const float* by_order, int bands, const float* azimuth_cosines, float* out);
};
WELKIN_KERNEL_TABLES(SolverKernels, solver_kernels)

// Sky lookups: what the kernels take.

/// Colours at the ends of rays, and factors of the aureole: red, green, blue, 0.
inline constexpr int kSkyColour = 4;

/// A row of a slice: Rayleigh's and higher orders' red, green, blue, 0; the aerosol's red, green, blue, 0.
inline constexpr int kSkyRow = 8;

/// Angles between view and sun at which the aerosol's phase function is corrected (sky/aureole.h): even in the fourth
/// root of (1 - cosine) / 2.
/// sin(angle / 2) = (k / 128)^2: node k stands at about 0.007 k^2 degrees from the sun, and the second to last 20
/// degrees from the point opposite, where factors hardly change.
inline constexpr int kAureoleAngles = 129;

/// Weights of the cubic through four nodes next to each other, at 0 <= x <= 3.
struct CubicTaps {
  std::int32_t first;
  std::int32_t between;  ///< the position lies between this and the next of the four: 0 to 2
  float weights[4];
};

/// Such weights over suns, between which light falls by decades. The cubic is of rows relative to the brightness of
/// their suns, and the weights hold the ratio of the brightness there to that of each node's sun.
struct SunTaps {
  CubicTaps cubic;
  float ratios[2];  ///< of the two nodes in the middle of which the position lies
};

/// Nodes darker than that take no part.
inline constexpr float kMaxRatio = 1e12F;

/// One slice and one sun. Lengths in metres, all in double: planets have 1e9 of them, and altitudes of one.
struct SkyRun {
  // The point from which the slice is seen: the viewer's, or, of one above the air, any point of the top.
  double bottom;       ///< R
  double radius;       ///< r
  double altitude;     ///< h
  double rho_squared;  ///< h (2 R + h)
  double shell;        ///< (T - h) (2 R + T + h)
  double shortest;     ///< T - h
  double to_sky;       ///< positions per metre of distance to the top beyond the shortest
  double to_ground;    ///< positions per metre of distance to the ground beyond h
  double view_bend;    ///< of these positions (TableMapping), or 0
  ViewTerms view_terms;

  bool outside;          ///< the viewer is above the air
  double viewer_radius;  ///< then

  double sun[3];      ///< unit
  double sun_zenith;  ///< mu_s = sun[1]
  double sun_sine;    ///< sqrt(sun[0]^2 + sun[2]^2)

  // Suns' nodes, for views from outside, each of whose rays enters the air under another sun.
  double sun_tangent_squared;  ///< H^2 of the top that suns' paths are measured to
  double sun_thickness;        ///< its T
  double sun_scale;            ///< 1 / (H - T)
  double lowest_sun;           ///< a of the lowest
  double lowest_zenith;        ///< its mu_s
  SunTerms sun_terms;
  SunTaps sun_taps;     ///< from inside
  double azimuth_bend;  ///< q of the azimuths' coordinate, from inside
  AzimuthTerms azimuth_terms;
  const float* brightness;  ///< of suns, in steps between nodes (resample_log_cubic): [(suns - 1)
                            ///< steps + 1]
  float fade;

  int half;  ///< nodes of either half of the views: first those that end on the ground
  int azimuths;
  int suns;
  const float* rows;    ///< [2 half][azimuths][suns][kSkyRow]
  const float* of_sun;  ///< `reduce_sky` of them, or null: computed during the lookup

  bool henyey_greenstein;
  int lobes;                ///< 1: the first of the three below is all channels'; 3: each has its own
  double asymmetry[3];      ///< g
  double aerosol_scale[3];  ///< what does not depend on the angle
  bool hazy;                ///< its phase function is to be multiplied by:
  float aureole[kAureoleAngles * kSkyColour];

  const float* reach;   ///< [half][kSkyColour]: transmittance up to the ground; null: the ground adds no light
  const float* ground;  ///< [grounds][kSkyColour]: radiance of the ground over sqrt|mu_s| with its sign
  int grounds;

  const float* night;   ///< [nights][kSkyColour]: added to what rays to the sky see; null: nothing is
  double night_lowest;  ///< the zenith's cosine at its first node; 1 at its last
  int nights;
};

// A sky's light on rings of equal zenith angle, summed over azimuths.

inline constexpr int kSkyRings = 16;
inline constexpr int kSkyChannels = 6;  ///< Rayleigh's red, green, blue, then the aerosol's

/// The aerosol's phase function of a channel: aerosol (1 + even (1 - x)^2) / (gap + slope x)^1.5.
struct SkyLobe {
  float aerosol;
  float gap;    ///< (1 - |g|)^2
  float slope;  ///< 2 |g|
};

/// Sixteen rings under one sun, one per lane.
///
/// With x = 1 - cos(angle to the lobe's axis), which is the sun or, where the aerosol scatters backwards, the point
/// opposite: x = nearness + breadth * gap(azimuth), so that it has its digits where the lobe is sharp. Radiance is
///   rayleigh (1 + (1 - x)^2) value(c) + phase(c) (value(3 + c) - lobe(c)) + ground(c),
///   value = max(weighted sum of four azimuth nodes' and suns', 0), phase the channel's of `lobes`.
/// (Suns come first, as in views: under each sun the nodes of azimuths stand elsewhere.)
struct SkyRings {
  int azimuths;
  int bands;
  const float* values;            ///< of the first of four suns: [azimuth nodes][...][kSkyChannels][kSkyRings]
  std::ptrdiff_t node_step;       ///< floats between azimuth nodes; suns are kSkyChannels * kSkyRings apart
  const CubicTaps* azimuth_taps;  ///< [azimuths]: of azimuth nodes
  const float* azimuth_gaps;      ///< [azimuths]: 1 - or 1 + cosine
  const float* azimuth_factors;   ///< [azimuths][bands]: weight times cos(m azimuth)
  const float* nearness;          ///< [kSkyRings]
  const float* breadth;           ///< [kSkyRings]: product of the sines of both zenith angles
  const float* ground;            ///< [azimuths][3][kSkyRings]: light of the ground or the night; null: black
  const float* aureole;           ///< [kAureoleAngles][4]: multiplies the aerosol's phase function; null: nothing does
  float sun_weights[4];
  float lobe[3];
  float rayleigh;
  int lobe_count;    ///< 1: the first is all channels'; 3: each has its own
  SkyLobe lobes[3];  ///< gap and slope are those of a lobe about the axis; one that points away from it has
                     ///< (1 + |g|)^2 and -2 |g|
  float even;        ///< Cornette-Shanks: 1; Henyey-Greenstein: 0
};

struct ViewKernels {
  /// of_sun[2 half][azimuths][kSkyRow] = the rows weighted by the sun's taps.
  void (*reduce)(const SkyRun& run, float* of_sun);

  /// Radiance from each of `count` directions x y z, which need not be of unit length (the origin counts as up).
  void (*radiance)(const SkyRun& run, const double* directions, int count, float* rgb);

  /// Adds to sums[bands][3][kSkyRings]: radiance times each azimuth's factors.
  void (*add_rings)(const SkyRings& rings, float* sums);

  /// Adds to sums[kSkyRings]: the first lobe's phase function times each azimuth's first factor.
  void (*add_lobe)(const SkyRings& rings, float* sums);
};
WELKIN_KERNEL_TABLES(ViewKernels, view_kernels)

}  // namespace welkin::sky
