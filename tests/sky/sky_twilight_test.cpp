// Skies by low suns and after sunset: light falls by decades between the suns at the tables' nodes.
#include <glm/common.hpp>

#include "math/quadrature.h"
#include "reference/sky_monte_carlo.h"
#include "reference/sky_reference.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/sky_tables_for_tests.h"
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
  static const auto tables =
      std::make_shared<const SkyTables>(precompute_sky(earth_bruneton(), {.truncate_orders = true}));
  return tables;
}

/// The same with an estimate of all further orders, the default.
const std::shared_ptr<const SkyTables>& all_orders() {
  static const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth_bruneton()));
  return tables;
}

/// Of a view's radiances on level ground: places closer together about the sun and the horizon.
dvec3 integral_of_radiance(const SkyView& view, const dvec3& sun) {
  constexpr int zeniths = 40;
  constexpr int azimuths = 72;
  const math::GaussNodes along = math::gauss_nodes(zeniths);
  const math::GaussNodes about = math::gauss_nodes(azimuths);
  const double middle = std::clamp(std::acos(std::clamp(sun.y, -1.0, 1.0)), 0.2, 0.4 * pi);
  dvec3 sum(0.0);
  for (int part = 0; part < 2; ++part) {
    const double low = part == 0 ? 0.0 : middle;
    const double size = part == 0 ? middle : 0.5 * pi - middle;
    for (std::size_t i = 0; i < zeniths; ++i) {
      const double t = 0.5 + 0.5 * along.nodes[i];
      const double zenith = low + size * t * t * (3.0 - 2.0 * t);
      const double ring = std::cos(zenith) * std::sin(zenith) * size * 3.0 * t * (1.0 - t) * along.weights[i];
      for (std::size_t k = 0; k < azimuths; ++k) {
        const double u = 0.5 + 0.5 * about.nodes[k];
        const dvec3 direction = sun_direction(90.0 - zenith * 180.0 / pi, 180.0 * u * u);
        sum += view.radiance(direction, sun) * (ring * 2.0 * pi * u * about.weights[k]);
      }
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("sky view: irradiance is the integral of its own radiances to 0.5 % down to -9 degrees",
          "[sky][twilight][truth]") {
  for (const auto& tables : {four_orders(), all_orders()}) {
    const SkyView view(tables, 0.0);
    for (const double elevation :
         some_of(2, {90.0, 60.0, 30.0, 10.0, 2.0,  0.3,  0.0,  -0.3,  -1.0,  -2.0,  -3.0,  -4.0, -5.0,
                     -5.5, -6.0, -6.5, -7.0, -7.5, -9.0, -8.0, -10.0, -12.0, -14.0, -16.0, -18.0})) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      const dvec3 found = view.irradiance(sun);
      const dvec3 integral = integral_of_radiance(view, sun);
      for (int c = 0; c < 3; ++c) {
        CAPTURE(tables->options.truncate_orders, elevation, c, found[c] / integral[c]);
        CHECK(std::abs(found[c] / integral[c] - 1.0) < (elevation < -9.0 ? 0.025 : 0.005));
      }
    }
  }
}

TEST_CASE("sky view: earth()'s radiances at 8 azimuths integrate to its irradiance to 0.75 %, at 16 to 0.3 %",
          "[sky][twilight][truth]") {
  for (const int angles : {8, 16}) {
    const SkyView view(std::make_shared<const SkyTables>(precompute_sky(earth(), {.sun_angles = angles})), 0.0);
    double most = 0.0;
    for (const double elevation : {60.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.3, 0.0, -0.5}) {
      const dvec3 sun = sun_direction(elevation, 0.0);
      const dvec3 off = glm::abs(view.irradiance(sun) / integral_of_radiance(view, sun) - 1.0);
      most = std::max({most, off.x, off.y, off.z});
    }
    CAPTURE(angles, most);
    CHECK(most < (angles == 8 ? 0.0075 : 0.003));
    CHECK(most > (angles == 8 ? 0.005 : 0.001));  // what docs/maths/sky.md says is true
  }
}

namespace {

/// Of directions all over the sky: what singly scattered light is off the quadrature, as a share of all light in the
/// same direction, at most, below 3 degrees, up to 45, and above; and the root of the mean square over that of light.
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

// Below the horizon's own haze the shadow's edge is sharper than views' nodes lie apart.
TEST_CASE("sky view: single directions are right to 1 % while the sun sets", "[sky][twilight][truth]") {
  for (const double elevation : some_of(3, {0.5, 0.25, 0.1, 0.0, -0.1, -0.25, -0.5})) {
    const DirectionErrors errors = direction_errors(elevation);
    CAPTURE(elevation, errors.low, errors.middle, errors.high, errors.rms);
    CHECK(errors.low < (elevation < -0.1 ? 0.012 : 0.01));
    CHECK(errors.middle < 0.0075);
    CHECK(errors.high < 0.002);
    CHECK(errors.rms < 0.0015);
  }
}

TEST_CASE("sky view: single directions are right to 2 % while the shadow rises, and to 5 % at -2 degrees",
          "[sky][twilight][truth]") {
  for (const double elevation : some_of(3, {-0.75, -1.0, -1.25, -2.0, -1.5, -1.75, -4.0, -3.0, -5.0, -6.0})) {
    const DirectionErrors errors = direction_errors(elevation);
    CAPTURE(elevation, errors.low, errors.middle, errors.high, errors.rms);
    CHECK(errors.low < 0.02);
    CHECK(errors.middle < (elevation == -2.0 ? 0.05 : 0.02));
    CHECK(errors.high < (elevation < -3.0 ? 0.01 : 0.003));
    CHECK(errors.rms < 0.0015);
  }
}

TEST_CASE("sky view: orders two to four at -6 degrees are those of paths", "[sky][twilight][truth]") {
  const dvec3 sun = sun_direction(-6.0, 0.0);
  const dvec3 all = SkyView(four_orders(), 0.0).irradiance(sun);
  SkyTableOptions one{.orders = 1};
  const dvec3 single =
      SkyView(std::make_shared<const SkyTables>(precompute_sky(earth_bruneton(), one)), 0.0).irradiance(sun);
  const TracedLight traced =
      trace_sky_irradiance(earth_bruneton(), 0.0, sun, {.lowest_order = 2, .highest_order = 4, .paths = 150'000});
  for (int c = 0; c < 3; ++c) {
    const auto k = static_cast<std::size_t>(c);
    CAPTURE(c, (all[c] - single[c]) / traced.value[k], traced.standard_error[k] / traced.value[k]);
    CHECK(traced.standard_error[k] < 0.02 * traced.value[k]);
    CHECK(std::abs(all[c] - single[c] - traced.value[k]) < 0.01 * traced.value[k] + 2.0 * traced.standard_error[k]);
  }
}

// The oracle against one of another kind.
TEST_CASE("sky Monte Carlo: its first order is the quadrature's", "[sky][twilight][truth]") {
  for (const double elevation : {40.0, 0.0, -6.0}) {
    const dvec3 sun = sun_direction(elevation, 0.0);
    const dvec3 direction = sun_direction(20.0, 30.0);
    const TracedLight traced = trace_sky_radiance(earth_bruneton(), 0.0, direction, sun,
                                                  {.lowest_order = 1, .highest_order = 1, .paths = 40'000});
    const std::vector<double> truth = reference_sky_radiance(earth_bruneton(), 0.0, direction, sun, {1e-5, true});
    for (std::size_t c = 0; c < 3; ++c) {
      CAPTURE(elevation, c, traced.value[c] / truth[c], traced.standard_error[c] / truth[c]);
      CHECK(traced.standard_error[c] < 0.02 * truth[c]);
      CHECK(std::abs(traced.value[c] - truth[c]) < 3.5 * traced.standard_error[c]);
    }
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

}  // namespace welkin::test
