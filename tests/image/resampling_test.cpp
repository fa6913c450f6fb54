// Promise: resampling keeps light where it is, knows no seams, and gives the same bits on any number of threads.
#include "welkin/resampling.h"

#include <cmath>
#include <functional>
#include <limits>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/thrown_error.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

// A smooth environment: a polynomial of degree 3 in the direction.
glm::dvec3 radiance(const glm::dvec3& d) {
  return {1.0 + 0.5 * d.x + 0.3 * d.y * d.z, 2.0 + d.z - d.x * d.y * d.z,
          1.5 - 0.7 * d.y + 0.4 * (d.x * d.x - d.z * d.z)};
}

void put(std::vector<float>& pixels, std::size_t texel, const glm::dvec3& value) {
  for (int c = 0; c < 3; ++c) pixels[3 * texel + static_cast<std::size_t>(c)] = static_cast<float>(value[c]);
}

CubemapImage smooth_cubemap(int size, const glm::dmat3& turn = glm::dmat3(1.0)) {
  CubemapImage map{size, std::vector<float>(static_cast<std::size_t>(18 * size * size))};
  for (int row = 0; row < 6 * size; ++row) {
    for (int column = 0; column < size; ++column) {
      const glm::dvec3 to = image::face_direction(size, row / size, column + 0.5, row % size + 0.5);
      put(map.pixels, static_cast<std::size_t>(row * size + column), radiance(glm::transpose(turn) * to));
    }
  }
  return map;
}

LatLongImage smooth_lat_long(int width, int height, const glm::dmat3& turn = glm::dmat3(1.0)) {
  LatLongImage map{width, height, std::vector<float>(static_cast<std::size_t>(3 * width * height))};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const glm::dvec3 to = image::lat_long_direction(width, height, column + 0.5, row + 0.5);
      put(map.pixels, static_cast<std::size_t>(row * width + column), radiance(glm::transpose(turn) * to));
    }
  }
  return map;
}

double worst_difference(const std::vector<float>& a, const std::vector<float>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(static_cast<double>(a[i]) - b[i]));
  return worst;
}

// Without the rows next to the poles: the mean of such a texel by solid angle lies two thirds down it, not half-way.
double worst_difference_off_poles(const LatLongImage& a, const LatLongImage& b) {
  const auto inner = [](const LatLongImage& map) {
    return std::vector<float>(map.pixels.begin() + 12 * map.width, map.pixels.end() - 12 * map.width);
  };
  return worst_difference(inner(a), inner(b));
}

const glm::dmat3 kAskew = turn_about_y(37.0) * glm::dmat3(0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1);

double relative_difference(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  double off = 0.0;
  double whole = 0.0;
  for (std::size_t i = 0; i < a.coefficients().size(); ++i) {
    const glm::dvec3 difference = a.coefficients()[i] - b.coefficients()[i];
    off += glm::dot(difference, difference);
    whole += glm::dot(b.coefficients()[i], b.coefficients()[i]);
  }
  return std::sqrt(off / whole);
}

}  // namespace

TEST_CASE("A smooth environment is resampled to itself in every shape, askew too", "[resampling]") {
  const CubemapImage cube = smooth_cubemap(64);
  const LatLongImage lat_long = smooth_lat_long(256, 128);
  for (const glm::dmat3& turn : {glm::dmat3(1.0), kAskew, kAskew * glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)}) {
    CHECK(worst_difference(to_cubemap(cube.view(), 48, turn).pixels, smooth_cubemap(48, turn).pixels) < 2e-3);
    CHECK(worst_difference(to_cubemap(lat_long.view(), 48, turn).pixels, smooth_cubemap(48, turn).pixels) < 2e-3);
    CHECK(worst_difference_off_poles(to_lat_long(cube.view(), 160, 80, turn), smooth_lat_long(160, 80, turn)) < 2e-3);
    CHECK(worst_difference_off_poles(to_lat_long(lat_long.view(), 160, 80, turn), smooth_lat_long(160, 80, turn)) <
          2e-3);
  }
}

TEST_CASE("Resampling keeps a smooth environment's harmonics", "[resampling]") {
  const CubemapImage cube = smooth_cubemap(128);
  const SphericalHarmonics wanted = project(cube.view()).radiance;
  CHECK(relative_difference(project(to_cubemap(cube.view(), 64).view()).radiance, wanted) < 2e-4);
  CHECK(relative_difference(project(to_lat_long(cube.view(), 512, 256).view()).radiance, wanted) < 2e-4);
  CHECK(relative_difference(project(to_lat_long(cube.view(), 64, 32).view()).radiance, wanted) < 2e-3);
}

TEST_CASE("Reducing noise keeps its flux", "[resampling]") {
  // Every texel of the source enters with about its solid angle: what is left is the error of evenly spaced samples.
  const LatLongImage noise{256, 128, some_pixels(256, 128)};
  const glm::dvec3 wanted = project(noise.view()).radiance.coefficients()[0];
  for (const int size : {1, 2, 3, 7, 16, 64}) {
    const glm::dvec3 found = project(to_cubemap(noise.view(), size, kAskew).view()).radiance.coefficients()[0];
    CAPTURE(size);
    for (int c = 0; c < 3; ++c) CHECK(found[c] == Approx(wanted[c]).epsilon(4e-3));
  }
}

TEST_CASE("A uniform environment stays what it is at every size", "[resampling]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    CubemapImage cube{size, std::vector<float>(static_cast<std::size_t>(18 * size * size), 0.1F)};
    for (const int result : {1, 3, 64}) {
      for (const float value : to_cubemap(cube.view(), result, kAskew).pixels) REQUIRE(value == 0.1F);
      for (const float value : to_lat_long(cube.view(), 2 * result + 1, result, kAskew).pixels) REQUIRE(value == 0.1F);
    }
  }
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 2}, {7, 3}, {257, 128}}) {
    const LatLongImage map{width, height, std::vector<float>(static_cast<std::size_t>(3 * width * height), 0.1F)};
    for (const float value : to_lat_long(map.view(), 9, 5, kAskew).pixels) REQUIRE(value == 0.1F);
  }
}

TEST_CASE("Faces are interpolated across their edges without a seam", "[resampling]") {
  // Interpolated much finer, neighbours on either side of an edge differ by no more than those inside a face do.
  const CubemapImage coarse = smooth_cubemap(8);
  const int width = 1024;
  const LatLongImage fine = to_lat_long(coarse.view(), width, 512);
  double largest_step = 0.0;
  for (int row = 128; row < 384; ++row) {
    for (int column = 0; column < width; ++column) {
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](int x) { return fine.pixels[static_cast<std::size_t>(3 * (row * width + x % width) + c)]; };
        largest_step = std::max(largest_step, static_cast<double>(std::abs(at(column + 1) - at(column))));
      }
    }
  }
  // The steepest slope, 1.5 or so a radian, times 2 pi / 1024, with room for the coarse map's own error.
  CHECK(largest_step < 0.02);
}

TEST_CASE("A lat-long goes on over its poles, in odd widths too", "[resampling]") {
  for (const int width : {64, 63}) {
    const LatLongImage coarse = smooth_lat_long(width, 32);
    const CubemapImage wanted = smooth_cubemap(64);
    const glm::dmat3 upright(1.0);
    CHECK(worst_difference(to_cubemap(coarse.view(), 64, upright, {}, ResampleFilter::bilinear).pixels, wanted.pixels) <
          0.01);
    CHECK(worst_difference(to_cubemap(coarse.view(), 64, kAskew).pixels, smooth_cubemap(64, kAskew).pixels) < 0.01);
    // By area a texel next to the pole goes on to the pole as it is.
    CHECK(worst_difference(to_cubemap(coarse.view(), 64).pixels, wanted.pixels) < 0.02);
  }
}

TEST_CASE("Two turns one after the other are their product", "[resampling]") {
  const CubemapImage map = smooth_cubemap(64);
  const glm::dmat3 second = turn_about_y(-71.0);
  const CubemapImage twice = to_cubemap(to_cubemap(map.view(), 64, kAskew).view(), 64, second);
  CHECK(worst_difference(twice.pixels, to_cubemap(map.view(), 64, second * kAskew).pixels) < 2e-3);
}

TEST_CASE("Resampling gives the same bits on any number of threads", "[resampling]") {
  const LatLongImage noise{257, 129, some_pixels(257, 129)};
  std::vector<float> alone;
  run_with_threads(1, [&] { alone = to_cubemap(noise.view(), 67, kAskew).pixels; });
  for (const int threads : {2, 7}) {
    run_with_threads(threads, [&] { CHECK(to_cubemap(noise.view(), 67, kAskew).pixels == alone); });
  }
}

TEST_CASE("Resampling refuses what it cannot do, and can be stopped", "[resampling]") {
  const CubemapImage map = smooth_cubemap(4);
  const ThrownError skewed = thrown_by([&] { return to_cubemap(map.view(), 4, glm::dmat3(1.1)); });
  CHECK(skewed.code == ErrorCode::invalid_argument);
  CHECK(skewed.says("orthogonal"));
  CHECK(thrown_by([&] { return to_cubemap(map.view(), 4, glm::dmat3(NAN)); }).says("orthogonal"));
  CHECK(thrown_by([&] { return to_cubemap(map.view(), 0); }).says("from 1 to 16384"));
  CHECK(thrown_by([&] { return to_lat_long(map.view(), 70000, 4); }).says("from 1 to 65536"));
  CHECK(thrown_by([&] { return to_lat_long(CubemapView{}, 4, 2); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([] { return turn_about_y(std::numeric_limits<double>::infinity()); }).code ==
        ErrorCode::invalid_argument);
  std::stop_source stop;
  stop.request_stop();
  CHECK(thrown_by([&] {
          return to_cubemap(map.view(), 5, kAskew, {stop.get_token(), {}});
        }).code == ErrorCode::cancelled);
}

}  // namespace welkin::test
