// Area that the texels of a lat-long and those of a cube have in common: tiles, shares and weights.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "image/image_kernels.h"
#include "platform/memory.h"

namespace welkin::image {

// A cube's texels as tiles of the plane of longitude and sine of latitude, where areas are solid angles.
//
// Edges of tiles run along longitudes and latitudes only, in steps: an edge of a texel that leads rather along a
// latitude goes, from the longitude of its one end to that of the other, at its own mean height; one that leads rather
// along a longitude, from the height of its one end to that of the other, at its own mean longitude; and both ends stay
// where they are. (On the faces +-Y and at their borders in two such steps each: at the diagonals tiles' edges differ
// in kind.) So neighbours share the edge still, tiles cover the sphere without gap or overlap, and each has its texel's
// solid angle exactly. On the four side faces, whose columns are bounded by longitudes, a tile is a rectangle.
//
// It suffices to look at the faces +X or the like, from the middle to the right and upwards, and of +Y at the eighth
// 0 <= u <= v: all else is mirrored or turned. Heights are -y, which rises with the rows of a lat-long.

class CubeTiling {
 public:
  explicit CubeTiling(int size);

  [[nodiscard]] int size() const noexcept { return size_; }
  /// Texels from the middle of a face on, the middle one included.
  [[nodiscard]] int half() const noexcept { return half_; }

  /// Where texel `index`, counted from the middle, begins: below 0 only for the middle one of an odd number.
  [[nodiscard]] double edge(int index) const noexcept { return static_cast<double>(2 * index - size_ % 2) / size_; }
  /// The longitude of that on a side face.
  [[nodiscard]] double longitude(int index) const noexcept { return longitudes_[static_cast<std::size_t>(index)]; }

  /// Side faces: the mean heights of line `line` (from the top, 0 to half()) over each column, half() of them.
  void side_heights(int line, double* heights) const noexcept;

  /// A column's stretch of the border between a side face and +Y, in two steps.
  struct Border {
    double middle;  ///< longitude
    double first_height;
    double second_height;
  };
  [[nodiscard]] Border border(int column) const noexcept;

 private:
  int size_;
  int half_;
  std::vector<double> longitudes_;
};

/// Row after row of the eighth of +Y, from the pole outwards.
class PolarRow {
 public:
  explicit PolarRow(const CubeTiling& tiling);

  /// Texels (column, row), column <= row, in the first row's case (0, 0). Rows must be placed in rising order from any
  /// one on.
  void place(int row);

  /// The sides of a tile, at most `TileRun::kMaxSides`, whose sum of longitude (to - from) is its solid angle; how
  /// many there are. Not for the middle texel of an odd number, which has no boundary in longitude.
  int sides(int column, TileSide* sides) const noexcept;

  /// The height of the line beyond the row over a column: the middle texel's tile is what lies above that of column 0.
  [[nodiscard]] double outer_height(int column) const noexcept {
    const auto k = static_cast<std::size_t>(column);
    return 0.5 * (outer_.first_heights[k] + outer_.second_heights[k]);
  }

 private:
  /// The points of a line of constant v with the columns' edges and middles, and the mean heights between.
  struct Line {
    std::vector<double> longitudes;
    std::vector<double> point_heights;
    std::vector<double> middles;  ///< longitudes
    std::vector<double> first_heights;
    std::vector<double> second_heights;
  };

  /// The part of a column's edge that lies in the row, in two halves.
  struct Upright {
    double inner_longitude;
    double outer_longitude;
    double middle_height;
  };

  void fill_line(int index, Line& line) const noexcept;

  const CubeTiling& tiling_;
  int row_ = -2;
  Line inner_;
  Line outer_;
  /// An end of a column's edge in a row: y, and the integral of longitude over y up to there.
  struct End {
    double y;
    double integral;
  };

  std::vector<Upright> uprights_;  ///< of the columns' edges
  std::vector<End> outer_ends_;    ///< at the row's outer line
};

// Where on a cube the mirror images and quarter turns of a tile lie: all of them have the same weights.

/// From a distance in longitude, in columns, to a column: quarter / 4 of the width plus or minus the distance.
struct TileImage {
  int face;
  int quarter;    ///< where the distance is counted from, in quarters of the width
  bool mirrored;  ///< columns fall with the distance
  bool below;     ///< rows from the bottom up
  bool right;     ///< the texel's position on the face: u > 0
  bool lower;     ///< v > 0
  bool swapped;   ///< u and v exchanged
};

/// How far the position that an image's distances are counted from lies beyond a column's edge, against the way its
/// columns count, in quarters of a column.
[[nodiscard]] int rest_of(const TileImage& image, int width) noexcept;

/// The parts of the cube whose tiles have weights of their own, and those tiles' images.
enum class TileKind {
  side,   ///< on +X or the like, from the middle to the right and upwards
  polar,  ///< on +Y, 0 <= u <= v
  pole,   ///< the texel around the pole where the number of texels is odd
};
[[nodiscard]] std::span<const TileImage> images_of(TileKind kind) noexcept;

/// The weights of a run of tiles. `patches` lacks what depends on the image and the lat-long; its columns are counted
/// from the position of distance 0 and its rows from the pole.
struct WeighedRun {
  TileKind kind;
  int line;   ///< counted from the middle of the face: v of the texels
  int first;  ///< u of the first texel, counted in the same way
  int rest;   ///< of the images that the weights are for
  PatchRun patches;
  const double* areas;  ///< of the tiles, in columns times height; may be missing
};

/// `count` of a run's points, from `first` on.
[[nodiscard]] PatchRun part_of(const PatchRun& run, int first, int count);

/// A run as one of its images has it: `patches` lacks its origin and stride only.
struct PlacedRun {
  PatchRun patches;
  const double* areas;
  std::ptrdiff_t offset;  ///< of the first result in the image's face, in floats
};

/// Whether an image has texels of a run that are not another one's too, on a cube of `size` and a lat-long of `width`;
/// which ones, if so.
[[nodiscard]] bool place_image(const TileImage& image, const WeighedRun& run, int size, int width, PlacedRun& placed);

// A row of cells along a line, with a value each, made smooth between neighbours without moving any of it.
//
// About each edge the value goes linearly from one cell's to the next one's, over a ramp of equal length on both sides;
// so the integral of a cell's share stays the cell's length, and all shares add up to 1. Ramps of no length: cells as
// they are; of a cell's length: linear interpolation between cells' centres, where cells are equal.

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

  /// Integral between two positions of the shares of all cells from edge `edge` on; that of one cell's share is the
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

  /// Calls `use(share)` with the integral between two positions of each of `count` cells' shares.
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
// Every texel of the lat-long has a share of each point, smooth where the cube is finer (SoftCells); every texel of the
// cube is a tile (CubeTiling) over which shares are integrated. Shares add up to 1 everywhere and tiles cover the
// sphere once: so a uniform source stays uniform and each source texel's total radiance arrives, whatever the sizes.
//
// A tile's weights serve all its mirror images and quarter turns: 16 of them, where the lat-long's width divides by
// four. On side faces, but for the line next to +Y, a tile is a rectangle; its weights are products of shares in height
// and shares in longitude, and the latter are the same on all lines.

class TileWeights;

/// Receives the weights. (A reference to the callable, which allocates nothing.)
using RunSink = std::function<void(const WeighedRun&)>;

/// One worker's scratch for the weights of a run of tiles.
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
  void weigh(TileKind kind, int row, TileScratch& scratch, const RunSink& sink) const;

  /// Columns and weights that all lines of a side face but the first have in common, for the images of a rest.
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

  void weigh_rectangles(int row, TileScratch& scratch, const RunSink& sink) const;
  void weigh_border(TileScratch& scratch, const RunSink& sink) const;
  void weigh_polar(int row, TileScratch& scratch, const RunSink& sink) const;
  void weigh_pole(TileScratch& scratch, const RunSink& sink) const;

  /// The maximum size of the patches of a stretch of tiles: rows, and groups of four columns.
  struct PatchSize {
    int rows = 1;
    int groups = 1;

    friend bool operator==(const PatchSize&, const PatchSize&) = default;
  };
  [[nodiscard]] PatchSize patch_size(const TileScratch& scratch, int first, int end) const noexcept;
  /// Returns how many tiles from `first` on go together, with patches of one size.
  [[nodiscard]] int tiles_together(const TileScratch& scratch, int first, int end, PatchSize& size) const noexcept;

  template <class Sides>
  void weigh_line(WeighedRun run, int count, const Sides& sides, TileScratch& scratch, const RunSink& sink) const;

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

/// The sizes that identify a table.
struct TileWeightKey {
  int width;  ///< of the lat-long
  int height;
  int size;  ///< of the cube

  friend bool operator==(const TileWeightKey&, const TileWeightKey&) = default;
};

/// Weights for resampling to a cube. The call that makes a table fills it, line by line as the lines are drawn, and
/// then shares it: weighing costs a few times as much as drawing, and so is not done ahead of it.
class TileWeightTable {
 public:
  /// The table of an earlier call; null if there is none, or none any more.
  [[nodiscard]] static std::shared_ptr<const TileWeightTable> find(const TileWeightKey& key);
  /// Keeps a table whose lines have all been filled, unless another call has kept one meanwhile.
  static void keep(const TileWeightKey& key, const std::shared_ptr<const TileWeightTable>& table);

  /// Reserves memory for lines to be filled, if they are not more than a table may have: otherwise all are weighed
  /// again each time.
  explicit TileWeightTable(const TileWeightKey& key);

  [[nodiscard]] const TileWeights& weights() const noexcept { return weights_; }
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns whether no line needs to be weighed any more.
  [[nodiscard]] bool complete() const noexcept;

  /// Weighs a line, hands it out and keeps it. Threads may fill different lines at once.
  void fill(bool polar, int row, TileScratch& scratch, const RunSink& sink);
  /// Hands out a line, which is weighed only if it is not kept. `scratch`: may be null if the table is complete.
  void read(bool polar, int row, TileScratch* scratch, const RunSink& sink) const;

 private:
  /// Where the weights of a line are, for each of the rests that images have.
  struct Line {
    std::size_t first_float = 0;
    std::size_t first_index = 0;
    std::size_t first_run = 0;
    std::size_t floats = 0;  ///< reserved for each rest
    std::size_t runs = 0;    ///< reserved for each rest
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
