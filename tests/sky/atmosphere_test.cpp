// Atmospheres: what is refused, densities, phase functions, spectra.
#include "sky/air.h"
#include "sky/spectrum.h"
#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "support/thrown_error.h"
#include "welkin/sky.h"

namespace welkin::test {

// Every parameter of an atmosphere is checked, and named if wrong; presets and random atmospheres pass.

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Parameter {
  std::string name;
  std::function<double&(Atmosphere&)> of;
  bool may_be_negative = false;
};

std::vector<Parameter> parameters() {
  return {
      {"wavelengths_nm[1]", [](Atmosphere& a) -> double& { return a.wavelengths_nm[1]; }},
      {"bottom_radius_m", [](Atmosphere& a) -> double& { return a.bottom_radius_m; }},
      {"top_radius_m", [](Atmosphere& a) -> double& { return a.top_radius_m; }},
      {"rayleigh.scattering_per_m[2]", [](Atmosphere& a) -> double& { return a.rayleigh.scattering_per_m[2]; }},
      {"aerosol.scattering_per_m[0]", [](Atmosphere& a) -> double& { return a.aerosol.scattering_per_m[0]; }},
      {"aerosol.absorption_per_m[1]", [](Atmosphere& a) -> double& { return a.aerosol.absorption_per_m[1]; }},
      {"absorbers[0].absorption_per_m[1]", [](Atmosphere& a) -> double& { return a.absorbers[0].absorption_per_m[1]; }},
      {"aerosol_asymmetry", [](Atmosphere& a) -> double& { return a.aerosol_asymmetry; }, true},
      {"night_zenith_luminance", [](Atmosphere& a) -> double& { return a.night_zenith_luminance; }},
      {"ground_albedo[2]", [](Atmosphere& a) -> double& { return a.ground_albedo[2]; }},
      {"solar_irradiance[0]", [](Atmosphere& a) -> double& { return a.solar_irradiance[0]; }},
      {"sun_angular_radius_degrees", [](Atmosphere& a) -> double& { return a.sun_angular_radius_degrees; }},
      {"absorbers[0].density[0].thickness_m",
       [](Atmosphere& a) -> double& { return a.absorbers[0].density[0].thickness_m; }},
      {"rayleigh.density[0].exponential_term",
       [](Atmosphere& a) -> double& { return a.rayleigh.density[0].exponential_term; }, true},
      {"rayleigh.density[0].exponential_scale_per_m",
       [](Atmosphere& a) -> double& { return a.rayleigh.density[0].exponential_scale_per_m; }, true},
      {"absorbers[0].density[1].linear_term_per_m",
       [](Atmosphere& a) -> double& { return a.absorbers[0].density[1].linear_term_per_m; }, true},
      {"aerosol.density[0].constant_term", [](Atmosphere& a) -> double& { return a.aerosol.density[0].constant_term; },
       true},
  };
}

void must_be_refused(const Atmosphere& air, const std::string& words) {
  INFO(words);
  const ThrownError error = thrown_by([&] { check(air); });
  CHECK(error.code == ErrorCode::invalid_argument);
  INFO(error.message);
  CHECK(error.says(words));
}

}  // namespace

TEST_CASE("sky: every parameter of an atmosphere is refused by its name if it is no number or negative", "[sky][air]") {
  for (const Parameter& parameter : parameters()) {
    for (const double wrong : {kNan, kInfinity, -kInfinity, -0.25}) {
      Atmosphere air = earth_bruneton();
      if (wrong == -0.25 && parameter.may_be_negative) {
        parameter.of(air) = wrong;
        CHECK_NOTHROW(check(air));
        continue;
      }
      parameter.of(air) = wrong;
      must_be_refused(air, parameter.name);
    }
  }
}

TEST_CASE("sky: ranges of an atmosphere are kept at both ends", "[sky][air]") {
  const auto changed = [](const std::function<void(Atmosphere&)>& change) {
    Atmosphere air = earth_bruneton();
    change(air);
    return air;
  };
  must_be_refused(changed([](Atmosphere& a) { a.bottom_radius_m = 0.99; }), "bottom_radius_m is 0.99");
  must_be_refused(changed([](Atmosphere& a) { a.bottom_radius_m = 1.01e9; }), "bottom_radius_m");
  must_be_refused(changed([](Atmosphere& a) { a.top_radius_m = a.bottom_radius_m; }), "must be above it");
  must_be_refused(changed([](Atmosphere& a) { a.top_radius_m = 11.1 * a.bottom_radius_m; }), "top_radius_m");
  must_be_refused(changed([](Atmosphere& a) { a.aerosol_asymmetry = 0.9991; }), "0.9991");
  must_be_refused(changed([](Atmosphere& a) { a.aerosol_asymmetry = -1.1; }), "-0.8 to 0.999");
  must_be_refused(changed([](Atmosphere& a) { a.aerosol_asymmetry = -0.81; }), "sends light back");
  const auto by_wavelength = [&](std::vector<double> values) {
    return changed([&](Atmosphere& a) { a.aerosol_asymmetries = std::move(values); });
  };
  must_be_refused(by_wavelength({0.5, 0.6}), "aerosol_asymmetries has 2 values for 3 wavelengths");
  must_be_refused(by_wavelength({0.5, 0.6, 0.9991}), "aerosol_asymmetries[2] is 0.9991");
  must_be_refused(by_wavelength({0.5, kNan, 0.6}), "aerosol_asymmetries[1]");
  must_be_refused(by_wavelength({-0.81, 0.5, 0.6}), "sends light back");
  must_be_refused(changed([](Atmosphere& a) { a.night_zenith_luminance = 1.1; }), "from 0 to 1");
  must_be_refused(changed([](Atmosphere& a) { a.ground_albedo[1] = 1.01; }), "ground_albedo[1] is 1.01");
  must_be_refused(changed([](Atmosphere& a) { a.sun_angular_radius_degrees = 10.1; }), "10.1");
  must_be_refused(changed([](Atmosphere& a) { a.wavelengths_nm = {680.0, 550.0}; }), "2 wavelengths");
  must_be_refused(changed([](Atmosphere& a) { a.wavelengths_nm = {680.0, 550.0, 550.0}; }), "all rise or all fall");
  must_be_refused(changed([](Atmosphere& a) { a.wavelengths_nm = {440.0, 550.0, 500.0}; }), "all rise or all fall");
  must_be_refused(changed([](Atmosphere& a) { a.wavelengths_nm.assign(97, 1.0); }), "97 wavelengths");
  must_be_refused(changed([](Atmosphere& a) { a.solar_irradiance.pop_back(); }), "solar_irradiance has 2 values");
  must_be_refused(changed([](Atmosphere& a) { a.solar_irradiance.clear(); }), "solar_irradiance");
  must_be_refused(changed([](Atmosphere& a) { a.ground_albedo.push_back(0.5); }), "ground_albedo has 4 values");
  must_be_refused(changed([](Atmosphere& a) { a.rayleigh.scattering_per_m.resize(1); }), "1 values for 3");
  must_be_refused(changed([](Atmosphere& a) { a.rayleigh.scattering_per_m[0] = 1.1e6; }), "1100000");
  must_be_refused(changed([](Atmosphere& a) { a.aerosol.density.resize(9); }), "9 layers");
  must_be_refused(changed([](Atmosphere& a) { a.absorbers.resize(5); }), "5 absorbers");
  must_be_refused(changed([](Atmosphere& a) { a.absorbers[0].scattering_per_m.assign(3, 0.1); }), "does not scatter");
  CHECK_NOTHROW(check(changed([](Atmosphere& a) { a.ground_albedo.clear(); })));
  CHECK_NOTHROW(check(changed([](Atmosphere& a) { a.rayleigh = {}; })));
  CHECK_NOTHROW(check(changed([](Atmosphere& a) { a.top_radius_m = 11.0 * a.bottom_radius_m; })));
}

TEST_CASE("sky: the Earth has Bruneton's constants", "[sky][air]") {
  const Atmosphere air = earth_bruneton();
  // From his web demo's shader, which has them folded for 680, 550 and 440 nm (Rayleigh, ozone: 1/km).
  CHECK(air.rayleigh.scattering_per_m[0] == Approx(5.802339e-6).epsilon(1e-6));
  CHECK(air.rayleigh.scattering_per_m[1] == Approx(1.3557762e-5).epsilon(1e-6));
  CHECK(air.rayleigh.scattering_per_m[2] == Approx(3.3100e-5).epsilon(1e-4));
  CHECK(air.aerosol.scattering_per_m[1] == Approx(3.996e-6).epsilon(1e-12));
  CHECK(air.absorbers[0].absorption_per_m[0] == Approx(6.497166e-7).epsilon(1e-6));
  CHECK(air.absorbers[0].absorption_per_m[1] == Approx(1.8809e-6).epsilon(1e-4));
  CHECK(air.solar_irradiance == std::vector<double>{1.474, 1.8504, 1.91198});
  const Atmosphere between = earth_bruneton({365.0, 550.0, 830.0});
  CHECK(between.solar_irradiance[0] == Approx(0.5 * (1.11776 + 1.14259)).epsilon(1e-12));
  CHECK(between.solar_irradiance[2] == 1.04992);
  CHECK(thrown_by([] { return earth_bruneton({359.0, 550.0, 600.0}); }).says("359"));
  CHECK(thrown_by([] { return earth_bruneton({kNan, 550.0, 600.0}); }).says("360 to 830"));
}

TEST_CASE("sky: Mars has red dust, a paler sun and little air", "[sky][air]") {
  const Atmosphere air = mars();
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    CHECK((air.aerosol.scattering_per_m[at] + air.aerosol.absorption_per_m[at]) * 11'100.0 == Approx(0.5));
    CHECK(air.rayleigh.scattering_per_m[at] < 0.03 * air.aerosol.scattering_per_m[at]);
    CHECK(air.solar_irradiance[at] == Approx(0.4307 * earth_bruneton().solar_irradiance[at]).epsilon(1e-3));
  }
  CHECK(air.aerosol.absorption_per_m[2] > 3.0 * air.aerosol.absorption_per_m[0]);
  CHECK(air.rayleigh.scattering_per_m[1] == Approx(2.55e-7).epsilon(0.02));
}

TEST_CASE("sky: profiles and variants refuse what is no number", "[sky][air]") {
  CHECK(thrown_by([] { return exponential_profile(0.0); }).says("scale height"));
  CHECK(thrown_by([] { return exponential_profile(kNan); }).says("scale height"));
  CHECK(thrown_by([] { return tent_profile(-1.0, 1.0); }).says("centre"));
  CHECK(thrown_by([] { return tent_profile(1.0, kInfinity); }).says("half width"));
  CHECK(thrown_by([] { return with_ground_albedo(earth_bruneton(), 1.5); }).says("1.5"));
  CHECK(without_aerosol(earth_bruneton()).aerosol == Constituent{});
  CHECK(with_ground_albedo(earth_bruneton(), 0.25).ground_albedo == std::vector<double>(3, 0.25));
}

TEST_CASE("sky: the sun stands where its angles say", "[sky][air]") {
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-15; };
  CHECK(near(sun_direction(90.0, 123.0), {0.0, 1.0, 0.0}));
  CHECK(near(sun_direction(0.0, 0.0), {0.0, 0.0, 1.0}));
  CHECK(near(sun_direction(0.0, 90.0), {1.0, 0.0, 0.0}));
  CHECK(near(sun_direction(-30.0, 180.0), {0.0, -0.5, -std::sqrt(0.75)}));
  CHECK(near(sun_direction(20.0, -90.0), sun_direction(20.0, 270.0)));
  CHECK(thrown_by([] { return sun_direction(90.1, 0.0); }).says("elevation"));
  CHECK(thrown_by([] { return sun_direction(kNan, 0.0); }).says("elevation"));
  CHECK(thrown_by([] { return sun_direction(0.0, kInfinity); }).says("azimuth"));
}

// Densities are their layers' formulas, from 0 to 1 whatever the formulas do, and every kink is known.

TEST_CASE("sky: densities are their formulas, layer by layer", "[sky][air]") {
  const std::vector<DensityLayer> exponential = exponential_profile(8000.0);
  CHECK(sky::density(exponential, 0.0) == 1.0);
  CHECK(sky::density(exponential, -5.0) == 1.0);
  CHECK(sky::density(exponential, 16'000.0) == Approx(std::exp(-2.0)).epsilon(1e-14));
  const std::vector<DensityLayer> tent = tent_profile(25'000.0, 15'000.0);
  for (double h = 0.0; h < 60'000.0; h += 500.0) {
    CHECK(sky::density(tent, h) == Approx(std::max(0.0, 1.0 - std::abs(h - 25'000.0) / 15'000.0)).margin(1e-14));
  }
  const std::vector<DensityLayer> slabs{{.thickness_m = 100.0, .constant_term = 0.25},
                                        {.thickness_m = 0.0, .constant_term = 0.5},
                                        {.thickness_m = 50.0, .constant_term = 7.0},
                                        {.constant_term = -1.0}};
  CHECK(sky::density(slabs, 99.999) == 0.25);
  CHECK(sky::density(slabs, 100.0) == 1.0);
  CHECK(sky::density(slabs, 150.0) == 0.0);
  CHECK(sky::density({}, 10.0) == 0.0);
}

// Spectra become linear sRGB luminances as the CIE's observer sees them.

namespace {

std::vector<double> spread(double low, double high, int count) {
  std::vector<double> result;
  for (int i = 0; i < count; ++i) result.push_back(low + (high - low) * i / (count - 1));
  return result;
}

template <class Spectrum>
glm::dvec3 folded(const std::vector<double>& wavelengths, const Spectrum& spectrum) {
  const std::vector<glm::dvec3> weights = sky::srgb_weights(wavelengths);
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * spectrum(wavelengths[i]);
  return sum;
}

double luminance(const glm::dvec3& rgb) {
  return 0.2126390058715103 * rgb.r + 0.7151686787677559 * rgb.g + 0.0721923153607337 * rgb.b;
}

/// Planck's law at 6500 K, scaled: a smooth white.
double hot(double nm) {
  const double m = nm * 1e-9;
  return 1e-31 / (m * m * m * m * m) / (std::exp(0.014387769 / (m * 6500.0)) - 1.0);
}

}  // namespace

TEST_CASE("sky: an even spectrum is the equal-energy white", "[sky][air]") {
  // Chromaticity (1/3, 1/3): sRGB in proportion 1.205 : 0.948 : 0.909; luminance 683 times the integral of y,
  // 106.857.
  const glm::dvec3 even = folded({360.0, 600.0, 830.0}, [](double) { return 1.0; });
  CHECK(luminance(even) == Approx(683.0 * 106.857).epsilon(1e-5));
  CHECK(even.r / luminance(even) == Approx(1.205).epsilon(5e-4));
  CHECK(even.g / luminance(even) == Approx(0.9483).epsilon(5e-4));
  CHECK(even.b / luminance(even) == Approx(0.909).epsilon(5e-4));
  // However many wavelengths, wherever they are, and in both orders.
  for (const auto& wavelengths : {spread(440.0, 680.0, 3), spread(680.0, 440.0, 7), spread(200.0, 1200.0, 96),
                                  spread(900.0, 1000.0, 5), std::vector<double>{549.0, 550.0, 551.0}}) {
    const glm::dvec3 same = folded(wavelengths, [](double) { return 1.0; });
    for (int c = 0; c < 3; ++c) CHECK(same[c] == Approx(even[c]).epsilon(1e-12));
  }
}

TEST_CASE("sky: weights follow their wavelengths, rising or falling", "[sky][air]") {
  const std::vector<glm::dvec3> rising = sky::srgb_weights({440.0, 550.0, 680.0});
  const std::vector<glm::dvec3> falling = sky::srgb_weights({680.0, 550.0, 440.0});
  CHECK(rising[0].b > rising[0].g);
  CHECK(rising[2].r > rising[2].g);
  for (std::size_t i = 0; i < 3; ++i) CHECK(falling[i] == rising[2 - i]);
}

TEST_CASE("sky: more wavelengths come closer to the whole spectrum", "[sky][air]") {
  const glm::dvec3 truth = folded(spread(360.0, 830.0, 95), hot);
  double before = 1.0;
  for (const int count : {3, 6, 12, 24, 48}) {
    const double error = glm::length(folded(spread(380.0, 740.0, count), hot) - truth) / glm::length(truth);
    INFO(count << " wavelengths: " << error);
    CHECK(error < 0.6 * before);
    before = error;
  }
  CHECK(before < 1e-3);
  // A black body of 6500 K is (255, 249, 253) in sRGB bytes (Charity, `What color is a blackbody`).
  CHECK(truth.r / truth.g == Approx(1.055).margin(0.015));
  CHECK(truth.b / truth.g == Approx(1.04).margin(0.015));
}

}  // namespace welkin::test
