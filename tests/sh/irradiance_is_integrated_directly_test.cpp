// Promise: direct irradiance is the cosine integral over texels as areas, at every size, on any number of threads.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/lat_long_of.h"
#include "support/random_harmonics.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/control.h"
#include "welkin/irradiance.h"

namespace welkin::test {
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

/// A dense midpoint rule over a lat-long's texels, each cut into cells x cells.
glm::dvec3 brute_force(const LatLongImage& image, const glm::dvec3& normal, int cells) {
  glm::dvec3 sum(0.0);
  const double du = 2.0 * kPi / image.width / cells;
  const double dv = kPi / image.height / cells;
  for (int row = 0; row < image.height * cells; ++row) {
    const double v = kPi / 2.0 - (row + 0.5) * dv;
    for (int column = 0; column < image.width * cells; ++column) {
      const double u = kPi - (column + 0.5) * du;
      const glm::dvec3 d(std::sin(u) * std::cos(v), std::sin(v), std::cos(u) * std::cos(v));
      const float* const rgb = image.pixels.data() + 3 * ((row / cells) * image.width + column / cells);
      sum += std::max(0.0, glm::dot(normal, d)) * std::cos(v) * du * dv * glm::dvec3(rgb[0], rgb[1], rgb[2]);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("A uniform sky gives pi times its radiance, at every size", "[sh][irradiance]") {
  const std::vector<glm::dvec3> normals = some_normals(12);
  const std::vector<glm::dvec3> expected(normals.size(), kPi * glm::dvec3(0.5, 1.0, 2.0));
  const double bound = 1e-5 * glm::length(expected[0]);
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

TEST_CASE("Maps of a usual size give a uniform sky to 1e-6", "[sh][irradiance]") {
  const std::vector<glm::dvec3> normals = some_normals(8);
  const std::vector<glm::dvec3> expected(normals.size(), kPi * glm::dvec3(0.5, 1.0, 2.0));
  const double bound = 1e-6 * glm::length(expected[0]);
  const TestLatLong image = make_lat_long(Content::uniform, 512, 256, 0);
  CHECK(worst_length(direct_irradiance(image.view(), normals), expected) < bound);
  CHECK(worst_length(direct_irradiance(make_cubemap(Content::uniform, 256, 3, 0).view(), normals), expected) < bound);
}

TEST_CASE("Noise on few texels agrees with a dense integral", "[sh][irradiance]") {
  RandomLight light(52);
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 2}, {3, 2}, {4, 7}, {16, 8}}) {
    const LatLongImage image =
        lat_long_of(width, height, [&](const glm::dvec3&) { return glm::dvec3(1.0) + light.colour(); });
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 normal = light.direction();
      CAPTURE(width, height, k);
      const glm::dvec3 truth = brute_force(image, normal, 1 + 600 / std::max(width, height));
      CHECK(glm::length(reference_irradiance(image.view(), normal) - truth) < 5e-5);
    }
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
    const glm::dvec3 found = reference_irradiance(image.view(), normal);
    CHECK(glm::length(found - glm::dot(normal, moment) * glm::dvec3(1, 2, 3)) < 1e-15);
    CHECK(reference_irradiance(image.view(), -normal) == glm::dvec3(0.0));
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

TEST_CASE("All six faces face the way that CubemapView says", "[sh][irradiance]") {
  for (int face = 0; face < 6; ++face) {
    TestCubemap cubemap{4, 3, std::vector<float>(6 * 4 * 4 * 3)};
    const std::size_t lit = static_cast<std::size_t>(face * 16 + 1 * 4 + 3) * 3;  // row 1, column 3
    cubemap.pixels[lit] = cubemap.pixels[lit + 1] = cubemap.pixels[lit + 2] = 1.0F;
    const glm::dvec3 towards = image::face_direction(4, face, 3.5, 1.5);
    const double facing = reference_irradiance(cubemap.view(), towards).x;
    double solid_angles[4];
    image::cubemap_row_solid_angles(1, solid_angles);
    CHECK(facing == Approx(solid_angles[3]).epsilon(0.02));
    CHECK(reference_irradiance(cubemap.view(), -towards).x == 0.0);
  }
}

TEST_CASE("The number of threads and the other normals do not change a bit", "[sh][irradiance]") {
  const TestLatLong image = make_lat_long(Content::high_range, 130, 65, 3);
  const TestCubemap cubemap = make_cubemap(Content::sun_disc, 33, 3, 3);
  const std::vector<glm::dvec3> normals = some_normals(40);
  std::vector<glm::dvec3> first;
  std::vector<glm::dvec3> second;
  run_with_threads(1, [&] { first = direct_irradiance(image.view(), normals); });
  run_with_threads(1, [&] { second = direct_irradiance(cubemap.view(), normals); });
  for (const int threads : {2, 5}) {
    run_with_threads(threads, [&] {
      CHECK(direct_irradiance(image.view(), normals) == first);
      CHECK(direct_irradiance(cubemap.view(), normals) == second);
    });
  }
  CHECK(reference_irradiance(image.view(), normals[17]) == first[17]);
  CHECK(reference_irradiance(image.view(), 7.0 * normals[1]) == first[1]);
}

TEST_CASE("Many normals are worked on in batches, with progress from 0 to 1", "[sh][irradiance]") {
  const TestLatLong image = make_lat_long(Content::random, 16, 8, 4);
  const std::vector<glm::dvec3> normals = some_normals(1100);
  double last = 0.0;
  bool falls = false;
  Control control;
  control.progress = [&](double share) {
    falls = falls || share < last;
    last = share;
  };
  const std::vector<glm::dvec3> found = direct_irradiance(image.view(), normals, {}, control);
  REQUIRE(found.size() == normals.size());
  CHECK(last == 1.0);
  CHECK_FALSE(falls);
  for (const std::size_t k : {0, 511, 512, 1023, 1024, 1099}) {
    CHECK(found[k] == reference_irradiance(image.view(), normals[k]));
  }
}

TEST_CASE("Formats, strides and pixel policies are those of project", "[sh][irradiance]") {
  const glm::dvec3 up(0, 1, 0);
  TestLatLong image = make_lat_long(Content::uniform, 8, 4, 0, 4);
  image.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[1] = 5000.0F;
  const glm::dvec3 found = reference_irradiance(image.view(), up);
  CHECK(found.x < kPi * 0.5 - 0.01);  // the NaN counts as 0
  ProjectionOptions clamped;
  clamped.clamp = RadianceClamp{1.0F, false};
  CHECK(direct_irradiance(image.view(), {&up, 1}, clamped).front().y == Approx(kPi).epsilon(1e-4));
  ProjectionOptions strict;
  strict.nan = NonFinitePolicy::reject;
  CHECK(thrown_by([&] { (void)direct_irradiance(image.view(), {&up, 1}, strict); }).code == ErrorCode::rejected_pixel);

  LatLongView upside_down = image.view();
  const std::ptrdiff_t row = 8 * 16;
  upside_down.pixels = static_cast<const std::byte*>(upside_down.pixels) + 3 * row;
  upside_down.row_stride_bytes = -row;
  CHECK(glm::length(reference_irradiance(upside_down, -up) - found) < 1e-12);
}

TEST_CASE("Normals that cannot be are refused, and a call can be cancelled", "[sh][irradiance]") {
  const TestLatLong image = make_lat_long(Content::uniform, 8, 4, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const glm::dvec3& bad : {glm::dvec3(0.0), glm::dvec3(nan, 0, 0), glm::dvec3(1e308, 1e308, 1e308)}) {
    const ThrownError error = thrown_by([&] { (void)reference_irradiance(image.view(), bad); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("normal 0"));
  }
  CHECK(thrown_by([&] { (void)direct_irradiance(image.view(), {}); }).says("1 to 100000"));
  std::stop_source stop;
  stop.request_stop();
  const Control control{stop.get_token(), {}};
  const glm::dvec3 up(0, 1, 0);
  CHECK(thrown_by([&] { (void)direct_irradiance(image.view(), {&up, 1}, {}, control); }).code == ErrorCode::cancelled);
}

}  // namespace welkin::test
