// Promises: a picture's statistics are weighted by the solid angles that its texels have, leave out what is no number,
// and are the same bits however the file is cut and on any number of threads.
#include <cmath>
#include <limits>
#include <numbers>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/close.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

constexpr double kPi = std::numbers::pi;

// The solid angle between the face's centre and (u, v), seen from the cube's: the textbook's closed form.
double corner_solid_angle(double u, double v) { return std::atan2(u * v, std::sqrt(1.0 + u * u + v * v)); }

bool same(const EnvironmentStatistics& a, const EnvironmentStatistics& b) {
  return a.texels == b.texels && a.minimum == b.minimum && a.maximum == b.maximum && a.mean == b.mean &&
         a.flux == b.flux && a.nans == b.nans && a.infinities == b.infinities && a.negatives == b.negatives &&
         a.brightest_column == b.brightest_column && a.brightest_row == b.brightest_row && a.brightest == b.brightest &&
         a.brightest_direction == b.brightest_direction;
}

}  // namespace

TEST_CASE("solid angles of a cube face's texels equal their closed form and make up a sixth of the sphere", "[codec]") {
  for (const int size : {1, 2, 3, 5, 8, 31, 32, 33, 64, 256, 1024}) {
    CAPTURE(size);
    std::vector<double> angles(static_cast<std::size_t>(size));
    double sum = 0.0;
    double worst = 0.0;
    for (int row = 0; row < size; ++row) {
      image::cubemap_row_solid_angles(row, angles);
      const double v0 = 2.0 * row / size - 1.0;
      const double v1 = 2.0 * (row + 1) / size - 1.0;
      for (int column = 0; column < size; ++column) {
        const double u0 = 2.0 * column / size - 1.0;
        const double u1 = 2.0 * (column + 1) / size - 1.0;
        const double exact = corner_solid_angle(u1, v1) - corner_solid_angle(u0, v1) - corner_solid_angle(u1, v0) +
                             corner_solid_angle(u0, v0);
        const double angle = angles[static_cast<std::size_t>(column)];
        worst = std::max(worst, std::abs(angle - exact) * size * size);  // the closed form's own rounding is absolute
        sum += angle;
      }
    }
    CHECK(std::abs(sum / (4.0 * kPi / 6.0) - 1.0) < 1e-11);
    CHECK(worst < 4e-16 * size * size + 1e-11);
  }
}

TEST_CASE("solid angles of a lat-long's texels make up the sphere", "[codec]") {
  for (const int height : {1, 2, 3, 17, 512}) {
    double sum = 0.0;
    for (int row = 0; row < height; ++row) {
      const double top = kPi / 2.0 - kPi * row / height;
      const double bottom = kPi / 2.0 - kPi * (row + 1) / height;
      const double angle = image::lat_long_texel_solid_angle(5, height, row);
      CHECK(test::close(angle, 2.0 * kPi / 5.0 * (std::sin(top) - std::sin(bottom)), 1e-9));
      sum += 5.0 * angle;
    }
    CHECK(std::abs(sum / (4.0 * kPi) - 1.0) < 1e-13);
  }
}

TEST_CASE("statistics of a known picture are what they must be", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("known.pfm");
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> pixels(std::size_t{3} * 64 * 32, 0.25F);
  const auto texel = [&](std::size_t column, std::size_t row) { return pixels.data() + 3 * (64 * row + column); };
  std::fill_n(texel(16, 16), 3, 5.0F);
  std::fill_n(texel(3, 4), 3, kInfinity);
  texel(9, 5)[0] = kNaN;
  texel(9, 5)[1] = 1e30F;
  texel(10, 6)[2] = -0.5F;
  texel(11, 6)[2] = -kInfinity;
  test::write_bytes(path, test::pfm_bytes(64, 32, false, "-1", pixels));

  const EnvironmentStatistics found = measure_environment(path);
  CHECK(found.texels == 64 * 32);
  CHECK(found.nans == 1);
  CHECK(found.infinities == 4);
  CHECK(found.negatives == 1);
  CHECK(found.minimum == glm::dvec3(0.25, 0.25, -0.5));
  CHECK(found.maximum == glm::dvec3(5.0, static_cast<double>(1e30F), 5.0));
  CHECK(found.brightest == glm::dvec3(5.0));
  CHECK(found.brightest_column == 16);
  CHECK(found.brightest_row == 16);
  // Column 16.5 of 64: a quarter in from the left is +x; row 16.5 of 32 is just below the horizon.
  const double latitude = -kPi * 0.5 / 32.0;
  const double longitude = kPi / 2.0 - 2.0 * kPi * 0.5 / 64.0;
  CHECK(test::close(found.brightest_direction.x, std::sin(longitude) * std::cos(latitude)));
  CHECK(test::close(found.brightest_direction.y, std::sin(latitude)));
  CHECK(test::close(found.brightest_direction.z, std::cos(longitude) * std::cos(latitude)));
  const double bright = image::lat_long_texel_solid_angle(64, 32, 16);
  const double out = image::lat_long_texel_solid_angle(64, 32, 4) + image::lat_long_texel_solid_angle(64, 32, 5);
  const double rest = 4.0 * kPi - out;
  CHECK(test::close(found.mean.r, (0.25 * (rest - bright) + 5.0 * bright) / rest, 1e-12));
  CHECK(test::close(found.flux.r, 4.0 * kPi * found.mean.r, 1e-15));
}

TEST_CASE("a uniform sphere has its own value as mean, in either layout", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("uniform.pfm");
  for (const auto& [width, height] : {std::pair{20, 10}, {1, 6}, {7, 42}, {40, 240}}) {
    test::write_bytes(path, test::pfm_bytes(width, height, true, "-1",
                                            std::vector<float>(static_cast<std::size_t>(width * height), 0.75F)));
    const EnvironmentStatistics found = measure_environment(path);
    CHECK(test::close(found.mean.g, 0.75, 1e-14));
    CHECK(test::close(found.flux.b, 3.0 * kPi, 1e-14));
    CHECK(found.brightest_column == 0);
    CHECK(found.brightest_row == 0);
  }
}

TEST_CASE("a picture of nothing but NaN has zeros as statistics", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("nothing.pfm");
  const std::vector<float> pixels(std::size_t{3} * 4 * 2, std::numeric_limits<float>::quiet_NaN());
  test::write_bytes(path, test::pfm_bytes(4, 2, false, "-1", pixels));
  const EnvironmentStatistics found = measure_environment(path);
  CHECK(found.nans == 24);
  CHECK(found.minimum == glm::dvec3(0.0));
  CHECK(found.maximum == glm::dvec3(0.0));
  CHECK(found.flux == glm::dvec3(0.0));
}

TEST_CASE("statistics are the same bits on any number of threads and however the file is cut", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cut.exr");
  const std::vector<float> pixels = test::some_pixels(64, 384);
  const std::vector<float> wide = test::some_pixels(512, 256);
  for (const bool cube : {false, true}) {
    std::vector<EnvironmentStatistics> all;
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
      for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(48, 40)}}) {
        test::ExrRecipe recipe{512, 256, 0, 0, compression, Imf::INCREASING_Y, tiles, std::nullopt, {}};
        recipe.channels = test::rgb_channels(Imf::FLOAT);
        if (cube) {
          recipe.width = 64;
          recipe.height = 384;
        }
        test::write_exr(path, recipe, cube ? pixels : wide);
        for (const int threads : {1, 2, 5}) {
          run_with_threads(threads, [&] { all.push_back(measure_environment(path)); });
        }
      }
    }
    for (const EnvironmentStatistics& one : all) {
      CHECK(same(one, all.front()));
    }
  }
}

}  // namespace welkin
