// An environment between its texels.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

/// Bilinear interpolation between texel centres, without seams. NaN and infinities spread to all directions whose
/// four texels include them.
class Sampler {
 public:
  virtual ~Sampler() = default;

  /// Adds `weight` times the radiance from `direction`, which need not be of unit length, to `sum`.
  virtual void add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept = 0;
};

/// Across the poles it goes on in the columns on the other side, half a turn away. In rows whose texels are narrower
/// than the distance of samples, the mean over that distance takes the place of interpolation: samples pass none over.
class LatLongSampler final : public Sampler {
 public:
  /// `spacing`: radians between samples. The view's pixels must outlive the sampler.
  LatLongSampler(const LatLongView& view, double spacing);

  void add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept override;

 private:
  void add_from_row(int row, double column, double weight, glm::dvec3& sum) const noexcept;

  FloatPlane plane_;
  int width_;
  int height_;
  std::vector<double> spans_;  // of each row: columns that a sample stands for, 1 to the width
};

/// Across an edge it goes on in the neighbouring face; at a corner, where three texels meet, their mean is the fourth.
class CubemapSampler final : public Sampler {
 public:
  /// The view's pixels must outlive the sampler.
  explicit CubemapSampler(const CubemapView& view);

  void add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept override;

 private:
  [[nodiscard]] const float* inside(const CubeTexel& texel) const noexcept {
    return planes_[static_cast<std::size_t>(texel.face)].texel(texel.column, texel.row);
  }
  void add_texel(const CubeTexel& texel, double weight, glm::dvec3& sum) const noexcept;

  std::array<FloatPlane, 6> planes_;
  int size_;
};

// Turns that take texels to texels, or rows to rows.

/// The result, if the turn is one of a cube's 48 symmetries: each entry within 1e-9 of 0, 1 or -1.
/// Nothing is interpolated, every texel stays what it is.
[[nodiscard]] std::optional<Cubemap> rotate_exactly(const CubemapView& source, const glm::dmat3& rotation,
                                                    const Control& control);

/// The result, if the turn leaves the axis y in its place or turns it over. Where it moves the columns by whole texels,
/// to 1e-6 texels, every texel stays what it is. (The mirror that exchanges front and back does so if the width is
/// even.) Else each row is resampled along itself and keeps its sum.
[[nodiscard]] std::optional<LatLongImage> moved_along_rows(const LatLongView& source, const glm::dmat3& rotation,
                                                           const Control& control);

// A row of a lat-long that is moved along itself by a fraction of a texel.

/// One channel of a row. Linear interpolation keeps the row's sum and every range, but blurs. Cubic convolution
/// (Catmull-Rom) adds a flux between neighbours, p (a - b) + q (b - c) from texel b to a, which keeps the sum as well.
/// Each flux is limited so that every result stays between the minimum and the maximum of the four texels around its
/// position (S. T. Zalesak, "Fully multidimensional flux-corrected transport algorithms for fluids", 1979). Where a
/// texel is NaN or infinite the interpolation remains linear.
class MovedRow {
 public:
  /// Result i lies `share` of a texel, from 0 to 1, after texel i.
  MovedRow(int width, double share);

  double& texel(int column) noexcept { return texels_[static_cast<std::size_t>(column + kBorder)]; }

  /// Writes the results, `step` floats apart, once all texels are set.
  void write(float* results, int step) noexcept;

 private:
  static constexpr int kBorder = 2;  ///< texels before the first one; as many and one more follow the last

  void wrap() noexcept;
  void interpolate() noexcept;
  void limit() noexcept;

  int width_;
  double share_;
  std::vector<double> texels_;
  // Texel i is at i + kBorder, from -kBorder to the width.
  std::vector<double> linear_;
  std::vector<double> flux_;  ///< into each texel from the next one
  std::vector<double> rise_;  ///< the shares of what flows in
  std::vector<double> fall_;  ///< and out that keep the result within its range
};

}  // namespace welkin::image
