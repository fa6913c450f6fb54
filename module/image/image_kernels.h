// The kernels of images: samples of grids and patches, half-sized rows, and what texels weigh in each harmonic.
#pragma once

#include <cstddef>
#include <cstdint>

#include "math/basis.h"
#include "math/quadrature.h"
#include "simd/dispatch.h"

namespace welkin::image {

/// A value for each byte.
struct ByteValues {
  float of[256];
};
/// Radiance of bytes of the sRGB transfer function (IEC 61966-2-1), each rounded once.
extern const ByteValues kLinearFromSrgb;

/// Points of a row of an image, on a grid of texels of four floats (red, green, blue, unused).
struct GridRun {
  const float* origin;         ///< ring 0, column 0
  std::ptrdiff_t ring_stride;  ///< floats from a ring to the next
  const std::int32_t* rings;   ///< [count]: first of the four rings around each point
  const std::int32_t* columns;
  const float* ring_weights;  ///< [count][4]
  const float* column_weights;
  int count;
  bool not_negative;  ///< results below 0 become 0
};

/// Points of an image of packed RGB floats, each the weighted sum of a patch of texels of its own.
struct PatchRun {
  const float* origin;          ///< row 0, column 0; two texels right of a patch are read, but have no part in its sum
  std::ptrdiff_t row_stride;    ///< floats from a row to the next
  const std::int32_t* rows;     ///< [count]: first row of each patch
  const std::int32_t* columns;  ///< [count]: first column
  std::int32_t base;            ///< column 0's position in the image
  bool mirrored;                ///< columns count to the left from the one before `base`
  /// [count][patch_rows][4 patch_groups]; or those of columns only, [count][4 patch_groups], with `row_weights`
  const float* weights;
  const float* row_weights;  ///< [count][patch_rows]: factors of the weights of columns; or null
  int patch_rows;
  int patch_groups;  ///< of four columns
  int count;
  std::ptrdiff_t rgb_step;  ///< floats from a point's result to the next one's
};

/// Cells along a line, with a ramp about each edge: see `SoftCells`. Beyond the last edge there are as many copies of
/// it as a patch may reach, and a register.
struct CellRow {
  const double* edges;
  const double* half_ramps;
  const double* inverses;  ///< 1 / (4 half_ramps), or 0
};

/// A piece of a tile's boundary, at one position across from one height to another.
struct TileSide {
  double longitude;  ///< radians, from the middle of the face or from v's axis
  double from;
  double to;
};

/// A tile and the patch that it covers, from the first cell of either row on.
struct TileRun {
  static constexpr int kMaxSides = 10;

  const TileSide* sides;
  int number;
  double columns_per_radian;
  CellRow columns;
  CellRow rows;
  int down;
  int groups;           ///< of four columns
  double* down_shares;  ///< scratch: [kMaxSides][down, up to a multiple of eight]
};

struct ImageKernels {
  /// lengths[k] = sqrt(u[k]^2 + v^2), k < count.
  void (*plane_lengths)(const double* u, double v, int count, double* lengths);

  /// positions[k] = `offset` + `quarter` times the angle of the point (along[k], across[k]) from the axis along in
  /// quarter turns, for k < count and coordinates >= 0; (0, 0) has the angle 0. Error of the angle: 1e-12. The product
  /// is rounded to a multiple of 2^-32, so that what is added to it later, in halves and whole numbers below 2^19,
  /// rounds nothing; with across and along exchanged it is `quarter` less the product.
  void (*angle_positions)(const double* across, const double* along, int count, double quarter, double offset,
                          double* positions);

  /// Which of a grid's texels a position lies between, texel k's centre being at k, and what the four from first[i] on
  /// weigh there: by the cubic B-spline, or linearly (the outer two nothing). weights: [count][4].
  void (*position_taps)(const double* positions, int count, bool cubic, std::int32_t* first, float* weights);

  /// rgb[3 i + c] = the sum over the 4 x 4 texels around point i of texel times weight of its ring times weight of its
  /// column. Nothing beyond rgb[3 count - 1] is written.
  void (*sample_grid)(const GridRun& run, float* rgb);

  /// rgb[rgb_step k + c] = the sum of weight times texel over point k's patch; where all its texels are equal, that
  /// value itself. Rows are added one after the other (weights of columns are multiplied after that), then groups, then
  /// the four columns as `sample_grid` does.
  void (*sample_patches)(const PatchRun& run, float* rgb);

  /// rgb[3 i + c] = (top w + bottom w of texel 2 i) + (the same of texel 2 i + 1), i < count: 2 x 2 texels of two rows
  /// of packed RGB, weighted each on its own. A texel's weight stands in all three of its channels' places: [6 count].
  void (*reduce_pairs)(const float* top, const float* bottom, const float* top_weights, const float* bottom_weights,
                       int count, float* rgb);

  /// weights[down][4 groups] = the integral over the tile of each cell's share, over the tile's area, which is
  /// returned. By Green's theorem the sum over its sides of (share across up to the side) x (share down along the
  /// side); each side begins at the height where the one before it ends.
  double (*weigh_tile)(const TileRun& run, float* weights);
};
WELKIN_KERNEL_TABLES(ImageKernels, image_kernels)

/// Apart from the others: a module of WebAssembly that only reads halves then has none of those.
struct HalfKernels {
  /// Bits of the halves nearest to `count` values. Values beyond 65504 become that, NaN becomes 0; returns how many
  /// did.
  int (*halves_of_floats)(const float* values, int count, std::uint16_t* halves);

  /// Converts half floats, given by their bits, to floats.
  void (*floats_of_halves)(const std::uint16_t* halves, int count, float* values);
};
WELKIN_KERNEL_TABLES(HalfKernels, half_kernels)

/// Texels of a row of a cubemap face. Positions are counted in the face's top left quadrant; weights are those of its
/// mirror image with u >= 0 and v >= 0.
struct TexelRun {
  int size;          ///< N, texels along an edge of the face
  int row;           ///< 0 to ceil(N/2) - 1
  int first_column;  ///< 0 to ceil(N/2) - 1
  int count;         ///< texels; positions from `count` to the next multiple of 16 get zero weights
  int bands;
  bool midpoint;  ///< solid angle times the value at the centre, instead of the integral
  /// How far below the row's the texels lie, in rows: weights between rows, for what is interpolated in them.
  double row_offset = 0.0;
  /// For `integrate_texels`: the integral along the texels' middles times their height, for what averages over rows
  /// itself.
  bool along_middle = false;
};

struct TexelKernels {
  /// Integrals over each texel of the face-local harmonics Y(l, m)(u, v, 1), by a product Gauss rule in
  /// double. `rows[l(l+1)+m]` is the row of `weights` (row stride `stride` floats) that gets Y(l, m).
  void (*integrate_texels)(const TexelRun& run, const math::BasisRecurrence& recurrence, const math::GaussRule& rule,
                           const int* rows, float* weights, int stride);

  /// Integrals of up to three bands by the expansion in the texel size h = 1/N, in float: relative error 2e-7 + 40 h^4.
  void (*expand_texels)(const TexelRun& run, const int* rows, float* weights, int stride);
};
WELKIN_KERNEL_TABLES(TexelKernels, texel_kernels)

}  // namespace welkin::image
