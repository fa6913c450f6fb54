// A picture's texels as direct cosine integration needs them: their first moments, and what the horizon leaves of them.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "welkin/image.h"

namespace welkin::projection {

/// Int d dw over each texel of a row: the dot product with a normal is the texel's cosine integral, where all of the
/// texel is above the horizon.
struct MomentRow {
  std::vector<double> x, y, z;
  std::vector<double> horizon;  ///< a texel with |normal . moment| above this lies on one side of the horizon
};

/// Where the texels of a picture are.
class CosineTexels {
 public:
  virtual ~CosineTexels() = default;

  [[nodiscard]] virtual int rows() const noexcept = 0;
  [[nodiscard]] virtual int columns() const noexcept = 0;

  /// Fills `moments`, whose vectors have `columns()` entries.
  virtual void fill(int row, MomentRow& moments) const = 0;

  /// Int max(0, normal . d) dw over a texel that the horizon may cut, by cells.
  [[nodiscard]] virtual double clipped(int row, int column, const glm::dvec3& normal) const noexcept = 0;
};

/// Texels of a lat-long.
[[nodiscard]] std::unique_ptr<CosineTexels> cosine_texels_of_lat_long(int width, int height);

/// Texels of a cubemap, the faces' rows one after the other.
[[nodiscard]] std::unique_ptr<CosineTexels> cosine_texels_of_cubemap(int size);

// Directions that cover the sphere evenly.

/// Points of equal area on a Fibonacci spiral: equal steps in height, each turned by the golden angle from the one
/// before. The same bits on every machine. Throws `Error` (invalid_argument) unless 1 <= count <= 100 000.
[[nodiscard]] std::vector<glm::dvec3> spiral(int count);

}  // namespace welkin::projection
