// Promise: a turn that takes texels to texels moves every texel as it is, bit for bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/test_environments.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

std::vector<glm::dmat3> cube_symmetries() {
  std::vector<glm::dmat3> all;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 matrix(0.0);
      for (int i = 0; i < 3; ++i) matrix[i][axes[static_cast<std::size_t>(i)]] = (signs >> i & 1) != 0 ? -1.0 : 1.0;
      all.push_back(matrix);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return all;
}

CubemapImage some_cubemap(int size) { return {size, some_pixels(size, 6 * size)}; }

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

const float* nearest(const CubemapImage& map, const glm::dvec3& direction) {
  double best = -2.0;
  const float* found = nullptr;
  for (int row = 0; row < 6 * map.size; ++row) {
    for (int column = 0; column < map.size; ++column) {
      const double cosine =
          glm::dot(direction, image::face_direction(map.size, row / map.size, column + 0.5, row % map.size + 0.5));
      if (cosine <= best) continue;
      best = cosine;
      found = map.pixels.data() + 3 * (row * map.size + column);
    }
  }
  return best > 1.0 - 1e-12 ? found : nullptr;
}

}  // namespace

TEST_CASE("All 48 symmetries of a cube move texels to where they turn directions", "[resampling]") {
  REQUIRE(cube_symmetries().size() == 48);
  for (const int size : {1, 2, 3}) {
    const CubemapImage map = some_cubemap(size);
    for (const glm::dmat3& turn : cube_symmetries()) {
      const CubemapImage turned = to_cubemap(map.view(), size, turn);
      for (int row = 0; row < 6 * size; ++row) {
        for (int column = 0; column < size; ++column) {
          const glm::dvec3 from = image::face_direction(size, row / size, column + 0.5, row % size + 0.5);
          const float* place = nearest(turned, turn * from);
          REQUIRE(place != nullptr);
          REQUIRE(std::equal(place, place + 3, map.pixels.data() + 3 * (row * size + column)));
        }
      }
    }
  }
}

TEST_CASE("A turn of a cube and its inverse give the same bits back", "[resampling]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    CubemapImage map = some_cubemap(size);
    map.pixels[1] = NAN;
    map.pixels[2] = -INFINITY;
    for (const glm::dmat3& turn : cube_symmetries()) {
      const CubemapImage there = to_cubemap(map.view(), size, turn);
      REQUIRE(same_bits(to_cubemap(there.view(), size, glm::transpose(turn)).pixels, map.pixels));
    }
  }
}

TEST_CASE("A quarter turn that came through a quaternion is exact too", "[resampling]") {
  const CubemapImage map = some_cubemap(7);
  const glm::dmat3 rounded = glm::mat3_cast(glm::normalize(glm::dquat(0.7071068, 0.0, 0.7071068, 0.0)));
  CHECK(same_bits(to_cubemap(map.view(), 7, rounded).pixels, to_cubemap(map.view(), 7, turn_about_y(90.0)).pixels));
}

TEST_CASE("Lat-longs turn about y by whole texels, and mirror, without a changed bit", "[resampling]") {
  for (const auto& [width, height] : {std::pair{8, 4}, {7, 4}, {64, 33}, {257, 128}, {1, 1}}) {
    const LatLongImage map{width, height, some_pixels(width, height)};
    CAPTURE(width, height);
    CHECK(same_bits(to_lat_long(map.view(), width, height).pixels, map.pixels));
    for (int shift : {0, 1, 2, width - 1}) {
      for (int mirrors = 0; mirrors < 4; ++mirrors) {
        glm::dmat3 mirror(1.0);
        if ((mirrors & 1) != 0) mirror[0][0] = -1.0;
        if ((mirrors & 2) != 0) mirror[1][1] = -1.0;
        const glm::dmat3 turn = turn_about_y(360.0 * shift / width) * mirror;
        const LatLongImage turned = to_lat_long(map.view(), width, height, turn);
        int wrong = 0;
        for (int row = 0; row < height; ++row) {
          for (int column = 0; column < width; ++column) {
            // Mirrored in x, then moved to the left by `shift`.
            const int mirrored = (mirrors & 1) != 0 ? width - 1 - column : column;
            const int to_column = ((mirrored - shift) % width + width) % width;
            const int to_row = (mirrors & 2) != 0 ? height - 1 - row : row;
            const float* from = map.pixels.data() + 3 * (row * width + column);
            if (!std::equal(from, from + 3, turned.pixels.data() + 3 * (to_row * width + to_column))) ++wrong;
          }
        }
        CHECK(wrong == 0);
        REQUIRE(same_bits(to_lat_long(turned.view(), width, height, glm::transpose(turn)).pixels, map.pixels));
      }
    }
  }
}

TEST_CASE("Exact turns read every pixel format, and rows from the bottom up", "[resampling]") {
  const TestCubemapHalf half = make_cubemap_half(Content::random, 5, 4, 3);
  const TestCubemap whole = make_cubemap(Content::random, 5, 3, 3);
  const CubemapImage of_half = to_cubemap(half.view(), 5, turn_about_y(90.0));
  const CubemapImage of_float = to_cubemap(whole.view(), 5, turn_about_y(90.0));
  for (std::size_t i = 0; i < of_half.pixels.size(); ++i) REQUIRE(of_half.pixels[i] == as_half(of_float.pixels[i]));

  LatLongImage map{6, 4, some_pixels(6, 4)};
  LatLongView upside_down = map.view();
  upside_down.pixels = map.pixels.data() + 3 * 6 * 3;
  upside_down.row_stride_bytes = -6 * 12;
  glm::dmat3 flip(1.0);
  flip[1][1] = -1.0;
  CHECK(same_bits(to_lat_long(upside_down, 6, 4).pixels, to_lat_long(map.view(), 6, 4, flip).pixels));
}

}  // namespace welkin::test
