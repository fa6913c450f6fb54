// The weights of all tiles of a lat-long and a cube's size, kept for the next time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "image/area_weights.h"
#include "platform/memory.h"

namespace welkin::image {

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
    std::size_t floats = 0;  ///< that there is room for, for each rest
    bool kept = false;
    struct Patches {
      int rows = 0;  ///< 0: no image has that rest
      int groups = 0;
    } patches[4];
  };
  class Filler;

  [[nodiscard]] std::size_t floats_for(TileKind kind, int row) const noexcept;
  [[nodiscard]] std::size_t line_index(bool polar, int row) const noexcept {
    return static_cast<std::size_t>(polar ? weights_.lines() + row : row);
  }

  TileWeights weights_;
  int rests_;  ///< that images may have
  std::vector<Line> lines_;
  platform::AlignedBuffer<float> floats_;
  platform::AlignedBuffer<std::int32_t> indices_;  ///< rows of a line's patches, then columns, for each rest
};

}  // namespace welkin::image
