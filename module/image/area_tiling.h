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
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "image/image_kernels.h"

namespace welkin::image {

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
  /// What lies on a line of constant v: its points with the columns' edges and middles, and the mean heights between.
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
  bool right;     ///< the texel's place on the face: u > 0
  bool lower;     ///< v > 0
  bool swapped;   ///< u and v exchanged
};

/// How far the place that an image's distances are counted from lies beyond a column's edge, against the way its
/// columns count, in quarters of a column.
[[nodiscard]] int rest_of(const TileImage& image, int width) noexcept;

/// The parts of the cube whose tiles have weights of their own, and those tiles' images.
enum class TileKind {
  side,   ///< on +X or the like, from the middle to the right and upwards
  polar,  ///< on +Y, 0 <= u <= v
  pole,   ///< the texel around the pole where the number of texels is odd
};
[[nodiscard]] std::span<const TileImage> images_of(TileKind kind) noexcept;

/// The weights of a run of tiles. `patches` lacks what depends on the image and the image; its columns are counted
/// from the place of distance 0 and its rows from the pole.
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

}  // namespace welkin::image
