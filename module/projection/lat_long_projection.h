// Weights of a lat-long image's texels: a factor for the column times a factor for the row.
//
// Frame: u = +z, v = +x, normal = +y (up), so that a texel's local direction is
// (cos(lon) cos(lat), sin(lon) cos(lat), sin(lat)) and the harmonics of that frame split into
//
//   Y(l, +-m) = q(l, m)(sin lat) cos^m(lat)  x  cos(m lon) or sin(m lon).
//
// A row needs only its sums over columns with cos(m lon) and sin(m lon), 2 bands - 1 of them; its integrals
// over latitude are multiplied on afterwards, once a row.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "platform/memory.h"
#include "projection/projection_kernels.h"
#include "welkin/projection.h"

namespace welkin::projection {

struct LatLongWeightsKey {
  int width;
  int height;
  int bands;
  bool midpoint;
  int target_size;  ///< of a cubemap face; the image is averaged to 4 x by 2 x this. 0: not reduced

  bool operator==(const LatLongWeightsKey&) const = default;
};

class LatLongWeights {
 public:
  static std::shared_ptr<const LatLongWeights> get(const LatLongWeightsKey& key);

  explicit LatLongWeights(const LatLongWeightsKey& key);

  /// Columns that are read as pairs 180 degrees apart: width / 2, where even orders take their sum and odd
  /// ones their difference. An odd width has no such pairs; then all its columns are read alone.
  [[nodiscard]] int column_count() const noexcept { return column_count_; }
  [[nodiscard]] bool paired() const noexcept { return paired_; }

  [[nodiscard]] int chunk_count() const noexcept { return (column_count_ + kChunk - 1) / kChunk; }
  /// Weights of chunk's columns: [2 bands - 1][kChunk], in class order, padding zero. Row 0 is m = 0.
  [[nodiscard]] const float* chunk_weights(int chunk) const noexcept;
  [[nodiscard]] const ClassCounts& class_counts() const noexcept { return counts_; }

  /// Weights' row of order m: cos(m lon) for m >= 0, sin(|m| lon) for m < 0.
  [[nodiscard]] int weight_row(int m) const noexcept { return weight_rows_[static_cast<std::size_t>(m + bands_ - 1)]; }

  /// The row's factor of Y(l, +-m), at l (l + 1) / 2 + m.
  [[nodiscard]] const double* row_weights(int row) const noexcept;

  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  void fill_columns(const LatLongWeightsKey& key);
  void fill_rows(const LatLongWeightsKey& key);

  int bands_;
  bool paired_;
  int column_count_;
  std::vector<int> weight_rows_;
  ClassCounts counts_{};
  platform::AlignedBuffer<float> columns_;
  std::vector<double> rows_;
};

// Projects a lat-long image whose rows arrive in blocks, in any order and from any thread.

/// One projection of one image. Make it, hand every block in once, then finish.
class LatLongProjector {
 public:
  /// Checks size and options, fetches or builds the tables, and allocates every block's sums and scratch for
  /// `workers` callers of `project_block` at the same time. Throws `Error` (invalid_argument).
  LatLongProjector(int width, int height, const ProjectionOptions& options, std::size_t workers);
  ~LatLongProjector();
  LatLongProjector(const LatLongProjector&) = delete;
  LatLongProjector& operator=(const LatLongProjector&) = delete;

  /// Blocks follow from the image's shape alone: block b holds rows [b rows_per_block, ...), the last
  /// one perhaps fewer. A block has some 32 768 texels.
  [[nodiscard]] int rows_per_block() const noexcept;
  [[nodiscard]] int block_count() const noexcept;

  /// Projects one block. `rows` views just the rows of that block. Different blocks may be handed in at
  /// the same time, each exactly once, by different workers (0 to workers - 1). Allocates nothing, throws
  /// nothing: pixels that a policy rejects are remembered for `finish`.
  void project_block(int block, const LatLongView& rows, std::size_t worker) noexcept;

  /// Adds up the blocks in order. Throws `Error` (rejected_pixel). Call it once, after all blocks. The
  /// diagnostics have no record of passes yet, the caller knows what they were.
  [[nodiscard]] Projection finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace welkin::projection
