// How the texels of an octahedral map and those of a cubemap overlap.
//
// An octant of the octahedron is a plane, and so is a face of the cube: the edges of both maps' texels lie on great
// circles, which are straight lines in either plane. So a texel of the map is a few convex polygons on the cube's
// faces, which are cut along the lines between the centres of the cube's texels. Within such a cell bilinear
// interpolation is a product of two straight lines, and its integral over the piece by solid angle gives the weights of
// the cell's four texels.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "welkin/image.h"

namespace welkin::octahedral {

/// A level of a cubemap in which each face has a ring of its neighbours' texels for bilinear interpolation. A corner of
/// the ring, where there is no texel, holds the mean of the three that meet there.
class RingedCube {
 public:
  explicit RingedCube(const CubemapView& view);

  /// Texels along an edge, without the ring.
  [[nodiscard]] int size() const noexcept { return size_; }
  /// Column and row are counted from 0 in the ring.
  [[nodiscard]] const float* texel(int face, int column, int row) const noexcept {
    return pixels_.data() + start(face, column, row);
  }

 private:
  [[nodiscard]] std::size_t start(int face, int column, int row) const noexcept {
    const auto edge = static_cast<std::size_t>(size_) + 2;
    return 3 * ((static_cast<std::size_t>(face) * edge + static_cast<std::size_t>(row)) * edge +
                static_cast<std::size_t>(column));
  }

  int size_;
  std::vector<float> pixels_;
};

/// A rectangle of a face's texels, whose weights are stored row by row from `first` on. Column and row count from 0 in
/// the ring.
struct Patch {
  int face;
  int column, row;
  int columns, rows;
  std::size_t first;
};

/// The weights of one texel of a map with `inner` texels along an edge, for cubes of `size`. Keeps its memory from one
/// texel to the next.
class TexelOverlap {
 public:
  TexelOverlap(int inner, int size) noexcept;

  /// Computes the weights of the map's texel whose centre is (a, b) in half texels from the middle. Their sum is
  /// proportional to its solid angle.
  void find(int a, int b);

  [[nodiscard]] const std::vector<Patch>& patches() const noexcept { return patches_; }
  [[nodiscard]] const double* weights(const Patch& patch) const noexcept { return weights_.data() + patch.first; }

 private:
  void add_face(int face, std::span<const glm::dvec2> corners);
  void add_piece(std::span<const glm::dvec2> corners, const Patch& patch, int column, int row);

  int inner_;
  int size_;
  int parts_;  ///< of a cell, along each edge
  std::vector<Patch> patches_;
  std::vector<double> weights_;
};

}  // namespace welkin::octahedral
