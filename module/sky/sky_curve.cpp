#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "sky/elevation_curve.h"
#include "sky/sky_geometry.h"
#include "sky/sky_projection.h"
#include "sky/sky_slice.h"
#include "sky/sunlight.h"
#include "sky/vertical_harmonics.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin::sky {
namespace {

/// w: at the horizon 256 nodes of both halves are 0.045 degrees apart, at 45 degrees 1.1.
constexpr double kWidth = 0.005;

/// Returns the first of the five nodes that a derivative reads.
int first_of_five(int node, int nodes) { return std::clamp(node - 2, 0, nodes - 5); }

/// Returns the derivative at a node of the polynomial through the five nearest, which are a step apart.
/// Weights over 12 of the nodes' values: derivatives of Lagrange's polynomials of degree four at node 0, 1, 2, 3 or 4
/// of the five. Exact for polynomials of degree four; the middle row is the central difference
/// (f_-2 - 8 f_-1 + 8 f_1 - f_2) / 12.
template <class Value>
double derivative(const Value& value, int node, int nodes) {
  constexpr double weights[5][5] = {{-25.0, 48.0, -36.0, 16.0, -3.0},
                                    {-3.0, -10.0, 18.0, -6.0, 1.0},
                                    {1.0, -8.0, 0.0, 8.0, -1.0},
                                    {-1.0, 6.0, -18.0, 10.0, 3.0},
                                    {3.0, -16.0, 36.0, -48.0, 25.0}};
  const int first = first_of_five(node, nodes);
  double sum = 0.0;
  for (int k = 0; k < 5; ++k) {
    const double weight = weights[node - first][k];
    if (weight != 0.0) sum += weight * value(first + k);
  }
  return sum / 12.0;
}

/// Returns whether `value` is a valid divisor and has a logarithm at all nodes that `derivative` reads.
template <class Value>
bool positive_around(const Value& value, int node, int nodes) {
  const int first = first_of_five(node, nodes);
  for (int k = first; k < first + 5; ++k) {
    if (!(value(k) >= std::numeric_limits<double>::min())) return false;
  }
  return true;
}

}  // namespace

CurveAxis::CurveAxis(int count, double lowest, double horizon) noexcept
    : count_(count), horizon_(horizon), first_(coordinate(lowest)), step_((coordinate(1.0) - first_) / (count - 1)) {}

// t^2 = x^2 / (w + sqrt(w^2 + x^2)) = sqrt(w^2 + x^2) - w, in the form that does not cancel. The inverse:
// t^2 + w = sqrt(w^2 + x^2), x^2 = t^4 + 2 w t^2. t ~ x / sqrt(2 w) for |x| below w, sqrt(x) beyond it.
double CurveAxis::coordinate(double sine) const noexcept {
  const double x = sine - horizon_;
  return x / std::sqrt(kWidth + std::sqrt(kWidth * kWidth + x * x));
}

double CurveAxis::sine(int node) const noexcept {
  if (node == count_ - 1) return 1.0;
  const double t = first_ + step_ * node;
  return std::clamp(horizon_ + t * std::sqrt(t * t + 2.0 * kWidth), -1.0, 1.0);
}

CurveAxis::Position CurveAxis::place(double sine) const noexcept {
  const double position = std::clamp((coordinate(sine) - first_) / step_, 0.0, static_cast<double>(count_ - 1));
  const int interval = std::min(static_cast<int>(position), count_ - 2);
  return {interval, position - interval};
}

// Hermite's basis (1 - t)^2 (1 + 2 t), (1 - t)^2 t, t^2 (3 - 2 t) and -t^2 (1 - t): value 1 or slope 1 at one end, 0
// else.
void CurveValues::at(const CurveAxis::Position& position, double* results) const noexcept {
  const double t = position.part;
  const double rest = 1.0 - t;
  const double first_value = rest * rest * (1.0 + 2.0 * t);
  const double first_slope = rest * rest * t;
  const double second_value = t * t * (3.0 - 2.0 * t);
  const double second_slope = -t * t * rest;
  const double* const first = values.data() + static_cast<std::size_t>(position.interval) * functions * 2;
  const double* const second = first + functions * 2;
  for (std::size_t i = 0; i < functions; ++i) {
    results[i] = (first_value * first[2 * i] + first_slope * first[2 * i + 1]) +
                 (second_value * second[2 * i] + second_slope * second[2 * i + 1]);
  }
}

// f' = f (log f)'. The limit: in Bernstein's basis the cubic has the coefficients f_0, f_0 + s_0 / 3, f_1 - s_1 / 3 and
// f_1, and it is not negative if they are not: s_0 >= -3 f_0 and s_1 <= 3 f_1. A node is the end of one cubic and the
// start of the next, so that its slope is held to both.
void set_slopes_of_positive(CurveValues& curve, int nodes, std::size_t function) {
  const auto value = [&](int node) { return curve.value(node, function); };
  const auto logarithm = [&](int node) { return math::logarithm(value(node)); };
  for (int node = 0; node < nodes; ++node) {
    const double slope = positive_around(value, node, nodes) ? value(node) * derivative(logarithm, node, nodes)
                                                             : derivative(value, node, nodes);
    const double most = 3.0 * std::max(value(node), 0.0);
    curve.slope(node, function) = std::clamp(slope, -most, most);
  }
}

// f = ratio x leader: f' = leader ratio' + ratio leader'. The ratio is smooth where both fall by decades.
void set_slopes_by_ratio(CurveValues& curve, int nodes, std::size_t function, std::size_t leader) {
  const auto value = [&](int node) { return curve.value(node, function); };
  const auto leading = [&](int node) { return curve.value(node, leader); };
  const auto ratio = [&](int node) { return value(node) / leading(node); };
  for (int node = 0; node < nodes; ++node) {
    if (positive_around(leading, node, nodes)) {
      curve.slope(node, function) =
          leading(node) * derivative(ratio, node, nodes) + ratio(node) * curve.slope(node, leader);
    } else {
      curve.slope(node, function) = value(node) == 0.0 ? 0.0 : derivative(value, node, nodes);
    }
  }
}

}  // namespace welkin::sky

namespace welkin {
namespace {

SkyHarmonicsOptions checked(const SkyCurveOptions& options) {
  image::require_range("nodes of a sky curve", options.nodes, 8, 4096);
  SkyHarmonicsOptions projection = options.projection;
  projection.bands = options.bands;
  return projection;
}

/// Returns the divisor of (l, m) before interpolation: a coefficient is sin^m(zenith angle) times an even function, so
/// this leaves a smooth function of the sine of the elevation.
/// sin^m of an even m > 0 over sin^2 is a power of sin^2 = 1 - cos^2, a polynomial in the cosine; dividing by all of
/// sin^m would multiply errors of nodes next to the zenith by its inverse.
double foot(int m, double zenith_sine) { return m == 0 ? 1.0 : (m % 2 == 1 ? zenith_sine : zenith_sine * zenith_sine); }

double horizon_of(const SkyView& view) {
  return sky::horizon_cosine(view.tables()->atmosphere.bottom_radius_m, view.altitude_m());
}

sky::SunAngles at_azimuth_zero(double sine) {
  return {.zenith_cosine = sine, .zenith_sine = std::sqrt(std::max(0.0, (1.0 - sine) * (1.0 + sine)))};
}

}  // namespace

struct SkyCurve::Nodes {
  int bands;
  sky::CurveAxis axis;
  sky::CurveValues sky;  ///< [(l, m)][channel]
  sky::SettingSun disc;
  sky::CurveAxis direct_axis;  ///< from the horizon up
  sky::CurveValues direct;     ///< the whole disc's irradiance, [channel]

  Nodes(const SkyView& view, const SkyCurveOptions& options, const SkyProjector& projector, const Control& control);

  void bake_sky(const SkyProjector& projector, const Control& control);
  void bake_sun(const SkyView& view);
  void extrapolate_end(int node, int inwards);
};

SkyCurve::Nodes::Nodes(const SkyView& view, const SkyCurveOptions& options, const SkyProjector& projector,
                       const Control& control)
    : bands(options.bands),
      axis(options.nodes, -1.0, horizon_of(view)),
      disc(view.tables()->atmosphere, view.altitude_m()),
      // The whole disc's irradiance has no values below the horizon: all nodes are above it.
      direct_axis(sky::kSunNodes * options.nodes, horizon_of(view), horizon_of(view)) {
  bake_sky(projector, control);
  bake_sun(view);
}

/// Sets (l, m > 0) over its foot in the zenith or straight below, where it has no value, from the four nodes next to
/// it: the cubic through f_1 to f_4 at 0, whose fourth difference f_0 - 4 f_1 + 6 f_2 - 4 f_3 + f_4 is 0.
void SkyCurve::Nodes::extrapolate_end(int node, int inwards) {
  for (int l = 1; l < bands; ++l) {
    for (int m = 1; m <= l; ++m) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t i = sky::even_index(l, m) * 3 + c;
        sky.value(node, i) = 4.0 * (sky.value(node + inwards, i) + sky.value(node + 3 * inwards, i)) -
                             6.0 * sky.value(node + 2 * inwards, i) - sky.value(node + 4 * inwards, i);
      }
    }
  }
}

void SkyCurve::Nodes::bake_sky(const SkyProjector& projector, const Control& control) {
  const sky::SkyProjection& projection = SkyProjectorAccess::projection(projector);
  const int count = axis.count();
  sky.functions = sky::even_count(bands) * 3;
  sky.values.resize(static_cast<std::size_t>(count) * sky.functions * 2);
  jobs::run_tiles(static_cast<std::size_t>(count), jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena),
                  control, [&](std::size_t tile, std::size_t) {
                    const auto node = static_cast<int>(tile);
                    const sky::SunAngles sun = at_azimuth_zero(axis.sine(node));
                    std::array<glm::dvec3, sky::even_count(kMaximumBands)> even;
                    projection.project(sun, even);
                    for (int l = 0; l < bands; ++l) {
                      for (int m = 0; m <= l; ++m) {
                        const std::size_t i = sky::even_index(l, m);
                        const double divisor = sun.zenith_sine > 0.0 ? foot(m, sun.zenith_sine) : 1.0;
                        for (int c = 0; c < 3; ++c) {
                          const double value = even[i][c] / divisor;
                          sky.value(node, i * 3 + static_cast<std::size_t>(c)) = i == 0 ? std::max(value, 0.0) : value;
                        }
                      }
                    }
                  });
  extrapolate_end(count - 1, -1);
  extrapolate_end(0, 1);
  for (std::size_t c = 0; c < 3; ++c) {
    // (0, 0), the mean radiance, is nowhere negative and leads; other coefficients fall with it by decades in the
    // twilight, while their ratio to it changes slowly.
    sky::set_slopes_of_positive(sky, count, c);
    for (std::size_t i = 1; i < sky::even_count(bands); ++i) sky::set_slopes_by_ratio(sky, count, i * 3 + c, c);
  }
}

// Nodes hold the whole disc's irradiance through the air, which is smooth. The disc itself sets within half a degree
// and has a corner at the horizon, which no cubic follows.
void SkyCurve::Nodes::bake_sun(const SkyView& view) {
  const sky::SkySlice& slice = SkyViewAccess::slice(view);
  const int count = direct_axis.count();
  direct.functions = 3;
  direct.values.resize(static_cast<std::size_t>(count) * direct.functions * 2);
  for (int node = 0; node < count; ++node) {
    const glm::dvec3 through =
        sky::sun_transmittance(*view.tables(), slice.mapping(), view.altitude_m(), direct_axis.sine(node));
    const glm::dvec3 irradiance = slice.fold().sunlight() * through;
    for (int c = 0; c < 3; ++c) direct.value(node, static_cast<std::size_t>(c)) = std::max(irradiance[c], 0.0);
  }
  for (std::size_t c = 0; c < 3; ++c) sky::set_slopes_of_positive(direct, count, c);
}

SkyCurve::SkyCurve(const SkyView& view, const SkyCurveOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  nodes_ = std::make_shared<const Nodes>(view, options, SkyProjector(view, checked(options)), control);
}

int SkyCurve::bands() const noexcept { return nodes_->bands; }

void SkyCurve::at(const glm::dvec3& sun, std::span<glm::dvec3> coefficients) const {
  const int bands = nodes_->bands;
  sky::check_room(coefficients.size(), bands);
  const platform::FloatingPointScope floating_point;
  const sky::SunAngles angles = sky::sun_angles(sun);
  std::array<glm::dvec3, sky::even_count(kMaximumBands)> even;
  std::array<double, 3 * sky::even_count(kMaximumBands)> values;
  nodes_->sky.at(nodes_->axis.place(angles.zenith_cosine), values.data());
  for (int l = 0; l < bands; ++l) {
    for (int m = 0; m <= l; ++m) {
      const std::size_t i = sky::even_index(l, m);
      even[i] = foot(m, angles.zenith_sine) * glm::dvec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    }
  }
  sky::rotate_even(even, bands, angles, coefficients);
}

SphericalHarmonics SkyCurve::at(const glm::dvec3& sun) const {
  SphericalHarmonics result(bands());
  at(sun, result.coefficients());
  return result;
}

glm::dvec3 SkyCurve::sun_irradiance(const glm::dvec3& sun) const {
  const platform::FloatingPointScope floating_point;
  const sky::SunAngles angles = sky::sun_angles(sun);
  double results[3];
  nodes_->direct.at(nodes_->direct_axis.place(angles.zenith_cosine), results);
  // The curve is of the whole disc, as if nothing hid it: the visible share is exact for each sun.
  return nodes_->disc.visible_share(angles.zenith_cosine) * glm::dvec3(results[0], results[1], results[2]);
}

std::uint64_t SkyCurve::bytes() const noexcept {
  static_assert(sizeof(Nodes) <= 512);  // `curve_bytes` counts on it
  return sizeof(Nodes) + (nodes_->sky.values.size() + nodes_->direct.values.size()) * sizeof(double);
}

}  // namespace welkin
