// A row of cells along a line, with a value each, made smooth between neighbours without moving any of it.
//
// About each edge the value goes linearly from one cell's to the next one's, over a ramp of equal length on both sides;
// so the integral of a cell's share stays the cell's length, and all shares add up to 1. Ramps of no length: cells as
// they are; of a cell's length: linear interpolation between cells' centres, where cells are equal.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "image/area_tiling.h"
#include "platform/memory.h"

namespace welkin::image {

class SoftCells {
 public:
  /// `edges`: rising, one more than there are cells. `half_ramps`: for each edge, at most half a neighbouring cell.
  SoftCells(std::vector<double> edges, std::vector<double> half_ramps);

  [[nodiscard]] int count() const noexcept { return cells_; }

  /// The first cell that has a share beyond `position`, from `guess` on or before.
  [[nodiscard]] int first_beyond(double position, int guess) const noexcept;
  /// The last cell that has a share before `position`.
  [[nodiscard]] int last_before(double position, int guess) const noexcept;

  /// Cells from `first` on, for as many as there are and 16 more beyond the last.
  [[nodiscard]] CellRow from(int first) const noexcept {
    return {edges_.data() + first, half_ramps_.data() + first, inverses_.data() + first};
  }

  /// The integral between two places of the shares of all cells from edge `edge` on; so that of one cell's share is the
  /// difference of two.
  [[nodiscard]] double integral_from_edge(int edge, double from, double to) const noexcept {
    const auto at = static_cast<std::size_t>(std::min(edge, cells_));
    const double half = half_ramps_[at];
    // The share beyond an edge rises from 0 at edge - half to 1 at edge + half: Int up to x is (x - edge + half)^2 /
    // (4 half) on the ramp, and x - edge beyond it, where the first term is `half` and the second x - edge - half.
    const auto up_to = [&](double position) {  // as `weigh_tile` has it
      const double beyond = position - edges_[at];
      const double on_ramp = std::min(std::max(beyond, -half), half) + half;
      return on_ramp * on_ramp * inverses_[at] + std::max(beyond - half, 0.0);
    };
    return up_to(to) - up_to(from);
  }

  /// Calls `use(share)` with the integral between two places of each of `count` cells' shares.
  template <class Use>
  void for_each_share(int first, int count, double from, double to, const Use& use) const {
    double here = integral_from_edge(first, from, to);
    for (int k = 0; k < count; ++k) {
      const double next = integral_from_edge(first + k + 1, from, to);
      use(here - next);
      here = next;
    }
  }

 private:
  int cells_;
  std::vector<double> edges_;
  std::vector<double> half_ramps_;
  std::vector<double> inverses_;  ///< 1 / (4 half_ramps), or 0
};

// How the texels of a lat-long and those of a cube overlap.
//
// Every texel of the lat-long has its share of the sphere, smooth where the cube is finer (SoftCells); every texel of
// the cube is a tile (CubeTiling) over which shares are integrated. Shares add up to 1 everywhere and tiles cover the
// sphere once: so a uniform source stays uniform and each source texel's total radiance arrives, whatever the sizes.
//
// A tile's weights serve all its mirror images and quarter turns: 16 of them, where the lat-long's width divides by
// four. On side faces, but for the line next to +Y, a tile is a rectangle; its weights are products of shares in height
// and shares in longitude, and the latter are the same on all lines.

class TileWeights;

/// Who gets the weights.
class RunSink {
 public:
  RunSink() = default;
  virtual ~RunSink() = default;
  RunSink(const RunSink&) = delete;
  RunSink& operator=(const RunSink&) = delete;

  virtual void take(const WeighedRun& run) = 0;
};

/// One worker's room for the weights of a run of tiles.
class TileScratch {
 public:
  explicit TileScratch(const TileWeights& weights);

 private:
  friend class TileWeights;
  std::vector<float> weights_;
  std::vector<std::int32_t> rows_, columns_;
  std::vector<int> down_count_, across_count_;  ///< what each tile touches
  std::vector<double> areas_, upper_, lower_;
  std::vector<double> down_shares_;
  int line_ = -1;  ///< whose heights `lower_` has
  PolarRow polar_;
};

class TileWeights {
 public:
  /// `soft`: the lat-long's texels get ramps.
  TileWeights(int width, int height, int size, bool soft);

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] int size() const noexcept { return tiling_.size(); }
  [[nodiscard]] const CubeTiling& tiling() const noexcept { return tiling_; }

  /// Lines of tiles of the kinds `side` and `polar` each; the pole's texel is the first polar line if there is one.
  [[nodiscard]] int lines() const noexcept { return tiling_.half(); }
  [[nodiscard]] TileKind kind_of(bool polar, int row) const noexcept;
  /// Tiles of a line.
  [[nodiscard]] int tiles_of(TileKind kind, int row) const noexcept;
  /// No patch has more texels.
  [[nodiscard]] std::size_t largest_patch() const noexcept;

  /// Hands out the weights of a line of tiles, counted from +Y on side faces and from the pole, run after run. Lines
  /// next to each other take less if one scratch has them in rising order.
  void weigh(TileKind kind, int row, TileScratch& scratch, RunSink& sink) const;

  /// What all lines of a side face but the first have in common, for the images of a rest.
  struct SideColumns {
    int groups = 0;  ///< of four columns
    std::vector<std::int32_t> columns;
    std::vector<float> weights;  ///< [half][4 groups]
  };
  [[nodiscard]] const SideColumns& side_columns(int rest) const noexcept {
    return side_columns_[static_cast<std::size_t>(rest)];
  }

 private:
  friend class TileScratch;
  static constexpr int kSpareColumns = 8;  ///< that a patch may be wider than what it needs, twice over

  [[nodiscard]] double half_ramp(double texels) const;
  [[nodiscard]] SoftCells soft_rows() const;
  [[nodiscard]] SoftCells soft_columns(double offset) const;
  [[nodiscard]] SideColumns columns_of_sides(const SoftCells& columns) const;

  void weigh_rectangles(int row, TileScratch& scratch, RunSink& sink) const;
  void weigh_border(TileScratch& scratch, RunSink& sink) const;
  void weigh_polar(int row, TileScratch& scratch, RunSink& sink) const;
  void weigh_pole(TileScratch& scratch, RunSink& sink) const;

  /// What patches of a stretch of tiles need at most: rows, and groups of four columns.
  struct PatchSize {
    int rows = 1;
    int groups = 1;

    friend bool operator==(const PatchSize&, const PatchSize&) = default;
  };
  [[nodiscard]] PatchSize patch_size(const TileScratch& scratch, int first, int end) const noexcept;
  /// How many tiles from `first` on go together, with patches of one size.
  [[nodiscard]] int tiles_together(const TileScratch& scratch, int first, int end, PatchSize& size) const noexcept;

  template <class Sides>
  void weigh_line(WeighedRun run, int count, const Sides& sides, TileScratch& scratch, RunSink& sink) const;

  CubeTiling tiling_;
  int width_;
  int height_;
  bool soft_;
  double columns_per_radian_;
  int reach_;  ///< columns before the place where the distance is 0: an odd number has texels on both sides of it
  SoftCells rows_;
  std::array<bool, 4> needed_{};    ///< whether an image has that rest
  std::vector<SoftCells> columns_;  ///< by rests
  std::vector<SideColumns> side_columns_;
};

// The weights of all tiles of a lat-long and a cube's size, kept for the next time.

/// Which table.
struct TileWeightKey {
  int width;  ///< of the lat-long
  int height;
  int size;  ///< of the cube

  friend bool operator==(const TileWeightKey&, const TileWeightKey&) = default;
};

/// Weights for resampling to a cube. Whoever makes a table fills it, line by line as the lines are drawn, and then
/// shares it: weighing costs a few times as much as drawing, and so is not done ahead of it.
class TileWeightTable {
 public:
  /// The table of an earlier call; null if there is none, or none any more.
  [[nodiscard]] static std::shared_ptr<const TileWeightTable> find(const TileWeightKey& key);
  /// Keeps a table whose lines have all been filled, unless somebody else's is there meanwhile.
  static void keep(const TileWeightKey& key, const std::shared_ptr<const TileWeightTable>& table);

  /// With room for lines to be filled, if they are not more than a table may have: otherwise all are weighed anew each
  /// time.
  explicit TileWeightTable(const TileWeightKey& key);

  [[nodiscard]] const TileWeights& weights() const noexcept { return weights_; }
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Whether no line needs to be weighed any more.
  [[nodiscard]] bool complete() const noexcept;

  /// Weighs a line, hands it out and keeps it. Of different lines in different threads at once.
  void fill(bool polar, int row, TileScratch& scratch, RunSink& sink);
  /// Hands out a line, which is weighed only if it is not kept. `scratch`: may be null if the table is complete.
  void read(bool polar, int row, TileScratch* scratch, RunSink& sink) const;

 private:
  /// Where the weights of a line are, for each of the rests that images have.
  struct Line {
    std::size_t first_float = 0;
    std::size_t first_index = 0;
    std::size_t first_run = 0;
    std::size_t floats = 0;  ///< that there is room for, for each rest
    std::size_t runs = 0;    ///< the same
    bool kept = false;
    std::size_t runs_of[4] = {};  ///< none: no image has that rest
  };
  struct Run {
    int first = 0;
    int count = 0;
    int rows = 0;
    int groups = 0;
    std::size_t float_offset = 0;  ///< within the line's rest
  };
  class Filler;

  [[nodiscard]] std::size_t floats_for(TileKind kind, int row) const noexcept;
  [[nodiscard]] std::size_t line_index(bool polar, int row) const noexcept {
    return static_cast<std::size_t>(polar ? weights_.lines() + row : row);
  }

  TileWeights weights_;
  int rests_;  ///< that images may have
  std::vector<Line> lines_;
  std::vector<Run> runs_;
  platform::AlignedBuffer<float> floats_;
  platform::AlignedBuffer<std::int32_t> indices_;  ///< rows of a line's patches, then columns, for each rest
};

}  // namespace welkin::image
