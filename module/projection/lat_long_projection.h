// Projects a lat-long picture whose rows arrive in blocks, in any order and from any thread.
#pragma once

#include <memory>

#include "welkin/projection.h"

namespace welkin::projection {

/// One projection of one picture. Make it, hand every block in once, then finish.
class LatLongProjector {
 public:
  /// Checks size and options, fetches or builds the tables, and makes room for every block's sums and for
  /// `workers` callers of `project_block` at the same time. Throws `Error` (invalid_argument).
  LatLongProjector(int width, int height, const ProjectionOptions& options, std::size_t workers);
  ~LatLongProjector();
  LatLongProjector(const LatLongProjector&) = delete;
  LatLongProjector& operator=(const LatLongProjector&) = delete;

  /// Blocks follow from the picture's shape alone: block b holds rows [b rows_per_block, ...), the last
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
