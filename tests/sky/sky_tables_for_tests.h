// Tables that several tests look things up in, precomputed once a program; and what a view shows of the whole sky.
#pragma once

#include "math/quadrature.h"
#include "support/catch.h"
#include "support/small_skies.h"
#include "welkin/sky.h"

namespace welkin::test {

/// Earth, single scattering, the default sizes. The ground is lit by the direct sun only, as in the reference.
[[nodiscard]] inline const std::shared_ptr<const SkyTables>& single_tables() {
  static const auto tables = [] {
    SkyTables made = precompute_sky(earth_bruneton(), {.orders = 1});
    std::fill(made.irradiance.begin(), made.irradiance.end(), 0.0F);
    return std::make_shared<const SkyTables>(std::move(made));
  }();
  return tables;
}

/// Returns small tables with two orders.
[[nodiscard]] inline std::shared_ptr<const SkyTables> small_tables(const Atmosphere& atmosphere = earth_bruneton(),
                                                                   ScatteringLayout layout = ScatteringLayout::full,
                                                                   SkyColour colour = SkyColour::spectral) {
  SkyTableOptions options = tiny_tables();
  options.layout = layout;
  options.colour = colour;
  options.heights = 6;
  options.sun_zeniths = 12;
  options.sun_angles = 5;
  options.orders = 2;
  return sky_tables_of(atmosphere, options);
}

/// Returns `small_tables()`, computed once per program.
[[nodiscard]] inline const std::shared_ptr<const SkyTables>& small_view_tables() {
  static const std::shared_ptr<const SkyTables> tables = small_tables();
  return tables;
}

/// Returns tables with few heights, and enough nodes of the other axes that these crowd.
[[nodiscard]] inline const std::shared_ptr<const SkyTables>& crowded_view_tables() {
  static const auto tables =
      sky_tables_of(earth_bruneton(), {.heights = 6, .view_zeniths = 48, .sun_zeniths = 48, .orders = 2});
  return tables;
}

/// Integrates a view's radiances over the sky, times a weight of the elevation's sine. The nodes lie closer together
/// near the sun and the horizon.
template <class Weight>
glm::dvec3 integral_of_radiance(const SkyView& view, const glm::dvec3& sun, const Weight& weight) {
  constexpr double pi = std::numbers::pi;
  const math::GaussNodes along = math::gauss_nodes(40);
  const math::GaussNodes about = math::gauss_nodes(72);
  const double middle = std::clamp(std::acos(std::clamp(sun.y, -1.0, 1.0)), 0.2, 0.4 * pi);
  glm::dvec3 sum(0.0);
  for (const auto& [low, high] : {std::pair{0.0, middle}, {middle, 0.5 * pi}}) {
    for (std::size_t i = 0; i < along.nodes.size(); ++i) {
      const double t = 0.5 + 0.5 * along.nodes[i];
      const double zenith = low + (high - low) * t * t * (3.0 - 2.0 * t);
      const double ring =
          weight(std::cos(zenith)) * std::sin(zenith) * (high - low) * 3.0 * t * (1.0 - t) * along.weights[i];
      for (std::size_t k = 0; k < about.nodes.size(); ++k) {
        const double u = 0.5 + 0.5 * about.nodes[k];
        const glm::dvec3 direction = sun_direction(90.0 - zenith * 180.0 / pi, 180.0 * u * u);
        sum += view.radiance(direction, sun) * (ring * 2.0 * pi * u * about.weights[k]);
      }
    }
  }
  return sum;
}

/// The weight of what falls on level ground.
inline double on_level_ground(double sine) { return sine; }

}  // namespace welkin::test
