// Promises: what the map loses is what the sun has, to 1e-6 and far better; no texel is made brighter, and none
// changes that does not belong to the sun.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "support/catch.h"
#include "support/sun_maps.h"
#include "welkin/directional_light.h"

namespace welkin::test {
namespace {

const glm::dvec3 kPlaces[] = {{0, 0, 1},
                              {0, 1, 0},
                              {0, -1, 0},
                              {0, 0, -1},
                              {0.577350269, 0.577350269, 0.577350269},
                              {0.707106781, 0, -0.707106781},
                              {0.48, 0.6, 0.64}};

template <class Image>
void make_noisy(Image& image, std::uint32_t seed) {
  std::mt19937 generator(seed);
  for (float& value : image.pixels) value *= 0.5F + static_cast<float>(generator() >> 8U) * 0x1p-24F;
}

/// One texel of this radiance, or a disc where texels are small.
template <class Image>
void add_sun(Image& image, const glm::dvec3& direction, const glm::dvec3& radiance) {
  const std::int64_t texel = nearest_texel(grid_of(image), direction);
  for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(3 * texel + c)] = static_cast<float>(radiance[c]);
  if (grid_of(image).texels() > 1000) paint_disc(image, direction, 1.2, radiance);
}

template <class Image>
void check_energy(Image image, bool expect_sun) {
  const Image before = image;
  const auto sun = take_out_sun(image);
  CHECK(sun.has_value() == expect_sun);
  std::uint64_t changed = 0;
  std::uint64_t brighter = 0;
  for (std::size_t i = 0; i < before.pixels.size(); i += 3) {
    bool same = true;
    for (std::size_t c = i; c < i + 3; ++c) {
      same = same && std::memcmp(&image.pixels[c], &before.pixels[c], sizeof(float)) == 0;
      brighter += image.pixels[c] > before.pixels[c] ? 1 : 0;
    }
    changed += same ? 0 : 1;
  }
  CHECK(brighter == 0);
  CHECK(changed == (sun ? sun->texels : 0));
  if (!sun) return;
  const glm::dvec3 flux_before = flux_of(before);
  const glm::dvec3 flux_after = flux_of(image);
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c);
    CHECK(sun->flux_before[c] == Approx(flux_before[c]).epsilon(1e-9));
    CHECK(sun->flux_after[c] == Approx(flux_after[c]).epsilon(1e-9));
    CHECK(flux_before[c] == Approx(flux_after[c] + sun->irradiance[c]).epsilon(1e-9));
    CHECK(sun->flux_before[c] == Approx(sun->flux_after[c] + sun->irradiance[c]).epsilon(1e-12));
    CHECK(sun->irradiance[c] == Approx(sun->radiance[c] * sun->solid_angle).epsilon(1e-14));
  }
}

}  // namespace

TEST_CASE("Map plus sun is the map that was, at every size and place", "[image][sun]") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    for (const glm::dvec3& place : kPlaces) {
      CAPTURE(size, place.x, place.y, place.z);
      LatLongImage lat_long = grey_lat_long(2 * size, size, 1.0F);
      make_noisy(lat_long, 7);
      add_sun(lat_long, place, {2e5, 1.5e5, 5e4});
      // A texel cannot be twenty times the mean if it is more than a twentieth of the sphere.
      check_energy(lat_long, size > 3 || (size == 3 && std::abs(place.y) > 0.5));
      CubemapImage cubemap = grey_cubemap(size, 1.0F);
      make_noisy(cubemap, 8);
      add_sun(cubemap, place, {2e5, 1.5e5, 5e4});
      check_energy(cubemap, size > 1);
    }
  }
}

TEST_CASE("Energy is conserved among negatives, values of 1e30 and of no value", "[image][sun]") {
  std::mt19937 generator(3);
  for (const float sun : {1e3F, 1e30F, 3e38F}) {
    CubemapImage cubemap = grey_cubemap(32, 1.0F);
    LatLongImage lat_long = grey_lat_long(65, 33, 1.0F);
    for (auto* pixels : {&cubemap.pixels, &lat_long.pixels}) {
      for (float& value : *pixels) {
        const std::uint32_t dice = generator() % 64;
        if (dice == 0) value = -0.5F;
        if (dice == 1) value = std::numeric_limits<float>::quiet_NaN();
        if (dice == 2) value = std::numeric_limits<float>::infinity();
        if (dice == 3) value = -std::numeric_limits<float>::infinity();
      }
    }
    add_sun(cubemap, {0, 1, 0}, glm::dvec3(sun));
    add_sun(lat_long, {1, 0, 0}, glm::dvec3(sun));
    check_energy(cubemap, true);
    check_energy(lat_long, true);
  }
}

TEST_CASE("A sun of one colour takes no other", "[image][sun]") {
  LatLongImage image = grey_lat_long(64, 32, 1.0F);
  add_sun(image, {0, 0.6, 0.8}, {0.25, -3.0, 15000.0});
  const auto sun = take_out_sun(image);
  REQUIRE(sun);
  CHECK(sun->irradiance.r == 0.0);
  CHECK(sun->irradiance.g == 0.0);
  CHECK(sun->irradiance.b > 0.0);
}

}  // namespace welkin::test
