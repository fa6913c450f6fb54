#include "harmonics/octahedral_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <utility>

#include "image/geometry.h"
#include "image/pixels.h"

namespace welkin::octahedral {
namespace {

/// Cells of smaller cubes are cut into so many along a face: a piece's density of solid angle is then nearly straight.
constexpr int kMinCells = 32;

/// A convex polygon: four corners, and at most one more for each of the nine lines that cut it.
template <class Point>
struct Polygon {
  // The lines: three of an octant, two of a face, four of a cell.
  std::array<Point, 16> corners;
  std::size_t count = 0;

  void add(const Point& corner) noexcept { corners[count++] = corner; }
  [[nodiscard]] std::span<const Point> all() const noexcept { return {corners.data(), count}; }
};

/// Writes the parts on either side of the line on which `distance`, linear in the point, is 0.
template <class Point, class Distance>
void split(const Polygon<Point>& from, const Distance& distance, Polygon<Point>& below,
           Polygon<Point>& above) noexcept {
  below.count = above.count = 0;
  if (from.count == 0) return;
  Point last = from.corners[from.count - 1];
  double last_distance = distance(last);
  for (const Point& here : from.all()) {
    const double here_distance = distance(here);
    if ((here_distance < 0.0) != (last_distance < 0.0)) {
      // `distance` is linear on the segment, so it is 0 at the share last / (last - here) of it. (Sutherland and
      // Hodgman 1974, keeping both sides.)
      const Point crossing = last + (here - last) * (last_distance / (last_distance - here_distance));
      below.add(crossing);
      above.add(crossing);
    }
    (here_distance < 0.0 ? below : above).add(here);
    last = here;
    last_distance = here_distance;
  }
}

/// Returns the part where `distance` is not below 0.
template <class Point, class Distance>
void keep(Polygon<Point>& polygon, const Distance& distance) noexcept {
  Polygon<Point> below;
  Polygon<Point> above;
  split(polygon, distance, below, above);
  polygon = above;
}

/// Signs of an octant.
struct Octant {
  double x, y, z;
};

/// A texel's part in an octant, on the octahedron. `low`, `high`: corners of the square from -1 to 1.
Polygon<glm::dvec3> part_in_octant(const glm::dvec2& low, const glm::dvec2& high, const Octant& octant) noexcept {
  Polygon<glm::dvec2> square;
  for (const glm::dvec2& corner : {low, {high.x, low.y}, high, {low.x, high.y}}) square.add(corner);
  keep(square, [&](const glm::dvec2& p) { return octant.x * p.x; });
  keep(square, [&](const glm::dvec2& p) { return octant.y * p.y; });
  // The map (Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014) has
  // z = 1 - |x| - |y|. Where that is below 0, the triangle beyond the square's diagonal is folded over it:
  //   (x, y) becomes (sign x (1 - |y|), sign y (1 - |x|)).
  // Within an octant all of this is linear, so corners stay corners and lines lines.
  keep(square, [&](const glm::dvec2& p) { return octant.z * (1.0 - octant.x * p.x - octant.y * p.y); });
  Polygon<glm::dvec3> part;
  for (const glm::dvec2& p : square.all()) {
    const double across = octant.x * p.x;
    const double down = octant.y * p.y;
    const double z = 1.0 - across - down;
    part.add(octant.z > 0.0 ? glm::dvec3(p, z) : glm::dvec3(octant.x * (1.0 - down), octant.y * (1.0 - across), z));
  }
  return part;
}

/// The part of it on a face of the cube; coordinates in texels, that of the face's first one at (1, 1).
Polygon<glm::dvec2> part_on_face(Polygon<glm::dvec3> part, int face, int size) noexcept {
  const image::Frame& frame = image::face_frame(face);
  for (const glm::dvec3& axis : {frame.u, frame.v}) {
    // |p . axis| is linear here: each axis is +-x, +-y or +-z, whose sign does not change in an octant. The faces that
    // an octant touches are the three towards its signs.
    keep(part, [&](const glm::dvec3& p) { return glm::dot(p, frame.normal) - std::abs(glm::dot(p, axis)); });
  }
  Polygon<glm::dvec2> on_face;
  for (const glm::dvec3& p : part.all()) {
    // u = p . u / p . normal from -1 to 1 is (u + 1) / 2 size texels from the edge; the first texel's centre, half a
    // texel from it, is at 1: 1/2 + (u + 1) / 2 size = middle + u size / 2.
    const double scale = 0.5 * size / glm::dot(p, frame.normal);
    const double middle = 0.5 * (size + 1);
    on_face.add({middle + scale * glm::dot(p, frame.u), middle + scale * glm::dot(p, frame.v)});
  }
  return on_face;
}

}  // namespace

RingedCube::RingedCube(const CubemapView& view)
    : size_(view.size), pixels_(std::size_t{18} * static_cast<std::size_t>((size_ + 2) * (size_ + 2))) {
  const auto at = [this](int face, int column, int row) { return pixels_.data() + start(face, column, row); };
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size_; ++row)
      image::decode_texels(view.format, image::row_of(view, face, row), size_, at(face, 1, row + 1));
  }
  const auto across = [&](int face, int column, int row) {
    const image::CubeTexel from = image::across_edge(size_, {face, column, row});
    std::copy_n(at(from.face, from.column + 1, from.row + 1), 3, at(face, column + 1, row + 1));
  };
  for (int face = 0; face < 6; ++face) {
    for (const int edge : {-1, size_}) {
      for (int k = 0; k < size_; ++k) {
        across(face, k, edge);
        across(face, edge, k);
      }
    }
    // Three faces meet at a cube's corner: bilinear interpolation has no fourth texel there. The mean of the three is
    // the same value from all three faces.
    const int last = size_ + 1;
    for (const auto& [column, row] : {std::pair{0, 0}, {last, 0}, {0, last}, {last, last}}) {
      const int inner_column = std::clamp(column, 1, size_);
      const int inner_row = std::clamp(row, 1, size_);
      for (int c = 0; c < 3; ++c) {
        const double sum = static_cast<double>(at(face, inner_column, inner_row)[c]) +
                           static_cast<double>(at(face, column, inner_row)[c]) +
                           static_cast<double>(at(face, inner_column, row)[c]);
        at(face, column, row)[c] = static_cast<float>(sum / 3.0);
      }
    }
  }
}

TexelOverlap::TexelOverlap(int inner, int size) noexcept
    : inner_(inner), size_(size), parts_((kMinCells + size - 1) / size) {}

void TexelOverlap::find(int a, int b) {
  patches_.clear();
  weights_.clear();
  const glm::dvec2 low(static_cast<double>(a - 1) / inner_, static_cast<double>(b - 1) / inner_);
  const glm::dvec2 high(static_cast<double>(a + 1) / inner_, static_cast<double>(b + 1) / inner_);
  for (int number = 0; number < 8; ++number) {
    const Octant octant{number % 2 == 0 ? 1.0 : -1.0, number / 2 % 2 == 0 ? 1.0 : -1.0, number < 4 ? 1.0 : -1.0};
    // The square lies wholly on the other side of x = 0.
    if (std::max(octant.x * low.x, octant.x * high.x) <= 0.0) continue;
    if (std::max(octant.y * low.y, octant.y * high.y) <= 0.0) continue;
    const Polygon<glm::dvec3> part = part_in_octant(low, high, octant);
    if (part.count < 3) continue;
    for (const int face : {octant.x > 0.0 ? 0 : 1, octant.y > 0.0 ? 2 : 3, octant.z > 0.0 ? 4 : 5}) {
      const Polygon<glm::dvec2> on_face = part_on_face(part, face, size_);
      if (on_face.count >= 3) add_face(face, on_face.all());
    }
  }
}

void TexelOverlap::add_face(int face, std::span<const glm::dvec2> corners) {
  const auto part_of = [this](double position) {
    return std::clamp(static_cast<int>(position * parts_), 0, (size_ + 1) * parts_ - 1);
  };
  Polygon<glm::dvec2> rest;
  glm::dvec2 low = corners.front();
  glm::dvec2 high = low;
  for (const glm::dvec2& corner : corners) {
    rest.add(corner);
    low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
    high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
  }
  const int first_column = part_of(low.x);
  const int last_column = part_of(high.x);
  const int first_row = part_of(low.y);
  const int last_row = part_of(high.y);
  const Patch patch{face,
                    first_column / parts_,
                    first_row / parts_,
                    last_column / parts_ - first_column / parts_ + 2,
                    last_row / parts_ - first_row / parts_ + 2,
                    weights_.size()};
  patches_.push_back(patch);
  weights_.resize(weights_.size() + static_cast<std::size_t>(patch.columns) * static_cast<std::size_t>(patch.rows));
  Polygon<glm::dvec2> band;
  Polygon<glm::dvec2> beyond;
  Polygon<glm::dvec2> piece;
  Polygon<glm::dvec2> right;
  // First into rows of cells, and each of these into cells, with what lies beyond an edge kept for the next cut.
  for (int row = first_row; row <= last_row; ++row) {
    const double lower_edge = static_cast<double>(row + 1) / parts_;
    split(
        rest, [&](const glm::dvec2& p) { return p.y - lower_edge; }, band, beyond);
    std::swap(rest, beyond);
    for (int column = first_column; column <= last_column && band.count > 0; ++column) {
      const double right_edge = static_cast<double>(column + 1) / parts_;
      split(
          band, [&](const glm::dvec2& p) { return p.x - right_edge; }, piece, right);
      std::swap(band, right);
      if (piece.count >= 3) add_piece(piece.all(), patch, column / parts_, row / parts_);
    }
  }
}

void TexelOverlap::add_piece(std::span<const glm::dvec2> corners, const Patch& patch, int column, int row) {
  const double scale = 2.0 / size_;
  double whole = 0.0;
  double across = 0.0;
  double down = 0.0;
  double both = 0.0;
  const auto add = [&](const glm::dvec2& position, double area) {
    const double u = scale * (position.x - 0.5) - 1.0;
    const double v = scale * (position.y - 0.5) - 1.0;
    const double square = 1.0 + u * u + v * v;
    // dw = du dv / r^3. `area` is twice a triangle's, in texels; such factors are common to all weights and drop out
    // when these are divided by their sum.
    const double angle = area / (square * std::sqrt(square));
    const double s = position.x - column;
    const double t = position.y - row;
    whole += angle;
    across += angle * s;
    down += angle * t;
    both += angle * s * t;
  };
  // The mean of the values at the middles of a triangle's sides, times the area, is exact for quadratic functions, and
  // s t, the highest term of bilinear interpolation, is quadratic: only r^-3 is approximated, over 1 / 32 of a face or
  // less.
  const glm::dvec2& first = corners[0];
  for (std::size_t k = 2; k < corners.size(); ++k) {  // triangles, each by the middles of its sides
    const glm::dvec2& second = corners[k - 1];
    const glm::dvec2& third = corners[k];
    const glm::dvec2 one = second - first;
    const glm::dvec2 other = third - first;
    const double area = std::abs(one.x * other.y - one.y * other.x);
    add(0.5 * (first + second), area);
    add(0.5 * (first + third), area);
    add(0.5 * (second + third), area);
  }
  double* const weights = weights_.data() + patch.first + (row - patch.row) * patch.columns + (column - patch.column);
  // Int (1 - s) (1 - t), Int s (1 - t), Int (1 - s) t and Int s t.
  weights[0] += whole - across - down + both;
  weights[1] += across - both;
  weights[patch.columns] += down - both;
  weights[patch.columns + 1] += both;
}

}  // namespace welkin::octahedral
