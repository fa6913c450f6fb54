#include "sky/sky_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "sky/sky_geometry.h"
#include "sky/sky_projection.h"
#include "sky/sky_slice.h"
#include "sky/sunlight.h"
#include "sky/vertical_harmonics.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

constexpr int kSunNodes = 2;  ///< of the sun's irradiance for each of the sky's

SkyHarmonicsOptions checked(const SkyCurveOptions& options) {
  if (options.nodes < 8 || options.nodes > 4096) {
    throw Error(ErrorCode::invalid_argument,
                "sky curve: " + std::to_string(options.nodes) + " nodes; 8 to 4096 are possible");
  }
  SkyHarmonicsOptions projection = options.projection;
  projection.bands = options.bands;
  return projection;
}

/// What (l, m) is divided by before it is interpolated: a coefficient is sin^m(zenith angle) times an even function,
/// so this leaves a smooth function of the sine of the elevation.
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
      direct_axis(kSunNodes * options.nodes, horizon_of(view), horizon_of(view)) {
  bake_sky(projector, control);
  bake_sun(view);
}

/// (l, m > 0) over its foot has no value in the zenith or straight below: from four nodes beside it.
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
    sky::set_slopes_of_positive(sky, count, c);
    for (std::size_t i = 1; i < sky::even_count(bands); ++i) sky::set_slopes_by_ratio(sky, count, i * 3 + c, c);
  }
}

// The disc sets within half a degree and has a corner at the horizon: no cubic follows that. What the air lets through
// of it is smooth.
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
  sky::turn_even(even, bands, angles, coefficients);
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
  return nodes_->disc.visible_share(angles.zenith_cosine) * glm::dvec3(results[0], results[1], results[2]);
}

std::uint64_t SkyCurve::bytes() const noexcept {
  return sizeof(Nodes) + (nodes_->sky.values.size() + nodes_->direct.values.size()) * sizeof(double);
}

}  // namespace welkin

namespace welkin::sky {
namespace {

/// w: at the horizon 256 nodes of both halves are 0.05 degrees apart, at 45 degrees 0.8.
constexpr double kWidth = 0.005;

/// Below, a float may lose digits.
constexpr double kLeastBrightness = 1e-30;
constexpr double kLargestFall = 0.01;
/// Where light goes out within a step, a cubic swings beyond its nodes: so far it may leave the range of the nearest.
constexpr double kLeastSwing = 0.9;
constexpr double kMostSwing = 1.1;

/// The first of the five nodes that a derivative looks at.
int first_of_five(int node, int nodes) { return std::clamp(node - 2, 0, nodes - 5); }

/// The derivative at a node of the polynomial through the five nearest, which are a step apart.
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

/// Whether `value` can be divided by and has a logarithm at all nodes that `derivative` looks at.
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

double CurveAxis::coordinate(double sine) const noexcept {
  const double x = sine - horizon_;
  return x / std::sqrt(kWidth + std::sqrt(kWidth * kWidth + x * x));
}

double CurveAxis::sine(int node) const noexcept {
  if (node == count_ - 1) return 1.0;
  const double t = first_ + step_ * node;
  return std::clamp(horizon_ + t * std::sqrt(t * t + 2.0 * kWidth), -1.0, 1.0);
}

CurveAxis::Place CurveAxis::place(double sine) const noexcept {
  const double position = std::clamp((coordinate(sine) - first_) / step_, 0.0, static_cast<double>(count_ - 1));
  const int interval = std::min(static_cast<int>(position), count_ - 2);
  return {interval, position - interval};
}

void CurveValues::at(const CurveAxis::Place& place, double* results) const noexcept {
  const double t = place.part;
  const double rest = 1.0 - t;
  const double first_value = rest * rest * (1.0 + 2.0 * t);
  const double first_slope = rest * rest * t;
  const double second_value = t * t * (3.0 - 2.0 * t);
  const double second_slope = -t * t * rest;
  const double* const first = values.data() + static_cast<std::size_t>(place.interval) * functions * 2;
  const double* const second = first + functions * 2;
  for (std::size_t i = 0; i < functions; ++i) {
    results[i] = (first_value * first[2 * i] + first_slope * first[2 * i + 1]) +
                 (second_value * second[2 * i] + second_slope * second[2 * i + 1]);
  }
}

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

void limit_falls(std::span<double> nodes) noexcept {
  for (std::size_t k = 1; k < nodes.size(); ++k) nodes[k] = std::max(nodes[k], kLargestFall * nodes[k - 1]);
  for (std::size_t k = nodes.size(); k-- > 1;) nodes[k - 1] = std::max(nodes[k - 1], kLargestFall * nodes[k]);
}

std::vector<float> fine_steps(std::span<const double> nodes) {
  const auto count = static_cast<int>(nodes.size());
  std::vector<double> logarithms;
  for (const double value : nodes) logarithms.push_back(value > kLeastBrightness ? math::logarithm(value) : 0.0);
  std::vector<float> steps;
  for (int k = 0; k <= (count - 1) * kSunSteps; ++k) {
    const int node = std::min(k / kSunSteps, count - 2);
    const double part = static_cast<double>(k - node * kSunSteps) / kSunSteps;
    const Cubic cubic = cubic_at(node + part, count);
    double logarithm = 0.0;
    bool positive = true;
    for (int i = 0; i < std::min(count, 4); ++i) {
      const auto at = static_cast<std::size_t>(cubic.first + i);
      positive = positive && nodes[at] > kLeastBrightness;
      logarithm += cubic.weights[i] * logarithms[at];
    }
    const double low = nodes[static_cast<std::size_t>(node)];
    const double high = nodes[static_cast<std::size_t>(node) + 1];
    if (!positive) {
      const auto at = static_cast<std::size_t>(node);
      logarithm = logarithms[at] + part * (logarithms[at + 1] - logarithms[at]);
      positive = low > kLeastBrightness && high > kLeastBrightness;
    }
    const double value = positive ? math::exponential(logarithm) : low + part * (high - low);
    const double limited = std::clamp(value, kLeastSwing * std::min(low, high), kMostSwing * std::max(low, high));
    steps.push_back(limited > kLeastBrightness ? static_cast<float>(limited) : 0.0F);
  }
  return steps;
}

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
