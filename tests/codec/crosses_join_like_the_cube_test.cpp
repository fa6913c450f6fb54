// Promises: in each cross, faces that touch in the picture touch on the cube, edge along edge; in every layout each
// face lies once; and OpenEXR's strip is that of its own documentation.
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "codec/face_placement.h"
#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/cube_pictures.h"
#include "support/thrown_error.h"

namespace welkin {
namespace {

const codec::FaceSegment* segment_at(const codec::RowSegments& segments, int size, int column) {
  for (const codec::FaceSegment& segment : segments) {
    if (column >= segment.first_column && column < segment.first_column + size) return &segment;
  }
  return nullptr;
}

// Direction of a texel's centre, or nothing at a blank place.
std::optional<glm::dvec3> direction_at(const codec::CubePlacement& placement, int size, int column, int row) {
  if (column >= placement.columns * size || row >= placement.rows * size) return std::nullopt;
  const codec::RowSegments segments = codec::row_segments(placement, size, row);
  const codec::FaceSegment* segment = segment_at(segments, size, column);
  if (segment == nullptr) return std::nullopt;
  const int offset = column - segment->first_column;
  const int face_column = segment->mirrored ? size - 1 - offset : offset;
  return image::face_direction(size, segment->face, face_column + 0.5, segment->face_row + 0.5);
}

}  // namespace

TEST_CASE("neighbouring texels of a cross are neighbours on the sphere, across faces too", "[codec][layout]") {
  for (const Layout layout : {Layout::horizontal_cross, Layout::vertical_cross}) {
    for (const int size : {1, 2, 7, 16}) {
      CAPTURE(name(layout), size);
      const codec::CubePlacement& placement = codec::cube_placement(layout);
      int joins = 0;
      for (int row = 0; row < placement.rows * size; ++row) {
        for (int column = 0; column < placement.columns * size; ++column) {
          const auto here = direction_at(placement, size, column, row);
          for (const auto& there :
               {direction_at(placement, size, column + 1, row), direction_at(placement, size, column, row + 1)}) {
            if (!here || !there) continue;
            ++joins;
            // Centres of neighbours are at most two texels' edges of 2 / size apart on the cube's surface.
            const double angle = std::acos(std::min(1.0, glm::dot(*here, *there)));
            REQUIRE(angle <= 2.0 * std::atan(1.0 / size) + 1e-9);
          }
        }
      }
      const int inside_faces = 6 * 2 * size * (size - 1);
      CHECK(joins == inside_faces + 5 * size);
    }
  }
}

TEST_CASE("each texel of each face lies once in each layout", "[codec][layout]") {
  for (const Layout layout : test::one_file_cube_layouts()) {
    const int size = 3;
    const codec::CubePlacement& placement = codec::cube_placement(layout);
    std::set<std::tuple<int, int, int>> seen;
    for (int row = 0; row < placement.rows * size; ++row) {
      int column = -1;
      for (const codec::FaceSegment& segment : codec::row_segments(placement, size, row)) {
        CHECK(segment.first_column > column);
        column = segment.first_column + size - 1;
        CHECK(column < placement.columns * size);
        for (int i = 0; i < size; ++i) {
          CHECK(seen.insert({segment.face, segment.face_row, segment.mirrored ? size - 1 - i : i}).second);
        }
      }
    }
    CHECK(seen.size() == 54);
  }
}

TEST_CASE("six files are taken as a strip, a lat-long has no faces", "[codec][layout]") {
  CHECK(&codec::cube_placement(Layout::six_files) == &codec::cube_placement(Layout::vertical_strip));
  const test::ThrownError error = test::thrown_by([] { (void)codec::cube_placement(Layout::lat_long); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.message == "the layout lat-long has no faces; strips, crosses and six files have them");
}

TEST_CASE("a segment copied there and back is as it was", "[codec][layout]") {
  for (const int size : {1, 2, 3, 64}) {
    std::vector<float> texels;
    for (int i = 0; i < 3 * size; ++i) texels.push_back(static_cast<float>(i));
    for (const bool mirrored : {false, true}) {
      std::vector<float> there(texels.size());
      std::vector<float> back(texels.size());
      codec::copy_segment(texels.data(), there.data(), size, mirrored);
      codec::copy_segment(there.data(), back.data(), size, mirrored);
      CHECK(back == texels);
      CHECK(there[0] == (mirrored ? static_cast<float>(3 * size - 3) : 0.0F));
      CHECK(there[1] == there[0] + 1.0F);
    }
  }
}

}  // namespace welkin
