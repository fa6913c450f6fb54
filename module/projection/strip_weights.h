// Weights of a strip's moments in each harmonic.
#pragma once

#include <cstddef>

#include "image/image_kernels.h"
#include "math/quadrature.h"
#include "projection/strip_kernels.h"

namespace welkin::projection {

/// For three bands or more. A strip's moments stand for the weights of its rows, which between 16 of them are a
/// polynomial in the row: of as low a degree as leaves 5e-8 of a texel's solid angle in double. Measured at all texels
/// of a face for three bands: 2e-8 with 4 moments at 1024, 5e-9 with 5 at 512, 7e-9 with 6 at 256. In floats a texel's
/// weight is off by up to 6e-7 (docs/maths/projection.md).
class StripWeights {
 public:
  /// Whether faces of this size are cut into strips.
  [[nodiscard]] static bool serve(int size, int bands) noexcept;
  /// How many moments that takes; more than kMaxMoments if none of those numbers are enough.
  [[nodiscard]] static int moments_for(int size, int bands) noexcept;

  /// `weight_rows`: as `TexelWeights::weight_rows`; it must stay.
  StripWeights(int size, int bands, bool midpoint, const int* weight_rows);

  [[nodiscard]] int moments() const noexcept { return matrix_.moments; }
  /// Whether the weights are those of `SumStrips`; else `weighted_sums` reads them, moment by moment.
  [[nodiscard]] bool packed() const noexcept { return bands_ == kStripBands; }

  /// How many floats `fill` writes, and how many more it needs, for a number of columns.
  [[nodiscard]] std::size_t size(int columns) const noexcept;
  [[nodiscard]] std::size_t scratch_size(int columns) const noexcept;

  /// The weights of `columns` columns (a multiple of 16) from one on, left of the face's middle.
  void fill(int strip, int first_column, int columns, float* weights, float* scratch) const noexcept;

 private:
  [[nodiscard]] int functions() const noexcept { return bands_ * bands_; }
  void fill_row(const image::TexelRun& run, float* weights) const noexcept;

  int size_;
  int bands_;
  bool midpoint_;
  const int* weight_rows_;
  math::GaussRule rule_;  ///< over a texel's columns
  MomentsFromRows matrix_{};
  double rows_[kMaxMoments] = {};  ///< where weights are computed, from the strip's middle
};

}  // namespace welkin::projection
