#include "sky/direct_sun.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "sky/cubic.h"
#include "sky/sky_geometry.h"
#include "tables/exponential.h"
#include "tables/logarithm.h"
#include "tables/trigonometry.h"

namespace welkin::sky {
namespace {

/// Below, a transmittance's logarithm says nothing.
constexpr double kDark = 1e-30;

}  // namespace

double lowest_sun_sine(const SkyTables& tables) noexcept {
  return tables::sine_cosine_of_turns(tables.options.lowest_sun_degrees / 360.0).sine;
}

TableMapping mapping_of(const SkyTables& tables) noexcept {
  return {tables.atmosphere.bottom_radius_m, tables.atmosphere.top_radius_m, lowest_sun_sine(tables)};
}

// Cubic in the optical depth, which is smooth where transmittance falls by decades.
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
        depth[c] -= weight * tables::logarithm(std::max(through, kDark));
      }
    }
  }
  glm::dvec3 result{};
  for (int c = 0; c < 3; ++c) {
    const double through = tables::exponential(-depth[c]);
    result[c] = through > 10.0 * kDark ? std::min(through, 1.0) : 0.0;
  }
  return result;
}

double visible_share(const Atmosphere& atmosphere, double altitude, double sun_zenith_cosine) noexcept {
  const double bottom = atmosphere.bottom_radius_m;
  const double radius = bottom + altitude;
  const double elevation = (sun_zenith_cosine - horizon_cosine(bottom, altitude)) * (radius / bottom);
  const double half = atmosphere.sun_angular_radius_degrees * (std::numbers::pi / 180.0);
  if (!(half > 0.0)) return elevation > 0.0 ? 1.0 : 0.0;
  const double t = std::clamp((elevation + half) / (2.0 * half), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

glm::dvec3 sun_share(const SkyTables& tables, const TableMapping& mapping, double altitude,
                     double sun_zenith_cosine) noexcept {
  const double visible = visible_share(tables.atmosphere, altitude, sun_zenith_cosine);
  if (!(visible > 0.0)) return {};
  const double thickness = mapping.thickness();
  // Towards the horizon if the centre is below it.
  const double mu =
      std::clamp(std::max(sun_zenith_cosine, horizon_cosine(mapping.bottom_radius(), altitude)), -1.0, 1.0);
  if (altitude <= thickness) return visible * transmittance_to_top(tables, mapping, altitude, mu);
  const double top = mapping.bottom_radius() + thickness;
  const double nearest = (mapping.bottom_radius() + altitude) * std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
  if (mu >= 0.0 || nearest >= top) return glm::dvec3(visible);
  // The ray comes in on the far side: from there, towards the ground, it is as long as any.
  const double entry = -std::sqrt((top - nearest) * (top + nearest)) / top;
  return visible * transmittance_to_top(tables, mapping, thickness, entry);
}

glm::dvec3 sky_irradiance(const SkyTables& tables, const TableMapping& mapping, double altitude,
                          double sun_zenith_cosine) noexcept {
  const int suns = tables.options.irradiance_sun_zeniths;
  const int heights = tables.options.irradiance_heights;
  const Cubic rows = cubic_at(mapping.height_coordinate(altitude) * (heights - 1), heights);
  const Cubic columns = cubic_at(mapping.sun_coordinate(sun_zenith_cosine) * (suns - 1), suns);
  glm::dvec3 sum{};
  for (int i = 0; i < std::min(4, heights); ++i) {
    for (int j = 0; j < std::min(4, suns); ++j) {
      const std::size_t texel = static_cast<std::size_t>(rows.first + i) * static_cast<std::size_t>(suns) +
                                static_cast<std::size_t>(columns.first + j);
      for (int c = 0; c < 3; ++c) {
        sum[c] += rows.weights[i] * columns.weights[j] *
                  static_cast<double>(tables.irradiance[3 * texel + static_cast<std::size_t>(c)]);
      }
    }
  }
  const double fade = sun_fade(tables, sun_zenith_cosine);
  for (int c = 0; c < 3; ++c) sum[c] = fade * std::max(sum[c], 0.0);
  return sum;
}

double sun_fade(const SkyTables& tables, double sun_zenith_cosine) noexcept {
  const double lowest = lowest_sun_sine(tables);
  if (sun_zenith_cosine >= lowest) return 1.0;
  const double t = std::clamp((sun_zenith_cosine + 1.0) / (lowest + 1.0), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace welkin::sky
