// Promise: a view's harmonics are the integral of what it shows, for any sun and height.
#include "welkin/sky_harmonics.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "sky/sky_projector_access.h"
#include "sky/vertical_harmonics.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/random_atmospheres.h"
#include "support/same_bits.h"
#include "support/small_skies.h"
#include "support/thrown_error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

using std::numbers::pi;

constexpr std::array<double, 10> kElevations{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0};

double difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return relative_difference(a.coefficients(), b.coefficients());
}

/// Puts the instruction set back.
class WithInstructionSet {
 public:
  explicit WithInstructionSet(InstructionSet set) { force_instruction_set(set); }
  ~WithInstructionSet() { force_instruction_set(before_); }
  WithInstructionSet(const WithInstructionSet&) = delete;
  WithInstructionSet& operator=(const WithInstructionSet&) = delete;

 private:
  InstructionSet before_ = active_instruction_set();
};

}  // namespace

TEST_CASE("the default quadrature is within 0.2 % of the integral from 90 to -6 degrees", "[sky][harmonics]") {
  const SkyView view(small_earth(), 0.0);
  const SkyProjector converged(view, {3, SkyQuadrature::gauss_split, 128, 128});
  const SkyProjector split(view);
  const SkyProjector plain(view, {3, SkyQuadrature::gauss, 16, 16});
  const SkyProjector article(view, {3, SkyQuadrature::article, 16, 16});
  const SkyProjector plainly_converged(view, {3, SkyQuadrature::gauss, 128, 256});
  for (const double elevation : kElevations) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 40.0);
    const SphericalHarmonics truth = converged.project(sun);
    CHECK(difference(plainly_converged.project(sun), truth) < 2e-4);  // the lobe's closed form is no other integral
    CHECK(difference(split.project(sun), truth) < 2e-3);
    CHECK(difference(plain.project(sun), truth) < 5e-3);
    CHECK(difference(article.project(sun), truth) > 5e-3);  // why it is not the default
    CHECK(difference(article.project(sun), truth) < 0.3);
  }
}

TEST_CASE("kernels give what the view's own calls give", "[sky][harmonics]") {
  for (const double altitude : {0.0, 1.8, 1000.0, 12'000.0, 59'000.0}) {
    for (const SkyHarmonicsOptions& options :
         {SkyHarmonicsOptions{}, SkyHarmonicsOptions{16, SkyQuadrature::gauss, 5, 7},
          SkyHarmonicsOptions{4, SkyQuadrature::article, 17, 33},
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
        if (elevation >= -1.0) {
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

TEST_CASE("a lit ground under air that scatters nothing is a hemisphere in closed form", "[sky][harmonics]") {
  Atmosphere air = earth();
  air.rayleigh = {};
  air.aerosol = {};
  air.absorbers.clear();
  air.ground_albedo = {0.25, 0.5, 1.0};
  air.solar_irradiance = {1.0, 2.0, 4.0};
  const auto tables = std::make_shared<const SkyTables>(precompute_sky(air, tiny_tables()));
  const SkyProjector projector(SkyView(tables, 0.0), {.bands = 5});
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
    CHECK(difference(light, transform(about_z, z_to_y)) < 2e-4);  // a view's ground is a table of suns
  }
}

TEST_CASE("sky harmonics are linear in light", "[sky][harmonics]") {
  SkyTables twice = *small_earth();
  for (double& irradiance : twice.atmosphere.solar_irradiance) irradiance *= 2.0;
  for (std::vector<float>* table : {&twice.scattering, &twice.single_mie, &twice.irradiance}) {
    for (float& value : *table) value *= 2.0F;
  }
  const SkyProjector one(SkyView(small_earth(), 300.0));
  const SkyProjector two(SkyView(std::make_shared<const SkyTables>(twice), 300.0));
  for (const double elevation : kElevations) {
    CAPTURE(elevation);
    const glm::dvec3 sun = sun_direction(elevation, 11.0);
    CHECK(difference(two.project(sun), scale(one.project(sun), glm::dvec3(2.0))) < 1e-6);
  }
}

TEST_CASE("a sky is the same on both sides of the sun, and turns with it", "[sky][harmonics]") {
  const SkyProjector projector(SkyView(small_earth(), 0.0), {.bands = 6});
  for (const double elevation : kElevations) {
    CAPTURE(elevation);
    const SphericalHarmonics ahead = projector.project(sun_direction(elevation, 0.0));
    glm::dmat3 mirror(1.0);
    mirror[0][0] = -1.0;  // x
    CHECK(difference(transform(ahead, mirror), ahead) < 1e-14);
    for (const double azimuth : {30.0, 90.0, -123.0, 180.0, 359.0}) {
      const double half = 0.5 * azimuth * pi / 180.0;
      const glm::dquat turn(std::cos(half), 0.0, std::sin(half), 0.0);  // +z towards +x
      const double bound = elevation == 90.0 ? 1e-4 : 1e-12;  // there the nodes' azimuths lean with the sun's rounding
      CHECK(difference(projector.project(sun_direction(elevation, azimuth)), rotate(ahead, turn)) < bound);
    }
  }
}

TEST_CASE("all instruction sets give the same sky harmonics", "[sky][harmonics][determinism]") {
  const SkyView view(small_earth(), 2.0);
  std::vector<SphericalHarmonics> expected;
  for (const InstructionSet set : available_instruction_sets()) {
    const WithInstructionSet scope(set);
    CAPTURE(name(set));
    std::vector<SphericalHarmonics> results;
    for (const SkyQuadrature quadrature : {SkyQuadrature::article, SkyQuadrature::gauss, SkyQuadrature::gauss_split}) {
      const SkyProjector projector(view, {5, quadrature, 19, 21});
      for (const double elevation : kElevations) results.push_back(projector.project(sun_direction(elevation, 33.0)));
    }
    if (expected.empty()) expected = results;
    for (std::size_t k = 0; k < results.size(); ++k) {
      CHECK(same_bytes(std::span<const glm::dvec3>(results[k].coefficients()),
                       std::span<const glm::dvec3>(expected[k].coefficients())));
    }
  }
}

TEST_CASE("an update allocates nothing", "[sky][harmonics]") {
  for (const double altitude : {0.0, 5000.0, 1e6}) {
    const SkyProjector projector(SkyView(small_earth(), altitude));
    SphericalHarmonics light(3);
    projector.project(sun_direction(20.0, 0.0), light.coefficients());  // tables of sizes are there now
    const FailingHeap heap(Heap::this_thread, 1, true);
    projector.project(glm::dvec3(0.3, 0.5, -0.2), light.coefficients());
    CHECK_FALSE(heap.failed());
  }
}

TEST_CASE("from space the planet's light is the integral too", "[sky][harmonics]") {
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

TEST_CASE("no atmosphere gives harmonics that are negative in band 0 or not finite", "[sky][harmonics]") {
  RandomAtmospheres random(606);
  for (int trial = 0; trial < trials(200); ++trial) {
    const Atmosphere air = random.next();
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(air, tiny_tables()));
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

TEST_CASE("sky projections refuse what they cannot do", "[sky][harmonics]") {
  const SkyProjector projector(SkyView(small_earth(), 0.0));
  std::vector<glm::dvec3> eight(8);
  const ThrownError room = thrown_by([&] { projector.project(glm::dvec3(0, 1, 0), eight); });
  CHECK(room.code == ErrorCode::invalid_argument);
  CHECK(room.says("room for 8"));
  for (const glm::dvec3& sun : {glm::dvec3(0.0), glm::dvec3(NAN, 0, 1), glm::dvec3(0, INFINITY, 0)}) {
    CHECK(thrown_by([&] { (void)projector.project(sun); }).code == ErrorCode::invalid_argument);
  }
  CHECK(difference(projector.project(glm::dvec3(0, 3e200, 4e200)), projector.project(glm::dvec3(0, 0.6, 0.8))) < 1e-12);
  CHECK(projector.directions() == 2 * 16 * 16);
}

}  // namespace welkin::test
