#include "support/small_skies.h"

#include <algorithm>
#include <cmath>

namespace welkin::test {

std::shared_ptr<const SkyTables> sky_tables_of(const Atmosphere& atmosphere, const SkyTableOptions& options) {
  return std::make_shared<const SkyTables>(precompute_sky(atmosphere, options));
}

SkyView sky_view_of(const Atmosphere& atmosphere, const SkyTableOptions& options, double altitude_m) {
  return {sky_tables_of(atmosphere, options), altitude_m};
}

SkyTableOptions tiny_tables() {
  return {.heights = 4,
          .view_zeniths = 16,
          .sun_zeniths = 8,
          .sun_angles = 4,
          .transmittance_heights = 16,
          .transmittance_zeniths = 64,
          .irradiance_heights = 4,
          .irradiance_sun_zeniths = 16,
          .orders = 1};
}

std::shared_ptr<const SkyTables> small_earth() {
  // exactly these two orders, without an estimate of the others
  static const auto tables = sky_tables_of(earth_bruneton(), {.heights = 8, .orders = 2, .truncate_orders = true});
  return tables;
}

double relative_difference(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b) {
  double worst = 0.0;
  for (int c = 0; c < 3; ++c) {
    double difference = 0.0;
    double size = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      difference += (a[i][c] - b[i][c]) * (a[i][c] - b[i][c]);
      size += b[i][c] * b[i][c];
    }
    worst = std::max(worst, std::sqrt(size > 0.0 ? difference / size : difference));
  }
  return worst;
}

}  // namespace welkin::test
