// What the moments of a strip weigh in each harmonic.
#pragma once

#include <cstddef>
#include <memory>

#include "projection/strip_kernels.h"

namespace welkin::projection {

/// For three bands. A strip's moments stand for the weights of its rows, which between 16 of them are a polynomial in
/// the row: of as low a degree as leaves 2e-8 of a texel's solid angle in double. Measured at all texels of a face:
/// 2e-8 with 4 moments at 1024, 5e-9 with 5 at 512, 7e-9 with 6 at 256. In floats a texel's weight is off by up to 6e-7
/// (docs/maths/projection.md).
class StripWeights {
 public:
  /// Whether faces of this size are cut into strips.
  [[nodiscard]] static bool serve(int size) noexcept;
  [[nodiscard]] static int moments_for(int size) noexcept;

  /// `weight_rows`: as `TexelWeights::weight_rows`; it must stay. The weights of faces of 256 texels are looked up, or
  /// all computed here if they are used for the first time.
  StripWeights(int size, bool midpoint, const int* weight_rows);

  [[nodiscard]] int moments() const noexcept { return matrix_.moments; }

  /// How many floats `fill` writes, and how many it needs besides, for a number of positions.
  [[nodiscard]] std::size_t size(int positions) const noexcept;
  [[nodiscard]] std::size_t scratch_size(int positions) const noexcept;

  /// The weights of `positions` positions (a multiple of 16) from a column on, as `WeighMoments` says.
  void fill(int strip, int first_column, int positions, float* weights, float* scratch) const noexcept;

  /// The same weights where they are kept, or else filled into `room`, which has `room_size` floats.
  [[nodiscard]] const float* at(int strip, int first_column, int positions, float* room, float* scratch) const noexcept;
  [[nodiscard]] std::size_t room_size(int positions) const noexcept { return kept_ ? 0 : size(positions); }

 private:
  class Kept;
  [[nodiscard]] std::shared_ptr<const Kept> compute_all() const;

  int size_;
  bool midpoint_;
  const int* weight_rows_;
  MomentsFromRows matrix_{};
  double rows_[kMostMoments] = {};    ///< where weights are computed, from the strip's middle
  std::shared_ptr<const Kept> kept_;  ///< all of a face's weights, or null
};

}  // namespace welkin::projection
