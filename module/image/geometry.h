// Where texels lie on the sphere and how much of it they cover.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

namespace welkin::image {

/// Axes of a frame in world coordinates: each +-x, +-y or +-z, all different; either handedness.
struct Frame {
  glm::dvec3 u;
  glm::dvec3 v;
  glm::dvec3 normal;
};

/// Axes of cubemap face 0 to 5, as CubemapView's table has them.
[[nodiscard]] const Frame& face_frame(int face) noexcept;

/// Unit direction of the point (column, row) of a cubemap face with `size` texels along an edge. Texel (i, j) has its
/// centre at (i + 0.5, j + 0.5).
[[nodiscard]] glm::dvec3 face_direction(int size, int face, double column, double row) noexcept;

/// Unit direction of the point (column, row) of a lat-long, counted in the same way. The same bits on every machine.
[[nodiscard]] glm::dvec3 lat_long_direction(int width, int height, double column, double row) noexcept;

/// Steradians of each texel in row `row` of a lat-long of `width` x `height`: all texels of a row are equal.
[[nodiscard]] double lat_long_texel_solid_angle(int width, int height, int row);

/// Returns the steradians of a texel of a cubemap face. Relative error below 1e-11.
[[nodiscard]] double cubemap_texel_solid_angle(int size, int row, int column);

/// Writes the steradians of the texels in row `row` of a cubemap face to `row_angles` (`size` of them, the
/// face's edge).
void cubemap_row_solid_angles(int row, std::span<double> row_angles);

/// The steradians of all texels of a cubemap face, for calls that read many of them: computed once for each size.
/// Relative error below 1e-11.
class FaceSolidAngles {
 public:
  /// A shared table; faces of more than 2048 texels along an edge are computed in each call.
  [[nodiscard]] static std::shared_ptr<const FaceSolidAngles> get(int size);
  explicit FaceSolidAngles(int size);

  [[nodiscard]] double at(int row, int column) const noexcept {
    const int half = (size_ + 1) / 2;
    return quadrant_[static_cast<std::size_t>(std::min(row, size_ - 1 - row) * half +
                                              std::min(column, size_ - 1 - column))];
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return quadrant_.size() * sizeof(double); }

 private:
  int size_;
  std::vector<double> quadrant_;
};

// A cube's texels as points with whole coordinates: where a texel goes when the cube turns, and what lies beyond a
// face's edge, without rounding.

struct CubeTexel {
  int face = 0;
  int column = 0;
  int row = 0;
};

/// The face on which a direction lies: that of its longest component, of equal ones the first of x, y, z.
[[nodiscard]] int face_of(const glm::dvec3& direction) noexcept;

/// A texel's centre in half texels: a cube with `size` texels along an edge reaches from -size to size.
[[nodiscard]] glm::ivec3 point_of(int size, const CubeTexel& texel) noexcept;

/// Returns the texel of that centre. One component, `size` in magnitude, decides the face; the others are smaller.
[[nodiscard]] CubeTexel texel_at(int size, const glm::ivec3& point) noexcept;

/// The texel that shares an edge with the outermost one. Either the column or the row is -1 or `size`, not both.
[[nodiscard]] CubeTexel across_edge(int size, const CubeTexel& outside) noexcept;

// A lat-long or a cubemap as texels on the sphere: one way to walk both.

/// Texels are numbered row after row, of a cubemap face after face (so it has 6 size rows).
class TexelGrid {
 public:
  enum class Kind { lat_long, cubemap };

  [[nodiscard]] static TexelGrid lat_long(int width, int height) noexcept { return {Kind::lat_long, width, height}; }
  [[nodiscard]] static TexelGrid cubemap(int size) noexcept { return {Kind::cubemap, size, 6 * size}; }

  [[nodiscard]] Kind kind() const noexcept { return kind_; }
  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] std::int64_t texels() const noexcept { return std::int64_t{columns_} * rows_; }

  /// Unit direction of a texel's centre.
  [[nodiscard]] glm::dvec3 direction(std::int64_t texel) const noexcept;

  /// The texels that touch a texel at an edge or a corner: across the seam, over the poles (to the columns on the
  /// other side of the pole) and over a cube's edges. Seven at a cube's corner. On tiny images a texel may be
  /// named twice, or be its own neighbour.
  struct Neighbours {
    std::array<std::int64_t, 8> texels{};
    int count = 0;

    void add(std::int64_t texel) noexcept { texels[static_cast<std::size_t>(count++)] = texel; }
    [[nodiscard]] const std::int64_t* begin() const noexcept { return texels.data(); }
    [[nodiscard]] const std::int64_t* end() const noexcept { return texels.data() + count; }
  };
  [[nodiscard]] Neighbours neighbours(std::int64_t texel) const noexcept;

  /// Rows of one class have the same solid angles: each row of a lat-long is a class; of a cubemap rows r and
  /// size - 1 - r of all faces are one.
  [[nodiscard]] int row_classes() const noexcept;
  [[nodiscard]] int class_of(int row) const noexcept;

  /// The rows of a class, in rising order.
  struct Rows {
    std::array<int, 12> rows{};
    int count = 0;

    [[nodiscard]] const int* begin() const noexcept { return rows.data(); }
    [[nodiscard]] const int* end() const noexcept { return rows.data() + count; }
  };
  [[nodiscard]] Rows rows_of(int row_class) const noexcept;

  /// Writes the steradians of the texels of such a row (`columns()` of them).
  void solid_angles(int row_class, std::span<double> steradians) const;

 private:
  TexelGrid(Kind kind, int columns, int rows) noexcept : kind_(kind), columns_(columns), rows_(rows) {}

  [[nodiscard]] std::int64_t on_lat_long(int row, int column) const noexcept;
  [[nodiscard]] std::int64_t on_cubemap(const CubeTexel& texel) const noexcept;

  Kind kind_;
  int columns_;
  int rows_;
};

/// Returns the steradians of some texels, in their order.
[[nodiscard]] std::vector<double> solid_angles_of(const TexelGrid& grid, const std::vector<std::int64_t>& texels);

}  // namespace welkin::image
