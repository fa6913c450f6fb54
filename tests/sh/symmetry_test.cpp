// What must hold of any projection: linearity, rotations, mirror images, energy.
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "image/texel_geometry.h"
#include "sh/frame_transform.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/test_environments.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

using Radiance = std::function<glm::dvec3(const glm::dvec3&)>;

glm::dvec3 texel_direction(int face, int row, int column, int size) {
  const image::Frame& frame = image::face_frame(face);
  const double u = (2.0 * column + 1.0) / size - 1.0;
  const double v = (2.0 * row + 1.0) / size - 1.0;
  return glm::normalize(u * frame.u + v * frame.v + frame.normal);
}

/// A cubemap whose texels hold the radiance at their centres.
TestCubemap sample(int size, const Radiance& radiance) {
  TestCubemap cubemap{size, 3, {}};
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const glm::dvec3 value = radiance(texel_direction(face, row, column, size));
        for (int c = 0; c < 3; ++c) cubemap.pixels.push_back(static_cast<float>(value[c]));
      }
    }
  }
  return cubemap;
}

/// The texel of `cubemap` that a direction falls into.
glm::dvec3 lookup(const TestCubemap& cubemap, const glm::dvec3& direction) {
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    const double depth = glm::dot(direction, frame.normal);
    if (depth < std::abs(glm::dot(direction, frame.u)) || depth < std::abs(glm::dot(direction, frame.v))) continue;
    const auto index = [&](const glm::dvec3& axis) {
      const double position = (glm::dot(direction, axis) / depth + 1.0) * 0.5 * cubemap.size;
      return std::min(cubemap.size - 1, static_cast<int>(position));
    };
    const auto at = 3 * (static_cast<std::size_t>((face * cubemap.size + index(frame.v)) * cubemap.size) +
                         static_cast<std::size_t>(index(frame.u)));
    return {cubemap.pixels[at], cubemap.pixels[at + 1], cubemap.pixels[at + 2]};
  }
  return {};
}

double smooth_function(const glm::dvec3& d) { return 1.0 + 0.5 * d.x + 0.25 * d.y * d.z + std::exp(4.0 * (d.z - 1.0)); }

}  // namespace

TEST_CASE("Projection is linear", "[sh][property]") {
  for (const int size : {1, 3, 64, 130}) {
    const TestCubemap a = make_cubemap(Content::random, size, 3, 1);
    const TestCubemap b = make_cubemap(Content::high_range, size, 3, 2);
    TestCubemap sum = a;
    for (std::size_t k = 0; k < sum.pixels.size(); ++k) sum.pixels[k] = 2.0F * a.pixels[k] + b.pixels[k];
    const SphericalHarmonics pa = project(a.view()).radiance;
    const SphericalHarmonics pb = project(b.view()).radiance;
    SphericalHarmonics expected(3);
    for (std::size_t k = 0; k < 9; ++k) {
      expected.coefficients()[k] = 2.0 * pa.coefficients()[k] + pb.coefficients()[k];
    }
    CHECK(relative_error(project(sum.view()).radiance, expected) < 5e-7);
  }
}

TEST_CASE("Scaling by a power of two scales every bit", "[sh][property]") {
  const TestCubemap a = make_cubemap(Content::random, 65, 3, 4);
  TestCubemap scaled = a;
  for (float& value : scaled.pixels) value *= 1024.0F;
  SphericalHarmonics expected = project(a.view()).radiance;
  for (glm::dvec3& value : expected.coefficients()) value *= 1024.0;
  CHECK(same_bits(project(scaled.view()).radiance, expected));
}

TEST_CASE("Turning a cubemap by 90 degrees permutes coefficients", "[sh][property]") {
  // About y: (x, y, z) -> (z, y, -x); about x: (x, z, -y); about z: (y, -x, z). Band 1 is (y, z, x).
  const glm::dmat3 turns[] = {
      {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
  for (const int size : {1, 2, 7, 64}) {
    const TestCubemap original = make_cubemap(Content::random, size, 3, 6);
    const SphericalHarmonics before = project(original.view()).radiance;
    for (const glm::dmat3& turn : turns) {
      // The turned environment seen along d is the original one seen along the inverse turn of d.
      const TestCubemap turned =
          sample(size, [&](const glm::dvec3& d) { return lookup(original, glm::transpose(turn) * d); });
      const SphericalHarmonics after = project(turned.view()).radiance;
      for (int channel = 0; channel < 3; ++channel) {
        const glm::dvec3 b(before.at(1, 1)[channel], before.at(1, -1)[channel], before.at(1, 0)[channel]);
        const glm::dvec3 a(after.at(1, 1)[channel], after.at(1, -1)[channel], after.at(1, 0)[channel]);
        CHECK(glm::length(a - turn * b) < 5e-7 * norm(before));
        CHECK(std::abs(after.at(0, 0)[channel] - before.at(0, 0)[channel]) < 5e-7 * norm(before));
        // xy, yz and zx change places up to signs.
        double before_products = 0.0;
        double after_products = 0.0;
        for (const int m : {-2, -1, 1}) {
          before_products += before.at(2, m)[channel] * before.at(2, m)[channel];
          after_products += after.at(2, m)[channel] * after.at(2, m)[channel];
        }
        CHECK(std::abs(after_products - before_products) < 1e-6 * norm(before) * norm(before));
      }
    }
  }
}

TEST_CASE("Turning by any angle turns the coefficients within the texels' error", "[sh][property]") {
  const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, -0.5)));
  double error_before = 1.0;
  for (const int size : {16, 32, 64, 128}) {
    const SphericalHarmonics before =
        project(sample(size, [](const glm::dvec3& d) { return glm::dvec3(smooth_function(d)); }).view()).radiance;
    const SphericalHarmonics after =
        project(sample(size, [&](const glm::dvec3& d) { return glm::dvec3(smooth_function(glm::inverse(turn) * d)); })
                    .view())
            .radiance;
    double worst = 0.0;
    for (int k = 0; k < 50; ++k) {
      const glm::dvec3 d = glm::normalize(glm::dvec3(std::sin(k * 1.3), std::cos(k * 2.1), std::sin(k * 0.7 + 1.0)));
      worst = std::max(worst, std::abs(evaluate(after, turn * d).x - evaluate(before, d).x));
    }
    CAPTURE(size, worst);
    CHECK(worst < 4.0 / (size * size));
    CHECK(worst < 0.5 * error_before);
    error_before = worst;
  }
}

TEST_CASE("A mirror image flips the signs of odd coefficients", "[sh][property]") {
  const int size = 33;
  const TestCubemap original = make_cubemap(Content::random, size, 3, 8);
  const TestCubemap mirrored = sample(size, [&](const glm::dvec3& d) { return lookup(original, {-d.x, d.y, d.z}); });
  const SphericalHarmonics a = project(original.view()).radiance;
  const SphericalHarmonics b = project(mirrored.view()).radiance;
  // Odd in x: x, xy, xz.
  const double signs[9] = {1, 1, 1, -1, -1, 1, 1, -1, 1};
  for (std::size_t k = 0; k < 9; ++k) {
    CHECK(glm::length(b.coefficients()[k] - signs[k] * a.coefficients()[k]) < 5e-7 * norm(a));
  }
}

TEST_CASE("The flux is the sum of radiance times solid angle", "[sh][property]") {
  const TestCubemap uniform = make_cubemap(Content::uniform, 50, 3, 0);
  const ProjectionDiagnostics diagnostics = project(uniform.view()).diagnostics;
  CHECK(diagnostics.flux.x == Approx(0.5 * 4.0 * std::numbers::pi).epsilon(1e-7));
  CHECK(diagnostics.flux.z == Approx(2.0 * 4.0 * std::numbers::pi).epsilon(1e-7));
  CHECK(diagnostics.flux_before_clamp == diagnostics.flux);
}

TEST_CASE("Low-order radiance comes back from its own projection", "[sh][property]") {
  const auto radiance = [](const glm::dvec3& d) {
    return glm::dvec3(1.0 + d.x, 2.0 + d.y * d.z, 1.5 + 3.0 * d.z * d.z - d.x * d.y);
  };
  const SphericalHarmonics c = project(sample(256, radiance).view()).radiance;
  for (int k = 0; k < 100; ++k) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(std::sin(k * 1.7), std::cos(k * 0.9), std::sin(k * 0.37 + 0.5)));
    CHECK(glm::length(evaluate(c, d) - radiance(d)) < 1e-4);
  }
}

TEST_CASE("A cubemap and the lat-long of the same scene agree", "[sh][property]") {
  const auto radiance = [](const glm::dvec3& d) { return glm::dvec3(smooth_function(d), 1.0 + d.x * d.z, 2.0 - d.y); };
  const int height = 512;
  TestLatLong lat_long{2 * height, height, 3, {}};
  for (int row = 0; row < height; ++row) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / height);
    for (int column = 0; column < 2 * height; ++column) {
      const double longitude = std::numbers::pi * (1.0 - (column + 0.5) / height);
      const glm::dvec3 value = radiance(
          {std::sin(longitude) * std::cos(latitude), std::sin(latitude), std::cos(longitude) * std::cos(latitude)});
      for (int c = 0; c < 3; ++c) lat_long.pixels.push_back(static_cast<float>(value[c]));
    }
  }
  CHECK(relative_error(project(lat_long.view()).radiance, project(sample(256, radiance).view()).radiance) < 3e-5);
}

}  // namespace welkin::test
