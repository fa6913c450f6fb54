// The planets that Welkin knows by name, against what was measured of them.

#include <cmath>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "reference/sky_reference.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/sky.h"

namespace welkin::test {
namespace {

constexpr AerosolKind kKinds[] = {AerosolKind::clear, AerosolKind::hazy, AerosolKind::dusty, AerosolKind::polluted};

/// 400 to 680 nm, as the command folds them to colours.
std::vector<double> visible_spectrum() {
  std::vector<double> wavelengths;
  for (double wavelength = 400.0; wavelength <= 680.0; wavelength += 20.0) wavelengths.push_back(wavelength);
  return wavelengths;
}

/// Optical depth of all the air above the ground at each wavelength.
std::vector<double> vertical_depth(const Atmosphere& air) {
  std::vector<double> depths;
  for (const double transmittance : reference_transmittance(air, 0.0, 1.0)) depths.push_back(-std::log(transmittance));
  return depths;
}

Atmosphere with_aerosol_alone(Atmosphere air) {
  air.rayleigh = {};
  air.absorbers.clear();
  return air;
}

/// Y of linear sRGB (IEC 61966-2-1).
double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

/// The clear sky of IES RP-21-84, "Recommended Practice for the Calculation of Daylight Availability" (Journal of the
/// Illuminating Engineering Society 13:4, 1984), in lux: direct light on a surface that faces the sun, 127.5 klx
/// outside of the air, extinction 0.21 an air mass; and the sky's light on horizontal ground.
struct ClearSky {
  double direct;
  double sky;
};

ClearSky ies_clear_sky(double elevation_degrees) {
  const double sine = std::sin(elevation_degrees * std::numbers::pi / 180.0);
  return {127'500.0 * std::exp(-0.21 / sine), 800.0 + 15'500.0 * std::sqrt(sine)};
}

}  // namespace

TEST_CASE("planets: the Earth's molecules have the depth that Hansen and Travis measured", "[sky][planets]") {
  Atmosphere air = without_aerosol(earth({400.0, 550.0, 800.0}));
  air.absorbers.clear();
  const std::vector<double> depths = vertical_depth(air);
  CHECK(depths[1] == Approx(0.0973).margin(5e-5));
  const auto formula = [](double micrometres) {
    return 0.008569 * std::pow(micrometres, -4.0) *
           (1.0 + 0.0113 * std::pow(micrometres, -2.0) + 0.00013 * std::pow(micrometres, -4.0));
  };
  CHECK(depths[0] == Approx(formula(0.4)).epsilon(1e-6));
  CHECK(depths[2] == Approx(formula(0.8)).epsilon(1e-6));
}

TEST_CASE("planets: an aerosol has its optical depth, exponent and albedo", "[sky][planets]") {
  for (const AerosolKind kind : kKinds) {
    INFO(name(kind));
    const AerosolModel model = aerosol_model(kind);
    const Atmosphere air = earth({440.0, 550.0, 830.0}, kind);
    CHECK(air.name == std::string("Earth, ") + name(kind) + " air");
    const std::vector<double> depths = vertical_depth(with_aerosol_alone(air));
    CHECK(depths[1] == Approx(model.optical_depth).epsilon(1e-6));
    CHECK(std::log(depths[0] / depths[2]) / std::log(830.0 / 440.0) == Approx(model.angstrom_exponent).epsilon(1e-6));
    for (std::size_t i = 0; i < 3; ++i) {
      const double scattering = air.aerosol.scattering_per_m[i];
      CHECK(scattering / (scattering + air.aerosol.absorption_per_m[i]) == Approx(model.single_scattering_albedo));
    }
    CHECK(air.aerosol_asymmetry == model.asymmetry);
  }
  CHECK(vertical_depth(with_aerosol_alone(with_aerosol(mars(), {.optical_depth = 2.0})))[1] ==
        Approx(2.0).epsilon(1e-6));
  CHECK(with_aerosol(earth_bruneton(), aerosol_model(AerosolKind::dusty)).aerosol ==
        earth({680.0, 550.0, 440.0}, AerosolKind::dusty).aerosol);
}

TEST_CASE("planets: aerosols out of range are refused by the name of the value", "[sky][planets]") {
  const auto refused = [](AerosolModel model, const char* word) {
    const ThrownError error = thrown_by([&] { (void)with_aerosol(earth(), model); });
    CHECK(error.code == ErrorCode::invalid_argument);
    INFO(error.message);
    CHECK(error.says(word));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {-0.01, 100.1, kNan}) refused({.optical_depth = wrong}, "optical_depth");
  for (const double wrong : {-4.1, 8.1, kNan}) refused({.angstrom_exponent = wrong}, "angstrom_exponent");
  for (const double wrong : {-0.1, 1.1, kNan}) refused({.single_scattering_albedo = wrong}, "single_scattering_albedo");
  for (const double wrong : {0.0, 1.1e6, kNan}) refused({.scale_height_m = wrong}, "scale_height_m");
  for (const double wrong : {-1.0, 1.0, kNan}) refused({.asymmetry = wrong}, "asymmetry");
  CHECK(thrown_by([] { (void)earth({550.0, 450.0, 350.0}); }).says("350"));
  CHECK(thrown_by([] { (void)aerosol_model(static_cast<AerosolKind>(4)); }).says("4"));
}

TEST_CASE("planets: a clear day is as bright as the Illuminating Engineering Society measured",
          "[sky][planets][truth]") {
  SkyTableOptions options;
  options.colour = SkyColour::linear_srgb;
  options.heights = 8;
  options.view_zeniths = 64;
  options.sun_zeniths = 32;
  options.orders = 5;
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(earth(visible_spectrum()), options)), 0.0);
  for (const double elevation : {60.0, 30.0, 10.0}) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    const ClearSky wanted = ies_clear_sky(elevation);
    CHECK(luminance(view.sun(sun).irradiance) == Approx(wanted.direct).epsilon(0.1));
    CHECK(luminance(view.irradiance(sun)) == Approx(wanted.sky).epsilon(0.1));
  }
}

}  // namespace welkin::test
