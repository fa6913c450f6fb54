// Pixels of cubemaps and lat-longs: formats, directions and solid angles of texels, mips, rotations by whole texels.
#include "image/pixels.h"

#include <Imath/half.h>

#include <glm/gtc/quaternion.hpp>

#include "image/geometry.h"
#include "math/quadrature.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "support/images.h"
#include "support/random_harmonics.h"
#include "support/same_bits.h"
#include "support/sun_maps.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

/// The double nearest to 2.2 is not 2.2: at 1e-100 that makes 4e-14.
double power_2_2(double x) { return static_cast<double>(std::pow(static_cast<long double>(x), 2.2L)); }

}  // namespace

TEST_CASE("Halves become the floats that Imath makes of them", "[image]") {
  for (std::uint32_t bits = 0; bits < 0x10000U; ++bits) {
    Imath::half half;
    half.setBits(static_cast<std::uint16_t>(bits));
    const float expected = half;
    const float found = image::float_from_half(static_cast<std::uint16_t>(bits));
    if (std::isnan(expected)) {
      REQUIRE(std::isnan(found));
    } else {
      REQUIRE(found == expected);
      REQUIRE(std::signbit(found) == std::signbit(expected));
    }
  }
}

TEST_CASE("Transfer functions match libm to a few roundings", "[image]") {
  for (int k = 0; k <= 1000; ++k) {
    const double x = k / 1000.0;
    const double srgb = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    CHECK(image::linear_from_srgb(x) == Approx(srgb).epsilon(2e-15).margin(1e-300));
    CHECK(image::power_2_2(x) == Approx(power_2_2(x)).epsilon(2e-15).margin(1e-300));
  }
  for (const double x : {1e-100, 1e-38, 1e-10, 1e-3}) {
    CHECK(image::power_2_2(x) == Approx(power_2_2(x)).epsilon(2e-15).margin(0.0));
  }
}

TEST_CASE("A byte is its value over 255, rounded once, in runs of any length", "[image]") {
  std::vector<std::uint8_t> texels(std::size_t{4} * 256);
  for (std::size_t k = 0; k < texels.size(); ++k) texels[k] = static_cast<std::uint8_t>(k * 37);
  for (const int channels : {3, 4}) {
    const PixelFormat format = channels == 3 ? PixelFormat::rgb8 : PixelFormat::rgba8;
    for (int count = 1; count <= 256; count = count < 20 ? count + 1 : 2 * count) {
      std::vector<float> rgb(static_cast<std::size_t>(3 * count) + 1, -1.0F);
      image::decode_texels(format, texels.data(), count, rgb.data());
      for (std::size_t k = 0; k + 1 < rgb.size(); ++k) {
        const std::uint8_t byte = texels[k / 3 * static_cast<std::size_t>(channels) + k % 3];
        REQUIRE(rgb[k] == static_cast<float>(byte / 255.0));
      }
      REQUIRE(rgb.back() == -1.0F);
    }
  }
}

// Promises: neighbours are those that touch on the sphere, over every seam, edge and corner; both ways.

namespace {

std::set<std::int64_t> neighbour_set(const image::TexelGrid& grid, std::int64_t texel) {
  const auto neighbours = grid.neighbours(texel);
  return {neighbours.begin(), neighbours.end()};
}

}  // namespace

TEST_CASE("A cubemap's texel has eight neighbours, seven at a corner, and they are the nearest", "[image][sun]") {
  for (const int size : {3, 7, 16}) {
    const auto grid = image::TexelGrid::cubemap(size);
    int corners = 0;
    for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
      const std::set<std::int64_t> found = neighbour_set(grid, texel);
      REQUIRE(found.count(texel) == 0);
      const auto row = static_cast<int>(texel / size) % size;
      const auto column = static_cast<int>(texel % size);
      const bool corner = (row == 0 || row == size - 1) && (column == 0 || column == size - 1);
      corners += corner ? 1 : 0;
      REQUIRE(found.size() == (corner ? 7U : 8U));
      // Two texels touch if a corner of one is a corner of the other; centres are then within a diagonal and a half.
      for (const std::int64_t neighbour : found) {
        const double distance = glm::length(grid.direction(texel) - grid.direction(neighbour));
        REQUIRE(distance < 1.5 * std::numbers::sqrt2 * 2.0 / size);
      }
    }
    CHECK(corners == 24);
  }
}

TEST_CASE("A lat-long's neighbours cross the seam and the poles", "[image][sun]") {
  const auto grid = image::TexelGrid::lat_long(8, 4);
  CHECK(neighbour_set(grid, 8) == std::set<std::int64_t>{0, 1, 7, 9, 15, 16, 17, 23});
  CHECK(neighbour_set(grid, 1) == std::set<std::int64_t>{0, 2, 8, 9, 10, 4, 5, 6});
  CHECK(neighbour_set(grid, 25) == std::set<std::int64_t>{24, 26, 16, 17, 18, 28, 29, 30});
}

TEST_CASE("Solid angles of a face are computed once for each size, texel by texel", "[image][slow]") {
  for (const int size : {1, 2, 5, 31, 32, 63, 64, 257, 512}) {
    const auto angles = image::FaceSolidAngles::get(size);
    CHECK(image::FaceSolidAngles::get(size) == angles);
    std::vector<double> row_angles(static_cast<std::size_t>(size));
    int wrong = 0;
    for (int row = 0; row < size; ++row) {
      image::cubemap_row_solid_angles(std::min(row, size - 1 - row), row_angles);
      for (int column = 0; column < size; ++column) {
        const double angle = angles->at(row, column);
        const bool right = std::abs(angle / row_angles[static_cast<std::size_t>(column)] - 1.0) <= 1e-11;
        wrong += right && angle == angles->at(column, row) ? 0 : 1;
      }
    }
    CAPTURE(size);
    CHECK(wrong == 0);
    // A selection of texels has the same angles.
    const std::int64_t last = std::int64_t{6} * size * size - 1;
    const std::vector<double> some = image::solid_angles_of(image::TexelGrid::cubemap(size), {0, last / 2, last});
    CHECK(some[0] == Approx(angles->at(0, 0)).epsilon(1e-11));
    CHECK(
        some[1] ==
        Approx(angles->at(static_cast<int>(last / 2 / size) % size, static_cast<int>(last / 2 % size))).epsilon(1e-11));
    CHECK(some[2] == Approx(angles->at(size - 1, size - 1)).epsilon(1e-11));
  }
}

TEST_CASE("Solid angles of all row classes make a sphere", "[image][sun]") {
  std::vector<image::TexelGrid> grids;
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    grids.push_back(image::TexelGrid::cubemap(size));
    grids.push_back(image::TexelGrid::lat_long(2 * size + 1, size));
  }
  for (const auto& grid : grids) {
    std::vector<double> steradians(static_cast<std::size_t>(grid.columns()));
    std::vector<int> rows;
    double sum = 0.0;
    for (int row_class = 0; row_class < grid.row_classes(); ++row_class) {
      grid.solid_angles(row_class, steradians);
      for (const int row : grid.rows_of(row_class)) {
        CHECK(grid.class_of(row) == row_class);
        rows.push_back(row);
        for (const double value : steradians) sum += value;
      }
    }
    CHECK(sum == Approx(4.0 * std::numbers::pi).epsilon(1e-11));
    std::sort(rows.begin(), rows.end());
    REQUIRE(rows.size() == static_cast<std::size_t>(grid.rows()));
    for (int row = 0; row < grid.rows(); ++row) CHECK(rows[static_cast<std::size_t>(row)] == row);
  }
}

// Promise: a mip keeps the light of the level above it, at odd sizes too, and a uniform one stays exactly what it is.

namespace {

/// A texel below by its definition: the mean of all texels over the area that it shares with each, in double.
double value_below(const Cubemap& chain, int level, int face, int column, int row, int channel, MipFilter filter) {
  const int above = chain.level_size(level - 1);
  const int size = chain.level_size(level);
  double sum = 0.0;
  double weights = 0.0;
  for (int j = row * above / size; j < above && j * size < (row + 1) * above; ++j) {
    for (int i = column * above / size; i < above && i * size < (column + 1) * above; ++i) {
      const double left = std::max(1.0 * i / above, 1.0 * column / size);
      const double right = std::min((i + 1.0) / above, (column + 1.0) / size);
      const double top = std::max(1.0 * j / above, 1.0 * row / size);
      const double bottom = std::min((j + 1.0) / above, (row + 1.0) / size);
      if (left >= right || top >= bottom) continue;
      double weight = (right - left) * (bottom - top);
      if (filter == MipFilter::solid_angle) {
        weight = math::rectangle_solid_angle(left + right - 1.0, top + bottom - 1.0, right - left, bottom - top,
                                             math::gauss_legendre(20));
      }
      sum += weight * static_cast<double>(chain.face(level - 1, face)[3 * (j * above + i) + channel]);
      weights += weight;
    }
  }
  return sum / weights;
}

constexpr MipFilter kFilters[] = {MipFilter::box, MipFilter::solid_angle};

}  // namespace

TEST_CASE("A cubemap copies its pixels, moves and is refused", "[image]") {
  const Cubemap noise = noisy_chain(6, 3);
  Cubemap copy = noise;
  CHECK(same_bits(noise, copy));
  copy.pixels().back() = 7.0F;
  CHECK_FALSE(same_bits(noise, copy));  // each has its own

  const float* const first = copy.face(0);
  CHECK(first == copy.face(0, 0));
  CHECK(copy.face(5) == copy.face(0, 5));
  CHECK(copy.pixels().size() == 18 * (6 * 6 + 3 * 3 + 1));
  Cubemap taken = std::move(copy);
  CHECK(taken.face(0) == first);
  CHECK(copy.size() == 0);  // NOLINT(bugprone-use-after-move): it promises what it is then
  CHECK(copy.levels() == 0);
  CHECK(copy.pixels().empty());
  CHECK(copy.view().size == 0);
  CHECK(copy.views().empty());
  CHECK(same_bits(Cubemap(copy), copy));

  const std::vector<float> pixels(18 * 4, 0.5F);
  const Cubemap made(2, pixels);
  CHECK(made.levels() == 1);
  CHECK(std::ranges::equal(made.pixels(), pixels));
  CHECK(made.view() == made.view(0));
  CHECK_THROWS_WITH(Cubemap(3, pixels), "a cubemap of 3 texels takes 162 floats, not 72");
  CHECK_THROWS_WITH(Cubemap(0), Catch::Matchers::Contains("size is 0"));
  CHECK_THROWS_WITH(Cubemap(4, 4), Catch::Matchers::Contains("cannot have 4 levels"));
}

TEST_CASE("Each mip is the mean of the one above over each texel's area", "[mips]") {
  for (const MipFilter filter : kFilters) {
    for (const int size : {1, 2, 3, 5, 7, 12, 26, 27, 52}) {
      const TestCubemap map = make_cubemap(Content::random, size, 4, 3);
      const Cubemap chain = build_mips(map.view(), filter);
      REQUIRE(chain.levels() == full_chain_levels(size));
      for (int level = 1; level < chain.levels(); ++level) {
        const int edge = chain.level_size(level);
        double worst = 0.0;
        for (int texel = 0; texel < 6 * edge * edge; ++texel) {
          const int face = texel / (edge * edge);
          const int row = texel / edge % edge;
          const int column = texel % edge;
          const int channel = texel % 3;
          const float found = chain.face(level, face)[3 * (row * edge + column) + channel];
          worst = std::max(worst, std::abs(static_cast<double>(found) -
                                           value_below(chain, level, face, column, row, channel, filter)));
        }
        CAPTURE(size, level, static_cast<int>(filter));
        CHECK(worst < 2e-7);
      }
    }
  }
}

TEST_CASE("Mips that cannot be are refused", "[mips]") {
  const TestCubemap map = make_cubemap(Content::random, 8, 3, 4);
  CHECK(thrown_by([&] { return build_mips(map.view(), MipFilter::box, 5); }).says("8 texels has 1 to 4"));
  CHECK(thrown_by([&] { return build_mips(map.view(), MipFilter::box, -1); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { return build_mips(CubemapView{}); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([] {
          Cubemap none;
          fill_mips(none, MipFilter::box);
          return 0;
        }).says("no levels"));
}

// Promise: a rotation that maps texels to texels copies every texel bit for bit.

namespace {

Cubemap some_cubemap(int size) { return {size, some_pixels(size, 6 * size)}; }

/// The texel whose centre is there; null if there is none.
const float* texel_at(const Cubemap& map, const glm::dvec3& direction) {
  const std::vector<glm::dvec3> centres = texel_centres(map.size());
  for (std::size_t k = 0; k < centres.size(); ++k) {
    if (glm::dot(direction, centres[k]) > 1.0 - 1e-12) return map.face(0) + 3 * k;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("All 48 symmetries of a cube move texels to where they turn directions", "[resampling]") {
  REQUIRE(cube_symmetries().size() == 48);
  for (const int size : {1, 2, 3}) {
    const Cubemap map = some_cubemap(size);
    for (const glm::dmat3& rotation : cube_symmetries()) {
      const Cubemap rotated = to_cubemap(map.view(), size, rotation);
      const float* texel = map.face(0);
      for (const glm::dvec3& from : texel_centres(size)) {
        const float* const position = texel_at(rotated, rotation * from);
        REQUIRE(position != nullptr);
        REQUIRE(std::equal(position, position + 3, texel));
        texel += 3;
      }
    }
  }
}

TEST_CASE("Lat-longs turn about y by whole texels, and mirror, without a changed bit", "[resampling]") {
  for (const auto& [width, height] : {std::pair{8, 4}, {7, 4}, {64, 33}, {257, 128}, {1, 1}}) {
    const LatLongImage map{width, height, some_pixels(width, height)};
    CAPTURE(width, height);
    CHECK(same_bytes<float>(to_lat_long(map.view(), width, height).pixels, map.pixels));
    for (int shift : {0, 1, 2, width - 1}) {
      for (int mirrors = 0; mirrors < 4; ++mirrors) {
        glm::dmat3 mirror(1.0);
        if ((mirrors & 1) != 0) mirror[0][0] = -1.0;
        if ((mirrors & 2) != 0) mirror[1][1] = -1.0;
        const glm::dmat3 rotation = rotation_about_y(360.0 * shift / width) * mirror;
        const LatLongImage rotated = to_lat_long(map.view(), width, height, rotation);
        int wrong = 0;
        for (int row = 0; row < height; ++row) {
          for (int column = 0; column < width; ++column) {
            // Mirrored in x, then moved to the left by `shift`.
            const int mirrored = (mirrors & 1) != 0 ? width - 1 - column : column;
            const int to_column = ((mirrored - shift) % width + width) % width;
            const int to_row = (mirrors & 2) != 0 ? height - 1 - row : row;
            const float* from = map.pixels.data() + 3 * (row * width + column);
            if (!std::equal(from, from + 3, rotated.pixels.data() + 3 * (to_row * width + to_column))) ++wrong;
          }
        }
        CHECK(wrong == 0);
        REQUIRE(
            same_bytes<float>(to_lat_long(rotated.view(), width, height, glm::transpose(rotation)).pixels, map.pixels));
      }
    }
  }
}

TEST_CASE("Exact turns read every pixel format, and rows from the bottom up", "[resampling]") {
  const TestCubemapHalf half = make_cubemap_half(Content::random, 5, 4, 3);
  const TestCubemap whole = make_cubemap(Content::random, 5, 3, 3);
  const Cubemap of_half = to_cubemap(half.view(), 5, rotation_about_y(90.0));
  const Cubemap of_float = to_cubemap(whole.view(), 5, rotation_about_y(90.0));
  for (std::size_t i = 0; i < of_half.pixels().size(); ++i)
    REQUIRE(of_half.pixels()[i] == as_half(of_float.pixels()[i]));

  LatLongImage map{6, 4, some_pixels(6, 4)};
  LatLongView upside_down = map.view();
  upside_down.pixels = map.pixels.data() + 3 * 6 * 3;
  upside_down.row_stride_bytes = -6 * 12;
  glm::dmat3 flip(1.0);
  flip[1][1] = -1.0;
  CHECK(same_bits(to_lat_long(upside_down, 6, 4), to_lat_long(map.view(), 6, 4, flip)));
}

}  // namespace welkin::test
