// Promise: no atmosphere that is accepted gives tables with a negative value or one that is no number, nor more light
// on the ground than the sun sends.
#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "welkin/sky_tables.h"

namespace welkin::test {
namespace {

bool sound(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return value >= 0.0F && std::isfinite(value); });
}

/// Of what the sun sends.
constexpr double kMostOnGround = 1.1;
constexpr SkyTableOptions kUsable{.heights = 16, .view_zeniths = 32, .sun_zeniths = 32, .sun_angles = 4};

double most_on_ground(const SkyTables& tables) {
  double most = 0.0;
  for (std::size_t k = 0; k < tables.irradiance.size(); ++k) {
    most = std::max(most, static_cast<double>(tables.irradiance[k]) / tables.atmosphere.solar_irradiance[k % 3]);
  }
  return most;
}

}  // namespace

TEST_CASE("Tables of random atmospheres are finite, not negative and hold no more light than comes", "[sky][random]") {
  RandomAtmospheres atmospheres(2026);
  for (int i = 0; i < trials(600); ++i) {
    const int wavelengths = i % 5 == 4 ? 7 : 3;
    const Atmosphere air = atmospheres.next(wavelengths);
    const SkyTableOptions options{
        .layout = i % 3 == 0 ? ScatteringLayout::compact : ScatteringLayout::full,
        .heights = atmospheres.whole(2, 5),
        .view_zeniths = 2 * atmospheres.whole(2, 5),
        .sun_zeniths = atmospheres.whole(4, 8),
        .sun_angles = atmospheres.whole(2, 4),
        .transmittance_heights = atmospheres.whole(2, 8),
        .transmittance_zeniths = atmospheres.whole(2, 16),
        .irradiance_heights = atmospheres.whole(2, 4),
        .irradiance_sun_zeniths = atmospheres.whole(2, 9),
        .lowest_sun_degrees = atmospheres.between(-90.0, 0.0),
        .orders = atmospheres.whole(1, 4),
        .colour = wavelengths > 3 ? SkyColour::linear_srgb : SkyColour::spectral,
    };
    const SkyTables tables = precompute_sky(air, options);
    CAPTURE(i, air.bottom_radius_m, air.top_radius_m, air.aerosol_asymmetry, options.orders);
    REQUIRE(sound(tables.transmittance));
    REQUIRE(sound(tables.scattering));
    REQUIRE(sound(tables.single_mie));
    REQUIRE(sound(tables.irradiance));
    CHECK(*std::max_element(tables.transmittance.begin(), tables.transmittance.end()) <= 1.0F);
    if (wavelengths > 3) continue;
    REQUIRE(most_on_ground(tables) <= kMostOnGround);
    if (i % 200 == 0) REQUIRE(most_on_ground(precompute_sky(air, kUsable)) <= kMostOnGround);
  }
}

}  // namespace welkin::test
