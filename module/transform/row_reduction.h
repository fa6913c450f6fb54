// Rows far finer than the bands need, brought to few rows and columns before the transform.
//
// The transform (spectrum.cpp) sums steps between rows times g(theta) = sin^2(theta) P(l, m), l < bands, at the edges
// where they lie. Along a meridian, and on beyond the poles, g is a trigonometric polynomial of degree l + 2: between
// coarse edges, twice as many as there are bands, interpolation through six of them gives it, so that each fine edge's
// step may as well be given to six coarse edges in the interpolation's shares. The harmonics then err by
//   0.005 x^5 max(1, x) of degree l, x = (l + 2) h, h = pi / rows the distance between coarse edges,
// where two coarse rows a band make 0.08 of the last one, 0.0015 half way there, 5e-5 at a quarter. (The sixth power is
// the interpolation's own; below x = 1 the fifth was found by measuring, and is what the test allows.) Beyond a pole
// g(-theta) = (-1)^m g(theta), as if the step lay at 180 degrees.
//
// The integrals begin with those of P(m, m), which start at either pole and so make a step at the equator; what fine
// edges give across it is set right in the sum of the two rows next to the equator, with which they begin too.
//
// Columns are halved as long as four a band are left, each time through the filter (1, 5, 10, 10, 5, 1) / 32. It
// multiplies order m by cos(pi m / width)^5, which is undone exactly; what it mixes in are orders of at least width / 2
// - m times tan(pi m / width)^5: of the last band 0.01, half way there 3e-4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "platform/memory.h"
#include "transform/image_rows.h"
#include "transform/reduction_kernels.h"
#include "transform/transform_kernels.h"
#include "welkin/core.h"

namespace welkin::transforms {

struct ReducedShape {
  int rows = 0;  ///< 0: nothing is to be gained
  int columns = 0;
  int halvings = 0;  ///< of columns

  friend bool operator==(const ReducedShape&, const ReducedShape&) = default;
};

[[nodiscard]] ReducedShape reduced_shape(int width, int height, int bands) noexcept;

/// Returns the factor of order m by the columns' filters, which keep the sum of all columns.
[[nodiscard]] double column_response(int width, int halvings, int order) noexcept;

class ReducedRows {
 public:
  /// The rows' pixels outlive this. `shape` is that of `reduced_shape` with some rows.
  ReducedRows(ImageRows source, const ReducedShape& shape);

  /// Reads the source, rows between tiles more than once.
  void fill(const Control& control);

  /// The steps at 16 pairs of coarse edges, as the analysis of so many rows wants them.
  [[nodiscard]] RowQuads quads(int group) const noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept { return rows_.bytes(); }

  /// Returns an upper bound on their bytes, including the rows' shares and the scratch memory of `workers`; 0 if
  /// reduction does not pay.
  [[nodiscard]] static std::size_t most_bytes(int width, int height, int bands, std::size_t workers) noexcept;

 private:
  struct Scratch;
  struct Strip;

  [[nodiscard]] float* row(int index) noexcept { return rows_.data() + static_cast<std::size_t>(index) * row_floats_; }
  [[nodiscard]] const float* row(int index) const noexcept {
    return rows_.data() + static_cast<std::size_t>(index) * row_floats_;
  }
  // After the steps at coarse edges 1 to rows - 1, half of it at the equator:
  [[nodiscard]] int row_of_half_sum() const noexcept { return shape_.rows - 1; }
  [[nodiscard]] int row_of_negated_step() const noexcept { return shape_.rows; }  ///< the equator's half step
  [[nodiscard]] int row_of_zeros() const noexcept { return shape_.rows + 1; }

  void find_shares();
  void add_interval(int interval, const float* shares, const Strip& strip, bool rotated, float* const* sums) noexcept;
  void add_beyond_pole(int edge, const Strip& strip, Scratch& scratch) noexcept;
  void sum_steps(int first_edge, int end_edge, const Strip& strip, Scratch& scratch) noexcept;
  void sum_equator(const Strip& strip, Scratch& scratch) noexcept;
  void finish(float* sums, const Strip& strip, int to) noexcept;

  ImageRows source_;
  ReducedShape shape_;
  const ReductionKernels& kernels_;
  std::size_t row_floats_;
  std::vector<int> first_edges_;  ///< of the interval from each coarse edge to the next, in fine edges
  std::vector<float> shares_;     ///< [fine edge][kStepShares]: what the coarse edges around it get
  std::vector<float> beyond_;     ///< the same: what edges 1 and 2 from a pole get from beyond it, then nothing
  std::vector<float> across_;     ///< the same: what the half sum at the equator gets, then nothing
  platform::AlignedBuffer<float> rows_;
};

}  // namespace welkin::transforms
