// The atmospheres that Welkin knows by name, with the sources of their constants.
#include "welkin/atmosphere.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>

#include "math/elementary.h"
#include "platform/float_environment.h"
#include "sky/spectrum.h"
#include "welkin/core.h"

namespace welkin {
namespace {

// Far beyond any air, near enough that no product of them overflows a float's table.
constexpr double kLargestCoefficient = 1e6;   // 1/m
constexpr double kLargestIrradiance = 1e12;   // W/m2/nm
constexpr double kLargestDensityTerm = 1e15;  // any term of a layer's formula
constexpr double kLargestThickness = 1e12;    // m
constexpr double kLeastAsymmetry = -0.8;
constexpr double kLargestAsymmetry = 0.999;  // narrower lobes cannot be told from light that goes straight on
constexpr std::size_t kMostLayers = 8;
constexpr std::size_t kMostAbsorbers = 4;
constexpr std::size_t kFewestWavelengths = 3;
constexpr std::size_t kMostWavelengths = 96;

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

std::string text(double value) {
  std::ostringstream out;
  out.precision(10);
  out << value;
  return out.str();
}

/// `not in range` also of a NaN.
void require(const std::string& what, double value, double low, double high) {
  if (value >= low && value <= high) return;
  refuse("the atmosphere's " + what + " is " + text(value) + "; it must be from " + text(low) + " to " + text(high));
}

/// A forward lobe too narrow for the bands of scattered light can be taken for light that goes straight on; one that
/// sends light back where it came from cannot, and would make or lose light.
void check_asymmetry(double g) {
  if (g >= -1.0 && g < kLeastAsymmetry) {
    refuse("the atmosphere's aerosol_asymmetry is " + text(g) + "; it must be from " + text(kLeastAsymmetry) + " to " +
           text(kLargestAsymmetry) +
           ", as the lobe of one that sends light back is computed only if it is no narrower");
  }
  require("aerosol_asymmetry", g, kLeastAsymmetry, kLargestAsymmetry);
}

std::string at(const std::string& what, std::size_t index) { return what + "[" + std::to_string(index) + "]"; }

void check_values(const std::string& what, const std::vector<double>& values, std::size_t wavelengths, double highest) {
  if (values.empty()) return;
  if (values.size() != wavelengths) {
    refuse("the atmosphere's " + what + " has " + std::to_string(values.size()) + " values for " +
           std::to_string(wavelengths) + " wavelengths; it must have one for each, or none");
  }
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
  if (matter.density.size() > kMostLayers) {
    refuse("the atmosphere's " + what + ".density has " + std::to_string(matter.density.size()) +
           " layers; it may have " + std::to_string(kMostLayers));
  }
  for (std::size_t i = 0; i < matter.density.size(); ++i) check_layer(at(what + ".density", i), matter.density[i]);
  check_values(what + ".scattering_per_m", matter.scattering_per_m, wavelengths, kLargestCoefficient);
  check_values(what + ".absorption_per_m", matter.absorption_per_m, wavelengths, kLargestCoefficient);
}

void check_absorbers(const Atmosphere& air) {
  if (air.absorbers.size() > kMostAbsorbers) {
    refuse("the atmosphere has " + std::to_string(air.absorbers.size()) + " absorbers; it may have " +
           std::to_string(kMostAbsorbers));
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
  if (wavelengths.size() < kFewestWavelengths || wavelengths.size() > kMostWavelengths) {
    refuse("the atmosphere has " + std::to_string(wavelengths.size()) + " wavelengths; it must have from " +
           std::to_string(kFewestWavelengths) + " to " + std::to_string(kMostWavelengths));
  }
  for (std::size_t i = 0; i < wavelengths.size(); ++i) require(at("wavelengths_nm", i), wavelengths[i], 1.0, 1e6);
  const bool rising = wavelengths[1] > wavelengths[0];
  for (std::size_t i = 1; i < wavelengths.size(); ++i) {
    if (rising ? wavelengths[i] > wavelengths[i - 1] : wavelengths[i] < wavelengths[i - 1]) continue;
    refuse("the atmosphere's " + at("wavelengths_nm", i) + " is " + text(wavelengths[i]) + " after " +
           text(wavelengths[i - 1]) + "; they must all rise or all fall");
  }
}

void check(const Atmosphere& atmosphere) {
  const platform::FloatingPointScope floating_point;
  sky::check_wavelengths(atmosphere.wavelengths_nm);
  const std::size_t wavelengths = atmosphere.wavelengths_nm.size();
  require("bottom_radius_m", atmosphere.bottom_radius_m, 1.0, 1e9);
  require("top_radius_m", atmosphere.top_radius_m, atmosphere.bottom_radius_m, 11.0 * atmosphere.bottom_radius_m);
  if (!(atmosphere.top_radius_m > atmosphere.bottom_radius_m)) {
    refuse("the atmosphere's top_radius_m is " + text(atmosphere.top_radius_m) +
           ", that of its ground; it must be above it");
  }
  check_constituent("rayleigh", atmosphere.rayleigh, wavelengths);
  check_constituent("aerosol", atmosphere.aerosol, wavelengths);
  check_absorbers(atmosphere);
  check_asymmetry(atmosphere.aerosol_asymmetry);
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
}

std::vector<DensityLayer> exponential_profile(double scale_height_m) {
  const platform::FloatingPointScope floating_point;
  if (!(scale_height_m > 0.0) || !std::isfinite(scale_height_m)) {
    refuse("the scale height is " + text(scale_height_m) + " m; it must be above 0 and finite");
  }
  return {{.exponential_term = 1.0, .exponential_scale_per_m = -1.0 / scale_height_m}};
}

std::vector<DensityLayer> tent_profile(double centre_m, double half_width_m) {
  const platform::FloatingPointScope floating_point;
  if (!(centre_m >= 0.0) || !std::isfinite(centre_m)) {
    refuse("the tent's centre is " + text(centre_m) + " m; it must be 0 or above and finite");
  }
  if (!(half_width_m > 0.0) || !std::isfinite(half_width_m)) {
    refuse("the tent's half width is " + text(half_width_m) + " m; it must be above 0 and finite");
  }
  const double slope = 1.0 / half_width_m;
  const double centre = centre_m / half_width_m;
  return {{.thickness_m = centre_m, .linear_term_per_m = slope, .constant_term = 1.0 - centre},
          {.linear_term_per_m = -slope, .constant_term = 1.0 + centre}};
}

Atmosphere without_aerosol(Atmosphere atmosphere) {
  atmosphere.aerosol = {};
  return atmosphere;
}

Atmosphere with_ground_albedo(Atmosphere atmosphere, double albedo) {
  const platform::FloatingPointScope floating_point;
  require("ground albedo", albedo, 0.0, 1.0);
  atmosphere.ground_albedo.assign(atmosphere.wavelengths_nm.size(), albedo);
  return atmosphere;
}

glm::dvec3 sun_direction(double elevation_degrees, double azimuth_degrees) {
  const platform::FloatingPointScope floating_point;
  require("sun's elevation", elevation_degrees, -90.0, 90.0);
  if (!(std::abs(azimuth_degrees) <= 1e6)) {
    refuse("the sun's azimuth is " + text(azimuth_degrees) + " degrees; it must be from -1e6 to 1e6");
  }
  const math::SineCosine elevation = math::sine_cosine_of_turns(elevation_degrees / 360.0);
  const math::SineCosine azimuth = math::sine_cosine_of_turns(azimuth_degrees / 360.0);
  return {azimuth.sine * elevation.cosine, elevation.sine, azimuth.cosine * elevation.cosine};
}

namespace {

constexpr double kFirstWavelength = 360.0;
constexpr double kWavelengthStep = 10.0;
constexpr std::size_t kWavelengths = 48;

// W/m2/nm at 360, 370, ... 830 nm: ASTM G-173 (reference solar spectral irradiance, extraterrestrial column), averaged
// over the 10 nm from each wavelength on, as tabulated by E. Bruneton, "Precomputed Atmospheric Scattering: a New
// Implementation" (2017), atmosphere/demo/demo.cc.
constexpr std::array<double, kWavelengths> kSolarIrradiance{
    1.11776, 1.14259, 1.01249, 1.14716, 1.72765, 1.73054, 1.6887,  1.61253, 1.91198, 2.03474, 2.02042, 2.02212,
    1.93377, 1.95809, 1.91686, 1.8298,  1.8685,  1.8931,  1.85149, 1.8504,  1.8341,  1.8345,  1.8147,  1.78158,
    1.7533,  1.6965,  1.68194, 1.64654, 1.6048,  1.52143, 1.55622, 1.5113,  1.474,   1.4482,  1.41018, 1.36775,
    1.34188, 1.31429, 1.28303, 1.26758, 1.2367,  1.2082,  1.18737, 1.14683, 1.12362, 1.1058,  1.07124, 1.04992};

// Ozone's cross section, m2 a molecule, at 233 K and the same wavelengths: the spectra of the University of Bremen's
// molecular spectroscopy group (2011), averaged likewise in the same file.
constexpr std::array<double, kWavelengths> kOzoneCrossSection{
    1.18e-27,  2.182e-28, 2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27,  8.451e-27, 1.582e-26, 2.316e-26,
    3.669e-26, 4.924e-26, 7.752e-26, 9.016e-26, 1.48e-25,  1.602e-25, 2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25,
    4.266e-25, 4.672e-25, 4.398e-25, 4.701e-25, 5.019e-25, 4.305e-25, 3.74e-25,  3.215e-25, 2.662e-25, 2.238e-25,
    1.852e-25, 1.473e-25, 1.209e-25, 9.423e-26, 7.455e-26, 6.566e-26, 5.105e-26, 4.15e-26,  4.228e-26, 3.237e-26,
    2.451e-26, 2.801e-26, 2.534e-26, 1.624e-26, 1.465e-26, 2.078e-26, 1.383e-26, 7.105e-27};

/// 300 Dobson units (2.687e20 molecules/m2 each) over the tent's integral of 15 km: molecules/m3 at its top.
constexpr double kOzoneDensity = 300.0 * 2.687e20 / 15000.0;

double tabulated(const std::array<double, kWavelengths>& table, double wavelength_nm) {
  const double place = (wavelength_nm - kFirstWavelength) / kWavelengthStep;
  const auto below = static_cast<std::size_t>(place);
  if (below + 1 >= table.size()) return table.back();
  const double part = place - static_cast<double>(below);
  return table[below] * (1.0 - part) + table[below + 1] * part;
}

void check_wavelengths(const std::vector<double>& wavelengths_nm) {
  constexpr double last = kFirstWavelength + kWavelengthStep * (kWavelengths - 1);
  for (const double wavelength : wavelengths_nm) {
    if (wavelength >= kFirstWavelength && wavelength <= last) continue;
    throw Error(ErrorCode::invalid_argument, "a wavelength of the Earth's atmosphere is " + std::to_string(wavelength) +
                                                 " nm; its solar spectrum and ozone are known from 360 to 830");
  }
}

/// 1 / wavelength^4, micrometres: molecules.
double inverse_fourth_power(double wavelength_nm) {
  const double square = wavelength_nm * 1e-3 * (wavelength_nm * 1e-3);
  return 1.0 / (square * square);
}

constexpr double kPi = 3.14159265358979323846;

/// Scattering of carbon dioxide of Mars at the ground, 1/m. Cross section of a molecule
/// 24 pi^3 / (wavelength^4 N^2) ((n^2 - 1) / (n^2 + 2))^2 F: refractive index n - 1 = 4.49e-4 at N = 2.687e25 molecules
/// a cubic metre, F = 1.15 for its anisotropy (Bodhaine et al. 1999, "On Rayleigh Optical Depth Calculations"). Number
/// density p / (k T) of 636 Pa and 210 K (NASA's Mars fact sheet). About 2.5e-7 at 550 nm: a hundredth of the dust's.
double carbon_dioxide(double wavelength_nm) {
  constexpr double index = 1.0 + 4.49e-4;
  constexpr double reference_density = 2.687e25;
  constexpr double lorentz = (index * index - 1.0) / (index * index + 2.0);
  constexpr double king_factor = 1.15;
  constexpr double number_density = 636.0 / (1.380649e-23 * 210.0);
  const double fourth = inverse_fourth_power(wavelength_nm) * 1e24;  // 1/m4
  const double cross_section =
      24.0 * kPi * kPi * kPi * fourth / (reference_density * reference_density) * lorentz * lorentz * king_factor;
  return number_density * cross_section;
}

}  // namespace

Atmosphere earth(const std::vector<double>& wavelengths_nm) {
  const platform::FloatingPointScope floating_point;
  check_wavelengths(wavelengths_nm);
  Atmosphere air;
  air.name = "Earth (Bruneton 2017)";
  air.wavelengths_nm = wavelengths_nm;
  air.rayleigh.density = exponential_profile(8000.0);
  air.aerosol.density = exponential_profile(1200.0);
  Constituent ozone{tent_profile(25'000.0, 15'000.0), {}, {}};
  // Angstrom's turbidity 5.328e-3 with exponent 0 over the scale height; nine tenths of it scatter.
  constexpr double aerosol_extinction = 5.328e-3 / 1200.0;
  for (const double wavelength : wavelengths_nm) {
    air.rayleigh.scattering_per_m.push_back(1.24062e-6 * inverse_fourth_power(wavelength));
    air.aerosol.scattering_per_m.push_back(0.9 * aerosol_extinction);
    air.aerosol.absorption_per_m.push_back(0.1 * aerosol_extinction);
    ozone.absorption_per_m.push_back(kOzoneDensity * tabulated(kOzoneCrossSection, wavelength));
    air.ground_albedo.push_back(0.1);
    air.solar_irradiance.push_back(tabulated(kSolarIrradiance, wavelength));
  }
  air.absorbers.push_back(std::move(ozone));
  return air;
}

Atmosphere earth_hillaire() {
  const platform::FloatingPointScope floating_point;
  Atmosphere air = earth();
  air.name = "Earth (Hillaire 2020)";
  air.top_radius_m = 6'460'000.0;
  air.rayleigh.scattering_per_m = {5.802e-6, 13.558e-6, 33.1e-6};
  // Scattering 3.996e-6. The paper's table has 4.40e-6 beside it as absorption; its author's program computes with an
  // extinction of 4.440e-6, nine tenths of which scatter as in Bruneton's, and so does this.
  air.aerosol.scattering_per_m = {3.996e-6, 3.996e-6, 3.996e-6};
  air.aerosol.absorption_per_m = {0.444e-6, 0.444e-6, 0.444e-6};
  air.absorbers.front().absorption_per_m = {0.650e-6, 1.881e-6, 0.085e-6};
  air.ground_albedo = {0.3, 0.3, 0.3};
  return air;
}

// Radius 3389.5 km, scale height 11.1 km, sunlight 586.2 / 1361.0 of the Earth's: NASA's Mars fact sheet. Dust of
// optical depth 0.5, the clearest that Viking's landers saw (Appelbaum, Landis and Sherman 1991), mixed with the air;
// it scatters 94, 86 and 76 % at 680, 550 and 440 nm, forward with a mean cosine of 0.65: rounded from the ranges of
// the landers' cameras (Pollack et al. 1995; Tomasko et al. 1999). Rusty ground.
Atmosphere mars() {
  const platform::FloatingPointScope floating_point;
  Atmosphere air;
  air.name = "Mars";
  air.bottom_radius_m = 3'389'500.0;
  air.top_radius_m = 3'389'500.0 + 110'000.0;
  air.sun_angular_radius_degrees = 0.2678 / 1.524;
  constexpr double scale_height = 11'100.0;
  air.rayleigh.density = exponential_profile(scale_height);
  air.aerosol.density = exponential_profile(scale_height);
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = 0.65;
  constexpr double dust_extinction = 0.5 / scale_height;
  for (const double albedo : {0.94, 0.86, 0.76}) {
    air.aerosol.scattering_per_m.push_back(albedo * dust_extinction);
    air.aerosol.absorption_per_m.push_back((1.0 - albedo) * dust_extinction);
  }
  for (const double wavelength : air.wavelengths_nm) {
    air.rayleigh.scattering_per_m.push_back(carbon_dioxide(wavelength));
    air.solar_irradiance.push_back(586.2 / 1361.0 * tabulated(kSolarIrradiance, wavelength));
  }
  air.ground_albedo = {0.28, 0.14, 0.07};
  return air;
}

}  // namespace welkin
