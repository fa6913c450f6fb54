// Promises: a disc of known place, size and radiance is found as what it is, whatever the resolution, on the pole, on
// the seam and on a cube's corner too; and it turns with the map.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <vector>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/sun_maps.h"
#include "welkin/control.h"
#include "welkin/directional_light.h"

namespace welkin::test {
namespace {

const glm::dvec3 kRadiance{2e5, 1.5e5, 5e4};

std::vector<glm::dvec3> places() {
  std::vector<glm::dvec3> result{{0, 1, 0},  {0, -1, 0}, {0, 0, -1}, {1, 1, 1},        {-1, 1, -1},
                                 {1, 0, -1}, {-3, 2, 5}, {5, 1, 2},  {0.01, 1, 0.004}, {0.003, -0.2, -1}};
  for (glm::dvec3& place : result) place = glm::normalize(place);
  return result;
}

template <class Image>
void check_disc(Image image, const glm::dvec3& place, double radius, double texel_degrees) {
  paint_disc(image, place, radius, kRadiance);
  const auto sun = take_out_sun(image);
  CAPTURE(place.x, place.y, place.z, radius, texel_degrees);
  REQUIRE(sun);
  for (int c = 0; c < 3; ++c) {
    CHECK(sun->irradiance[c] == Approx((kRadiance[c] - 1.0) * disc_solid_angle(radius)).epsilon(0.005));
  }
  CHECK(degrees_between(sun->direction, place) < 0.1 * texel_degrees);
  CHECK(glm::length(sun->direction) == Approx(1.0).epsilon(1e-14));
  // Texels that it covers in part are changed whole.
  CHECK(sun->angular_radius_degrees > radius - 0.1 * texel_degrees);
  CHECK(sun->angular_radius_degrees < radius + texel_degrees);
  CHECK(disc_solid_angle(sun->angular_radius_degrees) == Approx(sun->solid_angle).epsilon(1e-9));
  CHECK(std::all_of(image.pixels.begin(), image.pixels.end(), [](float value) { return value == 1.0F; }));
}

}  // namespace

TEST_CASE("A disc's light, place and size do not depend on the resolution", "[image][sun]") {
  for (const glm::dvec3& place : places()) {
    check_disc(grey_lat_long(256, 128, 1.0F), place, 0.9, 360.0 / 256);
    check_disc(grey_cubemap(64, 1.0F), place, 1.9, 115.0 / 64);  // a texel at a face's middle, the widest
  }
  for (const std::size_t i : {0U, 3U, 6U}) {
    check_disc(grey_lat_long(512, 256, 1.0F), places()[i], 1.9, 360.0 / 512);
    check_disc(grey_lat_long(1024, 512, 1.0F), places()[i], 0.9, 360.0 / 1024);
    check_disc(grey_cubemap(256, 1.0F), places()[i], 0.9, 115.0 / 256);
  }
}

TEST_CASE("A lat-long's sun turns with its columns and is mirrored with its rows", "[image][sun]") {
  const int width = 96;
  const int height = 48;
  LatLongImage image = grey_lat_long(width, height, 1.0F);
  paint_disc(image, glm::normalize(glm::dvec3(1, 2, -3)), 4.0, kRadiance);
  LatLongImage taken = image;
  const SunOptions options{0.02, 9.0, 20.0, 0.01};
  const auto expected = take_out_sun(taken, options);
  REQUIRE(expected);
  for (const int shift : {1, 30, 48, 95}) {
    LatLongImage turned = image;
    for (int texel = 0; texel < width * height; ++texel) {
      const int to = (height - 1 - texel / width) * width + (texel + shift) % width;
      for (int c = 0; c < 3; ++c) {
        turned.pixels[static_cast<std::size_t>(3 * to + c)] = image.pixels[static_cast<std::size_t>(3 * texel + c)];
      }
    }
    const auto sun = take_out_sun(turned, options);
    REQUIRE(sun);
    CHECK(sun->texels == expected->texels);
    CHECK(glm::length(sun->irradiance - expected->irradiance) < 1e-12 * glm::length(expected->irradiance));
    const double longitude = -2.0 * std::numbers::pi * shift / width;
    const glm::dvec3 d = expected->direction;
    const glm::dvec3 place{d.x * std::cos(longitude) + d.z * std::sin(longitude), -d.y,
                           d.z * std::cos(longitude) - d.x * std::sin(longitude)};
    CHECK(glm::length(sun->direction - place) < 1e-12);
  }
}

TEST_CASE("A cubemap's sun follows all 48 symmetries of the cube", "[image][sun]") {
  const int size = 31;
  CubemapImage image = grey_cubemap(size, 1.0F);
  paint_disc(image, glm::normalize(glm::dvec3(10, 9.5, 9)), 5.0, kRadiance);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] *= 1.0F + static_cast<float>(i * i % 97) / 400.0F;
  const SunOptions options{0.02, 12.0, 20.0, 0.01};
  CubemapImage taken = image;
  const auto expected = take_out_sun(taken, options);
  REQUIRE(expected);
  const auto grid = grid_of(image);
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      const auto turn = [&](const glm::dvec3& d) {
        glm::dvec3 turned{};
        for (int k = 0; k < 3; ++k)
          turned[k] = d[axes[static_cast<std::size_t>(k)]] * ((signs >> k & 1) != 0 ? -1.0 : 1.0);
        return turned;
      };
      // Where each texel goes: to the one of the face that looks that way with the same place on it.
      const auto target = [&](std::int64_t texel) {
        const glm::dvec3 d = turn(grid.direction(texel));
        const glm::dvec3 magnitude = glm::abs(d);
        const double largest = std::max({magnitude.x, magnitude.y, magnitude.z});
        int face = 0;
        while (glm::dot(d, image::face_frame(face).normal) != largest) ++face;
        const auto index = [&](const glm::dvec3& axis) {
          return static_cast<int>(std::floor((glm::dot(d, axis) / largest + 1.0) * size / 2.0));
        };
        return (face * size + index(image::face_frame(face).v)) * size + index(image::face_frame(face).u);
      };
      CubemapImage turned = image;
      CubemapImage turned_rest = image;
      for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
        const auto from = static_cast<std::size_t>(3 * texel);
        const auto to = static_cast<std::size_t>(3 * target(texel));
        for (std::size_t c = 0; c < 3; ++c) turned.pixels[to + c] = image.pixels[from + c];
        for (std::size_t c = 0; c < 3; ++c) turned_rest.pixels[to + c] = taken.pixels[from + c];
      }
      const auto sun = take_out_sun(turned, options);
      REQUIRE(sun);
      CHECK(glm::length(sun->direction - turn(expected->direction)) < 1e-12);
      CHECK(glm::length(sun->irradiance - expected->irradiance) < 1e-12 * glm::length(expected->irradiance));
      CHECK(sun->solid_angle == Approx(expected->solid_angle).epsilon(1e-12));
      CHECK(turned.pixels == turned_rest.pixels);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
}

TEST_CASE("The sun has the same bits on any number of threads", "[image][sun]") {
  LatLongImage image = grey_lat_long(1024, 512, 0.7F);
  paint_disc(image, glm::normalize(glm::dvec3(1, 2, 3)), 1.0, kRadiance);
  LatLongImage alone = image;
  std::optional<Sun> expected;
  run_with_threads(1, [&] { expected = take_out_sun(alone); });
  LatLongImage shared = image;
  std::optional<Sun> found;
  run_with_threads(5, [&] { found = take_out_sun(shared); });
  REQUIRE((expected && found));
  CHECK(found->direction == expected->direction);
  CHECK(found->irradiance == expected->irradiance);
  CHECK(found->flux_before == expected->flux_before);
  CHECK(found->flux_after == expected->flux_after);
  CHECK(shared.pixels == alone.pixels);
}

}  // namespace welkin::test
