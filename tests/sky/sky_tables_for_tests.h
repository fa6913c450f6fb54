// Tables that several tests look things up in: precomputed once a program.
#pragma once

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

/// Small ones with two orders.
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

/// The same for all of a program.
[[nodiscard]] inline const std::shared_ptr<const SkyTables>& small_view_tables() {
  static const std::shared_ptr<const SkyTables> tables = small_tables();
  return tables;
}

/// Of few heights, and as many other nodes as it takes for those to crowd.
[[nodiscard]] inline const std::shared_ptr<const SkyTables>& crowded_view_tables() {
  static const auto tables =
      sky_tables_of(earth_bruneton(), {.heights = 6, .view_zeniths = 48, .sun_zeniths = 48, .orders = 2});
  return tables;
}

}  // namespace welkin::test
