#include "sky/sunlight.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "math/elementary.h"
#include "sky/sky_geometry.h"
#include "sky/table_sizes.h"

namespace welkin::sky {
namespace {

constexpr double kNearHorizon = 0.75;    ///< share of the nodes that the rational part of the axis places
constexpr double kMinRefraction = 1e-4;  ///< float tells cosines apart to 1e-7
/// Minimum radius of a disc, radians: a point, as far as float tells cosines apart.
constexpr double kSmallestRadius = 1e-7;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

// The bend: along a ray that touches the ground, the altitude is s^2 / (2 R) at the distance s, and an air of scale
// height h_s has the density exp(-s^2 / (2 R h_s)). It spans an angle of sqrt(2 h_s / R) as seen from the planet's
// centre, over which a sun about the horizon darkens; four times that for the bend.
SunPaths::SunPaths(const AirModel& air, const TableMapping& mapping, const Size& size, const Control& control)
    : mapping_(mapping),
      size_(size),
      bend_(std::clamp(4.0 * std::sqrt(2.0 * air.scale_height() / air.bottom_radius()), kMinRefraction, 1.0)) {
  std::vector<Ray> rays;
  for (int h = 0; h < size_.heights; ++h) {
    const double altitude = mapping_.altitude(static_cast<double>(h) / (size_.heights - 1));
    for (int k = 0; k < size_.zeniths; ++k) {
      const double mu = zenith_cosine(altitude, k);
      rays.push_back({altitude, mu, false, distance_to_top(air.bottom_radius(), air.thickness(), altitude, mu)});
    }
  }
  lengths_ = lengths_of(air, std::move(rays), control);
}

// x = share ((Y + b) / Y) y / (y + b) + (1 - share) y / Y is 1 at y = Y, the zenith. At the horizon
// dx/dy = rational / b + linear: on the Earth's ground (aerosol of scale height 1.2 km, b = 0.078) 256 nodes stand
// 0.021 degrees apart there.
SunPaths::Axis SunPaths::axis(double altitude) const noexcept {
  const double horizon = horizon_cosine(mapping_.bottom_radius(), altitude);
  const double whole = 1.0 - horizon;
  return {horizon, kNearHorizon * (whole + bend_) / whole, bend_, (1.0 - kNearHorizon) / whole};
}

// x = a y / (y + b) + l y with y = mu - mu_h: x (y + b) = a y + l y (y + b), or l y^2 + (a + l b - x) y - x b = 0. With
// half = (a + l b - x) / 2 the positive root is -half + sqrt(half^2 + l x b) over l; where half > 0 it is x b over
// half + root, which does not cancel for the nodes next to the horizon.
double SunPaths::zenith_cosine(double altitude, int node) const noexcept {
  const Axis axis = this->axis(altitude);
  if (node + 1 == size_.zeniths) return 1.0;
  const double x = static_cast<double>(node) / (size_.zeniths - 1);
  const double half = 0.5 * (axis.rational + axis.linear * axis.bend - x);
  const double root = std::sqrt(half * half + axis.linear * x * axis.bend);
  const double y = half > 0.0 ? x * axis.bend / (half + root) : (root - half) / axis.linear;
  return std::min(1.0, axis.horizon + y);
}

Sunlight::Sunlight(const AirModel& air, const SunPaths& paths, const Extinctions& extinctions)
    : paths_(&paths), bottom_radius_(air.bottom_radius()), row_(4 * index(paths.size().zeniths)) {
  const double radius = air.atmosphere().sun_angular_radius_degrees * std::numbers::pi / 180.0;
  disc_slope_ = 0.5 / std::max(radius, kSmallestRadius);
  rows_.resize(index(paths_->size().heights) * row_);
  float* texel = rows_.data();
  for (int height = 0; height < paths_->size().heights; ++height) {
    for (int k = 0; k < paths_->size().zeniths; ++k, texel += 4) {
      for (std::size_t c = 0; c < 3; ++c) {
        texel[c] = static_cast<float>(math::exponential(-optical_depth(extinctions[c], paths.lengths(height, k))));
      }
    }
  }
}

// Between heights: the cubic through the four nearest.
void Sunlight::at(double altitude, SunlitSample& sample) const noexcept {
  const SunPaths::Axis axis = paths_->axis(altitude);
  sample.horizon = static_cast<float>(axis.horizon);
  sample.rational = static_cast<float>(axis.rational * (paths_->size().zeniths - 1));
  sample.bend = static_cast<float>(axis.bend);
  sample.linear = static_cast<float>(axis.linear * (paths_->size().zeniths - 1));
  // t = 1/2 + e / (2 a), e the sun's elevation over the horizon and a the disc's radius. The horizon's zenith angle has
  // the sine R / r, so that mu_s - mu_h ~ (R / r) e: the slope in mu_s - mu_h is r / R times 1 / (2 a).
  sample.disc_slope = static_cast<float>(disc_slope_ * (bottom_radius_ + altitude) / bottom_radius_);
  sample.disc_offset = 0.5F;
  const double position = paths_->mapping().height_coordinate(altitude) * (paths_->size().heights - 1);
  const int first = std::clamp(static_cast<int>(position) - 1, 0, paths_->size().heights - 4);
  const double t = position - first;  // 0 to 3
  const std::array<double, 4> weights{-(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0, t * (t - 2.0) * (t - 3.0) / 2.0,
                                      -t * (t - 1.0) * (t - 3.0) / 2.0, t * (t - 1.0) * (t - 2.0) / 6.0};
  for (int k = 0; k < 4; ++k) {
    sample.rows[k] = rows_.data() + index(first + k) * row_;
    sample.row_weights[k] = static_cast<float>(weights[index(k)]);
  }
}

std::array<double, 3> Sunlight::at(double altitude, double sun_zenith_cosine) const noexcept {
  SunlitSample sample{};
  at(altitude, sample);
  const double above = sun_zenith_cosine - static_cast<double>(sample.horizon);
  const double t = std::clamp(sample.disc_slope * above + sample.disc_offset, 0.0, 1.0);
  const double y = std::max(0.0, above);
  const auto [node, part] =
      between(sample.rational * (y / (y + sample.bend)) + sample.linear * y, paths_->size().zeniths);
  std::array<double, 3> light{};
  for (std::size_t c = 0; c < 3; ++c) {
    double ends[2]{};
    for (int k = 0; k < 4; ++k) {
      const float* const row = sample.rows[k] + 4 * node + c;
      for (int i = 0; i < 2; ++i)
        ends[i] += static_cast<double>(sample.row_weights[k]) * static_cast<double>(row[4 * i]);
    }
    const double value = ends[0] + part * (ends[1] - ends[0]);
    light[c] = std::max(0.0, value) * t * t * (3.0 - 2.0 * t);
  }
  return light;
}

namespace {

/// Below, a transmittance's logarithm says nothing.
constexpr double kDark = 1e-30;

}  // namespace

double lowest_sun_sine(const SkyTables& tables) noexcept {
  return math::sine_cosine_of_turns(tables.options.minimum_sun_elevation_degrees / 360.0).sine;
}

TableMapping mapping_of(const SkyTables& tables) noexcept { return mapping_of(tables.atmosphere, tables.options); }

// Cubic in the optical depth, which is smooth where transmittance falls by decades.
// The logarithm is taken of the folded colours too: of a mean of exponentials it is as smooth as the depth of one.
// Below 1e-30 the depth of 69 stands for all that is darker, and a result below 1e-29 is 0.
glm::dvec3 transmittance_to_top(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                double zenith_cosine) noexcept {
  const int zeniths = tables.options.transmittance_zeniths;
  const int heights = tables.options.transmittance_heights;
  const Cubic rows = cubic_at(mapping.height_coordinate(altitude) * (heights - 1), heights);
  const Cubic columns = cubic_at(mapping.transmittance_coordinate(altitude, zenith_cosine) * (zeniths - 1), zeniths);
  glm::dvec3 depth{};
  for (int i = 0; i < std::min(4, heights); ++i) {
    for (int j = 0; j < std::min(4, zeniths); ++j) {
      const double weight = rows.weights[i] * columns.weights[j];
      if (weight == 0.0) continue;
      const std::size_t texel = static_cast<std::size_t>(rows.first + i) * static_cast<std::size_t>(zeniths) +
                                static_cast<std::size_t>(columns.first + j);
      for (int c = 0; c < 3; ++c) {
        const auto through = static_cast<double>(tables.transmittance[3 * texel + static_cast<std::size_t>(c)]);
        depth[c] -= weight * math::logarithm(std::max(through, kDark));
      }
    }
  }
  glm::dvec3 result{};
  for (int c = 0; c < 3; ++c) {
    const double through = math::exponential(-depth[c]);
    result[c] = through > 10.0 * kDark ? std::min(through, 1.0) : 0.0;
  }
  return result;
}

// Elevations over the horizon are (mu_s - horizon) stretch: d cos(z) = -sin(z) dz, and sin(z) at the horizon is
// R / (R + h).
SettingSun::SettingSun(const Atmosphere& atmosphere, double altitude_m) noexcept
    : horizon(horizon_cosine(atmosphere.bottom_radius_m, altitude_m)),
      stretch((atmosphere.bottom_radius_m + altitude_m) / atmosphere.bottom_radius_m),
      radius(atmosphere.sun_angular_radius_degrees * (std::numbers::pi / 180.0)) {}

// Smoothstep over the disc's rise. The part of an even disc above a straight horizon, 1/2 + (asin s + s
// sqrt(1 - s^2)) / pi with s = 2 t - 1, differs from it by at most 0.039, and needs an arcsine.
double SettingSun::visible_share(double sun_zenith_cosine) const noexcept {
  const double elevation = (sun_zenith_cosine - horizon) * stretch;
  if (!(radius > 0.0)) return elevation > 0.0 ? 1.0 : 0.0;
  const double t = std::clamp((elevation + radius) / (2.0 * radius), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

glm::dvec3 sun_transmittance(const SkyTables& tables, const TableMapping& mapping, double altitude,
                             double sun_zenith_cosine) noexcept {
  const double thickness = mapping.thickness();
  const double mu =
      std::clamp(std::max(sun_zenith_cosine, horizon_cosine(mapping.bottom_radius(), altitude)), -1.0, 1.0);
  if (altitude <= thickness) return transmittance_to_top(tables, mapping, altitude, mu);
  const double top = mapping.bottom_radius() + thickness;
  const double nearest = (mapping.bottom_radius() + altitude) * std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
  if (mu >= 0.0 || nearest >= top) return glm::dvec3(1.0);
  // The ray comes in on the far side: from there, towards the ground, it is as long as any.
  // mu' = -sqrt(top^2 - b^2) / top, as in view_kernels.cpp: the ray runs on through the air, past the lowest point, to
  // the top again.
  const double entry = -std::sqrt((top - nearest) * (top + nearest)) / top;
  return transmittance_to_top(tables, mapping, thickness, entry);
}

glm::dvec3 sun_share(const SkyTables& tables, const TableMapping& mapping, double altitude,
                     double sun_zenith_cosine) noexcept {
  const double visible = SettingSun(tables.atmosphere, altitude).visible_share(sun_zenith_cosine);
  if (!(visible > 0.0)) return {};
  return visible * sun_transmittance(tables, mapping, altitude, sun_zenith_cosine);
}

namespace {

// Light falls by decades between suns: the cubic is of its logarithm where all four nodes have one, and leaves the
// range of the two nearest by no more than a tenth.
double between_suns(const double* nodes, const Cubic& cubic, int count, double position) {
  double plain = 0.0;
  double logarithm = 0.0;
  bool positive = true;
  for (int j = 0; j < count; ++j) {
    positive = positive && nodes[j] > kDark;
    plain += cubic.weights[j] * nodes[j];
    if (positive) logarithm += cubic.weights[j] * math::logarithm(nodes[j]);
  }
  const int near = std::clamp(static_cast<int>(position), 0, count - 2);
  const double low = std::min(nodes[near], nodes[near + 1]);
  const double high = std::max(nodes[near], nodes[near + 1]);
  return std::clamp(positive ? math::exponential(logarithm) : plain, 0.9 * low, 1.1 * high);
}

}  // namespace

glm::dvec3 sky_irradiance(const SkyTables& tables, const TableMapping& mapping, double altitude,
                          double sun_zenith_cosine) noexcept {
  const int suns = tables.options.irradiance_sun_zeniths;
  const int heights = tables.options.irradiance_heights;
  const Cubic rows = cubic_at(mapping.height_coordinate(altitude) * (heights - 1), heights);
  const double position = mapping.sun_coordinate(sun_zenith_cosine) * (suns - 1);
  const Cubic columns = cubic_at(position, suns);
  glm::dvec3 sum{};
  for (int i = 0; i < std::min(4, heights); ++i) {
    const std::size_t first = static_cast<std::size_t>(rows.first + i) * static_cast<std::size_t>(suns) +
                              static_cast<std::size_t>(columns.first);
    for (int c = 0; c < 3; ++c) {
      double nodes[4]{};
      for (std::size_t j = 0; j < static_cast<std::size_t>(std::min(4, suns)); ++j) {
        nodes[j] = static_cast<double>(tables.irradiance[3 * (first + j) + static_cast<std::size_t>(c)]);
      }
      sum[c] += rows.weights[i] * between_suns(nodes, columns, std::min(4, suns), position - columns.first);
    }
  }
  const double fade = sun_fade(tables, sun_zenith_cosine);
  for (int c = 0; c < 3; ++c) sum[c] = fade * std::max(sum[c], 0.0);
  return sum;
}

// Smoothstep from the nadir, t = 0, to the lowest sun, t = 1: the fade has no slope at either end, so that light does
// not jump.
double sun_fade(const SkyTables& tables, double sun_zenith_cosine) noexcept {
  const double lowest = lowest_sun_sine(tables);
  if (sun_zenith_cosine >= lowest) return 1.0;
  const double t = std::clamp((sun_zenith_cosine + 1.0) / (lowest + 1.0), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace welkin::sky
