// Skies by low suns, after sunset and at night: light falls by decades between the suns at the tables' nodes.
#include <glm/common.hpp>

#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/sky_projection.h"
#include "sky/sky_tables_for_tests.h"
#include "sky/spectrum.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "support/trials.h"
#include "welkin/sky.h"

namespace welkin::test {

// Promise: what a view says of its irradiance is the integral of what it says of its radiances, light scattered often
// is that of paths, and single directions are right while the disc sets.

namespace {

using glm::dvec3;
using std::numbers::pi;

/// Earth's four orders, the default sizes.
const std::shared_ptr<const SkyTables>& four_orders() {
  static const auto tables = sky_tables_of(earth_bruneton(), {.truncate_orders = true});
  return tables;
}

}  // namespace

// In one case, as they share tables that take seconds.
TEST_CASE("sky view: irradiance is the integral of its own radiances to 0.5 % down to -9 degrees, and that of paths",
          "[sky][twilight][truth]") {
  // Four orders alone, and with an estimate of all further ones, the default.
  for (const auto& tables : {four_orders(), sky_tables_of(earth_bruneton())}) {
    const SkyView view(tables, 0.0);
    for (const double elevation :
         some_of(2, {90.0, 60.0, 30.0, 10.0, 2.0,  0.3,  0.0,  -0.3,  -1.0,  -2.0,  -3.0,  -4.0, -5.0,
                     -5.5, -6.0, -6.5, -7.0, -7.5, -9.0, -8.0, -10.0, -12.0, -14.0, -16.0, -18.0})) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      const dvec3 found = view.irradiance(sun);
      const dvec3 integral = integral_of_radiance(view, sun, on_level_ground);
      for (int c = 0; c < 3; ++c) {
        CAPTURE(tables->options.truncate_orders, elevation, c, found[c] / integral[c]);
        CHECK(std::abs(found[c] / integral[c] - 1.0) < (elevation < -9.0 ? 0.025 : 0.005));
      }
    }
  }

  // Orders two to four at -6 degrees are those of paths.
  const dvec3 sun = sun_direction(-6.0, 0.0);
  const dvec3 all = SkyView(four_orders(), 0.0).irradiance(sun);
  const dvec3 single = sky_view_of(earth_bruneton(), {.orders = 1}).irradiance(sun);
  const TracedLight traced =
      trace_sky_irradiance(earth_bruneton(), 0.0, sun, {.lowest_order = 2, .highest_order = 4, .paths = 150'000});
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    CAPTURE(c, (all[c] - single[c]) / traced.value[k], traced.standard_error[k] / traced.value[k]);
    CHECK(traced.standard_error[k] < 0.02 * traced.value[k]);
    CHECK(std::abs(all[c] - single[c] - traced.value[k]) < 0.01 * traced.value[k] + 2.0 * traced.standard_error[k]);
  }
}

TEST_CASE("sky view: earth()'s radiances at 8 azimuths integrate to its irradiance to 0.75 %, at 16 to 0.3 %",
          "[sky][twilight][truth]") {
  for (const int angles : {8, 16}) {
    const SkyView view = sky_view_of(earth(), {.sun_angles = angles});
    double most = 0.0;
    for (const double elevation : {60.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.3, 0.0, -0.5}) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      const dvec3 off = glm::abs(view.irradiance(sun) / integral_of_radiance(view, sun, on_level_ground) - 1.0);
      most = std::max({most, off.x, off.y, off.z});
    }
    CAPTURE(angles, most);
    CHECK(most < (angles == 8 ? 0.0075 : 0.003));
    CHECK(most > (angles == 8 ? 0.005 : 0.001));  // what docs/maths/sky.md says is true
  }
}

namespace {

/// Errors of singly scattered light against the quadrature, over the sky: the maximum relative to all light in the same
/// direction, below 3 degrees, up to 45, and above; and the root mean square error over the light's root mean square.
struct DirectionErrors {
  double low = 0.0;
  double middle = 0.0;
  double high = 0.0;
  double rms = 0.0;
};

DirectionErrors direction_errors(double elevation) {
  static const SkyView once(single_tables(), 0.0);
  static const SkyView view(four_orders(), 0.0);
  const dvec3 sun = sun_direction(elevation, 0.0);
  DirectionErrors errors;
  double squares = 0.0;
  double all = 0.0;
  for (const double up : {0.2, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 25.0, 45.0, 60.0, 70.0, 80.0, 90.0}) {
    for (const double azimuth : {0.0, 20.0, 60.0, 90.0, 120.0, 150.0, 165.0, 180.0}) {
      const dvec3 direction = sun_direction(up, azimuth);
      const std::vector<double> truth = reference_sky_radiance(earth_bruneton(), 0.0, direction, sun, {1e-5, true});
      const dvec3 found = once.radiance(direction, sun);
      const dvec3 bright = view.radiance(direction, sun);
      for (int c = 0; c < 3; ++c) {
        const double exact = truth[static_cast<std::size_t>(c)];
        double& most = up < 3.0 ? errors.low : (up < 50.0 ? errors.middle : errors.high);
        most = std::max(most, std::abs(found[c] - exact) / bright[c]);
        squares += (found[c] - exact) * (found[c] - exact);
        all += exact * exact;
      }
    }
  }
  errors.rms = std::sqrt(squares / all);
  return errors;
}

}  // namespace

// Below the horizon's own haze the shadow's edge is sharper than views' nodes lie apart. In one case, as both twilights
// share tables that take seconds.
TEST_CASE(
    "sky view: single directions are right to 1 % while the sun sets, to 2 % while the shadow rises, and to 5 % "
    "at -2 degrees",
    "[sky][twilight][truth]") {
  for (const double elevation : some_of(3, {0.5, 0.25, 0.1, 0.0, -0.1, -0.25, -0.5})) {
    const DirectionErrors errors = direction_errors(elevation);
    CAPTURE(elevation, errors.low, errors.middle, errors.high, errors.rms);
    CHECK(errors.low < (elevation < -0.1 ? 0.012 : 0.01));
    CHECK(errors.middle < 0.0075);
    CHECK(errors.high < 0.002);
    CHECK(errors.rms < 0.0015);
  }
  for (const double elevation : some_of(3, {-0.75, -1.0, -1.25, -2.0, -1.5, -1.75, -4.0, -3.0, -5.0, -6.0})) {
    const DirectionErrors errors = direction_errors(elevation);
    CAPTURE(elevation, errors.low, errors.middle, errors.high, errors.rms);
    CHECK(errors.low < 0.02);
    CHECK(errors.middle < (elevation == -2.0 ? 0.05 : 0.02));
    CHECK(errors.high < (elevation < -3.0 ? 0.01 : 0.003));
    CHECK(errors.rms < 0.0015);
  }
}

TEST_CASE("brightness between suns falls as an exponential does, and swings nowhere", "[sky][twilight]") {
  std::vector<double> nodes;
  for (int k = 0; k < 9; ++k) nodes.push_back(std::exp(2.0 * k));
  const std::vector<float> steps = sky::resample_log_cubic(nodes);
  REQUIRE(steps.size() == std::size_t{8} * sky::kSunSteps + 1);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    CHECK(steps[k] == Approx(std::exp(2.0 * static_cast<double>(k) / sky::kSunSteps)).epsilon(1e-5));
  }
  const std::vector<float> cliff = sky::resample_log_cubic(std::vector<double>{1.0, 0.9, 1e-25, 0.0, 0.0, 1.0});
  for (const float value : cliff) CHECK((value >= 0.0F && value <= 1.1F));
  std::vector<double> falls{1.0, 0.9, 1e-25, 0.0, 0.0, 1.0};
  sky::limit_decay(falls);
  CHECK(falls == std::vector<double>{1.0, 0.9, 0.01 * 0.9, 0.01 * 0.01, 0.01, 1.0});
}

// The light of the night, and skies by suns deep below the horizon.

// Promise: where an atmosphere sets one, the zenith has the requested night luminance, by night and by day; irradiance,
// harmonics, curves and images have it too.

namespace {

Atmosphere at_night(Atmosphere air = earth(), double luminance = kDarkNightZenithLuminance) {
  air.night_zenith_luminance = luminance;
  return air;
}

/// Returns the luminance of radiances at an atmosphere's three wavelengths, cd/m2.
double luminance(const Atmosphere& air, const dvec3& radiance) {
  const std::vector<dvec3> weights = sky::srgb_weights(air.wavelengths_nm);
  dvec3 rgb(0.0);
  for (std::size_t i = 0; i < 3; ++i) rgb += weights[i] * radiance[static_cast<glm::length_t>(i)];
  return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
}

const dvec3 kUp(0.0, 1.0, 0.0);
const dvec3 kNadir(0.0, -1.0, 0.0);

}  // namespace

TEST_CASE("night: the zenith has the luminance asked for", "[sky][night]") {
  for (const double wanted : {2e-4, 5e-3}) {
    const SkyView view(small_tables(at_night(earth(), wanted)), 0.0);
    CHECK(luminance(earth(), view.radiance(kUp, kNadir)) == Approx(wanted).epsilon(1e-5));
    const Atmosphere spectrum = at_night(earth({420.0, 480.0, 540.0, 600.0, 660.0}), wanted);
    const SkyView folded(small_tables(spectrum, ScatteringLayout::full, SkyColour::linear_srgb), 0.0);
    const dvec3 rgb = folded.radiance(kUp, kNadir);
    CHECK(0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z == Approx(wanted).epsilon(1e-5));
  }
}

TEST_CASE("night: it is the same by day, and none is the bits without", "[sky][night]") {
  const auto with = small_tables(at_night(earth(), 1.0));  // as bright as may be: floats show it by day
  const auto without = small_tables(earth());
  CHECK(with->scattering == without->scattering);
  CHECK(with->irradiance == without->irradiance);
  const SkyView night(with, 300.0);
  const SkyView plain(without, 300.0);
  const dvec3 noon = sun_direction(50.0, 20.0);
  for (const double up : {90.0, 40.0, 10.0, 1.0}) {
    const dvec3 direction = sun_direction(up, 130.0);
    const dvec3 added = night.radiance(direction, kNadir) - plain.radiance(direction, kNadir);
    const dvec3 by_day = night.radiance(direction, noon) - plain.radiance(direction, noon);
    for (int c = 0; c < 3; ++c) {
      CAPTURE(up, c);
      CHECK(added[c] > 0.0);
      CHECK(by_day[c] == Approx(added[c]).epsilon(2e-3));
    }
  }
  // many directions at once, and from space
  const std::vector<glm::vec3> directions{{0.0F, 1.0F, 0.0F}, {0.6F, 0.8F, 0.0F}, {0.0F, -1.0F, 0.0F}};
  std::vector<glm::vec3> many(3);
  night.radiance(directions, kNadir, many);
  for (std::size_t k = 0; k < 3; ++k) CHECK(dvec3(many[k]) == night.radiance(dvec3(directions[k]), kNadir));
  CHECK((SkyView(with, 1e6).radiance(kUp, kNadir) == dvec3(0.0)));
}

// By Garstang's and Patat's formula, for a direction 70 degrees from the zenith.
TEST_CASE("night: it brightens towards the horizon as a layer does, less what the air takes", "[sky][night]") {
  const Atmosphere air = at_night();
  const SkyView view(small_tables(air), 0.0);
  const std::vector<double> through = reference_transmittance(air, 0.0, 1.0);
  const double sine = std::sin(70.0 * pi / 180.0) * 6'360e3 / (6'360e3 + 130e3);
  const double path = 1.0 / std::sqrt(1.0 - sine * sine);
  const dvec3 zenith = view.radiance(kUp, kNadir);
  const dvec3 slanted = view.radiance(sun_direction(20.0, 77.0), kNadir);
  for (int c = 0; c < 3; ++c) {
    const double wanted = (0.4 + 0.6 * path) * std::pow(through[static_cast<std::size_t>(c)], path - 1.0);
    CHECK(slanted[c] / zenith[c] == Approx(wanted).epsilon(1e-3));
  }
}

TEST_CASE("night: irradiance, harmonics and curves are those of its radiance", "[sky][night]") {
  for (const double altitude : {0.0, 20e3}) {
    const SkyView view(small_tables(at_night()), altitude);
    dvec3 integral(0.0);
    constexpr int steps = 400;
    for (int k = 0; k < steps; ++k) {
      const double cosine = (k + 0.5) / steps;
      const dvec3 direction(std::sqrt(1.0 - cosine * cosine), cosine, 0.0);
      integral += 2.0 * pi * cosine / steps * view.radiance(direction, kNadir);
    }
    const dvec3 found = view.irradiance(kNadir);
    const SkyProjector projector(view);
    const SkyCurve curve(view);
    // at nodes and between them
    for (const double elevation : {-90.0, -71.3, -40.0}) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      std::vector<dvec3> plain(sky::even_count(3));
      sky::SkyProjection(view, {}).project_plainly(sky::sun_angles(sun), plain);
      const SphericalHarmonics harmonics = projector.project(sun);
      const SphericalHarmonics of_curve = curve.at(sun);
      for (int c = 0; c < 3; ++c) {
        CAPTURE(altitude, elevation, c);
        CHECK(found[c] == Approx(integral[c]).epsilon(1e-3));
        CHECK(harmonics.coefficients()[0][c] == Approx(plain[0][c]).epsilon(1e-5));
        CHECK(of_curve.coefficients()[0][c] == Approx(harmonics.coefficients()[0][c]).epsilon(1e-3));
        CHECK(harmonics.coefficients()[0][c] > 0.1 * found[c]);
      }
    }
  }
}

// Promise: down to -18 degrees the light that is left is that of paths. (docs/maths/sky.md has the table of many more
// paths.)
TEST_CASE("sky view: light by deep suns is that of paths", "[sky][twilight][night][truth]") {
  const SkyView view = sky_view_of(earth(), {.truncate_orders = true});
  struct Case {
    double elevation;
    double up;
    std::int64_t paths;
    double noise;
  };
  for (const Case& one : some_of(
           2, {Case{-9.0, 90.0, 50'000, 0.06}, Case{-15.0, 30.0, 120'000, 0.12}, Case{-12.0, 30.0, 80'000, 0.08}})) {
    const dvec3 sun = sun_direction(one.elevation, 0.0);
    const dvec3 direction = sun_direction(one.up, 0.0);
    const std::vector<double> once = reference_sky_radiance(earth(), 0.0, direction, sun, {1e-4, true});
    const TracedLight often = trace_sky_radiance(
        earth(), 0.0, direction, sun, {.lowest_order = 2, .highest_order = 4, .paths = one.paths, .seed = 3});
    const dvec3 found = view.radiance(direction, sun);
    for (int c = 0; c < 3; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const double truth = once[k] + often.value[k];
      CAPTURE(one.elevation, one.up, c, found[c] / truth, often.standard_error[k] / truth);
      CHECK(often.standard_error[k] < one.noise * truth);
      CHECK(std::abs(found[c] - truth) < 0.02 * truth + 2.5 * often.standard_error[k]);
    }
  }
}

// Promise: down to -18 degrees the default holds the light of all orders, though it follows but four of them. Light at
// night has been scattered often: of clear air eight orders alone hold it too.
TEST_CASE("sky view: the default holds the light of all orders to 2 % from noon to night, eight orders to 1 %",
          "[sky][twilight][night][truth]") {
  struct Planet {
    Atmosphere air;
    double bound;
    double eight = 0.0;  ///< the minimum share that eight orders have at night
  };
  // on Mars half of an order's light is scattered once more, and dust makes it last longest opposite to the sun
  for (const Planet& planet :
       some_of(2, {Planet{earth(), 0.005, 0.99}, Planet{earth_bruneton(), 0.005},
                   Planet{with_ground_albedo(earth(), 0.8), 0.01},
                   Planet{earth({680.0, 550.0, 440.0}, AerosolKind::polluted), 0.02}, Planet{mars(), 0.02}})) {
    SkyTableOptions options{.heights = 12, .view_zeniths = 32, .sun_zeniths = 32};
    const SkyView usual = sky_view_of(planet.air, options);
    options.truncate_orders = true;
    const SkyView four = sky_view_of(planet.air, options);
    options.orders = 24;
    const SkyView all = sky_view_of(planet.air, options);
    double lacking = 0.0;
    for (const double elevation : {90.0, 30.0, 5.0, 0.0, -3.0, -6.0, -9.0, -12.0, -15.0, -18.0}) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      for (const dvec3& direction : {kUp, sun_direction(10.0, 0.0), sun_direction(30.0, 180.0)}) {
        const dvec3 wanted = all.radiance(direction, sun);
        const dvec3 found = usual.radiance(direction, sun);
        for (int c = 0; c < 3; ++c) {
          CAPTURE(planet.air.name, elevation, direction.y, c, found[c] / wanted[c]);
          CHECK(std::abs(found[c] / wanted[c] - 1.0) < planet.bound);
        }
        lacking = std::max(lacking, 1.0 - four.radiance(direction, sun).z / wanted.z);
      }
      for (int c = 0; c < 3; ++c) {
        CAPTURE(planet.air.name, elevation, c);
        CHECK(std::abs(usual.irradiance(sun)[c] / all.irradiance(sun)[c] - 1.0) < planet.bound);
      }
    }
    CHECK(lacking > 0.15);  // which four orders alone are
    if (planet.eight == 0.0) continue;
    options.orders = 8;
    const SkyView eight = sky_view_of(planet.air, options);
    for (const double elevation : {-9.0, -12.0, -15.0, -18.0}) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      const dvec3 share = eight.radiance(kUp, sun) / all.radiance(kUp, sun);
      for (int c = 0; c < 3; ++c) {
        CAPTURE(elevation, c, share[c]);
        CHECK(share[c] > planet.eight);
        CHECK(share[c] <= 1.0);
      }
    }
  }
}

}  // namespace welkin::test
