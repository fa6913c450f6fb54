// Promise: the irradiance of n bands is off by what docs/irradiance.md says, on real environments and synthetic ones.
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "support/catch.h"
#include "support/lat_long_of.h"
#include "support/random_harmonics.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/irradiance.h"

namespace welkin::test {
namespace {

namespace fs = std::filesystem;

constexpr double kPi = std::numbers::pi;

/// E of a lone light in all bands minus that in the first ones, root mean square over normals: what is left out has
/// the power sum over l of A_l^2 (2l + 1) / 4 pi, spread over the sphere; all of it is that of the clipped cosine, 1/6.
double share_left_out(int bands) {
  double kept = 0.0;
  for (int l = 0; l < bands; ++l) kept += cosine_lobe(l) * cosine_lobe(l) * (2.0 * l + 1.0) / (16.0 * kPi * kPi);
  return std::sqrt((1.0 / 6.0 - kept) * 6.0);
}

}  // namespace

TEST_CASE("A lone small sun is off by what the cosine lobe's spectrum leaves out", "[sh][irradiance]") {
  LatLongImage image{128, 64, std::vector<float>(128 * 64 * 3)};
  for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * (20 * 128 + 45) + c] = 1e6F;
  const SphericalHarmonics radiance = project(image.view(), {.bands = 9}).radiance;
  const auto errors = irradiance_errors(image.view(), radiance, 2000);
  REQUIRE(errors.size() == 9);
  for (const IrradianceError& error : errors) {
    CAPTURE(error.bands);
    CHECK(error.rms == Approx(share_left_out(error.bands)).epsilon(0.02));
    CHECK(error.maximum >= error.rms);
    // Behind the sun nothing is received and the harmonics give something.
    CHECK(error.relative == std::numeric_limits<double>::infinity());
  }
  // Ramamoorthi and Hanrahan's 99 %: nine coefficients keep all but 0.8 % of the lobe's energy.
  CHECK(share_left_out(3) * share_left_out(3) == Approx(0.0078).epsilon(0.02));
}

TEST_CASE("Light that three bands hold has no error in three bands", "[sh][irradiance]") {
  const LatLongImage image = lat_long_of(512, 256, [](const glm::dvec3& d) {
    return glm::dvec3(2.0 + d.x, 1.0 + 0.5 * d.y * d.z, 3.0 + d.z * d.z - d.y);
  });
  const auto errors = irradiance_errors(image.view(), project(image.view(), {.bands = 5}).radiance, 100);
  CHECK(errors[0].rms > 0.05);
  CHECK(errors[1].rms > 0.01);
  for (std::size_t bands = 2; bands < 5; ++bands) {
    CHECK(errors[bands].rms < 1e-5);
    CHECK(errors[bands].relative < 3e-5);
  }
}

TEST_CASE("A cubemap's errors are those of the lat-long of the same scene", "[sh][irradiance]") {
  const TestCubemap cubemap = make_cubemap(Content::sun_disc, 64, 3, 5);
  const auto errors = irradiance_errors(cubemap.view(), project(cubemap.view(), {.bands = 7}).radiance, 200);
  for (std::size_t k = 1; k < errors.size(); ++k) CHECK(errors[k].rms <= errors[k - 1].rms * (1.0 + 1e-9));
  CHECK(errors[2].rms > 0.01);
  CHECK(errors[6].rms < errors[2].rms / 3.0);
  CHECK(errors[3].rms == Approx(errors[2].rms).epsilon(1e-6));  // A_3 = 0
  CHECK(glm::length(errors[2].worst_normal) == Approx(1.0));
}

TEST_CASE("Errors of darkness, of too many normals, on any number of threads", "[sh][irradiance]") {
  const LatLongImage dark{8, 4, std::vector<float>(8 * 4 * 3)};
  for (const IrradianceError& error : irradiance_errors(dark.view(), SphericalHarmonics(3), 10)) {
    CHECK(error.rms == 0.0);
    CHECK(error.maximum == 0.0);
    CHECK(error.relative == 0.0);
  }
  CHECK(std::isinf(irradiance_errors(dark.view(), constant_radiance({1, 1, 1}), 10)[0].rms));
  for (const int normals : {-1, 0, 100001}) {
    CHECK(thrown_by([&] { (void)irradiance_errors(dark.view(), SphericalHarmonics(3), normals); }).says("normals"));
  }
  const TestLatLong image = make_lat_long(Content::high_range, 64, 32, 1);
  const SphericalHarmonics radiance = project(image.view()).radiance;
  double rms[2];
  run_with_threads(1, [&] { rms[0] = irradiance_errors(image.view(), radiance)[2].rms; });
  run_with_threads(4, [&] { rms[1] = irradiance_errors(image.view(), radiance)[2].rms; });
  CHECK(rms[0] == rms[1]);
}

}  // namespace welkin::test
