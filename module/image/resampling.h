// An environment between its texels.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "image/geometry.h"
#include "image/pixels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

/// Bilinear interpolation between texel centres, without seams. NaN and infinities spread to all directions whose
/// four texels include them.
/// Across an edge it goes on in the neighbouring face; at a corner, where three texels meet, their mean is the fourth.
class CubemapSampler {
 public:
  /// The view's pixels must outlive the sampler.
  explicit CubemapSampler(const CubemapView& view);

  /// Adds `weight` times the radiance from `direction`, which need not be of unit length, to `sum`.
  void add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept;

 private:
  [[nodiscard]] const float* inside(const CubeTexel& texel) const noexcept {
    return planes_[static_cast<std::size_t>(texel.face)].texel(texel.column, texel.row);
  }
  void add_texel(const CubeTexel& texel, double weight, glm::dvec3& sum) const noexcept;

  std::array<FloatPlane, 6> planes_;
  int size_;
};

// Rotations that take texels to texels, or rows to rows.

/// The result, if the rotation is one of a cube's 48 symmetries: each entry within 1e-9 of 0, 1 or -1.
/// Nothing is interpolated, every texel stays what it is.
[[nodiscard]] std::optional<Cubemap> rotate_exactly(const CubemapView& source, const glm::dmat3& rotation,
                                                    const Control& control);

/// The result, if the rotation keeps the axis y or reverses it. Where it moves the columns by whole texels,
/// to 1e-6 texels, every texel stays what it is. (The mirror that exchanges front and back does so if the width is
/// even.) Else each row is resampled along itself and keeps its sum.
[[nodiscard]] std::optional<LatLongImage> moved_along_rows(const LatLongView& source, const glm::dmat3& rotation,
                                                           const Control& control);

}  // namespace welkin::image
