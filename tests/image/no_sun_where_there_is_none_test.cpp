// Promises: a map without a sun stays as it is, bit by bit; options say what is one; wrong arguments are named.
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "support/catch.h"
#include "support/sun_maps.h"
#include "support/thrown_error.h"
#include "welkin/directional_light.h"

namespace welkin::test {
namespace {

const glm::dvec3 kHere = glm::normalize(glm::dvec3(1, 2, 2));
const glm::dvec3 kThere = glm::normalize(glm::dvec3(-2, 1, 1));

template <class Image>
void check_untouched(Image image, const SunOptions& options = {}) {
  const Image before = image;
  CHECK_FALSE(take_out_sun(image, options));
  CHECK(std::memcmp(image.pixels.data(), before.pixels.data(), before.pixels.size() * sizeof(float)) == 0);
}

LatLongImage with_disc(double radius, double radiance) {
  LatLongImage image = grey_lat_long(512, 256, 1.0F);
  paint_disc(image, kHere, radius, glm::dvec3(radiance));
  return image;
}

}  // namespace

TEST_CASE("Black, even, noisy and empty maps have no sun", "[image][sun]") {
  std::mt19937 generator(1);
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    for (const float value :
         {0.0F, 1.0F, -1.0F, 1e30F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      check_untouched(grey_lat_long(2 * size, size, value));
      check_untouched(grey_cubemap(size, value));
    }
    CubemapImage noise = grey_cubemap(size, 0.0F);
    for (float& value : noise.pixels) value = static_cast<float>(generator() >> 8U) * 0x1p-24F;
    check_untouched(noise);
  }
}

TEST_CASE("A source that is too large, too weak or too small a share is no sun", "[image][sun]") {
  check_untouched(with_disc(4.0, 1e4));
  CHECK(take_out_sun(*std::make_unique<LatLongImage>(with_disc(4.0, 1e4)), {0.02, 9.0, 20.0, 0.01}));
  check_untouched(with_disc(2.0, 15.0));
  check_untouched(with_disc(0.9, 100.0));  // 7.7e-4 steradians of 100: 0.6 % of the light
  LatLongImage weak = with_disc(0.9, 100.0);
  CHECK(take_out_sun(weak, {0.02, 3.0, 20.0, 0.005}));
}

TEST_CASE("Glow below the threshold stays in the map", "[image][sun]") {
  LatLongImage image = with_disc(6.0, 100.0);
  paint_disc(image, kHere, 1.0, glm::dvec3(1e5));
  const auto sun = take_out_sun(image);
  REQUIRE(sun);
  CHECK(sun->irradiance.g == Approx((1e5 - 100.0) * disc_solid_angle(1.0)).epsilon(0.01));
  const auto middle = static_cast<std::size_t>(3 * nearest_texel(grid_of(image), kHere));
  CHECK(image.pixels[middle] == 100.0F);
}

TEST_CASE("Of two suns the brighter is taken, then the other", "[image][sun]") {
  LatLongImage image = with_disc(1.0, 1e5);
  paint_disc(image, kThere, 1.0, glm::dvec3(2e5));
  const auto first = take_out_sun(image);
  const auto second = take_out_sun(image);
  REQUIRE((first && second));
  CHECK(degrees_between(first->direction, kThere) < 0.1);
  CHECK(degrees_between(second->direction, kHere) < 0.1);
  CHECK(first->flux_after == second->flux_before);
  CHECK_FALSE(take_out_sun(image));
}

TEST_CASE("Texels without a value are passed over", "[image][sun]") {
  LatLongImage image = with_disc(1.5, 1e5);
  const auto grid = grid_of(image);
  const std::int64_t middle = nearest_texel(grid, kHere);
  image.pixels[static_cast<std::size_t>(3 * middle)] = std::numeric_limits<float>::infinity();
  const auto sun = take_out_sun(image);
  REQUIRE(sun);
  CHECK(std::isinf(image.pixels[static_cast<std::size_t>(3 * middle)]));
  CHECK(image.pixels[static_cast<std::size_t>(3 * middle + 1)] == 1e5F);
  CHECK(std::isfinite(sun->flux_before.x));
  CHECK(degrees_between(sun->direction, kHere) < 0.2);

  // A sun with nothing but NaN around it has no radiance to be replaced by.
  CubemapImage lonely = grey_cubemap(16, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < 3 * 16 * 16; ++i) lonely.pixels[i + std::size_t{3} * 16 * 16] = 0.001F;
  for (int c = 0; c < 3; ++c) lonely.pixels[static_cast<std::size_t>(3 * (5 * 256 + 100) + c)] = 1e4F;
  check_untouched(lonely);
}

TEST_CASE("Suns are refused in words when options or sizes are wrong", "[image][sun]") {
  LatLongImage image = grey_lat_long(4, 2, 1.0F);
  const auto message = [&](const SunOptions& options) {
    const ThrownError error = thrown_by([&] { static_cast<void>(take_out_sun(image, options)); });
    CHECK(error.code == ErrorCode::invalid_argument);
    return error.message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double wrong : {0.0, -1.0, 1.5, nan}) {
    CHECK(message({wrong, 3.0, 20.0, 0.01}).find("SunOptions::relative_threshold is ") == 0);
  }
  for (const double wrong : {-1.0, 91.0, nan}) {
    CHECK(message({0.02, wrong, 20.0, 0.01}).find("it must be from 0 to 90") != std::string::npos);
  }
  for (const double wrong : {0.5, -3.0, nan})
    CHECK(message({0.02, 3.0, wrong, 0.01}).find("at least 1") != std::string::npos);
  for (const double wrong : {-0.1, 1.1, nan})
    CHECK(message({0.02, 3.0, 20.0, wrong}).find("minimum_share") != std::string::npos);

  image.pixels.pop_back();
  CHECK(message({}).find("a lat-long of 4 x 2 texels with 23 floats") == 0);
  for (const int size : {-5, 0, 3, 2000000000}) {
    CubemapImage cubemap{size, std::vector<float>(24)};
    const ThrownError error = thrown_by([&] { static_cast<void>(take_out_sun(cubemap)); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("3 floats a texel"));
  }
}

}  // namespace welkin::test
