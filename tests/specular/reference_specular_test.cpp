// Promise: the truth is the integral over texels as areas: against closed forms, dense integration, at any size.
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "specular/lobe.h"
#include "specular/prefilter_support.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"

namespace welkin::test {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<glm::dvec3> some_directions(int count) {
  RandomLight light(3);
  std::vector<glm::dvec3> directions{{0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {1, 0, 0}};
  while (directions.size() < static_cast<std::size_t>(count)) directions.push_back(light.direction());
  return directions;
}

/// A dense midpoint rule, each texel cut into cells x cells.
glm::dvec3 brute_force(const TestLatLong& image, double alpha, const glm::dvec3& normal, int cells) {
  glm::dvec3 sum(0.0);
  double whole = 0.0;
  const double du = 2.0 * kPi / image.width / cells;
  const double dv = kPi / image.height / cells;
  for (int row = 0; row < image.height * cells; ++row) {
    const double v = kPi / 2.0 - (row + 0.5) * dv;
    for (int column = 0; column < image.width * cells; ++column) {
      const double u = kPi - (column + 0.5) * du;
      const glm::dvec3 d(std::sin(u) * std::cos(v), std::sin(v), std::cos(u) * std::cos(v));
      const float* const rgb = image.pixels.data() + 3 * ((row / cells) * image.width + column / cells);
      const double weight = specular::lobe(glm::dot(normal, d), alpha) * std::cos(v) * du * dv;
      sum += weight * glm::dvec3(rgb[0], rgb[1], rgb[2]);
      whole += weight;
    }
  }
  return sum / whole;
}

}  // namespace

TEST_CASE("The truth of a uniform environment is its value, however narrow the lobe", "[specular][truth]") {
  const auto directions = some_directions(9);
  for (const double roughness : {0.01, 0.0316, 0.1, 0.3, 0.7, 1.0}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {5, 3}, {64, 32}, {128, 64}}) {
      CAPTURE(roughness, width, height);
      const TestLatLong image = make_lat_long(Content::uniform, width, height, 0);
      for (const glm::dvec3& value : reference_specular(image.view(), roughness, directions))
        CHECK(glm::length(value - glm::dvec3(0.5, 1.0, 2.0)) < 1e-4);
    }
    for (const int size : {1, 3, 16}) {
      CAPTURE(roughness, size);
      const TestCubemap cube = make_cubemap(Content::uniform, size, 3, 0);
      for (const glm::dvec3& value : reference_specular(cube.view(), roughness, directions))
        CHECK(glm::length(value - glm::dvec3(0.5, 1.0, 2.0)) < 1e-4);
    }
  }
}

TEST_CASE("The truth of noise is dense integration's", "[specular][truth]") {
  const TestLatLong image = make_lat_long(Content::random, 16, 8, 21);
  const auto directions = some_directions(5);
  for (const double roughness : {0.25, 0.5, 1.0}) {
    const auto values = reference_specular(image.view(), roughness, directions);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      CAPTURE(roughness, k);
      const glm::dvec3 expected = brute_force(image, roughness * roughness, directions[k], 64);
      CHECK(glm::length(values[k] - expected) < 1e-3);
    }
  }
}

TEST_CASE("One small light gives the closed form of the lobe", "[specular][truth]") {
  TestLatLong image = make_lat_long(Content::uniform, 512, 256, 0);
  for (float& value : image.pixels) value = 0.0F;
  const int row = 90;
  const int column = 300;
  for (std::size_t c = 0; c < 3; ++c)
    image.pixels[3 * (static_cast<std::size_t>(row) * 512 + static_cast<std::size_t>(column)) + c] = 1e6F;
  const glm::dvec3 light = image::lat_long_direction(512, 256, column + 0.5, row + 0.5);
  const double flux = 1e6 * image::lat_long_texel_solid_angle(512, 256, row);
  for (const double roughness : {0.5, 1.0}) {
    const double alpha = roughness * roughness;
    const auto directions = some_directions(40);
    const auto values = reference_specular(image.view(), roughness, directions);
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const double cosine = glm::dot(light, directions[k]);
      if (std::abs(cosine) < 0.02) continue;  // the horizon cuts the texel
      CAPTURE(roughness, cosine);
      const double expected = flux * specular::lobe(cosine, alpha) / specular::lobe_integral(alpha);
      CHECK(values[k].g == Approx(expected).epsilon(2e-4).margin(1e-12));
    }
  }
}

TEST_CASE("A lobe far narrower than texels sees the texel that it points into", "[specular][truth]") {
  const TestLatLong image = make_lat_long(Content::random, 32, 16, 2);
  const TestCubemap cube = make_cubemap(Content::random, 8, 3, 2);
  const glm::dvec3 d = image::lat_long_direction(32, 16, 11.5, 4.5);
  const auto lat_long = reference_specular(image.view(), 0.01, {d});
  CHECK(lat_long[0].r == Approx(image.pixels[3 * (4 * 32 + 11)]).epsilon(1e-3));
  CHECK(reference_specular(image.view(), 0.0, {d})[0].r == static_cast<double>(image.pixels[3 * (4 * 32 + 11)]));
  for (int face = 0; face < 6; ++face) {
    CAPTURE(face);
    const glm::dvec3 to = image::face_direction(8, face, 2.5, 5.5);
    const float expected = cube.pixels[static_cast<std::size_t>(3 * ((face * 8 + 5) * 8 + 2))];
    CHECK(reference_specular(cube.view(), 0.01, {to})[0].r == Approx(expected).epsilon(1e-3));
    CHECK(reference_specular(cube.view(), 0.0, {to})[0].r == static_cast<double>(expected));
  }
}

TEST_CASE("What the truth cannot be asked is refused", "[specular][truth]") {
  const TestLatLong image = make_lat_long(Content::random, 8, 4, 2);
  const auto call = [&](double roughness, const std::vector<glm::dvec3>& directions) {
    return thrown_by([&] { (void)reference_specular(image.view(), roughness, directions); });
  };
  CHECK(call(1.5, {{0, 1, 0}}).says("roughness 1.5"));
  CHECK(call(std::nan(""), {{0, 1, 0}}).code == ErrorCode::invalid_argument);
  CHECK(call(0.5, {}).says("0 directions"));
  CHECK(call(0.5, {{0, 1, 0}, {0, 0, 0}}).says("direction 1"));
}

}  // namespace welkin::test
