// Images of skies, small skies for reflections, and skies that keep an environment.
#include "sky/sky_images.h"

#include "image/geometry.h"
#include "sky/sky_tables_for_tests.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/small_skies.h"
#include "support/sun_maps.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/reflections.h"
#include "welkin/sky.h"

namespace welkin::test {

// Images of skies: their texels are the view's radiance, the sun's disc in them is the directional light.

namespace {

const SkyView& view_at(double altitude) {
  static const SkyView ground(small_view_tables(), 0.0);
  static const SkyView hill(small_view_tables(), 900.0);
  static const SkyView space(small_view_tables(), 400'000.0);
  return altitude > 1e5 ? space : altitude > 0.0 ? hill : ground;
}

/// The sun in an image adds its irradiance to the light.
template <class Image>
void check_disc_irradiance(const Image& image, const Image& plain, const glm::dvec3& irradiance) {
  const glm::dvec3 with = total_radiance_of(image);
  const glm::dvec3 without = total_radiance_of(plain);
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c, with[c], without[c], irradiance[c]);
    CHECK(std::abs(with[c] - without[c] - irradiance[c]) <= 1e-5 * (irradiance[c] + without[c]));
  }
}

bool all_sound(std::span<const float> pixels) {
  return std::all_of(pixels.begin(), pixels.end(), [](float value) { return value >= 0.0F && std::isfinite(value); });
}

}  // namespace

TEST_CASE("sky images: a texel is the radiance at its centre", "[sky][view][images]") {
  const glm::dvec3 sun = sun_direction(12.0, 33.0);
  for (const double altitude : {0.0, 900.0, 400'000.0}) {
    const SkyView& view = view_at(altitude);
    for (const int size : {1, 2, 3, 7, 64}) {
      CAPTURE(altitude, size);
      const Cubemap cube = sky_cubemap(view, sun, size);
      REQUIRE(cube.size() == size);
      const image::TexelGrid grid = image::TexelGrid::cubemap(size);
      REQUIRE(cube.pixels().size() == 3 * static_cast<std::size_t>(grid.texels()));
      const LatLongImage map = sky_lat_long(view, sun, size);
      REQUIRE(map.width == 2 * size);
      const image::TexelGrid flat = image::TexelGrid::lat_long(map.width, map.height);
      double worst = 0.0;
      double brightest = 0.0;
      const auto compare = [&](const image::TexelGrid& texels, std::span<const float> pixels) {
        for (std::int64_t i = 0; i < texels.texels(); i += 1 + texels.texels() / 200) {
          const glm::dvec3 expected = view.radiance(texels.direction(i), sun);
          for (int c = 0; c < 3; ++c) {
            const auto found = static_cast<double>(pixels[static_cast<std::size_t>(3 * i + c)]);
            worst = std::max(worst, std::abs(found - expected[c]));
            brightest = std::max(brightest, expected[c]);
          }
        }
      };
      compare(grid, cube.pixels());
      compare(flat, map.pixels);
      CHECK(worst <= 1e-6 * brightest);
    }
  }
}

TEST_CASE("sky images: the disc's total radiance is the directional light's irradiance", "[sky][view][images][truth]") {
  for (const double altitude : {0.0, 900.0, 400'000.0}) {
    const SkyView& view = view_at(altitude);
    // High, low, half set, a sliver, below the horizon of the ground but not of the hill, straight up, gone.
    for (const double elevation : {90.0, 47.0, 0.0, -0.2, -0.26, -0.9, -1.2, -20.0, -60.0}) {
      const glm::dvec3 sun = sun_direction(elevation, 77.0);
      const glm::dvec3 irradiance = view.sun_light(sun).irradiance;
      for (const int size : {1, 2, 3, 7, 64}) {
        CAPTURE(altitude, elevation, size);
        const Cubemap with = sky_cubemap(view, sun, size, {.sun_disc = true});
        CHECK(all_sound(with.pixels()));
        check_disc_irradiance(with, sky_cubemap(view, sun, size), irradiance);
        if (size > 7) continue;
        const LatLongImage map = sky_lat_long(view, sun, size, {.sun_disc = true});
        CHECK(all_sound(map.pixels));
        check_disc_irradiance(map, sky_lat_long(view, sun, size), irradiance);
      }
    }
  }
}

TEST_CASE("sky images: the disc covers what it covers", "[sky][view][images][truth]") {
  const double radius = 0.2678;
  const double turn = radius * 3.14159265358979324 / 180.0;
  const double whole = 2.0 * 3.14159265358979324 * (1.0 - std::cos(turn));
  const auto sum = [](const std::vector<sky::CoveredTexel>& texels) {
    double all = 0.0;
    for (const sky::CoveredTexel& texel : texels) all += texel.steradians;
    return all;
  };
  sky::VisibleDisc disc{{}, std::sin(turn), std::cos(turn), -1.0};
  // On a face's middle, on an edge, at a corner, at the pole, at a lat-long's seam.
  for (const glm::dvec3& centre : {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 1), glm::dvec3(1, 1, 1), glm::dvec3(0, 1, 0),
                                   glm::dvec3(1e-4, 0.3, -1), glm::dvec3(0.3, 0.4, 0.5)}) {
    disc.centre = glm::normalize(centre);
    for (const int size : {1, 2, 3, 64, 257, 2048, 16384}) {
      CAPTURE(centre.x, centre.y, centre.z, size);
      const std::vector<sky::CoveredTexel> cube = sky::covered_texels(disc, image::TexelGrid::cubemap(size));
      CHECK(std::abs(sum(cube) / whole - 1.0) < 2e-3);
      for (std::size_t i = 1; i < cube.size(); ++i) REQUIRE(cube[i - 1].texel < cube[i].texel);
      const std::vector<sky::CoveredTexel> map = sky::covered_texels(disc, image::TexelGrid::lat_long(2 * size, size));
      CHECK(std::abs(sum(map) / whole - 1.0) < 2e-3);
      for (std::size_t i = 1; i < map.size(); ++i) REQUIRE(map[i - 1].texel < map[i].texel);
    }
  }
  // Cut by the horizon through its centre: half of it; a quarter of the diameter: the segment's area.
  disc.centre = glm::normalize(glm::dvec3(0.3, 0.0, 1.0));
  disc.horizon_cosine = 0.0;
  CHECK(std::abs(sum(sky::covered_texels(disc, image::TexelGrid::cubemap(512))) / whole - 0.5) < 2e-3);
  CHECK(std::abs(sum(sky::covered_texels(disc, image::TexelGrid::lat_long(1024, 512))) / whole - 0.5) < 2e-3);
  disc.horizon_cosine = std::sin(0.5 * turn);
  CHECK(std::abs(sum(sky::covered_texels(disc, image::TexelGrid::cubemap(100))) / whole - 0.195501) < 2e-3);
}

TEST_CASE("sky images: sizes that cannot be are refused", "[sky][view][images][errors]") {
  const SkyView& view = view_at(0.0);
  const glm::dvec3 sun(0.0, 1.0, 0.0);
  for (const int size : {0, -1, 16385}) {
    CHECK(thrown_by([&] { static_cast<void>(sky_cubemap(view, sun, size)); }).code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(sky_lat_long(view, sun, size)); }).says("height"));
  }
}

// A small sky for reflections.

TEST_CASE("sky specular: it is the sky's cubemap, prefiltered", "[sky][view][specular]") {
  const SkyView view(small_view_tables(), 0.0);
  const glm::dvec3 sun = sun_direction(25.0, 40.0);
  PrefilterOptions options{.size = 16};
  for (const bool disc : {false, true}) {
    const PrefilteredSpecular found = sky_specular(view, sun, options, {.sun_disc = disc});
    const Cubemap sky = sky_cubemap(view, sun, 16, {.sun_disc = disc});
    const PrefilteredSpecular expected = prefilter_specular(sky.view(), options);
    CHECK(all_values(found.cubemap, expected.cubemap, [](float a, float b) { return a == b; }));
    CHECK(all_sound(found.cubemap.pixels()));
  }
  options.size = 0;
  CHECK(thrown_by([&] { static_cast<void>(sky_specular(view, sun, options)); }).code == ErrorCode::invalid_argument);
}

}  // namespace welkin::test
