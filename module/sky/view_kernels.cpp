// The radiance of a sky: sixteen directions' geometry in double lanes, then each one's cubic through 4 x 4 (x 4) rows.
//
// The formulas are those of sky/table_mapping.h and sky/sky_slice.h, where they are explained.
#include "simd/vec.h"
#include "sky/sky_kernels.h"

namespace welkin::sky::WELKIN_ISA {
namespace {

using simd::DoubleLanes, simd::kDoubleWidth, simd::kLanes, simd::kNarrowWidth, simd::kWidth, simd::Lanes,
    simd::NarrowLanes;

constexpr double kPi = 3.14159265358979324;
constexpr double kTiny = 1e-300;  // below any number that matters, above what divides to infinity
constexpr float kRayleigh = static_cast<float>(3.0 / (16.0 * kPi));

/// Positions and phase functions of sixteen directions.
struct Positions {
  alignas(64) double view[kLanes];     ///< position within the half
  alignas(64) double azimuth[kLanes];  ///< position
  alignas(64) double sun[kLanes];      ///< position, from outside
  alignas(64) double fade[kLanes];     ///< from outside
  alignas(64) double hit[kLanes];      ///< 0: a ray that misses the air
  alignas(64) double ends[kLanes];     ///< 1: on the ground
  alignas(64) double ground[kLanes];   ///< position
  alignas(64) double night[kLanes];    ///< position
  alignas(64) double rayleigh[kLanes];
  alignas(64) double aerosol[3][kLanes];  ///< of the run's lobes
  alignas(64) double aureole[kLanes];     ///< position
};

WELKIN_INLINE DoubleLanes constant(double value) { return DoubleLanes(value); }

WELKIN_INLINE DoubleLanes between(DoubleLanes value, double low, double high) {
  return xsimd::min(xsimd::max(value, constant(low)), constant(high));
}

WELKIN_INLINE DoubleLanes square_root(DoubleLanes value) { return xsimd::sqrt(xsimd::max(value, constant(0.0))); }

/// Distance to the top, without cancellation either way.
WELKIN_INLINE DoubleLanes to_top(DoubleLanes along, double shell) {
  const DoubleLanes root = xsimd::sqrt(along * along + constant(shell));
  const auto up = along > constant(0.0);
  const DoubleLanes sum = xsimd::max(along + root, constant(kTiny));
  return xsimd::select(up, constant(shell) / sum, root - along);
}

/// Cosine between view and sun to phase functions.
/// (1 - |g|)^2 + 2 |g| (1 - nu) = 1 + g^2 - 2 g nu for g > 0, and with 1 + nu for g < 0: a sum of two parts that are
/// not negative, where the textbook's form cancels next to nu = 1. The aureole's nodes are even in the fourth root of
/// (1 - nu) / 2 = sin^2(angle / 2), about the root of the angle: dense at the sun.
WELKIN_INLINE void store_phases(const SkyRun& run, DoubleLanes nu, int k, Positions& positions) {
  const DoubleLanes lobe = constant(1.0) + nu * nu;
  lobe.store_aligned(positions.rayleigh + k);
  for (int c = 0; c < run.lobes; ++c) {
    const double g = run.asymmetry[c];
    const double size = g < 0.0 ? -g : g;
    const DoubleLanes ahead = g < 0.0 ? constant(1.0) + nu : constant(1.0) - nu;
    const DoubleLanes square = constant((1.0 - size) * (1.0 - size)) + constant(2.0 * size) * ahead;
    const DoubleLanes denominator = square * xsimd::sqrt(square);
    const DoubleLanes scale = constant(run.aerosol_scale[c]);
    const DoubleLanes numerator = run.henyey_greenstein ? scale : scale * lobe;
    (numerator / denominator).store_aligned(positions.aerosol[c] + k);
  }
  const DoubleLanes angle = xsimd::sqrt(square_root(constant(0.5) * (constant(1.0) - nu)));
  (angle * constant(kAureoleAngles - 1)).store_aligned(positions.aureole + k);
}

/// Position and fade of suns whose zenith cosine is known.
/// `TableMapping::sun_coordinate`, and `sun_fade`'s smoothstep from the nadir to the lowest sun.
WELKIN_INLINE void store_suns(const SkyRun& run, DoubleLanes mu_s, int k, Positions& positions) {
  const DoubleLanes distance = to_top(constant(run.bottom) * mu_s, run.sun_tangent_squared);
  const DoubleLanes a = xsimd::max(distance - constant(run.sun_thickness), constant(0.0)) * constant(run.sun_scale);
  const SunTerms& terms = run.sun_terms;
  const DoubleLanes path = xsimd::max(constant(1.0) - a / constant(run.lowest_sun), constant(0.0)) /
                           (constant(1.0) + constant(terms.bend) * a);
  const DoubleLanes mu = xsimd::max(mu_s, constant(terms.lowest));
  const DoubleLanes above = mu - constant(terms.centre);
  const DoubleLanes set = above / xsimd::sqrt(above * above + constant(terms.width * terms.width));
  const DoubleLanes x = between(constant(terms.path) * path + constant(terms.level) * (mu - constant(terms.lowest)) +
                                    constant(terms.sunset) * (set - constant(terms.sunset_lowest)),
                                0.0, 1.0);
  const DoubleLanes u = xsimd::min((constant(1.0) - x) / constant(kHighSuns), constant(1.0));
  const DoubleLanes rest = constant(1.0) - u;
  const DoubleLanes bent = xsimd::sqrt(u * (u + constant(terms.zenith) * (rest * rest * rest))) - u;
  ((x - constant(kHighSuns) * bent) * constant(run.suns - 1)).store_aligned(positions.sun + k);
  const DoubleLanes t = between((mu_s + constant(1.0)) / constant(run.lowest_zenith + 1.0 + kTiny), 0.0, 1.0);
  (t * t * (constant(3.0) - constant(2.0) * t)).store_aligned(positions.fade + k);
}

/// Positions from 0 to half - 1 as thin shells bend them.
/// x = (1 + b) y / (y + b) with x = position / last on both sides.
WELKIN_INLINE DoubleLanes bent(const SkyRun& run, DoubleLanes position) {
  const double last = run.half - 1;
  return constant((1.0 + run.view_bend) * last) * position / (position + constant(run.view_bend * last));
}

/// Positions of rays to the top from 0 to half - 1 as they crowd at both ends (ViewTerms).
WELKIN_INLINE DoubleLanes crowded(const SkyRun& run, DoubleLanes position) {
  const double last = run.half - 1;
  const ViewTerms& terms = run.view_terms;
  const DoubleLanes u = position * constant(1.0 / last);
  const DoubleLanes y = xsimd::sqrt(u * (constant(terms.zenith) + constant(1.0 - terms.zenith) * u));
  return y * (constant((1.0 - terms.horizon) * last) + constant(terms.horizon * last) * (y * y * y));
}

/// q of the azimuths' coordinate (TableMapping).
WELKIN_INLINE DoubleLanes azimuth_bend(const AzimuthTerms& terms, DoubleLanes mu_s) {
  const DoubleLanes one = constant(1.0);
  const DoubleLanes t = (mu_s - constant(terms.middle)) / constant(terms.width);
  const DoubleLanes u = xsimd::max(constant(terms.start) - mu_s, constant(0.0)) / constant(terms.rise);
  const DoubleLanes fall = one + t * t;
  return constant(terms.most) / (fall * fall) - constant(terms.deep) * u * u / (one + u * u);
}

/// One register of directions.
WELKIN_INLINE void locate(const SkyRun& run, DoubleLanes x, DoubleLanes y, DoubleLanes z, int k, Positions& positions) {
  const DoubleLanes one = constant(1.0);
  const DoubleLanes zero = constant(0.0);
  const DoubleLanes length = xsimd::sqrt(x * x + y * y + z * z);
  const auto some = length > constant(kTiny);
  const DoubleLanes inverse = one / xsimd::select(some, length, one);
  const DoubleLanes dx = x * inverse;
  const DoubleLanes dy = xsimd::select(some, y * inverse, one);
  const DoubleLanes dz = z * inverse;
  const DoubleLanes sine = xsimd::sqrt(dx * dx + dz * dz);
  const DoubleLanes level = dx * constant(run.sun[0]) + dz * constant(run.sun[2]);
  const DoubleLanes nu = between(level + dy * constant(run.sun_zenith), -1.0, 1.0);
  store_phases(run, nu, k, positions);

  DoubleLanes mu = between(dy, -1.0, 1.0);
  DoubleLanes mu_s = constant(run.sun_zenith);
  DoubleLanes along = constant(run.radius) * mu;
  DoubleLanes discriminant = along * along - constant(run.rho_squared);
  // nu = mu mu_s + s s_s cos(azimuth): `level` is s s_s cos(azimuth), the product of the horizontal parts.
  DoubleLanes cosine = level / xsimd::max(sine * constant(run.sun_sine), constant(kTiny));
  if (run.night != nullptr) {
    const DoubleLanes share = (mu - constant(run.night_lowest)) / constant(1.0 - run.night_lowest);
    (between(share, 0.0, 1.0) * constant(run.nights - 1)).store_aligned(positions.night + k);
  }
  if (run.outside) {
    // b: how near the ray's line comes to the centre. It comes in where its zenith's sine is b / top.
    // b = r_v sin is the same at all points of the line. It meets the top's sphere at (r_v mu + s) = -+
    // sqrt(top^2 - b^2); the nearer point, at s = -r_v mu - root, is where the air is entered, with
    // mu' = (r_v mu + s) / top = -root / top. There
    // (r' mu')^2 - rho'^2 = (top^2 - b^2) - (top^2 - R^2) = R^2 - b^2 decides on the ground, in a product that keeps
    // the sign of a ray that only just touches. mu_s' = (r_v mu_s + s nu) / top, and the azimuth about the new vertical
    // follows from nu, which does not change along the ray: cos = (nu - mu' mu_s') / (sin' sin_s'), sin' = b / top.
    const DoubleLanes b = constant(run.viewer_radius) * sine;
    const DoubleLanes top = constant(run.radius);
    const DoubleLanes root = square_root((top - b) * (top + b));
    const DoubleLanes distance = zero - constant(run.viewer_radius) * mu - root;
    xsimd::select((mu < zero) && (b < top), one, zero).store_aligned(positions.hit + k);
    mu = zero - root / top;
    mu_s = between((constant(run.viewer_radius * run.sun_zenith) + distance * nu) / top, -1.0, 1.0);
    along = zero - root;
    discriminant = (constant(run.bottom) - b) * (constant(run.bottom) + b);
    const DoubleLanes sun_sine = square_root((one - mu_s) * (one + mu_s));
    cosine = (nu - mu * mu_s) / xsimd::max(b / top * sun_sine, constant(kTiny));
    store_suns(run, mu_s, k, positions);
  }
  const DoubleLanes even = (between(cosine, -1.0, 1.0) + one) * constant(0.5);
  const DoubleLanes bend = run.outside ? azimuth_bend(run.azimuth_terms, mu_s) : constant(run.azimuth_bend);
  const DoubleLanes bent_even = xsimd::min((one + bend) * even / (one + bend * even), one);
  (bent_even * constant(run.azimuths - 1)).store_aligned(positions.azimuth + k);

  const auto ends = (mu < zero) && (discriminant > zero);
  // The nearer root of s^2 + 2 (r mu) s + rho^2 = 0 as rho^2 over the farther one (sky_geometry.h).
  const DoubleLanes reach = xsimd::max(square_root(discriminant) - along, constant(kTiny));
  const DoubleLanes to_ground = constant(run.rho_squared) / reach;
  const double last = run.half - 1;
  const DoubleLanes below = between((to_ground - constant(run.altitude)) * constant(run.to_ground), 0.0, last);
  const DoubleLanes down = constant(last) - (run.view_bend > 0.0 ? bent(run, below) : below);
  const DoubleLanes above =
      between((to_top(along, run.shell) - constant(run.shortest)) * constant(run.to_sky), 0.0, last);
  DoubleLanes up = above;
  if (run.view_bend > 0.0) up = bent(run, above);
  if (run.view_terms.crowd()) up = crowded(run, above);
  xsimd::select(ends, down, up).store_aligned(positions.view + k);
  xsimd::select(ends, one, zero).store_aligned(positions.ends + k);

  // The sun's cosine where the ray ends, and its position among nodes that are even in sqrt|mu| with mu's sign.
  const DoubleLanes mu_ground =
      between((constant(run.radius) * mu_s + to_ground * nu) / constant(run.bottom), -1.0, 1.0);
  const DoubleLanes rooted = xsimd::sqrt(xsimd::abs(mu_ground));
  const DoubleLanes folded = xsimd::select(mu_ground < zero, zero - rooted, rooted);
  ((folded + one) * constant(0.5 * (run.grounds - 1))).store_aligned(positions.ground + k);
}

/// Where a sky falls off steeply, at the rim of the planet's shadow, a cubic swings beyond its nodes: it may leave the
/// range of the two that the position lies between by this share of them, which smooth skies do not need.
constexpr float kMin = 0.9F;
constexpr float kMax = 1.1F;

/// The cubic through the four nodes about a position among `count` >= 4.
/// Lagrange's weights for nodes 0 to 3: -(x - 1) (x - 2) (x - 3) / 6, x (x - 2) (x - 3) / 2, and their mirror images.
WELKIN_INLINE CubicTaps taps_at(double position, int count) {
  int first = static_cast<int>(position) - 1;
  first = first > count - 4 ? count - 4 : first;
  first = first < 0 ? 0 : first;
  const auto x0 = static_cast<float>(position - first);
  const float x1 = x0 - 1.0F;
  const float x2 = x0 - 2.0F;
  const float x3 = x0 - 3.0F;
  const float low = x0 * x1;
  const float high = x2 * x3;
  const int between = x1 < 0.0F ? 0 : x2 < 0.0F ? 1 : 2;
  return {first, between, {x1 * high * (-1.0F / 6.0F), x0 * high * 0.5F, low * x3 * -0.5F, low * x2 * (1.0F / 6.0F)}};
}

/// A row in registers.
struct Row {
  static constexpr int kRegisters = kSkyRow / kNarrowWidth;
  NarrowLanes part[kRegisters];
};

WELKIN_INLINE Row nothing() {
  Row row;
  for (NarrowLanes& part : row.part) part = NarrowLanes(0.0F);
  return row;
}
WELKIN_INLINE Row load_row(const float* from) {
  Row row;
  for (int i = 0; i < Row::kRegisters; ++i) row.part[i] = NarrowLanes::load_unaligned(from + i * kNarrowWidth);
  return row;
}
WELKIN_INLINE Row plus(Row sum, float weight, Row row) {
  for (int i = 0; i < Row::kRegisters; ++i) sum.part[i] = sum.part[i] + NarrowLanes(weight) * row.part[i];
  return sum;
}
WELKIN_INLINE Row limited(Row row, Row a, Row b) {
  for (int i = 0; i < Row::kRegisters; ++i) {
    const NarrowLanes minimum = NarrowLanes(kMin) * xsimd::min(a.part[i], b.part[i]);
    const NarrowLanes maximum = NarrowLanes(kMax) * xsimd::max(a.part[i], b.part[i]);
    row.part[i] = xsimd::min(xsimd::max(row.part[i], minimum), maximum);
  }
  return row;
}
WELKIN_INLINE void store_row(Row row, float* to) {
  for (int i = 0; i < Row::kRegisters; ++i) row.part[i].store_unaligned(to + i * kNarrowWidth);
}

/// Returns the weighted sum of four rows, limited by kMin and kMax about the two that the position lies between.
WELKIN_INLINE Row cubic(const Row* rows, const CubicTaps& taps) {
  Row sum = nothing();
  for (int i = 0; i < 4; ++i) sum = plus(sum, taps.weights[i], rows[i]);
  return limited(sum, rows[taps.between], rows[taps.between + 1]);
}

WELKIN_INLINE Row times(float factor, Row row) {
  for (NarrowLanes& part : row.part) part = NarrowLanes(factor) * part;
  return row;
}

WELKIN_INLINE Row over_suns(const float* first, const SunTaps& sun) {
  Row rows[4];
  for (int i = 0; i < 4; ++i) rows[i] = load_row(first + i * kSkyRow);
  Row sum = nothing();
  for (int i = 0; i < 4; ++i) sum = plus(sum, sun.cubic.weights[i], rows[i]);
  return limited(sum, times(sun.ratios[0], rows[sun.cubic.between]), times(sun.ratios[1], rows[sun.cubic.between + 1]));
}

WELKIN_INLINE float ratio_to(float brightness, float node) {
  const float ratio = node > 0.0F ? brightness / node : 1.0F;
  return ratio < kMaxRatio ? ratio : kMaxRatio;
}

/// Sum_i w_i (row_i / B_i) B = Sum_i (w_i B / B_i) row_i: the cubic of rows relative to their sun's brightness is a
/// weighted sum of the rows themselves, and costs no more than one of the rows would.
WELKIN_INLINE SunTaps sun_taps_at(const SkyRun& run, double position) {
  SunTaps taps{taps_at(position, run.suns), {}};
  const int limit = (run.suns - 1) * kSunSteps - 1;
  const double fine = position * kSunSteps;
  const int step = static_cast<int>(fine) < limit ? static_cast<int>(fine) : limit;
  const auto part = static_cast<float>(fine - step);
  const float brightness = run.brightness[step] + part * (run.brightness[step + 1] - run.brightness[step]);
  float ratios[4];
  for (int i = 0; i < 4; ++i) {
    ratios[i] = ratio_to(brightness, run.brightness[(taps.cubic.first + i) * kSunSteps]);
    taps.cubic.weights[i] = taps.cubic.weights[i] * ratios[i];
  }
  taps.ratios[0] = ratios[taps.cubic.between];
  taps.ratios[1] = ratios[taps.cubic.between + 1];
  return taps;
}

/// The interpolated row of one direction.
/// Cubics over suns, then azimuths, then views, each held to the range of its two middle rows: 64 rows of eight floats,
/// or 16 if the slice was reduced to the run's sun, which all directions share.
WELKIN_INLINE void interpolate(const SkyRun& run, int view_base, const CubicTaps& view, const CubicTaps& azimuth,
                               const SunTaps& sun, float* row) {
  Row views[4];
  for (int a = 0; a < 4; ++a) {
    const std::ptrdiff_t index = static_cast<std::ptrdiff_t>(view_base + view.first + a) * run.azimuths + azimuth.first;
    Row azimuths[4];
    for (int b = 0; b < 4; ++b) {
      azimuths[b] = run.of_sun != nullptr
                        ? load_row(run.of_sun + (index + b) * kSkyRow)
                        : over_suns(run.rows + ((index + b) * run.suns + sun.cubic.first) * kSkyRow, sun);
    }
    views[a] = cubic(azimuths, azimuth);
  }
  store_row(cubic(views, view), row);
}

WELKIN_INLINE float positive(float value) { return value > 0.0F ? value : 0.0F; }

/// Three channels times the aureole's factors at a position.
WELKIN_INLINE void multiply_aureole(const float* aureole, float position, float* rgb) {
  const int node = static_cast<int>(position) < kAureoleAngles - 2 ? static_cast<int>(position) : kAureoleAngles - 2;
  const float part = position - static_cast<float>(node);
  const float* const low = aureole + node * kSkyColour;
  for (int c = 0; c < 3; ++c) rgb[c] = rgb[c] * (low[c] + part * (low[kSkyColour + c] - low[c]));
}

/// Adds the ground's light, at the end of a ray with these taps.
WELKIN_INLINE void add_ground(const SkyRun& run, const CubicTaps& view, double position, float* rgb) {
  const int limit = run.grounds - 2;
  const int node = static_cast<int>(position) < limit ? static_cast<int>(position) : limit;
  const auto t = static_cast<float>(position - node);
  const float* const ground = run.ground + node * kSkyColour;
  const float* const reach = run.reach + view.first * kSkyColour;
  for (int c = 0; c < 3; ++c) {
    float through = 0.0F;
    for (int i = 0; i < 4; ++i) through = through + view.weights[i] * reach[i * kSkyColour + c];
    // A cubic through transmittances may leave [0, 1] where they fall fast, next to the horizon.
    through = positive(through) < 1.0F ? positive(through) : 1.0F;
    rgb[c] = rgb[c] + through * (ground[c] + t * (ground[kSkyColour + c] - ground[c]));
  }
}

/// Adds the night's light.
WELKIN_INLINE void add_night(const SkyRun& run, double position, float* rgb) {
  const int node = static_cast<int>(position) < run.nights - 2 ? static_cast<int>(position) : run.nights - 2;
  const auto t = static_cast<float>(position - node);
  const float* const low = run.night + node * kSkyColour;
  for (int c = 0; c < 3; ++c) rgb[c] = rgb[c] + (low[c] + t * (low[kSkyColour + c] - low[c]));
}

WELKIN_INLINE void look_up(const SkyRun& run, const Positions& positions, int k, float* rgb) {
  const double fade = run.outside ? positions.fade[k] : static_cast<double>(run.fade);
  const bool ends = positions.ends[k] > 0.0;
  rgb[0] = rgb[1] = rgb[2] = 0.0F;
  if (run.outside && !(positions.hit[k] > 0.0)) return;
  const CubicTaps view = taps_at(positions.view[k], run.half);
  const CubicTaps azimuth = taps_at(positions.azimuth[k], run.azimuths);
  const SunTaps sun = run.outside ? sun_taps_at(run, positions.sun[k]) : run.sun_taps;
  alignas(32) float row[kSkyRow];
  interpolate(run, ends ? 0 : run.half, view, azimuth, sun, row);
  const float rayleigh = static_cast<float>(positions.rayleigh[k]) * kRayleigh;
  float aerosol[3];
  for (int c = 0; c < 3; ++c) aerosol[c] = static_cast<float>(positions.aerosol[run.lobes > 1 ? c : 0][k]);
  if (run.hazy) multiply_aureole(run.aureole, static_cast<float>(positions.aureole[k]), aerosol);
  for (int c = 0; c < 3; ++c) {
    rgb[c] = static_cast<float>(fade) * (positive(row[c]) * rayleigh + positive(row[4 + c]) * aerosol[c]);
  }
  if (ends && run.reach != nullptr) add_ground(run, view, positions.ground[k], rgb);
  if (!ends && run.night != nullptr) add_night(run, positions.night[k], rgb);
}

void reduce_sky(const SkyRun& run, float* of_sun) {
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(2) * run.half * run.azimuths;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const float* const from = run.rows + (i * run.suns + run.sun_taps.cubic.first) * kSkyRow;
    store_row(over_suns(from, run.sun_taps), of_sun + i * kSkyRow);
  }
}

void sky_radiance(const SkyRun& run, const double* directions, int count, float* rgb) {
  Positions positions;
  for (int first = 0; first < count; first += kLanes) {
    const int part = count - first < kLanes ? count - first : kLanes;
    alignas(64) double x[kLanes];
    alignas(64) double y[kLanes];
    alignas(64) double z[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const double* const from = directions + std::ptrdiff_t{3} * (first + (k < part ? k : 0));
      x[k] = from[0];
      y[k] = from[1];
      z[k] = from[2];
    }
    for (int k = 0; k < part; k += kDoubleWidth) {
      locate(run, DoubleLanes::load_aligned(x + k), DoubleLanes::load_aligned(y + k), DoubleLanes::load_aligned(z + k),
             k, positions);
    }
    for (int k = 0; k < part; ++k) look_up(run, positions, k, rgb + std::ptrdiff_t{3} * (first + k));
  }
}

// A sky's light on rings of equal zenith angle, summed over azimuths.

/// d^(3/2) = d sqrt(d); x comes without cancellation, see SkyRings.
WELKIN_INLINE Lanes lobe_phase(const SkyRings& rings, const SkyLobe& lobe, Lanes x) {
  const Lanes one(1.0F);
  const Lanes cosine = one - x;
  const Lanes square = cosine * cosine;
  const Lanes d = Lanes(lobe.gap) + Lanes(lobe.slope) * x;
  return Lanes(lobe.aerosol) * (one + Lanes(rings.even) * square) / (d * xsimd::sqrt(d));
}

WELKIN_INLINE Lanes rayleigh_phase(const SkyRings& rings, Lanes x) {
  const Lanes one(1.0F);
  const Lanes cosine = one - x;
  return Lanes(rings.rayleigh) * (one + cosine * cosine);
}

/// Returns a channel's light between four suns; `values` are the first one's of this register's rings.
WELKIN_INLINE Lanes between_suns(const SkyRings& rings, const float* values) {
  constexpr int sun = kSkyChannels * kSkyRings;
  const Lanes a = Lanes(rings.sun_weights[0]) * Lanes::load_aligned(values);
  const Lanes b = Lanes(rings.sun_weights[1]) * Lanes::load_aligned(values + sun);
  const Lanes c = Lanes(rings.sun_weights[2]) * Lanes::load_aligned(values + 2 * sun);
  const Lanes d = Lanes(rings.sun_weights[3]) * Lanes::load_aligned(values + 3 * sun);
  return (a + b) + (c + d);
}

/// The azimuth nodes about an azimuth, between suns. Azimuths follow each other, so that four are kept: most need
/// none that the one before did not.
struct NearNodes {
  int node[4] = {-1, -1, -1, -1};
  Lanes light[4][kSkyChannels];
};

/// `values` are those of this register's rings.
/// Nodes' slots are their numbers modulo 4: any four that follow each other have four different ones, and moving on by
/// one node overwrites the one that is no longer needed.
WELKIN_INLINE void bring(const SkyRings& rings, const CubicTaps& taps, const float* values, NearNodes& near) {
  for (int node = taps.first; node < taps.first + 4; ++node) {
    const int slot = node & 3;
    if (near.node[slot] == node) continue;
    near.node[slot] = node;
    const float* const from = values + node * rings.node_step;
    for (int c = 0; c < kSkyChannels; ++c) near.light[slot][c] = between_suns(rings, from + c * kSkyRings);
  }
}

/// One channel between the nodes.
WELKIN_INLINE Lanes between_nodes(const NearNodes& near, const CubicTaps& taps, int channel) {
  const int first = taps.first;
  const Lanes a = Lanes(taps.weights[0]) * near.light[first & 3][channel];
  const Lanes b = Lanes(taps.weights[1]) * near.light[(first + 1) & 3][channel];
  const Lanes c = Lanes(taps.weights[2]) * near.light[(first + 2) & 3][channel];
  const Lanes d = Lanes(taps.weights[3]) * near.light[(first + 3) & 3][channel];
  return xsimd::max((a + b) + (c + d), Lanes(0.0F));
}

/// Factors of a register's directions, x = 1 - cosine.
WELKIN_INLINE void fill_aureole(const float* aureole, Lanes x, float (&factors)[3][kWidth]) {
  alignas(64) float positions[kWidth];
  const Lanes half = xsimd::min(xsimd::max(Lanes(0.5F) * x, Lanes(0.0F)), Lanes(1.0F));
  (xsimd::sqrt(xsimd::sqrt(half)) * Lanes(static_cast<float>(kAureoleAngles - 1))).store_aligned(positions);
  for (int k = 0; k < kWidth; ++k) {
    float rgb[3] = {1.0F, 1.0F, 1.0F};
    multiply_aureole(aureole, positions[k], rgb);
    for (int c = 0; c < 3; ++c) factors[c][k] = rgb[c];
  }
}

void add_sky_rings(const SkyRings& rings, float* sums) {
  for (int lane = 0; lane < kSkyRings; lane += kWidth) {
    const Lanes nearness = Lanes::load_unaligned(rings.nearness + lane);
    const Lanes breadth = Lanes::load_unaligned(rings.breadth + lane);
    NearNodes near;
    for (int i = 0; i < rings.azimuths; ++i) {
      const CubicTaps& taps = rings.azimuth_taps[i];
      bring(rings, taps, rings.values + lane, near);
      const Lanes x = nearness + breadth * Lanes(rings.azimuth_gaps[i]);
      const Lanes molecules = rayleigh_phase(rings, x);
      Lanes phase = lobe_phase(rings, rings.lobes[0], x);
      alignas(64) float aureole[3][kWidth];
      if (rings.aureole != nullptr) fill_aureole(rings.aureole, x, aureole);
      const float* const factors = rings.azimuth_factors + static_cast<std::ptrdiff_t>(i) * rings.bands;
      for (int c = 0; c < 3; ++c) {
        const Lanes rayleigh = between_nodes(near, taps, c);
        Lanes aerosol = between_nodes(near, taps, 3 + c) - Lanes(rings.lobe[c]);
        if (rings.aureole != nullptr) aerosol = aerosol * Lanes::load_aligned(aureole[c]);
        if (rings.lobe_count > 1 && c > 0) phase = lobe_phase(rings, rings.lobes[c], x);
        Lanes light = molecules * rayleigh + phase * aerosol;
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
      const Lanes phase = lobe_phase(rings, rings.lobes[0], nearness + breadth * Lanes(rings.azimuth_gaps[i]));
      sum = sum + Lanes(rings.azimuth_factors[static_cast<std::ptrdiff_t>(i) * rings.bands]) * phase;
    }
    sum.store_unaligned(sums + lane);
  }
}

}  // namespace

const ViewKernels view_kernels_table = {
    .reduce = reduce_sky,
    .radiance = sky_radiance,
    .add_rings = add_sky_rings,
    .add_lobe = add_sky_lobe,
};

}  // namespace welkin::sky::WELKIN_ISA
