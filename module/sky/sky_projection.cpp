#include "sky/sky_projection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "image/pixels.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/projection_kernels.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/vertical_harmonics.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin::sky {
namespace {

constexpr int kMaxAzimuths = 256;

void check(const SkyHarmonicsOptions& options) {
  image::require_range("bands of sky harmonics", options.bands, 1, kMaximumBands);
  image::require_range("zeniths of sky harmonics", options.zeniths, 2, 128);
  image::require_range("azimuths of sky harmonics", options.azimuths, 2, kMaxAzimuths);
  switch (options.quadrature) {
    case SkyQuadrature::uniform:
    case SkyQuadrature::gauss:
    case SkyQuadrature::gauss_split: return;
  }
  throw Error(ErrorCode::invalid_argument, "sky harmonics: quadrature " +
                                               std::to_string(static_cast<int>(options.quadrature)) +
                                               " is unknown; pass uniform, gauss or gauss_split");
}

void add_ring(RingRule& rings, double cosine, double weight) {
  rings.cosines.push_back(cosine);
  rings.sines.push_back(std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))));
  rings.weights.push_back(weight);
}

/// The horizon is where a sky changes fastest: cosine = horizon + (end - horizon) t^2.
/// dmu = 2 (end - horizon) t dt with t = (1 + node) / 2, dt = weight / 2. Ray lengths go as the root of the distance
/// from the horizon, sqrt((r mu)^2 - rho^2) ~ t: a polynomial in t follows that, and one in the cosine cannot.
RingRule gauss_rings(int count, double horizon, double end) {
  RingRule rings;
  const math::GaussNodes rule = math::gauss_nodes(count);
  for (int k = 0; k < count; ++k) {
    const double t = 0.5 * (1.0 + rule.nodes[static_cast<std::size_t>(k)]);
    const double weight = rule.weights[static_cast<std::size_t>(k)] * t;  // 1/2 of the interval, 2 t of the square
    add_ring(rings, horizon + (end - horizon) * t * t, std::abs(end - horizon) * weight);
  }
  return rings;
}

/// Midpoints of equal angles, as in the article: Int f dmu = Int f sin(theta) dtheta, steps of pi / count.
void add_uniform_rings(SkyRule& rule, int count, double horizon) {
  for (int k = 0; k < count; ++k) {
    const math::SineCosine zenith = math::sine_cosine_of_turns((2.0 * k + 1.0) / (4.0 * count));
    const double weight = zenith.sine * std::numbers::pi / count;
    add_ring(zenith.cosine >= horizon ? rule.above : rule.below, zenith.cosine, weight);
  }
}

/// A in tan(azimuth / 2) = A tan(t / 2). A trapezoid of 2n points errs like exp(-2n b), b the distance from the real
/// axis to the nearest pole in t. The lobe's denominator 1 + g^2 - 2 g cos(azimuth) is 0 at azimuth = i ln g (its
/// mirror image counts alike). tan(i x) = i tanh(x), so that the pole moves to t = i b with
///   tanh(b / 2) = tanh(-ln(g) / 2) / A.
/// The map's own pole, where d azimuth / dt = A / (cos^2(t / 2) + A^2 sin^2(t / 2)) is infinite, has
/// tan(t / 2) = +-i / A: it lies at t = pi + i b with coth(b / 2) = 1 / A, or tanh(b / 2) = A. Both are equally far at
/// A^2 = tanh(-ln(g) / 2) = (1 - g) / (1 + g). A third more was best in a search at g = 0.8, as the map's pole is met
/// by polynomials of the harmonics' and Rayleigh's degrees. With few points, or a lobe too sharp for them, the map's
/// pole must not come closer than b = 2 atanh(A) = 8 / n, where the error's law is exp(-16): A >= tanh(4 / n), here by
/// its Pade approximant x (1 + x^2 / 15) / (1 + 2 x^2 / 5), whose bits are the same everywhere
/// (2e-7 off at n = 16, 1e-5 at n = 8). For ring and sun on the horizontal, 16 azimuths have the integral of
/// Henyey-Greenstein's lobe to 8e-7 at g = 0.8, where equal steps of the azimuth miss it by 5e-3.
double azimuth_clustering(int count, double asymmetry) {
  const double size = std::abs(asymmetry);
  const double lobe = (1.0 - size) / (1.0 + size);  // tanh(-ln(g) / 2)
  const double steps = 4.0 / count;
  const double minimum = steps * (1.0 + steps * steps / 15.0) / (1.0 + steps * steps * 0.4);  // tanh, nearly
  const double factor = std::min(1.0, std::max(4.0 / 3.0 * std::sqrt(lobe), std::min(1.0, minimum)));
  return asymmetry < 0.0 ? 1.0 / factor : factor;
}

/// Midpoints of equal steps in t: as good as with ends, and a whole register's worth.
/// With c, s the cosine and sine of t / 2: cos(azimuth) = (1 - tan^2) / (1 + tan^2) of half the
/// azimuth = (c^2 - A^2 s^2) / (c^2 + A^2 s^2), 1 - and 1 + it are twice either part over the sum, without a
/// difference, and d azimuth / dt = A / (c^2 + A^2 s^2). Each azimuth stands for its mirror image: steps of t are
/// pi / count, weights twice that.
AzimuthRule azimuth_rule(int count, double clustering) {
  AzimuthRule rule;
  for (int k = 0; k < count; ++k) {
    const math::SineCosine half = math::sine_cosine_of_turns((2.0 * k + 1.0) / (8.0 * count));
    const double towards = half.cosine * half.cosine;
    const double away = clustering * clustering * half.sine * half.sine;
    const double sum = towards + away;
    rule.cosines.push_back((towards - away) / sum);
    rule.from_sun.push_back(2.0 * away / sum);
    rule.from_opposite.push_back(2.0 * towards / sum);
    rule.weights.push_back(2.0 * std::numbers::pi / count * clustering / sum);
  }
  return rule;
}

}  // namespace

SkyRule sky_rule(const SkyHarmonicsOptions& options, double horizon, double top, double asymmetry) {
  check(options);
  SkyRule rule;
  if (options.quadrature == SkyQuadrature::uniform) {
    add_uniform_rings(rule, options.zeniths, horizon);
  } else {
    rule.above = gauss_rings(options.zeniths, horizon, top);
    rule.below = gauss_rings(options.zeniths, horizon, -1.0);
  }
  const bool cluster = options.quadrature == SkyQuadrature::gauss_split;
  rule.azimuths = azimuth_rule(options.azimuths, cluster ? azimuth_clustering(options.azimuths, asymmetry) : 1.0);
  return rule;
}

namespace {

constexpr int kRings = kSkyRings;
constexpr int kChunk = 16;  // azimuths
constexpr std::size_t kMax = std::size_t{1} << 30U;

static_assert(kRings == 16);

/// Returns the zenith cosine of the highest ring with any light: from space, that of the upper edge of the air.
double top_cosine(const SkySlice& slice, const Atmosphere& atmosphere) {
  if (!slice.outside()) return 1.0;
  const double above = slice.altitude() - (atmosphere.top_radius_m - atmosphere.bottom_radius_m);
  return horizon_cosine(atmosphere.top_radius_m, above);
}

}  // namespace

SkyProjection::SkyProjection(SkyView view, const SkyHarmonicsOptions& options)
    : view_(std::move(view)),
      options_(options),
      slice_(SkyViewAccess::slice(view_)),
      asymmetries_(slice_.fold().asymmetries()),
      one_lobe_(all_equal(asymmetries_)),
      backwards_(*std::max_element(asymmetries_.begin(), asymmetries_.end()) < 0.0),
      bottom_(view_.tables()->atmosphere.bottom_radius_m),
      radius_(1.0 + slice_.altitude() / bottom_),
      horizon_(horizon_cosine(bottom_, slice_.altitude())) {
  prepare_turns();
  const Atmosphere& atmosphere = view_.tables()->atmosphere;
  for (std::size_t c = 0; c < 3; ++c) {
    aerosol_[c] = aerosol_lobe(atmosphere, asymmetries_[c], backwards_);
    spectra_[c] = aerosol_moments(atmosphere, asymmetries_[c], kMaximumBands);
  }
  const double sharpest = *std::max_element(asymmetries_.begin(), asymmetries_.end(),
                                            [](double a, double b) { return std::abs(a) < std::abs(b); });
  const SkyRule rule = sky_rule(options, horizon_, top_cosine(slice_, atmosphere), sharpest);
  azimuths_ = rule.azimuths;
  directions_ = options.azimuths * static_cast<int>(rule.above.cosines.size() + rule.below.cosines.size());
  check_size(rule.above.cosines.size() + rule.below.cosines.size());
  for (std::size_t i = 0; i < azimuths_.cosines.size(); ++i) {
    gaps_.push_back(static_cast<float>(backwards_ ? azimuths_.from_opposite[i] : azimuths_.from_sun[i]));
    double before = azimuths_.cosines[i];
    // cos((m + 1) x) = 2 cos x cos(m x) - cos((m - 1) x), from cos(-x) = cos x and cos 0 = 1.
    double here = 1.0;  // cos(m azimuth) by Chebyshev's recurrence
    for (int m = 0; m < options.bands; ++m) {
      factors_.push_back(static_cast<float>(azimuths_.weights[i] * here));
      const double next = 2.0 * azimuths_.cosines[i] * here - before;
      before = here;
      here = next;
    }
  }
  add_rings(rule.above);
  add_rings(rule.below);
}

void SkyProjection::check_size(std::size_t rings) const {
  if (slice_.outside()) return;
  const std::size_t bytes = (rings + 2 * kRings) * static_cast<std::size_t>(slice_.azimuths()) *
                            static_cast<std::size_t>(slice_.suns()) * kSkyChannels * sizeof(float);
  if (bytes <= kMax) return;
  throw Error(ErrorCode::limit_exceeded,
              "sky harmonics: " + std::to_string(rings) + " rings x " + std::to_string(slice_.azimuths()) +
                  " azimuths x " + std::to_string(slice_.suns()) +
                  " suns take more than 1 GiB; use fewer zeniths, azimuths or suns in the table");
}

// Groups of sixteen rings, each with its part of the slice; uniform rings leave two groups unfilled, on either side of
// the horizon.
std::uint64_t projection_bytes(const SkyTableOptions& tables, const SkyHarmonicsOptions& options) noexcept {
  const SliceShape shape = slice_shape(tables);
  const auto texels = static_cast<std::uint64_t>(shape.azimuths) * static_cast<std::uint64_t>(shape.suns);
  const std::uint64_t side = (static_cast<std::uint64_t>(options.zeniths) + kRings - 1) / kRings;
  const std::uint64_t groups = options.quadrature == SkyQuadrature::uniform ? side + 1 : 2 * side;
  const std::uint64_t group =
      kRings * (texels * kSkyChannels * sizeof(float) + even_count(options.bands) * sizeof(double));
  const std::uint64_t of_azimuths = static_cast<std::uint64_t>(options.azimuths) *
                                    (64 + 2 * static_cast<std::uint64_t>(options.bands) * sizeof(float));
  // Their vector doubles its capacity, and a row of the slice is held while a group is filled.
  return groups * (group + 3 * sizeof(RingGroup)) + texels * kSkyRow * sizeof(float) + of_azimuths +
         sizeof(SkyProjection) + (std::uint64_t{64} << 10U);
}

void SkyProjection::add_rings(const RingRule& rings) {
  const auto count = static_cast<int>(rings.cosines.size());
  const std::size_t terms = even_count(options_.bands);
  std::vector<double> basis(terms);
  for (int first = 0; first < count; first += kRings) {
    RingGroup group;
    group.basis.resize(terms * kRings);
    for (int lane = 0; lane < kRings; ++lane) {
      const auto ring = static_cast<std::size_t>(std::min(first + lane, count - 1));
      group.cosines[lane] = rings.cosines[ring];
      group.sines[lane] = rings.sines[ring];
      even_basis(rings.cosines[ring], rings.sines[ring], options_.bands, basis);
      const double weight = first + lane < count ? rings.weights[ring] : 0.0;
      for (std::size_t k = 0; k < terms; ++k)
        group.basis[k * kRings + static_cast<std::size_t>(lane)] = weight * basis[k];
    }
    if (!slice_.outside()) fill_values(group);
    groups_.push_back(std::move(group));
  }
}

void SkyProjection::fill_values(RingGroup& group) const {
  const auto suns = static_cast<std::size_t>(slice_.suns());
  const std::size_t count = static_cast<std::size_t>(slice_.azimuths()) * suns;
  group.values = platform::AlignedBuffer<float>(count * kSkyChannels * kRings);
  std::vector<float> rows(count * kSkyRow);
  for (std::size_t lane = 0; lane < kRings; ++lane) {
    const ViewLookup point = slice_.view_lookup(group.cosines[lane]);
    slice_.view_rows(point.taps, rows.data());
    if (!point.ground && slice_.night().any()) {
      group.any_night = true;
      group.night[lane] = slice_.night().radiance(group.cosines[lane]);
    }
    if (point.ground) {
      group.ground[lane].distance = point.distance;
      for (int c = 0; c < 3; ++c) {
        group.ground[lane].transmittance[c] = static_cast<double>(point.transmittance[c]);
        group.any_ground = group.any_ground || point.transmittance[c] > 0.0F;
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      float* const to = group.values.data() + k * kSkyChannels * kRings + lane;
      for (std::size_t c = 0; c < kSkyChannels; ++c) to[c * kRings] = rows[k * kSkyRow + c + c / 3];
    }
  }
}

/// Returns the aerosol's light without its phase function towards the sun itself, or towards the horizon below it,
/// times the fraction of the lobe above the horizon. Any fraction gives the same integral where the nodes resolve the
/// lobe. Where they do not, this one is nearly right: small lobes fall like (w^2 + angle^2)^(-3/2), w = -ln g, or
/// nearly (1 - g) / sqrt(g), which a straight horizon cuts into 1/2 + atan(elevation / w) / pi. gap + slope x with x =
/// 1 - cos(angle) ~ angle^2 / 2 is slope / 2 times (w^2 + angle^2), w^2 = gap / (slope / 2) = (1 - g)^2 / g. On the
/// plane that touches the sphere at the sun, Int (w^2 + x^2 + y^2)^(-3/2) dy = 2 / (w^2 + x^2), and over x below e Int
/// 2 / (w^2 + x^2) dx = (2 / w) (pi / 2 + atan(e / w)), of 2 pi / w in all: 1/2 + atan(e / w) / pi.
SkyProjection::Lobe SkyProjection::lobe_at(const SunAngles& sun, const SunLookup& point) const noexcept {
  Lobe lobe{};
  if (options_.quadrature != SkyQuadrature::gauss_split || backwards_) return lobe;
  const double horizon_sine = std::sqrt((1.0 - horizon_) * (1.0 + horizon_));
  const double above = sun.zenith_cosine * horizon_sine - sun.zenith_sine * horizon_;  // sine of the elevation over it
  const double over = horizon_ * sun.zenith_cosine + horizon_sine * sun.zenith_sine;   // cosine
  const double angle = over > 0.0 ? above : (above < 0.0 ? -1.0 : 1.0);
  const ViewLookup view = slice_.view_lookup(std::max(sun.zenith_cosine, horizon_));
  const CubicTaps azimuth = slice_.azimuth_taps(1.0, sun.zenith_cosine);
  const auto suns = static_cast<std::ptrdiff_t>(slice_.suns());
  for (int v = 0; v < 4; ++v) {
    for (int a = 0; a < 4; ++a) {
      const std::ptrdiff_t row =
          (static_cast<std::ptrdiff_t>(view.taps.first + v) * slice_.azimuths() + azimuth.first + a) * suns;
      const double weight = static_cast<double>(view.taps.weights[v]) * static_cast<double>(azimuth.weights[a]);
      for (int s = 0; s < 4; ++s) {
        const float* const values = slice_.values() + (row + point.taps.cubic.first + s) * kSkyRow + 4;
        const double part = weight * static_cast<double>(point.taps.cubic.weights[s]);
        for (std::size_t c = 0; c < 3; ++c) lobe[c] += part * static_cast<double>(values[c]);
      }
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    // w, and then the fraction: turns_of is an arctangent over 2 pi, so that twice it is the angle over pi.
    const double width = std::sqrt(aerosol_[c].gap / std::max(0.5 * aerosol_[c].slope, 1e-3));
    const double share = asymmetries_[c] < 0.0 ? 0.0 : 0.5 + 2.0 * math::turns_of(angle, width);
    lobe[c] = static_cast<double>(static_cast<float>(share * std::max(lobe[c], 0.0)));
  }
  return lobe;
}

// The part that the rings leave out, in closed form: Int P(nu) Y(l, m) dw = chi_l Y(l, m)(sun) (Funk and Hecke), so
// that
//   Int P V Y = Int P (V - V_sun) Y + V_sun chi_l Y(sun),
// V what the aerosol scatters without its phase function. The first integrand is 0 where P is sharpest, and the nodes
// carry it.
void SkyProjection::add_lobe(const SunAngles& sun, const Lobe& lobe, std::span<glm::dvec3> even) const {
  std::array<double, kMaximumBands*(kMaximumBands + 1) / 2> basis;
  even_basis(sun.zenith_cosine, sun.zenith_sine, options_.bands, basis);
  const std::array<double, 3> depths = slice_.aureole_depths(sun.zenith_cosine);
  for (int l = 0; l < options_.bands; ++l) {
    for (int m = 0; m <= l; ++m) {
      for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        const double chi = spectra_[channel][static_cast<std::size_t>(l)];
        const double loss = depths[channel] > 0.0 ? slice_.aureole().loss(channel, chi, depths[channel]) : 0.0;
        const double moment = chi - loss;
        even[even_index(l, m)][c] += moment * basis[even_index(l, m)] * lobe[channel];
      }
    }
  }
}

/// Writes light of the ground under a group's rays, for azimuths from `first` on: [count][3][16].
///
/// Where a ray ends, the sun stands at (r mu_s + d nu) / R, which is linear in the azimuth's cosine. Over rays that end
/// nearby it varies so little that a parabola through three suns is exact to rounding; others compute each azimuth.
/// The end of the ray is x + d v, so that its zenith has the product (r mu_s + d nu) / R with the sun,
/// and nu = mu mu_s + sin sin_s cos(azimuth): centre + swing cos(azimuth). The parabola in the cosine has the values at
/// 1, 0 and -1.
void SkyProjection::fill_ground(const RingGroup& group, const SunAngles& sun, int first, int count,
                                float* ground) const noexcept {
  // A parabola through f(-1), f(0) and f(1), f(c) = E(centre + swing c), errs by |d3E| swing^3 |c^3 - c| / 6, at most
  // |d3E| swing^3 / (9 sqrt(3)): 6e-11 of the third derivative d3E for a swing of `gentle`. That is large only while
  // the disc sets.
  constexpr double flat = 1e-9;
  constexpr double gentle = 1e-3;
  glm::dvec3 below(0.0);
  double below_centre = std::numeric_limits<double>::quiet_NaN();
  for (int lane = 0; lane < kRings; ++lane) {
    const GroundRay& ray = group.ground[lane];
    const double reach = ray.distance / bottom_;
    const double centre = radius_ * sun.zenith_cosine + reach * group.cosines[lane] * sun.zenith_cosine;
    const double swing = reach * group.sines[lane] * sun.zenith_sine;
    if (centre != below_centre) below = slice_.ground_radiance(centre);  // on the ground all rays see the same
    below_centre = centre;
    const glm::dvec3 through(ray.transmittance[0], ray.transmittance[1], ray.transmittance[2]);
    glm::dvec3 slope(0.0);
    glm::dvec3 bend(0.0);
    if (!(swing > flat)) {
      for (int c = 0; c < 3; ++c) {
        const auto light = static_cast<float>(std::max(through[c] * below[c], 0.0));
        for (int i = 0; i < count; ++i) ground[(3 * i + c) * kRings + lane] = light;
      }
      continue;
    }
    if (swing <= gentle) {
      const glm::dvec3 near = slice_.ground_radiance(centre + swing);
      const glm::dvec3 far = slice_.ground_radiance(centre - swing);
      slope = 0.5 * (near - far);
      bend = 0.5 * (near + far) - below;
    }
    for (int i = 0; i < count; ++i) {
      const double cosine = azimuths_.cosines[static_cast<std::size_t>(first + i)];
      const glm::dvec3 seen =
          swing > gentle ? slice_.ground_radiance(centre + swing * cosine) : below + cosine * (slope + cosine * bend);
      for (int c = 0; c < 3; ++c) {
        ground[(3 * i + c) * kRings + lane] = static_cast<float>(std::max(through[c] * seen[c], 0.0));
      }
    }
  }
}

namespace {

/// Writes the night's light in the same layout; it is the same at all azimuths.
void fill_night(const RingGroup& group, int count, float* light) noexcept {
  for (int i = 0; i < 3 * count; ++i) {
    for (int lane = 0; lane < kRings; ++lane) light[i * kRings + lane] = static_cast<float>(group.night[lane][i % 3]);
  }
}

}  // namespace

/// Returns the kernels' input for a group under a sun, except values, azimuths and ground.
/// 1 - nu = 1 - mu mu_s - s s_s cos(azimuth) = (1 - mu mu_s - s s_s) + s s_s (1 - cos(azimuth)), and
/// 1 + nu = (1 + mu mu_s - s s_s) + s s_s (1 + cos(azimuth)): `nearness` + `breadth` x gap. The difference is taken
/// once per ring, in double, and the gap of the azimuth has its digits, so that a float's x is right where the lobe is
/// sharp.
SkyRings SkyProjection::rings_of(const RingGroup& group, const SunAngles& sun, SunDistances& distances) const noexcept {
  const double side = backwards_ ? -1.0 : 1.0;
  for (int k = 0; k < kRings; ++k) {
    const double along = group.cosines[k] * sun.zenith_cosine;
    const double across = group.sines[k] * sun.zenith_sine;
    distances.nearness[k] = static_cast<float>(std::max(0.0, 1.0 - side * along - across));
    distances.breadth[k] = static_cast<float>(across);
  }
  SkyRings rings{};
  rings.bands = options_.bands;
  rings.azimuths = options_.azimuths;
  rings.azimuth_gaps = gaps_.data();
  rings.azimuth_factors = factors_.data();
  rings.node_step = static_cast<std::ptrdiff_t>(slice_.suns()) * kSkyChannels * kRings;
  rings.nearness = distances.nearness;
  rings.breadth = distances.breadth;
  rings.rayleigh = static_cast<float>(rayleigh_phase(0.0));
  rings.lobe_count = one_lobe_ ? 1 : 3;
  for (std::size_t c = 0; c < 3; ++c) {
    rings.lobes[c] = {static_cast<float>(aerosol_[c].factor), static_cast<float>(aerosol_[c].gap),
                      static_cast<float>(aerosol_[c].slope)};
  }
  rings.even = static_cast<float>(aerosol_[0].even);
  return rings;
}

/// Returns the quadrature's own integral of a channel's phase function over the sphere.
/// `basis` of (0, 0) is weight / sqrt(4 pi): times 2 sqrt(pi) the weights remain.
double SkyProjection::lobe_integral(const SunAngles& sun, std::size_t channel) const noexcept {
  SunDistances distances;
  double integral = 0.0;
  for (const RingGroup& group : groups_) {
    alignas(64) float sums[kRings] = {};
    SkyRings rings = rings_of(group, sun, distances);
    rings.lobes[0] = rings.lobes[channel];
    view_kernels().add_lobe(rings, sums);
    for (std::size_t k = 0; k < kRings; ++k) integral += group.basis[k] * static_cast<double>(sums[k]);
  }
  return integral * (2.0 * std::sqrt(std::numbers::pi));
}

const float* SkyProjection::aureole_under(const SunAngles& sun, float* scratch) const noexcept {
  const std::array<double, 3> depths = slice_.aureole_depths(sun.zenith_cosine);
  if (!(depths[0] > 0.0 || depths[1] > 0.0 || depths[2] > 0.0)) return nullptr;
  slice_.aureole().factors(depths, scratch);
  return scratch;
}

void SkyProjection::add_group(const RingGroup& group, const SunAngles& sun, const SunLookup& point,
                              const CubicTaps* azimuth_taps, const Lobe& lobe, const Lobe& aerosol,
                              const float* aureole, std::span<glm::dvec3> even) const {
  alignas(64) float ground[kChunk * 3 * kRings];
  alignas(64) float sums[kMaximumBands * 3 * kRings] = {};
  SunDistances distances;
  SkyRings rings = rings_of(group, sun, distances);
  rings.rayleigh *= point.fade;
  for (std::size_t c = 0; c < 3; ++c) rings.lobes[c].aerosol = static_cast<float>(aerosol[c]) * point.fade;
  for (int k = 0; k < 4; ++k) rings.sun_weights[k] = point.taps.cubic.weights[k];
  for (std::size_t c = 0; c < 3; ++c) rings.lobe[c] = static_cast<float>(lobe[c]);
  rings.ground = group.any_ground || group.any_night ? ground : nullptr;
  if (group.any_night) fill_night(group, std::min(kChunk, options_.azimuths), ground);
  rings.aureole = aureole;
  rings.values = group.values.data() + static_cast<std::ptrdiff_t>(point.taps.cubic.first) * kSkyChannels * kRings;
  for (int first = 0; first < options_.azimuths; first += kChunk) {
    rings.azimuths = std::min(kChunk, options_.azimuths - first);
    rings.azimuth_taps = azimuth_taps + first;
    rings.azimuth_gaps = gaps_.data() + first;
    rings.azimuth_factors = factors_.data() + static_cast<std::ptrdiff_t>(first) * options_.bands;
    if (group.any_ground) fill_ground(group, sun, first, rings.azimuths, ground);
    view_kernels().add_rings(rings, sums);
  }
  const double* basis = group.basis.data();
  for (int l = 0; l < options_.bands; ++l) {
    for (int m = 0; m <= l; ++m, basis += kRings) {
      for (int c = 0; c < 3; ++c) {
        const float* const sum = sums + (3 * m + c) * kRings;
        // Four sums that do not depend on each other, in a fixed order: a compiler may keep them in one register.
        double lanes[4] = {};
        for (int k = 0; k < kRings; ++k) lanes[k % 4] += basis[k] * static_cast<double>(sum[k]);
        even[even_index(l, m)][c] += (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
      }
    }
  }
}

/// Returns the phase functions' factors. Where nodes hit a lobe that is too sharp for them, their integral of it is too
/// large: it is divided by that integral if that is above 1.
SkyProjection::Lobe SkyProjection::aerosol_factors(const SunAngles& sun) const noexcept {
  constexpr double sharp = 0.85;
  const bool split = options_.quadrature == SkyQuadrature::gauss_split;
  Lobe factors{};
  for (std::size_t c = 0; c < 3; ++c) {
    const bool as_before = one_lobe_ && c > 0;
    const bool scaled = !as_before && split && std::abs(asymmetries_[c]) > sharp && !slice_.aureole().glows();
    factors[c] = as_before ? factors[0] : aerosol_[c].factor;
    if (scaled) factors[c] /= std::max(lobe_integral(sun, c), 1.0);
  }
  return factors;
}

void SkyProjection::project(const SunAngles& sun, std::span<glm::dvec3> even) const {
  if (slice_.outside()) return project_plainly(sun, even);
  const std::size_t terms = even_count(options_.bands);
  for (std::size_t k = 0; k < terms; ++k) even[k] = glm::dvec3(0.0);
  const SunLookup point = slice_.sun_lookup(sun.zenith_cosine);
  const Lobe lobe = lobe_at(sun, point);
  const Lobe aerosol = aerosol_factors(sun);
  float scratch[kAureoleAngles * kSkyColour];
  const float* const aureole = aureole_under(sun, scratch);
  std::array<CubicTaps, kMaxAzimuths> azimuth_taps;  // NOLINT: as many as there are azimuths are filled in
  slice_.azimuth_taps(azimuths_.cosines, sun.zenith_cosine, azimuth_taps.data());
  for (const RingGroup& group : groups_) {
    add_group(group, sun, point, azimuth_taps.data(), lobe, aerosol, aureole, even);
  }
  const auto fade = static_cast<double>(point.fade);
  add_lobe(sun, {fade * lobe[0], fade * lobe[1], fade * lobe[2]}, even);
}

namespace {

/// The aureole's factors at a cosine between view and sun.
glm::dvec3 aureole_at(const float* aureole, double nu) {
  const double root = std::sqrt(std::sqrt(std::clamp(0.5 * (1.0 - nu), 0.0, 1.0)));
  const Between angle = between(root * (kAureoleAngles - 1), kAureoleAngles);
  const float* const factors_below = aureole + kSkyColour * angle.node;
  glm::dvec3 factors;
  for (int c = 0; c < 3; ++c) {
    const auto low = static_cast<double>(factors_below[c]);
    factors[c] = low + angle.part * (static_cast<double>(factors_below[kSkyColour + c]) - low);
  }
  return factors;
}

}  // namespace

void SkyProjection::project_plainly(const SunAngles& sun, std::span<glm::dvec3> even) const {
  const std::size_t terms = even_count(options_.bands);
  for (std::size_t k = 0; k < terms; ++k) even[k] = glm::dvec3(0.0);
  const SunLookup point = slice_.sun_lookup(sun.zenith_cosine);
  const Lobe lobe = slice_.outside() ? Lobe{} : lobe_at(sun, point);
  const double fade = slice_.outside() ? 1.0 : static_cast<double>(point.fade);
  const glm::dvec3 towards(0.0, sun.zenith_cosine, sun.zenith_sine);
  float scratch[kAureoleAngles * kSkyColour];
  const float* const aureole = aureole_under(sun, scratch);
  for (const RingGroup& group : groups_) {
    for (std::size_t i = 0; i < azimuths_.cosines.size(); ++i) {
      const double cosine = azimuths_.cosines[i];
      const double sine = std::sqrt(azimuths_.from_sun[i] * azimuths_.from_opposite[i]);
      for (int ring = 0; ring < kRings; ++ring) {
        const glm::dvec3 direction(group.sines[ring] * sine, group.cosines[ring], group.sines[ring] * cosine);
        glm::dvec3 light = view_.radiance(direction, towards);
        const double nu = direction.y * towards.y + direction.z * towards.z;
        const glm::dvec3 taken = fade * slice_.aerosol_phase(nu) * glm::dvec3(lobe[0], lobe[1], lobe[2]);
        light -= aureole != nullptr ? aureole_at(aureole, nu) * taken : taken;
        double before = cosine;
        double here = azimuths_.weights[i];
        before *= here;
        for (int m = 0; m < options_.bands; ++m) {
          for (int l = m; l < options_.bands; ++l) {
            even[even_index(l, m)] +=
                here * group.basis[even_index(l, m) * kRings + static_cast<std::size_t>(ring)] * light;
          }
          const double next = 2.0 * cosine * here - before;
          before = here;
          here = next;
        }
      }
    }
  }
  add_lobe(sun, {fade * lobe[0], fade * lobe[1], fade * lobe[2]}, even);
}

void check_room(std::size_t size, int bands) {
  const auto needed = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  if (size >= needed) return;
  throw Error(ErrorCode::invalid_argument, "sky harmonics: coefficients has " + std::to_string(size) + " elements; " +
                                               std::to_string(bands) + " bands need " + std::to_string(needed));
}

}  // namespace welkin::sky

namespace welkin {

const char* name(SkyQuadrature quadrature) noexcept {
  constexpr std::array<const char*, 3> kNames{"uniform", "gauss", "gauss-split"};
  return platform::name_in<SkyQuadrature::gauss_split>(kNames, quadrature, "unknown");
}

struct SkyProjector::Prepared {
  sky::SkyProjection projection;
};

SkyProjector::SkyProjector(SkyView view, const SkyHarmonicsOptions& options) {
  const platform::FloatingPointScope floating_point;
  prepared_ = std::make_shared<const Prepared>(Prepared{sky::SkyProjection(std::move(view), options)});
}

void SkyProjector::project(const glm::dvec3& sun, std::span<glm::dvec3> coefficients) const {
  const sky::SkyProjection& projection = prepared_->projection;
  const int bands = projection.options().bands;
  sky::check_room(coefficients.size(), bands);
  const platform::FloatingPointScope floating_point;
  const sky::SunAngles angles = sky::sun_angles(sun);
  std::array<glm::dvec3, sky::even_count(kMaximumBands)> even;
  projection.project(angles, even);
  sky::rotate_even(even, bands, angles, coefficients);
}

SphericalHarmonics SkyProjector::project(const glm::dvec3& sun) const {
  SphericalHarmonics result(options().bands);
  project(sun, result.coefficients());
  return result;
}

int SkyProjector::directions() const noexcept { return prepared_->projection.directions(); }
const SkyView& SkyProjector::view() const noexcept { return prepared_->projection.view(); }
const SkyHarmonicsOptions& SkyProjector::options() const noexcept { return prepared_->projection.options(); }

const sky::SkyProjection& SkyProjectorAccess::projection(const SkyProjector& projector) noexcept {
  return projector.prepared_->projection;
}

}  // namespace welkin
