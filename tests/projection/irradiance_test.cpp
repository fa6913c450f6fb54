// Irradiance: cubemaps from harmonics, integration over the texels, and how few bands come near to it.
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/images.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: an irradiance cubemap holds what its harmonics say at each texel's centre, and the direct one what cosine
// integration says.

TEST_CASE("Irradiance beyond the floats is the largest float, not infinity", "[irradiance_cubemap]") {
  const Cubemap source{4, std::vector<float>(6 * 4 * 4 * 3, 3e38F)};
  const LatLongImage lat_long{8, 4, std::vector<float>(8 * 4 * 3, 3e38F)};
  const SphericalHarmonics irradiance = irradiance_from_radiance(project(source.view()).radiance);
  for (const Cubemap& map : {irradiance_cubemap(irradiance, 8), direct_irradiance_cubemap(source.view(), 2),
                             direct_irradiance_cubemap(lat_long.view(), 2)}) {
    for (const float value : map.pixels()) CHECK(value == std::numeric_limits<float>::max());
  }
}

TEST_CASE("An irradiance cubemap is its harmonics' sum at every texel's centre", "[irradiance_cubemap]") {
  for (const int bands : {1, 2, 3, 4, 9, 16}) {
    const SphericalHarmonics harmonics = RandomLight(50).harmonics(bands);
    for (const int size : {1, 2, 3, 7, 33}) {
      const Cubemap map = irradiance_cubemap(harmonics, size);
      REQUIRE(map.size() == size);
      const float* found = map.face(0);
      int wrong = 0;
      for (const glm::dvec3& centre : texel_centres(size)) {
        const glm::dvec3 wanted = evaluate(harmonics, centre);
        for (int c = 0; c < 3; ++c)
          wrong += std::abs(wanted[c] - static_cast<double>(*found++)) < 1e-7 * bands * bands ? 0 : 1;
      }
      CAPTURE(bands, size);
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("The direct irradiance cubemap is direct irradiance", "[irradiance_cubemap]") {
  const TestCubemap source = make_cubemap(Content::high_range, 16, 3, 2);
  const Cubemap direct = direct_irradiance_cubemap(source.view(), 5);
  const std::vector<glm::dvec3> wanted = direct_irradiance(source.view(), texel_centres(5));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      REQUIRE(direct.pixels()[3 * i + c] == static_cast<float>(wanted[i][static_cast<glm::length_t>(c)]));
    }
  }
  const TestLatLong lat_long = make_lat_long(Content::smooth, 32, 16, 2);
  const SphericalHarmonics radiance = project(lat_long.view()).radiance;
  const Cubemap by_bands = irradiance_cubemap(irradiance_from_radiance(radiance), 6);
  const Cubemap reference = direct_irradiance_cubemap(lat_long.view(), 6);
  for (std::size_t i = 0; i < reference.pixels().size(); ++i) {
    REQUIRE(by_bands.pixels()[i] == Approx(reference.pixels()[i]).epsilon(0.02));
  }
}

TEST_CASE("Irradiance cubemaps of sizes that cannot be are refused", "[irradiance_cubemap]") {
  const SphericalHarmonics harmonics = RandomLight(50).harmonics(3);
  CHECK(thrown_by([&] { return irradiance_cubemap(harmonics, 0); }).says("from 1 to 4096"));
  CHECK(thrown_by([&] { return irradiance_cubemap(harmonics, 4097); }).code == ErrorCode::invalid_argument);
  const TestCubemap source = make_cubemap(Content::random, 4, 3, 2);
  CHECK(thrown_by([&] { return direct_irradiance_cubemap(source.view(), 5000); }).code == ErrorCode::invalid_argument);
}

// Promise: direct irradiance is the cosine integral over texels as areas, at every size, on any number of threads.

namespace {

constexpr double kPi = std::numbers::pi;

std::vector<glm::dvec3> some_normals(int count) {
  RandomLight light(51);
  std::vector<glm::dvec3> normals{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  while (normals.size() < static_cast<std::size_t>(count)) normals.push_back(light.direction());
  return normals;
}

double worst_length(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, glm::length(a[k] - b[k]));
  return worst;
}

}  // namespace

TEST_CASE("A uniform sky gives pi times its radiance, at every size", "[sh][irradiance]") {
  const std::vector<glm::dvec3> normals = some_normals(12);
  const std::vector<glm::dvec3> expected(normals.size(), kPi * glm::dvec3(0.5, 1.0, 2.0));
  const double bound = 1e-8 * glm::length(expected[0]);
  for (const int size : {1, 2, 3, 7, 64}) {
    CAPTURE(size);
    const TestCubemap cubemap = make_cubemap(Content::uniform, size, 3, 0);
    CHECK(worst_length(direct_irradiance(cubemap.view(), normals), expected) < bound);
  }
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 5}, {7, 64}, {64, 3}, {257, 64}, {512, 256}}) {
    CAPTURE(width, height);
    const TestLatLong image = make_lat_long(Content::uniform, width, height, 0);
    CHECK(worst_length(direct_irradiance(image.view(), normals), expected) < bound);
  }
}

TEST_CASE("A lone texel away from the horizon is integrated exactly", "[sh][irradiance]") {
  // Its first moment has a closed form; the normals below see all of it.
  LatLongImage image{32, 16, std::vector<float>(32 * 16 * 3)};
  const int row = 5;
  const int column = 9;
  for (int c = 0; c < 3; ++c)
    image.pixels[3 * (row * 32 + column) + static_cast<std::size_t>(c)] = 1.0F + static_cast<float>(c);
  const double u1 = kPi - 2.0 * kPi * column / 32;
  const double u0 = u1 - 2.0 * kPi / 32;
  const double v1 = kPi / 2.0 - kPi * row / 16;
  const double v0 = v1 - kPi / 16;
  const double ring = 0.5 * (v1 - v0) + 0.25 * (std::sin(2.0 * v1) - std::sin(2.0 * v0));
  const glm::dvec3 moment((std::cos(u0) - std::cos(u1)) * ring,
                          (u1 - u0) * 0.5 * (std::sin(v1) * std::sin(v1) - std::sin(v0) * std::sin(v0)),
                          (std::sin(u1) - std::sin(u0)) * ring);
  const glm::dvec3 towards = glm::normalize(moment);
  RandomLight light(53);
  for (int k = 0; k < 10; ++k) {
    const glm::dvec3 normal = glm::normalize(towards + 0.5 * light.direction());
    const glm::dvec3 found = direct_irradiance(image.view(), normal);
    CHECK(glm::length(found - glm::dot(normal, moment) * glm::dvec3(1, 2, 3)) < 1e-15);
    CHECK(direct_irradiance(image.view(), -normal) == glm::dvec3(0.0));
  }
}

TEST_CASE("Linear light through the horizon has a closed form", "[sh][irradiance]") {
  // L = 1 + a . d: E(n) = pi + 2 pi / 3 a . n.
  const glm::dvec3 a(0.3, -0.5, 0.2);
  const LatLongImage image =
      lat_long_of(512, 256, [&](const glm::dvec3& d) { return glm::dvec3(1.0 + glm::dot(a, d)); });
  const std::vector<glm::dvec3> normals = some_normals(20);
  const std::vector<glm::dvec3> found = direct_irradiance(image.view(), normals);
  for (std::size_t k = 0; k < normals.size(); ++k) {
    CHECK(std::abs(found[k].x - (kPi + 2.0 * kPi / 3.0 * glm::dot(a, normals[k]))) < 1e-4);  // texels are constant
  }
}

TEST_CASE("Formats, strides and pixel policies are those of project", "[sh][irradiance]") {
  const glm::dvec3 up(0, 1, 0);
  TestLatLong image = make_lat_long(Content::uniform, 8, 4, 0, 4);
  image.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[1] = 5000.0F;
  const glm::dvec3 found = direct_irradiance(image.view(), up);
  CHECK(found.x < kPi * 0.5 - 0.01);  // the NaN counts as 0
  const PixelPolicy clamped{.clamp = RadianceClamp{1.0F, false}};
  CHECK(direct_irradiance(image.view(), {&up, 1}, clamped).front().y == Approx(kPi).epsilon(1e-4));
  const PixelPolicy strict{.nan = NonFinitePolicy::reject};
  CHECK(thrown_by([&] { (void)direct_irradiance(image.view(), {&up, 1}, strict); }).code == ErrorCode::rejected_pixel);

  LatLongView upside_down = image.view();
  const std::ptrdiff_t row = 8 * 16;
  upside_down.pixels = static_cast<const std::byte*>(upside_down.pixels) + 3 * row;
  upside_down.row_stride_bytes = -row;
  CHECK(glm::length(direct_irradiance(upside_down, -up) - found) < 1e-12);
}

TEST_CASE("Normals that cannot be are refused", "[sh][irradiance]") {
  const TestLatLong image = make_lat_long(Content::uniform, 8, 4, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& bad : {glm::dvec3(0.0), glm::dvec3(nan, 0, 0), glm::dvec3(1, 1, infinity)}) {
    const ThrownError error = thrown_by([&] { (void)direct_irradiance(image.view(), bad); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("normal 0"));
  }
  CHECK(thrown_by([&] { (void)direct_irradiance(image.view(), std::span<const glm::dvec3>()); }).says("1 to 100000"));
}

// Promise: the irradiance of n bands has the error that docs/maths/irradiance.md states, for real and synthetic
// environments.

namespace {

/// Returns a lone light's E in all bands minus that in the first `bands`, root mean square over normals. The rest has
/// the power sum over l of A_l^2 (2l + 1) / 4 pi, spread over the sphere; all bands have the clipped cosine's, 1/6.
double share_left_out(int bands) {
  double kept = 0.0;
  for (int l = 0; l < bands; ++l) kept += cosine_lobe(l) * cosine_lobe(l) * (2.0 * l + 1.0) / (16.0 * kPi * kPi);
  return std::sqrt((1.0 / 6.0 - kept) * 6.0);
}

}  // namespace

TEST_CASE("A lone small sun is off by what the cosine lobe's spectrum leaves out", "[sh][irradiance][truth]") {
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

TEST_CASE("A cubemap's errors fall from band to band but the fourth, whose factor is 0", "[sh][irradiance]") {
  const TestCubemap cubemap = make_cubemap(Content::sun_disc, 64, 3, 5);
  const auto errors = irradiance_errors(cubemap.view(), project(cubemap.view(), {.bands = 7}).radiance, 200);
  for (std::size_t k = 1; k < errors.size(); ++k) CHECK(errors[k].rms <= errors[k - 1].rms * (1.0 + 1e-9));
  CHECK(errors[2].rms > 0.01);
  CHECK(errors[6].rms < errors[2].rms / 3.0);
  CHECK(errors[3].rms == Approx(errors[2].rms).epsilon(1e-6));  // A_3 = 0
  CHECK(glm::length(errors[2].worst_normal) == Approx(1.0));
}

TEST_CASE("Errors of darkness, and of too many normals", "[sh][irradiance]") {
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
}

// Promise: on the real environments of ../shared the bands' errors stay within what docs/maths/irradiance.md says.

TEST_CASE("The irradiance cubemap of a bake of a real environment is within its bound", "[irradiance][shared][truth]") {
  if (!shared_images_are_here()) return;
  for (const char* const name : {"blender_sunrise.exr", "blender_studio.exr", "openexr_KernerEnvCube.exr"}) {
    CAPTURE(name);
    const Environment environment = read_environment(kImages / "env" / name);
    const EnvironmentView view = environment.info.layout == Layout::lat_long ? EnvironmentView(environment.lat_long())
                                                                             : EnvironmentView(environment.cubemap());
    BakeOptions options{.background = {}, .specular = {}, .irradiance = IrradianceOptions{.size = 3}, .brdf = {}};
    const Cubemap found = *bake(view, options).irradiance;
    const Cubemap truth = direct_irradiance_cubemap(view, 3);
    for (std::size_t k = 0; k < truth.pixels().size(); ++k)
      CHECK(found.pixels()[k] == Approx(truth.pixels()[k]).epsilon(5e-3).margin(1e-4));
  }
}

TEST_CASE("Bands of real environments are off by no more than the docs say", "[sh][irradiance][shared][truth]") {
  const std::vector<std::filesystem::path> files = shared_lat_longs(".exr");
  if (files.empty()) return;
  double worst_of_three = 0.0;
  for (const std::filesystem::path& file : files) {
    const Environment environment = read_environment(file);
    const SphericalHarmonics radiance = project(environment.lat_long(), {.bands = 7}).radiance;
    const auto errors = irradiance_errors(environment.lat_long(), radiance, 40);  // few, for the time they take
    CAPTURE(file.filename().string());
    CHECK(errors[0].rms < 0.75);
    CHECK(errors[1].rms < 0.38);
    CHECK(errors[2].rms < 0.085);
    CHECK(errors[2].maximum < 0.22);
    CHECK(errors[3].rms < errors[2].rms * 1.0001);
    CHECK(errors[4].rms < 0.045);
    CHECK(errors[6].rms < 0.03);
    CHECK(errors[6].rms < 0.5 * errors[2].rms);
    worst_of_three = std::max(worst_of_three, errors[2].rms);
  }
  CHECK(worst_of_three > 0.06);
}

TEST_CASE("The minimum-Laplacian window repairs the real environments that ring, and leaves the others alone",
          "[sh][window][shared]") {
  for (const std::filesystem::path& file : shared_lat_longs(".exr")) {
    const SphericalHarmonics radiance = project_file(file).radiance;
    const WindowResult windowed = apply_window(radiance, Window::min_laplacian);
    const glm::dvec3 mean = std::numbers::pi * mean_radiance(radiance);
    CAPTURE(file.filename().string(), windowed.parameter);
    double before = 1.0;
    for (int c = 0; c < 3; ++c) {
      CHECK(windowed.minimum_after[c] >= -1e-9 * mean[c]);
      before = std::min(before, windowed.minimum_before[c] / mean[c]);
    }
    CHECK((windowed.parameter > 0.0) == (before < -1e-9));
    CHECK(before > -0.06);
    CHECK(windowed.parameter < 0.01);
  }
}

}  // namespace welkin::test
