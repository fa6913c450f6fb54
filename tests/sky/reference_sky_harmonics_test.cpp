// The truth of sky harmonics: it turns with the sun, converges, and is what a fine projector sees.
#include <cmath>
#include <glm/geometric.hpp>

#include "perf/report/error_norms.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/resampling.h"
#include "welkin/sky_reference.h"

using namespace welkin;
using report::relative_error;

namespace {

/// Coarse, so that it is quick under sanitizers too.
ReferenceHarmonicsOptions coarse(int places = 4) {
  ReferenceHarmonicsOptions options;
  options.zeniths = options.azimuths = places;
  options.radiance.relative_error = 1e-4;
  return options;
}

}  // namespace

TEST_CASE("reference sky harmonics turn with the sun", "[sky]") {
  const SphericalHarmonics ahead = reference_sky_harmonics(earth(), 0.0, sun_direction(20.0, 0.0), coarse());
  const SphericalHarmonics turned = reference_sky_harmonics(earth(), 0.0, sun_direction(20.0, 75.0), coarse());
  CHECK(relative_error(transform(ahead, turn_about_y(75.0)), turned) < 1e-9);
  CHECK(relative_error(ahead, turned) > 0.05);
}

TEST_CASE("reference sky harmonics are symmetric about the sun's plane", "[sky]") {
  const SphericalHarmonics light = reference_sky_harmonics(earth(), 0.0, sun_direction(10.0, 0.0), coarse());
  // x is across the plane: what is odd in it vanishes.
  for (const int index : {3, 4, 7})
    CHECK(glm::length(light.coefficients()[static_cast<std::size_t>(index)]) < 1e-12 * light.at(0, 0).r);
  CHECK(glm::length(light.at(1, 0)) > 0.05 * light.at(0, 0).r);
}

TEST_CASE("reference sky harmonics converge", "[sky]") {
  const glm::dvec3 sun = sun_direction(30.0, 0.0);
  const SphericalHarmonics fine = reference_sky_harmonics(earth(), 0.0, sun, coarse(12));
  const double six = relative_error(reference_sky_harmonics(earth(), 0.0, sun, coarse(6)), fine);
  const double four = relative_error(reference_sky_harmonics(earth(), 0.0, sun, coarse(4)), fine);
  CHECK(four < 0.1);
  CHECK(six < 0.03);
  CHECK(six < four);
}

TEST_CASE("reference sky harmonics: a sun in the zenith, and one seen from space", "[sky]") {
  // A sky that is the same all around: what is left is the azimuths' rule for a cosine.
  ReferenceHarmonicsOptions even = coarse();
  even.azimuths = 16;
  const SphericalHarmonics zenith = reference_sky_harmonics(earth(), 0.0, {0.0, 1.0, 0.0}, even);
  CHECK(glm::length(zenith.at(1, 0)) < 1e-9 * zenith.at(0, 0).r);
  CHECK(zenith.at(1, -1).r < 0.0);  // red: the lit ground is brighter than the sky
  even.radiance.ground = false;
  CHECK(reference_sky_harmonics(earth(), 0.0, {0.0, 1.0, 0.0}, even).at(1, -1).r > 0.0);  // light from above alone
  const SphericalHarmonics space = reference_sky_harmonics(earth(), 4e5, sun_direction(40.0, 0.0), coarse());
  CHECK(space.at(1, -1).r < 0.0);  // and from below
}

TEST_CASE("reference sky harmonics refuse what cannot be", "[sky]") {
  const glm::dvec3 sun = sun_direction(30.0, 0.0);
  const auto refused = [&](const Atmosphere& air, double altitude, const glm::dvec3& towards,
                           ReferenceHarmonicsOptions options) {
    return test::thrown_by([&] { (void)reference_sky_harmonics(air, altitude, towards, options); }).code ==
           ErrorCode::invalid_argument;
  };
  CHECK(refused(earth({500.0, 600.0}), 0.0, sun, {}));
  CHECK(refused(earth(), -1.0, sun, {}));
  CHECK(refused(earth(), 0.0, {0.0, 2.0, 0.0}, {}));
  CHECK(refused(earth(), 0.0, sun, {.zeniths = 1}));
  CHECK(refused(earth(), 0.0, sun, {.azimuths = 1000}));
  CHECK(refused(earth(), 0.0, sun, {.bands = 0}));
  std::stop_source stop;
  stop.request_stop();
  CHECK(test::thrown_by([&] {
          (void)reference_sky_harmonics(earth(), 0.0, sun, coarse(), {stop.get_token(), {}});
        }).code == ErrorCode::cancelled);
}
