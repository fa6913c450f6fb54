// How the texels of a lat-long and those of a cube overlap.
//
// Every texel of the lat-long has its share of the sphere, smooth where the cube is finer (SoftCells); every texel of
// the cube is a tile (CubeTiling) over which shares are integrated. Shares add up to 1 everywhere and tiles cover the
// sphere once: so a uniform source stays uniform and each source texel's flux arrives, whatever the sizes.
//
// A tile's weights serve all its mirror images and quarter turns: 16 of them, where the lat-long's width divides by
// four. On side faces, but for the line next to +Y, a tile is a rectangle; its weights are products of shares in height
// and shares in longitude, and the latter are the same on all lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/cube_tiling.h"
#include "image/soft_cells.h"
#include "image/tile_images.h"

namespace welkin::image {

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
  std::vector<double> areas_, upper_, lower_;
  std::vector<double> dense_, across_, along_, down_, from_, to_;
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
  /// How many columns a patch may reach beyond the lat-long's seam.
  [[nodiscard]] int border() const noexcept { return reach_ + kSpareColumns; }

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
  [[nodiscard]] std::size_t most_weights() const noexcept;

  void weigh_rectangles(int row, TileScratch& scratch, RunSink& sink) const;
  void weigh_border(TileScratch& scratch, RunSink& sink) const;
  void weigh_polar(int row, TileScratch& scratch, RunSink& sink) const;
  void weigh_pole(TileScratch& scratch, RunSink& sink) const;

  template <class Sides>
  void weigh_line(WeighedRun run, int count, const Sides& sides, TileScratch& scratch, RunSink& sink) const;
  double weigh_tile(const TileSide* sides, int number, const SoftCells& columns, int first_row, int first_column,
                    const simd::PatchRun& run, TileScratch& scratch, float* weights) const;

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

}  // namespace welkin::image
