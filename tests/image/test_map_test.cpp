// Promise: the labelled map shows which way is which, the same on a lat-long and on a cube.
#include "tools/test_map.h"

#include <cmath>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

glm::dvec3 mean_of_face(const CubemapImage& map, int face) {
  const std::size_t texels = static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size);
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < texels; ++i) {
    const float* rgb = map.pixels.data() + 3 * (static_cast<std::size_t>(face) * texels + i);
    sum += glm::dvec3(rgb[0], rgb[1], rgb[2]);
  }
  return sum / static_cast<double>(texels);
}

}  // namespace

TEST_CASE("Positive axes have their primary colour, negative ones its complement", "[testmap]") {
  const CubemapImage map = test_map_cubemap(32);
  for (int face = 0; face < 6; ++face) {
    const glm::dvec3 mean = mean_of_face(map, face);
    const int own = face / 2;
    for (int other : {(own + 1) % 3, (own + 2) % 3}) {
      CAPTURE(face, other);
      if (face % 2 == 0) {
        CHECK(mean[own] > mean[other] + 0.1);
      } else {
        CHECK(mean[own] < mean[other] - 0.1);
      }
    }
  }
}

TEST_CASE("Lat-long and cubemap are the same map", "[testmap]") {
  const LatLongImage map = test_map_lat_long(512, 256);
  const CubemapImage cube = test_map_cubemap(128);
  const LatLongImage from_cube = to_lat_long(cube.view(), 512, 256);
  double squares = 0.0;
  for (std::size_t i = 0; i < map.pixels.size(); ++i) {
    REQUIRE(map.pixels[i] >= 0.0F);
    REQUIRE(map.pixels[i] <= 1.0F);
    squares += std::pow(map.pixels[i] - from_cube.pixels[i], 2);
  }
  CHECK(std::sqrt(squares / static_cast<double>(map.pixels.size())) < 0.08);
}

TEST_CASE("From inside, letters read from left to right and arrows point up", "[testmap]") {
  // On each wall of the lat-long: the sign stands to the left of the letter. The upper half of an X, Z or its like and
  // the word below it are not symmetric to the arrow above.
  const int width = 1024;
  const LatLongImage map = test_map_lat_long(width, 512);
  const auto is_ink = [&](int column, int row) {
    const float* rgb = map.pixels.data() + 3 * (row * width + (column + width) % width);
    return rgb[0] > 0.9F && rgb[1] > 0.9F && rgb[2] > 0.9F;
  };
  for (const int middle : {0, 256, 512, 768}) {
    int left = 0;
    int right = 0;
    int above = 0;
    int below = 0;
    for (int row = 190; row < 315; ++row) {
      for (int step = 8; step < 110; ++step) {
        left += is_ink(middle - step, row) ? 1 : 0;
        right += is_ink(middle + step, row) ? 1 : 0;
      }
    }
    for (int step = -12; step <= 12; ++step) {
      for (int row = 140; row < 180; ++row) above += is_ink(middle + step, row) ? 1 : 0;
      for (int row = 332; row < 372; ++row) below += is_ink(middle + step, row) ? 1 : 0;
    }
    CAPTURE(middle, left, right, above, below);
    CHECK(left * 1.2 < right);  // '+' and '-' have less ink than 'X' and 'Z'
    CHECK(above > 200);         // the arrow's shaft
  }
}

TEST_CASE("Maps of every size are drawn; others are refused", "[testmap]") {
  for (const int size : {1, 2, 3, 7, 65}) {
    CHECK(test_map_cubemap(size).pixels.size() == static_cast<std::size_t>(18 * size * size));
    CHECK(test_map_lat_long(size, 2 * size).pixels.size() == static_cast<std::size_t>(6 * size * size));
  }
  CHECK(thrown_by([] { return test_map_cubemap(0); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([] { return test_map_lat_long(4, 40000); }).says("height"));
}

}  // namespace welkin::test
