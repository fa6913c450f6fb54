// Harmonics of skies, for one sun and along a curve of suns.
#include "reference/sky_reference.h"
#include "sky/elevation_curve.h"
#include "sky/sky_projection.h"
#include "sky/sky_tables_for_tests.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/random_atmospheres.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/core.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: a view's harmonics are the integral of what it shows, for any sun and height.

namespace {

using std::numbers::pi;

constexpr std::array<double, 10> kElevations{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0};

double difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return relative_difference(a.coefficients(), b.coefficients());
}

void check_quadratures() {
  const SkyView view(small_earth(), 0.0);
  const SkyProjector converged(view, {3, SkyQuadrature::gauss_split, 128, 128});
  const SkyProjector split(view);
  const SkyProjector plain(view, {3, SkyQuadrature::gauss, 16, 16});
  const SkyProjector uniform(view, {3, SkyQuadrature::uniform, 16, 16});
  const SkyProjector plainly_converged(view, {3, SkyQuadrature::gauss, 128, 256});
  for (const double elevation : kElevations) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 40.0);
    const SphericalHarmonics truth = converged.project(sun);
    CHECK(difference(plainly_converged.project(sun), truth) < 2e-4);  // the lobe's closed form is no other integral
    CHECK(difference(split.project(sun), truth) < 2e-3);
    CHECK(difference(plain.project(sun), truth) < 5e-3);
    CHECK(difference(uniform.project(sun), truth) > 5e-3);  // why it is not the default
    CHECK(difference(uniform.project(sun), truth) < 0.3);
  }
}

void check_kernels() {
  for (const double altitude : {0.0, 1.8, 1000.0, 12'000.0, 59'000.0}) {
    for (const SkyHarmonicsOptions& options :
         {SkyHarmonicsOptions{}, SkyHarmonicsOptions{16, SkyQuadrature::gauss, 5, 7},
          SkyHarmonicsOptions{4, SkyQuadrature::uniform, 17, 33},
          SkyHarmonicsOptions{1, SkyQuadrature::gauss_split, 2, 2}}) {
      const SkyProjector projector(SkyView(small_earth(), altitude), options);
      const sky::SkyProjection& projection = SkyProjectorAccess::projection(projector);
      const std::size_t terms = sky::even_count(options.bands);
      double by_day = 0.0;
      for (const double elevation : {90.0, 31.0, 3.0, 0.1, -1.0, -5.0, -12.0, -29.9, -31.0, -60.0}) {
        CAPTURE(altitude, elevation, options.bands);
        const sky::SunAngles sun = sky::sun_angles(sun_direction(elevation, 0.0));
        std::vector<glm::dvec3> fast(terms);
        std::vector<glm::dvec3> plain(terms);
        projection.project(sun, fast);
        projection.project_plainly(sun, plain);
        if (elevation == 90.0) by_day = glm::length(plain[0]);
        // By night the view keeps its cubics within reach of the nodes between which they run; a projection sums
        // plainly.
        if (elevation > -1.0) {
          CHECK(relative_difference(fast, plain) < 3e-5);
        } else {
          for (std::size_t i = 0; i < terms; ++i) {
            CHECK(glm::length(fast[i] - plain[i]) < 1e-2 * glm::length(plain[0]) + 1e-6 * by_day);
          }
        }
      }
    }
  }
}

void check_symmetry() {
  const SkyProjector projector(SkyView(small_earth(), 0.0), {.bands = 6});
  for (const double elevation : kElevations) {
    CAPTURE(elevation);
    const SphericalHarmonics ahead = projector.project(sun_direction(elevation, 0.0));
    glm::dmat3 mirror(1.0);
    mirror[0][0] = -1.0;  // x
    CHECK(difference(rotate(ahead, mirror), ahead) < 1e-14);
    for (const double azimuth : {30.0, 90.0, -123.0, 180.0, 359.0}) {
      const double half = 0.5 * azimuth * pi / 180.0;
      const glm::dquat rotation(std::cos(half), 0.0, std::sin(half), 0.0);  // +z towards +x
      const double bound = elevation == 90.0 ? 1e-4 : 1e-12;  // there the nodes' azimuths lean with the sun's rounding
      CHECK(difference(projector.project(sun_direction(elevation, azimuth)), rotate(ahead, rotation)) < bound);
    }
  }
}

void check_space() {
  for (const double altitude : {1e5, 1e6, 6e7}) {
    const SkyView view(small_earth(), altitude);
    const SkyProjector usual(view);
    const SkyProjector fine(view, {3, SkyQuadrature::gauss_split, 64, 64});
    for (const double elevation : {80.0, 20.0, -10.0, -60.0}) {
      CAPTURE(altitude, elevation);
      const glm::dvec3 sun = sun_direction(elevation, 5.0);
      const SphericalHarmonics light = usual.project(sun);
      // By a sun far behind it a planet is a thin crescent, and its light little.
      CHECK(difference(light, fine.project(sun)) < (elevation < -30.0 ? 1e-1 : 2e-2));
      for (int c = 0; c < 3; ++c) CHECK(light.at(0, 0)[c] >= 0.0);
    }
  }
}

}  // namespace

// In one case, as all take tables of half a second.
TEST_CASE("a view's harmonics are the integral of what it shows, for any sun and height", "[sky][harmonics][slow]") {
  SECTION("the default quadrature is within 0.2 % of the integral from 90 to -6 degrees") { check_quadratures(); }
  SECTION("kernels give what the view's own calls give") { check_kernels(); }
  SECTION("a sky is the same on both sides of the sun, and turns with it") { check_symmetry(); }
  SECTION("from space the planet's light is the integral too") { check_space(); }
}

TEST_CASE("a lit ground under air that scatters nothing is a hemisphere in closed form", "[sky][harmonics]") {
  Atmosphere air = earth_bruneton();
  air.rayleigh = {};
  air.aerosol = {};
  air.absorbers.clear();
  air.ground_albedo = {0.25, 0.5, 1.0};
  air.solar_irradiance = {1.0, 2.0, 4.0};
  const SkyProjector projector(sky_view_of(air, tiny_tables()), {.bands = 5});
  for (const double elevation : {90.0, 40.0, 3.0}) {
    CAPTURE(elevation);
    const SphericalHarmonics light = projector.project(sun_direction(elevation, 77.0));
    const double lit = std::sin(elevation * pi / 180.0) / pi;
    // Integral over y < 0 of Y(l, 0) about y: 2 pi sqrt((2l + 1) / 4 pi) Int P_l from -1 to 0.
    SphericalHarmonics about_z(5);
    const std::array<double, 5> integrals{1.0, -0.5, 0.0, 0.125, 0.0};
    for (int l = 0; l < 5; ++l) {
      const double value = 2.0 * pi * std::sqrt((2.0 * l + 1.0) / (4.0 * pi)) * integrals[static_cast<std::size_t>(l)];
      about_z.at(l, 0) = lit * value * glm::dvec3(0.25, 1.0, 4.0);
    }
    const glm::dmat3 z_to_y(glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0));
    CHECK(difference(light, rotate(about_z, z_to_y)) < 2e-4);  // a view's ground is a table of suns
  }
}

TEST_CASE("sky harmonics are linear in light", "[sky][harmonics]") {
  SkyTables twice = *small_view_tables();
  for (double& irradiance : twice.atmosphere.solar_irradiance) irradiance *= 2.0;
  for (std::vector<float>* table : {&twice.scattering, &twice.single_mie, &twice.irradiance}) {
    for (float& value : *table) value *= 2.0F;
  }
  const SkyProjector one(SkyView(small_view_tables(), 300.0));
  const SkyProjector two(SkyView(std::make_shared<const SkyTables>(twice), 300.0));
  for (const double elevation : kElevations) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 11.0);
    CHECK(difference(two.project(sun), scale(one.project(sun), glm::dvec3(2.0))) < 1e-6);
  }
}

TEST_CASE("an update allocates nothing", "[sky][harmonics][slow]") {
  for (const double altitude : {0.0, 5000.0, 1e6}) {
    const SkyProjector projector(SkyView(small_view_tables(), altitude));
    SphericalHarmonics light(3);
    projector.project(sun_direction(20.0, 0.0), light.coefficients());  // tables of sizes are there now
    const FailingHeap heap(Heap::this_thread, 1, true);
    projector.project(glm::dvec3(0.3, 0.5, -0.2), light.coefficients());
    CHECK_FALSE(heap.failed());
  }
}

TEST_CASE("no atmosphere gives harmonics that are negative in band 0 or not finite", "[sky][harmonics][truth]") {
  RandomAtmospheres random(606);
  for (int trial = 0; trial < trials(15); ++trial) {
    const Atmosphere air = random.next();
    const auto tables = sky_tables_of(air, tiny_tables());
    const double thickness = air.top_radius_m - air.bottom_radius_m;
    for (const double altitude : {0.0, 0.3 * thickness, 2.0 * thickness}) {
      const SkyProjector projector(SkyView(tables, std::min(altitude, 1e9)), {3, SkyQuadrature::gauss_split, 6, 6});
      for (const double elevation : {90.0, 12.0, 0.0, -3.0, -29.0, -90.0}) {
        CAPTURE(trial, altitude, elevation);
        const SphericalHarmonics light = projector.project(sun_direction(elevation, random.between(-180.0, 180.0)));
        for (const glm::dvec3& value : light.coefficients()) {
          REQUIRE(std::isfinite(value.x + value.y + value.z));
        }
        for (int c = 0; c < 3; ++c) REQUIRE(light.at(0, 0)[c] >= 0.0);
      }
    }
  }
}

TEST_CASE("sky projections refuse what they cannot do", "[sky][harmonics][slow]") {
  const SkyProjector projector(SkyView(small_view_tables(), 0.0));
  std::vector<glm::dvec3> eight(8);
  const ThrownError refused = thrown_by([&] { projector.project(glm::dvec3(0, 1, 0), eight); });
  CHECK(refused.code == ErrorCode::invalid_argument);
  CHECK(refused.says("coefficients has 8"));
  for (const glm::dvec3& sun : {glm::dvec3(0.0), glm::dvec3(NAN, 0, 1), glm::dvec3(0, INFINITY, 0)}) {
    CHECK(thrown_by([&] { (void)projector.project(sun); }).code == ErrorCode::invalid_argument);
  }
  CHECK(difference(projector.project(glm::dvec3(0, 3e200, 4e200)), projector.project(glm::dvec3(0, 0.6, 0.8))) < 1e-12);
  CHECK(projector.directions() == 2 * 16 * 16);
}

// Promise: with all defaults a sky's nine coefficients are within 0.5 % of the reference, tables, view and quadrature
// or curve together, for suns from the zenith to 6 degrees below the horizon.

TEST_CASE("defaults are within 0.5 % of the truth from 90 to -6 degrees", "[sky][harmonics][truth]") {
  const Atmosphere air = with_ground_albedo(earth_bruneton(), 0.0);
  const SkyView view = sky_view_of(air, {.orders = 1});
  const SkyProjector projector(view);
  const SkyCurve curve(view);
  for (const double elevation : some_of(3, {90.0, 45.0, 10.0, 2.0, 0.0, -2.0, -6.0, -4.0})) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 0.0);
    const SphericalHarmonics expected =
        reference_sky_harmonics(air, 0.0, sun, {.zeniths = 20, .azimuths = 12, .radiance = {.relative_error = 1e-4}});
    CHECK(relative_difference(projector.project(sun).coefficients(), expected.coefficients()) < 5e-3);
    CHECK(relative_difference(curve.at(sun).coefficients(), expected.coefficients()) < 5e-3);
  }
}

// Promise: a curve over the sun's elevation gives what the projection gives, for a fraction of it.

namespace {

/// The worst of many suns with elevations between two.
double worst(const SkyCurve& curve, const SkyProjector& projector, double low, double high) {
  std::mt19937 random(static_cast<unsigned>(1000.0 + high));
  double result = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double elevation = low + (high - low) * static_cast<double>(random()) * 0x1p-32;
    const glm::dvec3 sun = sun_direction(elevation, static_cast<double>(random()) * 0x1p-32 * 360.0);
    result = std::max(result, difference(curve.at(sun), projector.project(sun)));
  }
  return result;
}

void check_curves() {
  const SkyView view(small_earth(), 0.0);
  for (const int bands : {1, 3, 9}) {
    CAPTURE(bands);
    SkyCurveOptions options{.bands = bands};
    const SkyCurve curve(view, options);
    SkyHarmonicsOptions projection = options.projection;
    projection.bands = bands;
    const SkyProjector projector(view, projection);
    CHECK(curve.bands() == bands);
    CHECK(worst(curve, projector, 10.0, 90.0) < 5e-4);
    CHECK(worst(curve, projector, -6.0, 10.0) < 1e-3);
    CHECK(worst(curve, projector, -12.0, -6.0) < 5e-2);
  }
}

void check_curves_aloft() {
  for (const double altitude : {1.8, 3000.0, 40'000.0, 4e5, 6e7}) {
    CAPTURE(altitude);
    const SkyView view(small_earth(), altitude);
    SkyCurveOptions options;
    options.projection.zeniths = 12;
    options.projection.azimuths = 12;
    const SkyCurve curve(view, options);
    const SkyProjector projector(view, options.projection);
    double brightest = 0.0;
    double most = 0.0;
    for (double elevation = -90.0; elevation <= 90.0; elevation += 7.3) {
      const glm::dvec3 sun = sun_direction(elevation, 3.0);
      const SphericalHarmonics truth = projector.project(sun);
      const SphericalHarmonics light = curve.at(sun);
      for (std::size_t k = 0; k < 9; ++k) {
        for (int c = 0; c < 3; ++c)
          most = std::max(most, std::abs(light.coefficients()[k][c] - truth.coefficients()[k][c]));
      }
      brightest = std::max(brightest, truth.at(0, 0).y);
    }
    CHECK(most < 1e-2 * brightest);
  }
}

void check_signs_of_curves() {
  const SkyView view(small_earth(), 0.0);
  for (const int nodes : {8, 9, 64}) {
    SkyCurveOptions options{.nodes = nodes};
    const SkyCurve curve(view, options);
    for (double elevation = -90.0; elevation <= 90.0; elevation += 0.037) {
      const glm::dvec3 sun = sun_direction(elevation, 0.0);
      const SphericalHarmonics light = curve.at(sun);
      const glm::dvec3 direct = curve.sun_irradiance(sun);
      for (int c = 0; c < 3; ++c) {
        REQUIRE(light.at(0, 0)[c] >= 0.0);
        REQUIRE(direct[c] >= 0.0);
      }
    }
    CHECK(curve.sun_irradiance(sun_direction(-50.0, 0.0)) == glm::dvec3(0.0));
  }
}

void check_suns_of_curves() {
  for (const double altitude : {0.0, 2000.0}) {
    const SkyView view(small_earth(), altitude);
    const SkyCurve curve(view);
    const double horizon = -std::acos(6360.0 / (6360.0 + altitude / 1000.0)) * 180.0 / std::numbers::pi;
    for (double above = -0.25; above <= 2.0; above += 0.01) {
      CAPTURE(altitude, above);
      const glm::dvec3 sun = sun_direction(horizon + above, 12.0);
      const glm::dvec3 expected = view.sun_light(sun).irradiance;
      for (int c = 0; c < 3; ++c) CHECK(curve.sun_irradiance(sun)[c] == Approx(expected[c]).epsilon(1e-3));
    }
  }
}

}  // namespace

// In one case, as all take tables of half a second.
TEST_CASE("a curve gives the projection and the sun, at any elevation and height", "[sky][curve][slow]") {
  SECTION("the projection at any elevation") { check_curves(); }
  SECTION("aloft and in space") { check_curves_aloft(); }
  SECTION("band 0 and sun are never negative") { check_signs_of_curves(); }
  SECTION("the sun is the view's while its disc sets, in every channel") { check_suns_of_curves(); }
}

TEST_CASE("asking a curve allocates nothing", "[sky][curve]") {
  const SkyView view(small_view_tables(), 0.0);
  const SkyCurve curve(view);
  SphericalHarmonics light(3);
  const FailingHeap heap(Heap::this_thread, 1, true);
  curve.at(glm::dvec3(0.1, 0.2, 0.3), light.coefficients());
  (void)curve.sun_irradiance(glm::dvec3(0.1, 0.2, 0.3));
  CHECK_FALSE(heap.failed());
}

TEST_CASE("a curve refuses nonsense", "[sky][curve]") {
  const SkyView view(small_view_tables(), 0.0);
  const SkyCurve curve(view);
  for (const int nodes : {7, 4097, -1}) {
    CHECK(
        thrown_by([&] { SkyCurve(view, {.nodes = nodes}); }).says("nodes of a sky curve is " + std::to_string(nodes)));
  }
  CHECK(thrown_by([&] { SkyCurve(view, {.bands = 17}); }).says("bands"));
  std::vector<glm::dvec3> eight(8);
  CHECK(thrown_by([&] { curve.at(glm::dvec3(0, 1, 0), eight); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { (void)curve.sun_irradiance(glm::dvec3(0.0)); }).code == ErrorCode::invalid_argument);
}

TEST_CASE("a curve's axis goes there and back, and is finest at the horizon", "[sky][curve]") {
  for (const double horizon : {0.0, -0.05, -0.9}) {
    for (const double lowest : {-1.0, -0.95}) {
      const sky::CurveAxis axis(101, lowest, horizon);
      CHECK(axis.sine(0) == Approx(lowest));
      CHECK(axis.sine(100) == 1.0);
      double finest = 2.0;
      double where = 0.0;
      for (int node = 0; node < 100; ++node) {
        const double step = axis.sine(node + 1) - axis.sine(node);
        CHECK(step > 0.0);
        if (step < finest) {
          finest = step;
          where = axis.sine(node);
        }
        const auto located = axis.place(0.5 * (axis.sine(node) + axis.sine(node + 1)));
        CHECK(located.interval == node);
      }
      CHECK(std::abs(where - horizon) < 0.02);
      CHECK(axis.place(-2.0).interval == 0);
    }
  }
}

}  // namespace welkin::test
