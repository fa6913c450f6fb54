// Weights for resampling to a cube: all of them are kept, and give the same bits again.

#include "image/area_weights.h"

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "image/area_resampling.h"
#include "support/catch.h"
#include "support/exr_files.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

std::vector<float> cube_by_area(const LatLongImage& source, int size) {
  const std::size_t face = std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  std::vector<float> texels(6 * face);
  std::array<float*, 6> faces{};
  for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = texels.data() + i * face;
  image::fill_cubemap_by_area(source.view(), size, faces, Control{});
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
      const std::vector<float> first = cube_by_area(source, size);
      const auto table = image::TileWeightTable::find({width, height, size});
      REQUIRE(table != nullptr);
      CHECK(table->complete());
      REQUIRE(cube_by_area(source, size) == first);
    }
  }
}

}  // namespace welkin::test
