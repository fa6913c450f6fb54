// The planets that Welkin knows by name, against what was measured of them.
#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "sky/sky_projection.h"
#include "sky/sky_tables_for_tests.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "support/trials.h"
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
  const SkyView view = sky_view_of(earth(visible_spectrum()),
                                   {.heights = 8, .sun_zeniths = 32, .orders = 5, .colour = SkyColour::linear_srgb});
  for (const double elevation : {60.0, 30.0, 10.0}) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    const ClearSky wanted = ies_clear_sky(elevation);
    CHECK(luminance(view.sun_light(sun).irradiance) == Approx(wanted.direct).epsilon(0.1));
    CHECK(luminance(view.irradiance(sun)) == Approx(wanted.sky).epsilon(0.1));
  }
}

// Aerosols whose lobe differs from wavelength to wavelength, and the blue aureole that it gives Mars.

// Promise: a table of wavelengths with lobes of their own has in each the light of an atmosphere that has that one
// lobe.

namespace {

using glm::dvec3;

const std::vector<double> kAsymmetries{0.2, 0.55, 0.78};

Atmosphere haze(AerosolPhase phase = AerosolPhase::henyey_greenstein) {
  Atmosphere air = with_aerosol(earth(), {.optical_depth = 0.4});
  air.aerosol_phase = phase;
  air.aerosol_asymmetries = kAsymmetries;
  return air;
}

Atmosphere with_one(Atmosphere air, double asymmetry) {
  air.aerosol_asymmetries.clear();
  air.aerosol_asymmetry = asymmetry;
  return air;
}

SkyView ground_view(const Atmosphere& air, int orders) {
  return sky_view_of(air, {.heights = 12, .view_zeniths = 32, .sun_zeniths = 24, .orders = orders});
}

const std::vector<double> kElevations{60.0, 20.0, 5.0, 0.0, -4.0};

/// Returns the largest difference of a channel between two views, relative to the second.
double largest_difference(const SkyView& found, const SkyView& wanted, int channel) {
  double worst = 0.0;
  for (const double elevation : kElevations) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    for (const double up : {1.0, 10.0, 30.0, 60.0, 90.0}) {
      for (const double azimuth : {0.0, 5.0, 60.0, 180.0}) {
        const dvec3 direction = sun_direction(up, azimuth);
        const double truth = wanted.radiance(direction, sun)[channel];
        worst = std::max(worst, std::abs(found.radiance(direction, sun)[channel] - truth) / truth);
      }
    }
  }
  return worst;
}

double largest_harmonic_difference(const SkyView& found, const SkyView& wanted, int channel) {
  const SkyProjector first(found);
  const SkyProjector second(wanted);
  double worst = 0.0;
  for (const double elevation : kElevations) {
    const SphericalHarmonics a = first.project(sun_direction(elevation, 40.0));
    const SphericalHarmonics b = second.project(sun_direction(elevation, 40.0));
    for (std::size_t k = 0; k < a.coefficients().size(); ++k) {
      const double difference = std::abs(a.coefficients()[k][channel] - b.coefficients()[k][channel]);
      worst = std::max(worst, difference / b.coefficients()[0][channel]);
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("asymmetries: the same at all wavelengths is the bits of one", "[sky][asymmetries]") {
  Atmosphere all = with_one(haze(), 0.7);
  const std::shared_ptr<const SkyTables> wanted = small_tables(all);
  all.aerosol_asymmetries.assign(3, 0.7);
  all.aerosol_asymmetry = 0.1;
  const std::shared_ptr<const SkyTables> found = small_tables(all);
  CHECK(found->scattering == wanted->scattering);
  CHECK(found->single_mie == wanted->single_mie);
  CHECK(found->irradiance == wanted->irradiance);
  const dvec3 sun = sun_direction(12.0, 30.0);
  const dvec3 direction = sun_direction(25.0, 50.0);
  CHECK(SkyView(found, 100.0).radiance(direction, sun) == SkyView(wanted, 100.0).radiance(direction, sun));
  const SphericalHarmonics wanted_light = SkyProjector(SkyView(wanted, 100.0)).project(sun);
  const SphericalHarmonics found_light = SkyProjector(SkyView(found, 100.0)).project(sun);
  CHECK(std::ranges::equal(found_light.coefficients(), wanted_light.coefficients()));
}

// Wavelengths share the positions at which rays are cut and the brightness by which they are interpolated between suns.
// That costs 0.2 % of the light of one order, and in that of four what so few nodes leave undetermined.
TEST_CASE("asymmetries: each wavelength has the sky of its own", "[sky][asymmetries][truth]") {
  for (const AerosolPhase phase : {AerosolPhase::henyey_greenstein, AerosolPhase::cornette_shanks}) {
    for (const int orders : {1, 4}) {
      const SkyView all = ground_view(haze(phase), orders);
      for (int c = 0; c < 3; ++c) {
        const Atmosphere one = with_one(haze(phase), kAsymmetries[static_cast<std::size_t>(c)]);
        const SkyView wanted = ground_view(one, orders);
        CAPTURE(static_cast<int>(phase), orders, c);
        CHECK(largest_difference(all, wanted, c) < (orders == 1 ? 2e-3 : 2.5e-2));
        CHECK(largest_harmonic_difference(all, wanted, c) < (orders == 1 ? 1e-3 : 3e-3));
      }
    }
  }
}

TEST_CASE("asymmetries: kernels agree with their twin in double, also where some scatter back", "[sky][asymmetries]") {
  for (const std::vector<double>& asymmetries :
       {std::vector<double>{0.3, 0.7, 0.84}, std::vector<double>{-0.7, 0.2, 0.8},
        std::vector<double>{-0.2, -0.5, -0.8}}) {
    Atmosphere air = haze();
    air.aerosol_asymmetries = asymmetries;
    const SkyView view(small_tables(air), 0.0);
    const sky::SkyProjection projection(view, {.bands = 4});
    const dvec3 sun = sun_direction(25.0, 0.0);
    const sky::SunAngles angles = sky::sun_angles(sun);
    std::vector<dvec3> found(sky::even_count(4));
    std::vector<dvec3> plain(sky::even_count(4));
    projection.project(angles, found);
    projection.project_plainly(angles, plain);
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (int c = 0; c < 3; ++c) {
        CAPTURE(asymmetries[0], k, c);
        CHECK(std::abs(found[k][c] - plain[k][c]) < 2e-5 * plain[0][c]);
      }
    }
  }
}

TEST_CASE("asymmetries: light scattered once and often is that of paths", "[sky][asymmetries][truth]") {
  const SkyView view = sky_view_of(haze(), {.truncate_orders = true});
  const dvec3 sun = sun_direction(30.0, 0.0);
  for (const dvec3& direction :
       some_of(2, {sun_direction(36.0, 3.0), sun, sun_direction(12.0, 120.0), sun_direction(90.0, 0.0)})) {
    const std::vector<double> once = reference_sky_radiance(haze(), 0.0, direction, sun, {1e-5, true});
    const TracedLight often =
        trace_sky_radiance(haze(), 0.0, direction, sun, {.lowest_order = 2, .highest_order = 4, .paths = 12'000});
    const dvec3 found = view.radiance(direction, sun);
    for (int c = 0; c < 3; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const double truth = once[k] + often.value[k];
      CAPTURE(direction.y, c, found[c] / truth, often.standard_error[k] / truth);
      CHECK(std::abs(found[c] - truth) < 0.02 * truth + 2.5 * often.standard_error[k]);
    }
  }
}

TEST_CASE("asymmetries: folded channels have the mean of their wavelengths", "[sky][asymmetries][truth]") {
  std::vector<double> wavelengths;
  for (int i = 0; i < 15; ++i) wavelengths.push_back(400.0 + 20.0 * i);
  Atmosphere air = with_aerosol(earth(wavelengths), {.optical_depth = 0.4});
  for (int i = 0; i < 15; ++i) air.aerosol_asymmetries.push_back(0.85 - 0.015 * i);
  const sky::ColourFold fold(air, SkyColour::linear_srgb);
  CHECK(fold.asymmetries()[2] > fold.asymmetries()[1] + 0.02);
  CHECK(fold.asymmetries()[1] > fold.asymmetries()[0] + 0.02);
  const SkyView view(small_tables(air, ScatteringLayout::full, SkyColour::linear_srgb), 0.0);
  const dvec3 sun = sun_direction(30.0, 0.0);
  const dvec3 near = view.radiance(sun_direction(32.0, 0.0), sun);
  const SkyView grey(small_tables(with_one(air, 0.745), ScatteringLayout::full, SkyColour::linear_srgb), 0.0);
  const dvec3 before = grey.radiance(sun_direction(32.0, 0.0), sun);
  CHECK(near.z / near.x > 1.2 * before.z / before.x);
}

// Promise: dust whose lobe is narrower in blue makes the sky about a low sun bluer than sunlight, and far from it
// redder.
TEST_CASE("Mars has a blue aureole", "[sky][planets][asymmetries]") {
  const Atmosphere air = mars();
  const SkyView view = ground_view(air, 6);
  const double sunlight = air.solar_irradiance[2] / air.solar_irradiance[0];
  for (const double elevation : {3.0, 5.0, 10.0}) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    const auto blue_over_red = [&](const dvec3& direction) {
      const dvec3 radiance = view.radiance(direction, sun);
      return radiance.z / radiance.x / sunlight;
    };
    for (const double off : {0.0, 1.0, 3.0, 5.0}) {
      CAPTURE(elevation, off);
      CHECK(blue_over_red(sun_direction(elevation + off, 0.0)) > 1.2);
    }
    CHECK(blue_over_red(sun_direction(elevation + 40.0, 0.0)) < 0.8);
    CHECK(blue_over_red(sun_direction(elevation, 180.0)) < 0.8);
  }
}

// Hazes whose lobe is far narrower than what a solver of few bands can hold.

// Promise: the sky of a haze of Henyey and Greenstein's lobe of g = 0.95 and depth 0.3 is that of paths, in the sun's
// own direction too.

namespace {

using glm::dvec3;
using std::numbers::pi;

Atmosphere sharp_haze() {
  Atmosphere air;
  air.aerosol.density = exponential_profile(2000.0);
  air.aerosol.scattering_per_m.assign(3, 0.3 / 2000.0);
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = 0.95;
  air.solar_irradiance = {1.0, 1.0, 1.0};
  return air;
}

/// Radiance by `reference_sky_radiance` and, orders 2 to 20, `trace_sky_radiance` with 60 000 to 240 000 paths, seed 1:
/// up to a minute each.
struct Traced {
  double sun;      ///< degrees of elevation
  double up;       ///< the direction's
  double azimuth;  ///< degrees from the sun's
  double radiance;
  double standard_error;
};

const std::vector<Traced> kTraced{
    {45, 45, 0, 18.23, 0.0078},       {45, 48, 0, 6.348, 0.005},         {45, 51, 0, 1.677, 0.0021},
    {45, 59, 0, 0.1789, 0.00027},     {45, 65, 0, 0.06253, 0.00014},     {45, 80, 0, 0.01165, 5.9e-05},
    {45, 90, 0, 0.005615, 6.7e-06},   {45, 45, 10, 1.256, 0.0018},       {45, 45, 20, 0.2119, 0.00034},
    {45, 45, 35, 0.04471, 0.00011},   {45, 45, 70, 0.006761, 4.1e-05},   {45, 45, 120, 0.001997, 2.4e-06},
    {45, 45, 180, 0.001303, 1.7e-06}, {45, 0.5, 180, 0.003867, 1.1e-05}, {45, 2, 180, 0.004465, 1.1e-05},
    {45, 5, 180, 0.004167, 1.2e-05},  {45, 20, 180, 0.001673, 2.5e-06},  {45, 0.5, 0, 0.05828, 0.00015},
    {45, 5, 0, 0.07083, 0.00071},     {45, 20, 0, 0.08644, 0.00022},     {45, 30, 0, 0.2493, 0.00047},
    {45, 30, 40, 0.02391, 9e-05},     {45, 60, 40, 0.02518, 7.7e-05},    {45, 2, 90, 0.01028, 2.9e-05},
    {10, 10, 0, 25.03, 0.015},        {10, 11, 0, 21.25, 0.036},         {10, 13, 0, 9.684, 0.024},
    {10, 16, 0, 2.965, 0.0099},       {10, 20, 0, 0.8671, 0.0027},       {10, 24, 0, 0.3281, 0.0015},
    {10, 30, 0, 0.1054, 0.00034},     {10, 45, 0, 0.01613, 0.00012},     {10, 55, 0, 0.006877, 2.5e-05},
    {10, 10, 5, 5.66, 0.02},          {10, 10, 10, 1.636, 0.0052},       {10, 10, 20, 0.3451, 0.0011},
    {10, 10, 35, 0.08194, 0.00038},   {10, 10, 70, 0.0124, 4.8e-05},     {10, 10, 120, 0.00351, 1.2e-05},
    {10, 10, 180, 0.002269, 1e-05},   {10, 2, 180, 0.003479, 1.3e-05},   {10, 5, 180, 0.003327, 1.2e-05},
    {10, 20, 180, 0.001214, 5e-06},   {10, 2, 0, 3.647, 0.014},          {10, 5, 0, 7.071, 0.047},
    {10, 30, 40, 0.01457, 0.00011},   {10, 3, 40, 0.09178, 0.00041}};

TracedLight traced_now(const Traced& traced, std::int64_t paths) {
  const dvec3 sun = sun_direction(traced.sun, 0.0);
  const dvec3 direction = sun_direction(traced.up, traced.azimuth);
  TracedLight light =
      trace_sky_radiance(sharp_haze(), 0.0, direction, sun, {.lowest_order = 2, .highest_order = 20, .paths = paths});
  light.value[1] += reference_sky_radiance(sharp_haze(), 0.0, direction, sun, {1e-5, true})[1];
  return light;
}

}  // namespace

// In one case, as they share tables that take seconds.
TEST_CASE("haze: light of a narrow lobe is that of paths to 5 % in all directions, and its sums to 1.5 %",
          "[sky][haze][truth]") {
  const SkyView view = sky_view_of(sharp_haze(), {.heights = 16, .orders = 24, .convergence_threshold = 1e-3});
  for (const Traced& traced : kTraced) {
    const double found = view.radiance(sun_direction(traced.up, traced.azimuth), sun_direction(traced.sun, 0.0))[1];
    CAPTURE(traced.sun, traced.up, traced.azimuth, found / traced.radiance, traced.standard_error / traced.radiance);
    CHECK(std::abs(found - traced.radiance) < 0.05 * traced.radiance + 2.0 * traced.standard_error);
  }

  // Irradiance, to 1 %: `trace_sky_irradiance`, orders 1 to 20, 1.2 million paths.
  struct Irradiance {
    double sun, value, standard_error;
  };
  for (const Irradiance& traced : {Irradiance{45.0, 0.23882, 0.00031}, Irradiance{10.0, 0.11845, 0.00082}}) {
    const dvec3 sun = sun_direction(traced.sun, 0.0);
    const double found = view.irradiance(sun)[1];
    CAPTURE(traced.sun, found / traced.value);
    CHECK(std::abs(found - traced.value) < 0.01 * traced.value + 2.0 * traced.standard_error);
    const double sum = integral_of_radiance(view, sun, on_level_ground)[1];
    CAPTURE(sum / found);
    CHECK(std::abs(sum / found - 1.0) < 0.015);
  }

  // Harmonics hold the mean.
  const SkyProjector projector(view);
  for (const double elevation : some_of(3, {90.0, 75.0, 60.0, 45.0, 30.0, 20.0, 4.0, 10.0})) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    const double mean = projector.project(sun).coefficients()[0].y * std::sqrt(4.0 * pi);
    const double integral = integral_of_radiance(view, sun, [](double) { return 1.0; })[1];
    CAPTURE(elevation, mean / integral);
    CHECK(std::abs(mean / integral - 1.0) < 0.015);
  }
}

TEST_CASE("haze: the recorded paths are those of the oracle", "[sky][haze][truth]") {
  for (const std::size_t k : {std::size_t{1}, std::size_t{9}}) {
    const TracedLight now = traced_now(kTraced[k], 4'000);
    CAPTURE(k, now.value[1] / kTraced[k].radiance, now.standard_error[1] / now.value[1]);
    CHECK(std::abs(now.value[1] - kTraced[k].radiance) < 3.0 * now.standard_error[1] + 3.0 * kTraced[k].standard_error);
  }
}

}  // namespace welkin::test
