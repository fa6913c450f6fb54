// Promise: a cube's symmetries take texels to texels, each its own way and back.
#include "image/geometry.h"

#include "image/cube_symmetry.h"
#include "support/catch.h"
#include "support/pictures.h"
#include "support/same_bits.h"
#include "welkin/resampling.h"

namespace welkin::test {

TEST_CASE("A cube's sixteen images are all different, and lead back", "[symmetry]") {
  constexpr int size = 5;
  const image::CubeTexel texel{2, 0, 3};
  const glm::ivec3 point = image::point_of(size, texel);
  std::set<std::tuple<int, int, int>> places;
  for (int k = 0; k < 16; ++k) {
    const image::CubeImage there = image::cube_image_of(k);
    CHECK(image::index_of(there) == k);
    const glm::ivec3 place = moved(there, point);
    CHECK(moved_back(there, place) == point);
    const image::CubeTexel found = image::texel_at(size, place);
    CHECK(found.face == (there.below ? 3 : 2));
    places.emplace(found.face, found.column, found.row);
  }
  CHECK(places.size() == 16);
}

TEST_CASE("A turn is a cube's symmetry if it is within 1e-9 of one", "[symmetry]") {
  glm::dmat3 rotation(0.0);
  rotation[0][1] = 1.0;
  rotation[1][0] = -1.0;
  rotation[2][2] = 1.0 - 0.9e-9;
  REQUIRE(image::cube_symmetry_of(rotation));
  CHECK((*image::cube_symmetry_of(rotation))[1][0] == -1);
  rotation[2][2] = 1.0 - 1.1e-9;
  CHECK_FALSE(image::cube_symmetry_of(rotation));
}

// A lat-long that is turned about y by a share of a texel: sharp, within its range, every row's sum kept.

namespace {

/// Octaves of noise as photographs have them, and a sun of one texel that is 1e6 times as bright.
LatLongImage photograph_like(int width, int height) {
  std::mt19937 random(7);
  LatLongImage picture{width, height, std::vector<float>(std::size_t{3} * static_cast<std::size_t>(width * height))};
  std::vector<double> stops(static_cast<std::size_t>(width * height));
  for (int block = 1; block <= 32; block *= 2) {
    std::vector<double> coarse(stops.size());
    for (double& value : coarse) value = static_cast<double>(random()) / 4294967296.0 - 0.5;
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const auto at = static_cast<std::size_t>(row / block * width + column / block);
        stops[static_cast<std::size_t>(row * width + column)] += 0.5 * block * coarse[at] / 4.0;
      }
    }
  }
  for (std::size_t texel = 0; texel < stops.size(); ++texel) {
    for (std::size_t c = 0; c < 3; ++c)
      picture.pixels[3 * texel + c] =
          static_cast<float>(std::exp2(stops[texel]) * (1.0 + 0.1 * static_cast<double>(c)));
  }
  for (std::size_t c = 0; c < 3; ++c)
    picture.pixels[3 * static_cast<std::size_t>(height / 3 * width + width / 2) + c] = 1e6F;
  return picture;
}

double row_sum(const LatLongImage& picture, int row, int channel) {
  double sum = 0.0;
  for (int column = 0; column < picture.width; ++column)
    sum += static_cast<double>(
        picture.pixels[3 * static_cast<std::size_t>(row * picture.width + column) + static_cast<std::size_t>(channel)]);
  return sum;
}

}  // namespace

TEST_CASE("A lat-long that is turned by a share of a texel stays sharp and keeps each row's light",
          "[image][resampling]") {
  constexpr int kWidth = 256;
  const LatLongImage picture = photograph_like(kWidth, 128);
  const double before = sharpness(picture.view());
  const float least = *std::ranges::min_element(picture.pixels);
  const float largest = *std::ranges::max_element(picture.pixels);
  const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  for (const double texels : {0.1, 0.25, 0.5, 0.75, 33.4}) {
    for (const bool mirrored : {false, true}) {
      const glm::dmat3 rotation = rotation_about_y(360.0 * texels / kWidth) * (mirrored ? mirror : glm::dmat3(1.0));
      const LatLongImage rotated = to_lat_long(picture.view(), kWidth, picture.height, rotation);
      INFO(texels << (mirrored ? " mirrored" : "") << ": " << sharpness(rotated.view()) / before);
      CHECK(sharpness(rotated.view()) >= 0.9 * before);
      CHECK(sharpness(rotated.view()) <= before);
      for (int row = 0; row < picture.height; ++row) {
        for (int c = 0; c < 3; ++c) CHECK(row_sum(rotated, row, c) == Approx(row_sum(picture, row, c)).epsilon(1e-6));
      }
      CHECK(std::ranges::all_of(rotated.pixels, [&](float value) { return value >= least && value <= largest; }));
    }
  }
}

TEST_CASE("A smooth lat-long that is turned by a share of a texel is closer than linear interpolation",
          "[image][resampling]") {
  // cos(3 longitude): exact but for what cubic convolution loses of a wave of 40 texels.
  constexpr int kWidth = 120;
  const auto wave = [&](double shift) {
    LatLongImage picture{kWidth, 4, {}};
    for (int texel = 0; texel < 4 * kWidth; ++texel) {
      const double longitude = std::acos(-1.0) * (1.0 - 2.0 * (texel % kWidth + 0.5 + shift) / kWidth);
      for (int c = 0; c < 3; ++c) picture.pixels.push_back(static_cast<float>(2.0 + std::cos(3.0 * longitude)));
    }
    return picture;
  };
  const LatLongImage rotated = to_lat_long(wave(0.0).view(), kWidth, 4, rotation_about_y(360.0 * 0.3 / kWidth));
  const LatLongImage wanted = wave(0.3);
  for (std::size_t i = 0; i < wanted.pixels.size(); ++i)
    REQUIRE(std::abs(rotated.pixels[i] - wanted.pixels[i]) < 2.7e-3F);  // as linear: crests are not exceeded
  double square = 0.0;
  for (std::size_t i = 0; i < wanted.pixels.size(); ++i)
    square += std::pow(static_cast<double>(rotated.pixels[i] - wanted.pixels[i]), 2.0);
  CHECK(std::sqrt(square / static_cast<double>(wanted.pixels.size())) < 8e-4);  // linear: 1.8e-3
}

TEST_CASE("Narrow rows, uniform ones, NaN and infinity are turned by a share of a texel", "[image][resampling]") {
  for (const int width : {1, 2, 3, 5}) {
    const LatLongImage grey{width, 2, std::vector<float>(std::size_t{6} * static_cast<std::size_t>(width), 0.1F)};
    const LatLongImage rotated = to_lat_long(grey.view(), width, 2, rotation_about_y(360.0 * 0.37 / width));
    for (const float value : rotated.pixels) CHECK(value == 0.1F);
  }
  LatLongImage picture{16, 2, std::vector<float>(96, 0.5F)};
  picture.pixels[3 * 4] = std::numeric_limits<float>::quiet_NaN();
  picture.pixels[3 * 4 + 1] = std::numeric_limits<float>::infinity();
  const LatLongImage rotated = to_lat_long(picture.view(), 16, 2, rotation_about_y(360.0 * 0.25 / 16));
  for (std::size_t column = 0; column < 16; ++column) {
    const bool touched = column == 3 || column == 4;
    INFO(column);
    CHECK(std::isnan(rotated.pixels[3 * column]) == touched);
    CHECK(std::isinf(rotated.pixels[3 * column + 1]) == touched);
    CHECK(rotated.pixels[3 * column + 2] == 0.5F);
  }
}

}  // namespace welkin::test
