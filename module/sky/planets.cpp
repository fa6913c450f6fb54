// The atmospheres that Welkin knows by name, with the sources of their constants.
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "sky/spectrum.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
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
// molecular spectroscopy group (2011), averaged over the same intervals in the same file.
constexpr std::array<double, kWavelengths> kOzoneCrossSection{
    1.18e-27,  2.182e-28, 2.818e-28, 6.636e-28, 1.527e-27, 2.763e-27, 5.52e-27,  8.451e-27, 1.582e-26, 2.316e-26,
    3.669e-26, 4.924e-26, 7.752e-26, 9.016e-26, 1.48e-25,  1.602e-25, 2.139e-25, 2.755e-25, 3.091e-25, 3.5e-25,
    4.266e-25, 4.672e-25, 4.398e-25, 4.701e-25, 5.019e-25, 4.305e-25, 3.74e-25,  3.215e-25, 2.662e-25, 2.238e-25,
    1.852e-25, 1.473e-25, 1.209e-25, 9.423e-26, 7.455e-26, 6.566e-26, 5.105e-26, 4.15e-26,  4.228e-26, 3.237e-26,
    2.451e-26, 2.801e-26, 2.534e-26, 1.624e-26, 1.465e-26, 2.078e-26, 1.383e-26, 7.105e-27};

/// 300 Dobson units (2.687e20 molecules/m2 each) over the tent's integral of 15 km: molecules/m3 at its top.
constexpr double kOzoneDensity = 300.0 * 2.687e20 / 15000.0;

double tabulated(const std::array<double, kWavelengths>& table, double wavelength_nm) {
  const double position = (wavelength_nm - kFirstWavelength) / kWavelengthStep;
  const auto below = static_cast<std::size_t>(position);
  if (below + 1 >= table.size()) return table.back();
  const double part = position - static_cast<double>(below);
  return table[below] * (1.0 - part) + table[below + 1] * part;
}

void check_wavelengths(const std::vector<double>& wavelengths_nm) {
  constexpr double last = kFirstWavelength + kWavelengthStep * (kWavelengths - 1);
  for (const double wavelength : wavelengths_nm) {
    if (wavelength >= kFirstWavelength && wavelength <= last) continue;
    throw Error(ErrorCode::invalid_argument, "a wavelength of the Earth's atmosphere is " +
                                                 platform::number_text(wavelength) +
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

/// Optical depth of the molecules of air above sea level at 1013.25 hPa: Hansen and Travis 1974, "Light Scattering in
/// Planetary Atmospheres", equation 2.30.
double rayleigh_depth(double wavelength_nm) {
  const double square = 1.0 / (wavelength_nm * 1e-3 * (wavelength_nm * 1e-3));
  return 0.008569 * square * square * (1.0 + 0.0113 * square + 0.00013 * square * square);
}

/// Int of exp(-h / scale height) dh from the ground to the top, metres: what an optical depth is divided by to be a
/// coefficient at the ground.
double column_m(const Atmosphere& air, double scale_height_m) {
  return scale_height_m * (1.0 - math::exponential(-(air.top_radius_m - air.bottom_radius_m) / scale_height_m));
}

constexpr double kReferenceWavelength = 550.0;  // nm
constexpr double kEarthScaleHeight = 8000.0;    // m, of molecules (Bruneton 2017)

/// Ozone, ground and sunlight of Bruneton's Earth, without any matter that scatters.
Atmosphere earth_without_scattering(const std::vector<double>& wavelengths_nm) {
  check_wavelengths(wavelengths_nm);
  Atmosphere air;
  air.wavelengths_nm = wavelengths_nm;
  Constituent ozone{tent_profile(25'000.0, 15'000.0), {}, {}};
  for (const double wavelength : wavelengths_nm) {
    ozone.absorption_per_m.push_back(kOzoneDensity * tabulated(kOzoneCrossSection, wavelength));
    air.ground_albedo.push_back(0.1);
    air.solar_irradiance.push_back(tabulated(kSolarIrradiance, wavelength));
  }
  air.absorbers.push_back(std::move(ozone));
  return air;
}

}  // namespace

// Continental aerosol. Its asymmetry, and all of the polluted one but its exponent, are those of the continental
// polluted aerosol of Hess, Koepke and Schult 1998 ("Optical Properties of Aerosols and Clouds") at a relative humidity
// of 80 %. The exponent is Angstrom's mean of 1.3 (Angstrom 1929). The depth of haze is twice the mean over land, 0.16
// (Hao et al. 2023, "Visibility-derived aerosol optical depth over global land"). Dust over North Africa and Arabia:
// Kim et al. 2011 ("Dust optical properties over North Africa and Arabian Peninsula derived from the AERONET dataset"),
// depth from which on Drame et al. 2015 call a day dusty.
const char* name(AerosolKind kind) noexcept {
  constexpr std::array<const char*, 4> kNames{"clear", "hazy", "dusty", "polluted"};
  return platform::name_in<AerosolKind::polluted>(kNames, kind, "clear");
}

AerosolModel aerosol_model(AerosolKind kind) {
  const platform::FloatingPointScope floating_point;
  switch (kind) {
    case AerosolKind::clear: return {};
    case AerosolKind::hazy: return {.optical_depth = 0.32};
    case AerosolKind::dusty:
      return {.optical_depth = 0.5, .angstrom_exponent = 0.2, .single_scattering_albedo = 0.944, .asymmetry = 0.752};
    case AerosolKind::polluted: return {.optical_depth = 0.327, .single_scattering_albedo = 0.8925};
  }
  throw Error(ErrorCode::invalid_argument, "the kind of aerosol " + std::to_string(static_cast<int>(kind)) +
                                               " is unknown; pass an enumerator of AerosolKind");
}

Atmosphere with_aerosol(Atmosphere atmosphere, const AerosolModel& aerosol) {
  const platform::FloatingPointScope floating_point;
  platform::require_between("the aerosol's optical_depth", aerosol.optical_depth, 0.0, 100.0);
  platform::require_between("the aerosol's angstrom_exponent", aerosol.angstrom_exponent, -4.0, 8.0);
  platform::require_between("the aerosol's single_scattering_albedo", aerosol.single_scattering_albedo, 0.0, 1.0);
  platform::require_between("the aerosol's asymmetry", aerosol.asymmetry, -0.8, 0.999);
  platform::require_between("the aerosol's scale_height_m", aerosol.scale_height_m, 1.0, 1e6);
  atmosphere.aerosol = {exponential_profile(aerosol.scale_height_m), {}, {}};
  atmosphere.aerosol_phase = AerosolPhase::henyey_greenstein;
  atmosphere.aerosol_asymmetry = aerosol.asymmetry;
  atmosphere.aerosol_asymmetries.clear();
  const double at_reference = aerosol.optical_depth / column_m(atmosphere, aerosol.scale_height_m);
  for (const double wavelength : atmosphere.wavelengths_nm) {
    // Angstrom's law: depth falls like a power of the wavelength.
    const double extinction = at_reference * math::exponential(-aerosol.angstrom_exponent *
                                                               math::logarithm(wavelength / kReferenceWavelength));
    atmosphere.aerosol.scattering_per_m.push_back(aerosol.single_scattering_albedo * extinction);
    atmosphere.aerosol.absorption_per_m.push_back((1.0 - aerosol.single_scattering_albedo) * extinction);
  }
  return atmosphere;
}

Atmosphere earth(const std::vector<double>& wavelengths_nm, AerosolKind aerosol) {
  const platform::FloatingPointScope floating_point;
  Atmosphere air = earth_without_scattering(wavelengths_nm);
  air.name = std::string("Earth, ") + name(aerosol) + " air";
  air.rayleigh.density = exponential_profile(kEarthScaleHeight);
  const double column = column_m(air, kEarthScaleHeight);
  for (const double wavelength : wavelengths_nm)
    air.rayleigh.scattering_per_m.push_back(rayleigh_depth(wavelength) / column);
  return with_aerosol(std::move(air), aerosol_model(aerosol));
}

Atmosphere earth_bruneton(const std::vector<double>& wavelengths_nm) {
  const platform::FloatingPointScope floating_point;
  Atmosphere air = earth_without_scattering(wavelengths_nm);
  air.name = "Earth (Bruneton 2017)";
  air.rayleigh.density = exponential_profile(kEarthScaleHeight);
  air.aerosol.density = exponential_profile(1200.0);
  // Angstrom's turbidity 5.328e-3 with exponent 0 over the scale height; nine tenths of it scatter.
  constexpr double aerosol_extinction = 5.328e-3 / 1200.0;
  for (const double wavelength : wavelengths_nm) {
    air.rayleigh.scattering_per_m.push_back(1.24062e-6 * inverse_fourth_power(wavelength));
    air.aerosol.scattering_per_m.push_back(0.9 * aerosol_extinction);
    air.aerosol.absorption_per_m.push_back(0.1 * aerosol_extinction);
  }
  return air;
}

Atmosphere earth_hillaire() {
  const platform::FloatingPointScope floating_point;
  Atmosphere air = earth_bruneton();
  air.name = "Earth (Hillaire 2020)";
  air.top_radius_m = 6'460'000.0;
  air.rayleigh.scattering_per_m = {5.802e-6, 13.558e-6, 33.1e-6};
  // Scattering 3.996e-6. The paper's table also has 4.40e-6 as absorption; its author's program computes with an
  // extinction of 4.440e-6, nine tenths of which scatter as in Bruneton's, and so does this.
  air.aerosol.scattering_per_m = {3.996e-6, 3.996e-6, 3.996e-6};
  air.aerosol.absorption_per_m = {0.444e-6, 0.444e-6, 0.444e-6};
  air.absorbers.front().absorption_per_m = {0.650e-6, 1.881e-6, 0.085e-6};
  air.ground_albedo = {0.3, 0.3, 0.3};
  return air;
}

namespace {

// Mean cosine of the angle by which Martian dust deflects light, in bands of 240 to 400, 400 to 800 and 800 to 1310 nm,
// each at its middle: Ockert-Bell et al. 1997 ("Absorption and scattering properties of the Martian dust in the solar
// wavelengths"), weighted by the sun's spectrum, as the Mars climate model of NASA Ames has it (its array gv1). Between
// them straight lines: 0.688, 0.728 and 0.789 at 680, 550 and 440 nm. (Others at 650 nm: 0.691, the T-matrix dust of
// the LMD's model after Wolff et al. 2009; 0.685 from skies over Gale crater, Chen-Chen et al. 2019.)
struct AsymmetryAt {
  double wavelength_nm;
  double value;
};

constexpr std::array<AsymmetryAt, 3> kDustAsymmetry{{{320.0, 0.856}, {600.0, 0.700}, {1055.0, 0.634}}};

double dust_asymmetry(double wavelength_nm) {
  const std::size_t low = wavelength_nm < kDustAsymmetry[1].wavelength_nm ? 0 : 1;
  const auto& [start, first] = kDustAsymmetry[low];
  const auto& [end, last] = kDustAsymmetry[low + 1];
  return first + (wavelength_nm - start) / (end - start) * (last - first);
}

}  // namespace

// Radius 3389.5 km, scale height 11.1 km, sunlight 586.2 / 1361.0 of the Earth's: NASA's Mars fact sheet. Dust of
// optical depth 0.5, the clearest that Viking's landers saw (Appelbaum, Landis and Sherman 1991), mixed with the air;
// it scatters 94, 86 and 76 % at 680, 550 and 440 nm: rounded from the ranges of the landers' cameras (Pollack et al.
// 1995; Tomasko et al. 1999). Rusty ground.
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
  air.aerosol_asymmetry = kDustAsymmetry[1].value;
  for (const double wavelength : air.wavelengths_nm) air.aerosol_asymmetries.push_back(dust_asymmetry(wavelength));
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
