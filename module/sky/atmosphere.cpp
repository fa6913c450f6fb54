// Atmospheres as data: what can be computed of them, and the helpers that make and change them.
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "sky/spectrum.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

// Far beyond any air, near enough that no product of them overflows a float's table.
constexpr double kLargestCoefficient = 1e6;   // 1/m
constexpr double kLargestIrradiance = 1e12;   // W/m2/nm
constexpr double kLargestDensityTerm = 1e15;  // any term of a layer's formula
constexpr double kLargestThickness = 1e12;    // m
constexpr double kMinAsymmetry = -0.8;
constexpr double kLargestAsymmetry = 0.999;  // narrower lobes cannot be told from light that goes straight on
constexpr std::size_t kMaxLayers = 8;
constexpr std::size_t kMaxAbsorbers = 4;
constexpr std::size_t kMinWavelengths = 3;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

void require(const std::string& what, double value, double low, double high) {
  platform::require_between("the atmosphere's " + what, value, low, high);
}

/// A forward lobe too narrow for the bands of scattered light can be taken for light that goes straight on; one that
/// sends light back where it came from cannot, and would make or lose light.
void check_asymmetry(const std::string& what, double g) {
  if (g >= -1.0 && g < kMinAsymmetry) {
    refuse("the atmosphere's " + what + " is " + platform::number_text(g) + "; it must be from " +
           platform::number_text(kMinAsymmetry) + " to " + platform::number_text(kLargestAsymmetry) +
           ", as the lobe of one that sends light back is computed only if it is no narrower");
  }
  require(what, g, kMinAsymmetry, kLargestAsymmetry);
}

std::string at(const std::string& what, std::size_t index) { return what + "[" + std::to_string(index) + "]"; }

void check_count(const std::string& what, const std::vector<double>& values, std::size_t wavelengths) {
  if (values.empty() || values.size() == wavelengths) return;
  refuse("the atmosphere's " + what + " has " + std::to_string(values.size()) + " values for " +
         std::to_string(wavelengths) + " wavelengths; it must have one for each, or none");
}

void check_values(const std::string& what, const std::vector<double>& values, std::size_t wavelengths, double highest) {
  check_count(what, values, wavelengths);
  for (std::size_t i = 0; i < values.size(); ++i) require(at(what, i), values[i], 0.0, highest);
}

void check_layer(const std::string& what, const DensityLayer& layer) {
  require(what + ".thickness_m", layer.thickness_m, 0.0, kLargestThickness);
  const double most = kLargestDensityTerm;
  require(what + ".exponential_term", layer.exponential_term, -most, most);
  require(what + ".exponential_scale_per_m", layer.exponential_scale_per_m, -most, most);
  require(what + ".linear_term_per_m", layer.linear_term_per_m, -most, most);
  require(what + ".constant_term", layer.constant_term, -most, most);
}

void check_constituent(const std::string& what, const Constituent& matter, std::size_t wavelengths) {
  if (matter.density.size() > kMaxLayers) {
    refuse("the atmosphere's " + what + ".density has " + std::to_string(matter.density.size()) +
           " layers; it may have " + std::to_string(kMaxLayers));
  }
  for (std::size_t i = 0; i < matter.density.size(); ++i) check_layer(at(what + ".density", i), matter.density[i]);
  check_values(what + ".scattering_per_m", matter.scattering_per_m, wavelengths, kLargestCoefficient);
  check_values(what + ".absorption_per_m", matter.absorption_per_m, wavelengths, kLargestCoefficient);
}

void check_absorbers(const Atmosphere& air) {
  if (air.absorbers.size() > kMaxAbsorbers) {
    refuse("the atmosphere has " + std::to_string(air.absorbers.size()) + " absorbers; it may have " +
           std::to_string(kMaxAbsorbers));
  }
  for (std::size_t i = 0; i < air.absorbers.size(); ++i) {
    const std::string what = at("absorbers", i);
    check_constituent(what, air.absorbers[i], air.wavelengths_nm.size());
    if (!air.absorbers[i].scattering_per_m.empty()) {
      refuse("the atmosphere's " + what + ".scattering_per_m has values; an absorber does not scatter: it must be " +
             "empty (what scatters is rayleigh or aerosol)");
    }
  }
}

}  // namespace

void sky::check_wavelengths(const std::vector<double>& wavelengths) {
  if (wavelengths.size() < kMinWavelengths || wavelengths.size() > kMaxWavelengths) {
    refuse("the atmosphere has " + std::to_string(wavelengths.size()) + " wavelengths; it must have from " +
           std::to_string(kMinWavelengths) + " to " + std::to_string(kMaxWavelengths));
  }
  for (std::size_t i = 0; i < wavelengths.size(); ++i) require(at("wavelengths_nm", i), wavelengths[i], 1.0, 1e6);
  const bool rising = wavelengths[1] > wavelengths[0];
  for (std::size_t i = 1; i < wavelengths.size(); ++i) {
    if (rising ? wavelengths[i] > wavelengths[i - 1] : wavelengths[i] < wavelengths[i - 1]) continue;
    refuse("the atmosphere's " + at("wavelengths_nm", i) + " is " + platform::number_text(wavelengths[i]) + " after " +
           platform::number_text(wavelengths[i - 1]) + "; they must all rise or all fall");
  }
}

void check(const Atmosphere& atmosphere) {
  const platform::FloatingPointScope floating_point;
  sky::check_wavelengths(atmosphere.wavelengths_nm);
  const std::size_t wavelengths = atmosphere.wavelengths_nm.size();
  require("bottom_radius_m", atmosphere.bottom_radius_m, 1.0, 1e9);
  require("top_radius_m", atmosphere.top_radius_m, atmosphere.bottom_radius_m, 11.0 * atmosphere.bottom_radius_m);
  if (!(atmosphere.top_radius_m > atmosphere.bottom_radius_m)) {
    refuse("the atmosphere's top_radius_m is " + platform::number_text(atmosphere.top_radius_m) +
           ", that of its ground; it must be above it");
  }
  check_constituent("rayleigh", atmosphere.rayleigh, wavelengths);
  check_constituent("aerosol", atmosphere.aerosol, wavelengths);
  check_absorbers(atmosphere);
  check_asymmetry("aerosol_asymmetry", atmosphere.aerosol_asymmetry);
  check_count("aerosol_asymmetries", atmosphere.aerosol_asymmetries, wavelengths);
  for (std::size_t i = 0; i < atmosphere.aerosol_asymmetries.size(); ++i) {
    check_asymmetry(at("aerosol_asymmetries", i), atmosphere.aerosol_asymmetries[i]);
  }
  if (atmosphere.aerosol_phase != AerosolPhase::cornette_shanks &&
      atmosphere.aerosol_phase != AerosolPhase::henyey_greenstein) {
    refuse("the atmosphere's aerosol_phase has no known value; pass cornette_shanks or henyey_greenstein");
  }
  check_values("ground_albedo", atmosphere.ground_albedo, wavelengths, 1.0);
  if (atmosphere.solar_irradiance.empty()) {
    refuse("the atmosphere has no solar_irradiance; it must have one for each wavelength (0: no light)");
  }
  check_values("solar_irradiance", atmosphere.solar_irradiance, wavelengths, kLargestIrradiance);
  require("sun_angular_radius_degrees", atmosphere.sun_angular_radius_degrees, 0.0, 10.0);
  require("night_zenith_luminance", atmosphere.night_zenith_luminance, 0.0, 1.0);
}

std::vector<DensityLayer> exponential_profile(double scale_height_m) {
  const platform::FloatingPointScope floating_point;
  if (!(scale_height_m > 0.0) || !std::isfinite(scale_height_m)) {
    refuse("the scale height is " + platform::number_text(scale_height_m) + " m; it must be above 0 and finite");
  }
  return {{.exponential_term = 1.0, .exponential_scale_per_m = -1.0 / scale_height_m}};
}

std::vector<DensityLayer> tent_profile(double centre_m, double half_width_m) {
  const platform::FloatingPointScope floating_point;
  if (!(centre_m >= 0.0) || !std::isfinite(centre_m)) {
    refuse("the tent's centre is " + platform::number_text(centre_m) + " m; it must be 0 or above and finite");
  }
  if (!(half_width_m > 0.0) || !std::isfinite(half_width_m)) {
    refuse("the tent's half width is " + platform::number_text(half_width_m) + " m; it must be above 0 and finite");
  }
  // 1 - |h - centre| / half width: h / w + 1 - c / w below the centre, -h / w + 1 + c / w above it. Densities are
  // clamped at 0, which ends the tent on both sides.
  const double slope = 1.0 / half_width_m;
  const double centre = centre_m / half_width_m;
  return {{.thickness_m = centre_m, .linear_term_per_m = slope, .constant_term = 1.0 - centre},
          {.linear_term_per_m = -slope, .constant_term = 1.0 + centre}};
}

Atmosphere without_aerosol(Atmosphere atmosphere) {
  atmosphere.aerosol = {};
  atmosphere.aerosol_asymmetries.clear();
  return atmosphere;
}

Atmosphere with_ground_albedo(Atmosphere atmosphere, double albedo) {
  const platform::FloatingPointScope floating_point;
  platform::require_between("the ground's albedo", albedo, 0.0, 1.0);
  atmosphere.ground_albedo.assign(atmosphere.wavelengths_nm.size(), albedo);
  return atmosphere;
}

glm::dvec3 sun_direction(double elevation_degrees, double azimuth_degrees) {
  const platform::FloatingPointScope floating_point;
  platform::require_between("the sun's elevation in degrees", elevation_degrees, -90.0, 90.0);
  platform::require_between("the sun's azimuth in degrees", azimuth_degrees, -1e6, 1e6);
  const math::SineCosine elevation = math::sine_cosine_of_turns(elevation_degrees / 360.0);
  const math::SineCosine azimuth = math::sine_cosine_of_turns(azimuth_degrees / 360.0);
  // y is up, and the azimuth is counted from +z towards +x.
  return {azimuth.sine * elevation.cosine, elevation.sine, azimuth.cosine * elevation.cosine};
}

}  // namespace welkin
