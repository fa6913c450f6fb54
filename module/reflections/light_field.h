// Light over a square of a cubemap's face that is far from its sources: given at few points, interpolated between them.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

#include "image/geometry.h"

namespace welkin::reflections {

/// Returns where the centre of a texel lies along a face, from -1 to 1.
[[nodiscard]] constexpr double place_on_face(double texel, int size) noexcept {
  return (2.0 * texel + 1.0) / size - 1.0;
}

/// Texels [column, end_column) x [row, end_row) of a face of `size`.
struct FaceArea {
  int face;
  int size;
  int column;
  int row;
  int end_column;
  int end_row;

  [[nodiscard]] constexpr int across() const noexcept { return end_column - column; }
  [[nodiscard]] constexpr int down() const noexcept { return end_row - row; }
  /// Returns the unit direction of a point of the face, in texels.
  [[nodiscard]] glm::dvec3 direction(double texel_column, double texel_row) const noexcept {
    return image::face_direction(size, face, texel_column, texel_row);
  }
};

/// Cubics in u times cubics in v, by their values at 4 x 4 products of Chebyshev's points.
class LightField {
 public:
  static constexpr int kEdge = 4;
  static constexpr int kPoints = kEdge * kEdge;
  static constexpr int kMaxEdge = 8;    ///< texels of an area that `write` takes
  static constexpr int kMaxWidth = 64;  ///< columns of an area that `add_to` takes

  /// Returns where point k is, along one axis, of an area's texels [first, end).
  [[nodiscard]] static double point(int first, int end, int size, std::size_t k) noexcept;

  [[nodiscard]] bool dark() const noexcept { return dark_; }
  /// [channel][row][column], to be added to.
  [[nodiscard]] std::array<float, 3 * kPoints>& lit() noexcept {
    dark_ = false;
    return values_;
  }

  /// Returns this field at the points of a part of its area.
  [[nodiscard]] LightField within(const FaceArea& area, const FaceArea& part) const;

  /// Writes its values at the centres of the area's texels, row by row, to sums[3][count].
  void write(const FaceArea& area, int count, float* sums) const;

  /// Adds them times `scale` to the area's texels in a face, packed RGB.
  void add_to(const FaceArea& area, float scale, float* rgb) const;

 private:
  template <std::size_t Points>
  using Shares = std::array<std::array<float, Points>, kEdge>;

  template <std::size_t Points>
  void interpolate(const Shares<Points>& down, const Shares<Points>& across, float* to) const;

  std::array<float, 3 * kPoints> values_{};
  bool dark_ = true;
};

}  // namespace welkin::reflections
