// Kernels that take a cubemap to rings of latitude, sixteen images at a time, and that make the weights for it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "platform/compiler.h"
#include "simd/dispatch.h"

namespace welkin::reflections {

/// Mirror images and quarter turns of a sixteenth of the sphere, itself one of them; a record is a texel of it
/// as all images have it, [image][red, green, blue].
inline constexpr int kRingImages = 16;
inline constexpr int kRecordFloats = 3 * kRingImages;

/// A texel of the cube and its weight in a ring's texel.
struct RingTap {
  std::uint32_t record;
  float weight;
};

/// Texels of a ring within the sixteenth.
struct RingRun {
  const float* records;
  const RingTap* taps;
  const std::uint32_t* ends;  ///< [count + 1]: the taps of texel k are from ends[k] up to ends[k + 1]
  int count;
};

/// Where the images of a ring's texels go: image i's of texel k to to[i] + step[i] k.
struct RingLayout {
  float* to[kRingImages];
  std::ptrdiff_t step[kRingImages];
};

// A texel of a face gives its light to the four nearest of half as many along each axis, so that the light of all of
// them as areas has the texel's own moments up to the third.
//
// Let w_k be the share of the large texel whose middle is d_k from the small one's, in large texels: d = -7/4, -3/4,
// 1/4 and 5/4, or their mirror image. An area of width 1 about d has the moments 1, d, d^2 + 1/12 and d^3 + d / 4; the
// small one has 1, 0, (1/2)^2 / 12 and 0. So
//   Sum w = 1,  Sum w d = 0,  Sum w d^2 = 1/48 - 1/12 = -1/16,  Sum w d^3 = 0,
// which -6, 34, 110 and -10 over 128 solve. The fourth moments differ by -9/16, so along an axis a wave of k radians
// per large texel loses 9/16 k^4 / 24 = 0.0234 k^4.

/// Shares of texels that lie 7/4, 5/4, 3/4 and 1/4 of a large texel from its middle.
inline constexpr float kHalvedShares[4] = {-6.0F / 128.0F, -10.0F / 128.0F, 34.0F / 128.0F, 110.0F / 128.0F};
/// Coefficients of the light one and two large texels beyond the face's edge: parabolas through the first three within
/// it, by which uniform light stays uniform and moments up to the second remain. They are the Lagrange polynomials of
/// the positions 0, 1 and 2 at -1 and -2: a parabola there is the same combination of its values within.
inline constexpr int kFolded = 3;
inline constexpr float kFirstBeyond[kFolded] = {3.0F, -3.0F, 1.0F};
inline constexpr float kSecondBeyond[kFolded] = {6.0F, -8.0F, 3.0F};

/// Rows of a face's light that give to one row of a face of half as many texels.
struct HalvedRow {
  static constexpr int kMaxRows = 9;
  static constexpr int kMargin = 7;  ///< texels of `scratch` beyond both ends

  const float* light[kMaxRows];  ///< packed RGB, radiance times steradians
  float shares[kMaxRows];
  int count;                          ///< rows
  int size;                           ///< texels of a row: even, at least 16
  const float* scale;                 ///< of each texel of the result
  float* scratch;                     ///< 3 (size + 2 kMargin) + kBeyond floats
  static constexpr int kBeyond = 32;  ///< that registers may read
};

// Weights of a `RingTable`.

/// Cells, of rings or of columns, that share the light of a point; lanes that hold them; powers of the polynomials.
inline constexpr int kSpread = 5;
inline constexpr int kShareLanes = 8;
inline constexpr int kSharePowers = 13;
/// Gauss points in a part of a texel's edge.
inline constexpr int kPartPoints = 2;

/// A line of texels' edges, each cut into parts with `kPartPoints` points.
struct RingEdges {
  const std::uint32_t* parts;  ///< [edge + 1]: edge k has the parts from parts[k] up to parts[k + 1]
  const int* columns;          ///< [part]: the first of `kShareLanes` columns
  const float* across;         ///< [part][point][lane]: what falls on these columns of the point's longitudes
  const int* rings;            ///< [part][point]: the ring that the point lies on
  const float* along;          ///< [part][point][lane]: shares of the rings from `rings` - 2 on, from the pole to there
};

/// Shares of columns in the light of parts whose edges' longitudes they reach.
struct ColumnShares {
  const int* end_columns;     ///< [part][end]
  const float* end_shares;    ///< [part][end][lane]: of the columns from `end_columns` - 2 on, integrated up to there
  const int* point_columns;   ///< [part][point]
  const float* point_shares;  ///< [part][point][lane]
  const float* widths;        ///< [part][point]: columns that the point stands for
  int count;                  ///< parts
  bool falling;               ///< longitudes fall from a part's first end to its second one
};

/// Rings and columns that a texel's light reaches; a ring below 0 lies beyond the pole.
struct RingWindow {
  int first_ring;
  int rings;
  int first_column;
  int columns;
};

/// One edge of a texel: the parts from `first` up to `end`; inner ones lie towards the pole.
struct TexelEdge {
  const RingEdges* line;
  std::uint32_t first;
  std::uint32_t end;
  bool inner;
};

struct WeighedTexel {
  RingWindow window;
  int clip_first;  ///< rings that are wanted
  int clip_end;
  TexelEdge edges[4];
  int edge_count;
  std::uint32_t record;
  std::uint32_t images;       ///< bit k: image k has a record of its own, as some cells lie outside the sixteenth
  std::uint32_t first_image;  ///< record of the first of them
};

/// Columns of a ring of the sixteenth, and which image brings texels around it there.
struct RingCells {
  int ring;
  int column;  ///< of the first one
  int step;    ///< from one to the next: 1, or -1 in a mirror image
  int count;
  int image;
};

/// Calls `take(cells, k)` for the parts of `columns` columns of a ring from `first` on that lie in one sixteenth each,
/// k columns further on. `first` is above -8 `width`.
///
/// Ring -1 - r beyond the pole is ring r 180 degrees on, which is 4 widths of an eighth each. Below the equator rings
/// are mirror images of those above it. Every second eighth of a turn is the mirror image of the one next to it about
/// the line between them, so its columns run backwards; the image's number is that of `image::cube_image_of`.
template <class Take>
WELKIN_INLINE void for_folded(int ring, int first, int columns, int rows, int width, const Take& take) {
  if (ring < 0) {
    ring = -1 - ring;
    first += 4 * width;
  }
  const bool below = ring >= rows / 2;
  if (below) ring = rows - 1 - ring;
  first += 8 * width;
  int eighth = first / width;
  int column = first - eighth * width;
  for (int k = 0; k < columns; ++eighth, column = 0) {
    const bool mirrored = eighth % 2 == 1;
    const int count = columns - k < width - column ? columns - k : width - column;
    const int image = 4 * ((eighth + 1) / 2 % 4) + (mirrored ? 2 : 0) + (below ? 1 : 0);
    take(RingCells{ring, mirrored ? width - 1 - column : column, mirrored ? -1 : 1, count, image}, k);
    k += count;
  }
}

/// Where the taps of a band's rings go.
struct RingBand {
  const float* whole;   ///< [ring + 2]: what a ring gets where all of it is passed
  int rows;             ///< of the whole sphere
  int first_ring;       ///< of the band
  int width;            ///< columns of the sixteenth
  std::uint32_t* next;  ///< [ring][column]: where the next tap goes
  RingTap* taps;
};

struct RingKernels {
  /// Sums of weight times record, tap after tap.
  void (*sum_ring_taps)(const RingRun& run, const RingLayout& layout);

  /// light[k] = radiance[k] steradians[k].
  void (*weigh_light)(const float* radiance, const float* steradians, int count, float* light);

  /// Light of the rows times their shares, row after row; then along the row as `halved_faces` shares it out.
  void (*halve_row)(const HalvedRow& row, float* rgb);

  /// values[i][k] = the polynomial of cell cells[i] and neighbour k at points[i]. `coefficients`:
  /// [cell][power][neighbour], the highest power first.
  void (*evaluate_shares)(const float* coefficients, const int* cells, const float* points, int count, float* values);

  /// The points' shares times widths, moved to a part's columns and made to add up to what the ends say.
  void (*share_columns)(const ColumnShares& shares, int* columns, float* across);

  /// Finds a texel's weights and writes them. `block`: zeros, rings x (columns + `kShareLanes`) of the
  /// window, and as many again as there are lanes; left so.
  void (*weigh_texel)(const WeighedTexel& texel, const RingBand& band, float* block);
};
WELKIN_KERNEL_TABLES(RingKernels, ring_kernels)

}  // namespace welkin::reflections
