// Where on a cube the mirror images and quarter turns of a tile lie: all of them have the same weights.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "simd/kernels.h"

namespace welkin::image {

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

/// The weights of a run of tiles. `patches` lacks what depends on the image and the picture; its columns are counted
/// from the place of distance 0 and its rows from the pole.
struct WeighedRun {
  TileKind kind;
  int line;   ///< counted from the middle of the face: v of the texels
  int first;  ///< u of the first texel, counted in the same way
  int rest;   ///< of the images that the weights are for
  simd::PatchRun patches;
  const double* areas;  ///< of the tiles, in columns times height; may be missing
};

/// A run as one of its images has it: `patches` lacks its origin and stride only.
struct PlacedRun {
  simd::PatchRun patches;
  const double* areas;
  std::ptrdiff_t offset;  ///< of the first result in the image's face, in floats
};

/// Whether an image has texels of a run that are not another one's too, on a cube of `size` and a lat-long of `width`;
/// which ones, if so.
[[nodiscard]] bool place_image(const TileImage& image, const WeighedRun& run, int size, int width, PlacedRun& placed);

}  // namespace welkin::image
