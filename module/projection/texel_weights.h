// Weights of a cubemap face's texels in every face-local harmonic.
//
// A face's frame has u and v along columns and rows and the normal as third axis; the harmonics of that
// frame are each even or odd in u and in v. So one quadrant is enough, and all six faces share it. The
// quadrant is cut into chunks: runs of columns of one row, or several whole rows where rows are short.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "image/image_kernels.h"
#include "math/quadrature.h"
#include "platform/memory.h"
#include "projection/projection_kernels.h"
#include "welkin/projection.h"

namespace welkin::projection {

/// The parameters that the weights depend on.
struct TexelWeightsKey {
  int size;  ///< N, texels along a face's edge
  int bands;
  bool midpoint;    ///< see Quadrature
  int target_size;  ///< below N: weights of texels averaged by solid angle into target x target cells; else N

  bool operator==(const TexelWeightsKey&) const = default;
};

/// Returns the key of the weights that projecting faces of `size` needs.
[[nodiscard]] TexelWeightsKey weights_key(int size, const ProjectionOptions& options) noexcept;

/// The Gauss rule for a texel's harmonics. A rule of two points is off by h^4 / 135 times the fourth derivative, which
/// of a harmonic of degree l is at most l^4: with N >= 64 bands below 5e-10 of the harmonic itself, where a float
/// rounds to 6e-8. It has four points for a texel where the one for any harmonic has nine. One of three points is off
/// by h^6 / 15750 times the sixth derivative: from 64 texels and 16 for each band on below 1e-11. Smaller faces have 25
/// points or more, which for nine harmonics are a third of a first projection.
[[nodiscard]] math::GaussRule weights_rule(int size, int bands);

/// Part of a face's top left quadrant; stands for its three mirror images too.
struct QuadrantChunk {
  int first_row;
  int row_count;
  int first_column;
  int column_count;
  int groups_per_row;  ///< of 16 positions; the last one of a row may be padded

  [[nodiscard]] int groups() const noexcept { return row_count * groups_per_row; }
};

class TexelWeights {
 public:
  /// From the cache, or built. Small faces have their weights stored (up to 2 MiB a table); for larger ones
  /// `chunk_weights` computes them, which costs less than reading them from memory would.
  static std::shared_ptr<const TexelWeights> get(const TexelWeightsKey& key);

  explicit TexelWeights(const TexelWeightsKey& key);

  [[nodiscard]] int chunk_count() const noexcept { return chunk_count_; }
  [[nodiscard]] QuadrantChunk chunk(int index) const noexcept;

  /// Weights of a chunk, [bands^2][kChunk] in class order, padding zero. `scratch`: space for
  /// `scratch_size()` floats on a cache line, none if all is stored; what is returned points there or into
  /// the table.
  [[nodiscard]] const float* chunk_weights(int index, float* scratch) const;
  [[nodiscard]] std::size_t scratch_size() const noexcept;

  /// How many functions each symmetry class has.
  [[nodiscard]] const ClassCounts& class_counts() const noexcept { return counts_; }

  /// weight_rows()[l(l+1)+m]: the row of the weights that belongs to Y(l, m). Row 0 is Y(0, 0).
  [[nodiscard]] const std::vector<int>& weight_rows() const noexcept { return weight_rows_; }

  [[nodiscard]] std::size_t bytes() const noexcept {
    return table_.bytes() + sizeof(*this) + (target_ ? target_->bytes() : 0);
  }

  /// Weights of `count` texels of a row, [bands^2][stride] in class order, padding to a multiple of 16 zero.
  void fill_row(int row, int first_column, int count, float* weights, int stride) const;

 private:
  [[nodiscard]] std::size_t fill_scratch_size() const noexcept;
  void fill_chunk(int index, float* weights, float* scratch) const;
  [[nodiscard]] bool expandable() const noexcept;
  void fill_run(const image::TexelRun& run, float* weights, int stride) const;
  void copy_row(int row, int first_column, int count, float* weights, int stride) const;
  void fill_reduced_row(int row, int first_column, int count, float* weights, float* scratch) const;

  TexelWeightsKey key_;
  int half_;  ///< columns and rows of the quadrant, a middle one included
  int groups_per_row_;
  int rows_per_chunk_;
  int chunks_per_row_;
  int chunk_count_;
  ClassCounts counts_{};
  std::vector<int> weight_rows_;
  platform::AlignedBuffer<float> table_;        ///< all chunks' weights, or empty
  std::shared_ptr<const TexelWeights> target_;  ///< of the reduced face, where there is one
};

}  // namespace welkin::projection
