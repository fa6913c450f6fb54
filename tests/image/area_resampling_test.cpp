// Resampling to a cube by area: all weights are kept and give the same bits again, and sources are read where they lie.
#include "image/area_resampling.h"

#include "image/area_weights.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

std::vector<float> cube_by_area(const LatLongView& source, int size) {
  const std::size_t face = std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  std::vector<float> texels(6 * face);
  std::array<float*, 6> faces{};
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = texels.data() + i * face;
  image::fill_cubemap_by_area(source, size, faces, Control{});
  return texels;
}

}  // namespace

TEST_CASE("All weights of tiles are kept, and give the bits that they gave at first", "[resampling][area]") {
  // Widths that all images share, that pairs share and that none share; rows coarser and finer than texels.
  for (const auto& [width, height] :
       {std::pair{4, 2}, {16, 9}, {61, 30}, {64, 32}, {130, 64}, {257, 128}, {512, 256}}) {
    const LatLongImage source{width, height, some_pixels(width, height)};
    for (const int size : {1, 2, 3, 7, 33, 64, 128, 257}) {
      CAPTURE(width, height, size);
      const std::vector<float> first = cube_by_area(source.view(), size);
      const auto table = image::TileWeightTable::find({width, height, size});
      REQUIRE(table != nullptr);
      CHECK(table->complete());
      REQUIRE(cube_by_area(source.view(), size) == first);
    }
  }
}

TEST_CASE("Rows that are apart, upside down or of another format give the same cube", "[resampling][area]") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {16, 8}, {61, 30}, {130, 64}}) {
    const LatLongImage packed{width, height, some_pixels(width, height)};
    // The rows from the bottom up, with floats after each of them that belong to no texel.
    const std::ptrdiff_t row = std::ptrdiff_t{3} * width;
    const std::ptrdiff_t stride = row + 5;
    std::vector<float> apart(static_cast<std::size_t>(stride * height), std::numeric_limits<float>::quiet_NaN());
    std::vector<float> with_alpha;
    for (std::ptrdiff_t y = 0; y < height; ++y) {
      std::copy_n(packed.pixels.begin() + y * row, row, apart.begin() + (height - 1 - y) * stride);
    }
    for (std::size_t k = 0; k < packed.pixels.size(); ++k) {
      with_alpha.push_back(packed.pixels[k]);
      if (k % 3 == 2) with_alpha.push_back(std::numeric_limits<float>::quiet_NaN());
    }
    LatLongView upside_down = packed.view();
    upside_down.pixels = apart.data() + (height - 1) * stride;
    upside_down.row_stride_bytes = -stride * static_cast<std::ptrdiff_t>(sizeof(float));
    LatLongView rgba = packed.view();
    rgba.pixels = with_alpha.data();
    rgba.format = PixelFormat::rgba32f;
    for (const int size : {1, 2, 3, 7, 64}) {
      CAPTURE(width, height, size);
      const std::vector<float> expected = cube_by_area(packed.view(), size);
      CHECK(cube_by_area(upside_down, size) == expected);
      CHECK(cube_by_area(rgba, size) == expected);
    }
  }
}

}  // namespace welkin::test
