// Promises: neighbours are those that touch on the sphere, over every seam, edge and corner; both ways.
#include "image/texel_grid.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>
#include <vector>

#include "support/catch.h"
#include "support/sun_maps.h"

namespace welkin::test {
namespace {

std::set<std::int64_t> neighbour_set(const image::TexelGrid& grid, std::int64_t texel) {
  const auto neighbours = grid.neighbours(texel);
  return {neighbours.begin(), neighbours.end()};
}

void check_mutual(const image::TexelGrid& grid) {
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    for (const std::int64_t neighbour : grid.neighbours(texel)) {
      REQUIRE(neighbour >= 0);
      REQUIRE(neighbour < grid.texels());
      REQUIRE(neighbour_set(grid, neighbour).count(texel) == 1);
    }
  }
}

}  // namespace

TEST_CASE("Neighbours are mutual", "[image][sun]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    check_mutual(image::TexelGrid::cubemap(size));
    check_mutual(image::TexelGrid::lat_long(2 * size, size));
  }
  check_mutual(image::TexelGrid::lat_long(1, 1));
  check_mutual(image::TexelGrid::lat_long(8, 1));
}

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

}  // namespace welkin::test
