// Promise: a cube's symmetries take texels to texels, each its own way and back.
#include "image/cube_symmetry.h"

#include <set>
#include <tuple>

#include "image/geometry.h"
#include "support/catch.h"

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
  glm::dmat3 turn(0.0);
  turn[0][1] = 1.0;
  turn[1][0] = -1.0;
  turn[2][2] = 1.0 - 0.9e-9;
  REQUIRE(image::cube_symmetry_of(turn));
  CHECK((*image::cube_symmetry_of(turn))[1][0] == -1);
  turn[2][2] = 1.0 - 1.1e-9;
  CHECK_FALSE(image::cube_symmetry_of(turn));
}

}  // namespace welkin::test
