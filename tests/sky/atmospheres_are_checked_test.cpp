// Every parameter of an atmosphere is checked, by its name; what the presets and the random ones are passes.
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/random_atmospheres.h"
#include "support/thrown_error.h"
#include "welkin/atmosphere.h"

namespace welkin {
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
  const test::ThrownError error = test::thrown_by([&] { check(air); });
  CHECK(error.code == ErrorCode::invalid_argument);
  INFO(error.message);
  CHECK(error.says(words));
}

}  // namespace

TEST_CASE("sky: every parameter of an atmosphere is refused by its name if it is no number or negative", "[sky][air]") {
  for (const Parameter& parameter : parameters()) {
    for (const double wrong : {kNan, kInfinity, -kInfinity, -0.25}) {
      Atmosphere air = earth();
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
    Atmosphere air = earth();
    change(air);
    return air;
  };
  must_be_refused(changed([](Atmosphere& a) { a.bottom_radius_m = 0.99; }), "bottom_radius_m is 0.99");
  must_be_refused(changed([](Atmosphere& a) { a.bottom_radius_m = 1.01e9; }), "bottom_radius_m");
  must_be_refused(changed([](Atmosphere& a) { a.top_radius_m = a.bottom_radius_m; }), "must be above it");
  must_be_refused(changed([](Atmosphere& a) { a.top_radius_m = 11.1 * a.bottom_radius_m; }), "top_radius_m");
  must_be_refused(changed([](Atmosphere& a) { a.aerosol_asymmetry = 0.9991; }), "0.9991");
  must_be_refused(changed([](Atmosphere& a) { a.aerosol_asymmetry = -1.0; }), "-0.999 to 0.999");
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

TEST_CASE("sky: presets and random atmospheres pass the check", "[sky][air]") {
  for (const Atmosphere& air : {earth(), earth_hillaire(), mars(), without_aerosol(earth()),
                                with_ground_albedo(mars(), 1.0), earth({360.0, 365.0, 830.0})}) {
    INFO(air.name);
    CHECK_NOTHROW(check(air));
    CHECK_FALSE(air.name.empty());
  }
  test::RandomAtmospheres random(7);
  for (int i = 0; i < 5000; ++i) {
    const Atmosphere air = random.next(random.whole(3, 96));
    REQUIRE_NOTHROW(check(air));
  }
}

TEST_CASE("sky: the Earth has Bruneton's constants", "[sky][air]") {
  const Atmosphere air = earth();
  // Of his web demo's shader, which has them folded for 680, 550 and 440 nm (Rayleigh, ozone: 1/km).
  CHECK(air.rayleigh.scattering_per_m[0] == Approx(5.802339e-6).epsilon(1e-6));
  CHECK(air.rayleigh.scattering_per_m[1] == Approx(1.3557762e-5).epsilon(1e-6));
  CHECK(air.rayleigh.scattering_per_m[2] == Approx(3.3100e-5).epsilon(1e-4));
  CHECK(air.aerosol.scattering_per_m[1] == Approx(3.996e-6).epsilon(1e-12));
  CHECK(air.absorbers[0].absorption_per_m[0] == Approx(6.497166e-7).epsilon(1e-6));
  CHECK(air.absorbers[0].absorption_per_m[1] == Approx(1.8809e-6).epsilon(1e-4));
  CHECK(air.solar_irradiance == std::vector<double>{1.474, 1.8504, 1.91198});
  const Atmosphere between = earth({365.0, 550.0, 830.0});
  CHECK(between.solar_irradiance[0] == Approx(0.5 * (1.11776 + 1.14259)).epsilon(1e-12));
  CHECK(between.solar_irradiance[2] == 1.04992);
  CHECK(test::thrown_by([] { return earth({359.0, 550.0, 600.0}); }).says("359"));
  CHECK(test::thrown_by([] { return earth({kNan, 550.0, 600.0}); }).says("360 to 830"));
}

TEST_CASE("sky: Mars has red dust, a paler sun and little air", "[sky][air]") {
  const Atmosphere air = mars();
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    CHECK((air.aerosol.scattering_per_m[at] + air.aerosol.absorption_per_m[at]) * 11'100.0 == Approx(0.5));
    CHECK(air.rayleigh.scattering_per_m[at] < 0.03 * air.aerosol.scattering_per_m[at]);
    CHECK(air.solar_irradiance[at] == Approx(0.4307 * earth().solar_irradiance[at]).epsilon(1e-3));
  }
  CHECK(air.aerosol.absorption_per_m[2] > 3.0 * air.aerosol.absorption_per_m[0]);
  CHECK(air.rayleigh.scattering_per_m[1] == Approx(2.55e-7).epsilon(0.02));
}

TEST_CASE("sky: profiles and variants refuse what is no number", "[sky][air]") {
  CHECK(test::thrown_by([] { return exponential_profile(0.0); }).says("scale height"));
  CHECK(test::thrown_by([] { return exponential_profile(kNan); }).says("scale height"));
  CHECK(test::thrown_by([] { return tent_profile(-1.0, 1.0); }).says("centre"));
  CHECK(test::thrown_by([] { return tent_profile(1.0, kInfinity); }).says("half width"));
  CHECK(test::thrown_by([] { return with_ground_albedo(earth(), 1.5); }).says("1.5"));
  CHECK(without_aerosol(earth()).aerosol == Constituent{});
  CHECK(with_ground_albedo(earth(), 0.25).ground_albedo == std::vector<double>(3, 0.25));
}

TEST_CASE("sky: the sun stands where its angles say", "[sky][air]") {
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-15; };
  CHECK(near(sun_direction(90.0, 123.0), {0.0, 1.0, 0.0}));
  CHECK(near(sun_direction(0.0, 0.0), {0.0, 0.0, 1.0}));
  CHECK(near(sun_direction(0.0, 90.0), {1.0, 0.0, 0.0}));
  CHECK(near(sun_direction(-30.0, 180.0), {0.0, -0.5, -std::sqrt(0.75)}));
  CHECK(near(sun_direction(20.0, -90.0), sun_direction(20.0, 270.0)));
  CHECK(test::thrown_by([] { return sun_direction(90.1, 0.0); }).says("elevation"));
  CHECK(test::thrown_by([] { return sun_direction(kNan, 0.0); }).says("elevation"));
  CHECK(test::thrown_by([] { return sun_direction(0.0, kInfinity); }).says("azimuth"));
}

}  // namespace welkin
