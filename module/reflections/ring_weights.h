// Weights of each texel of a cubemap for rings of latitude, made band after band.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "reflections/ring_kernels.h"
#include "welkin/core.h"

namespace welkin::reflections {

/// Polynomials of the shares that the `kSpread` cells about a point have of its light: along both axes in such shares
/// that the moments below `kSpread` - 1 are the point's own (about the poles nearly so: uniform light is uniform
/// there). They pass smoothly from one `kSpread` - 1 neighbours to the next ones. All are [cell][power][lane],
/// `kSharePowers` and `kShareLanes`, the highest power first, of the position from the cell's middle; lane k stands for
/// the cell k - `kSpread` / 2 further on.
struct RingShares {
  /// `rows`: rings from pole to pole; twice as many columns.
  explicit RingShares(int rows);

  std::vector<float> columns;         ///< one cell: shares of the columns
  std::vector<float> columns_before;  ///< one cell: their integrals, in columns, from before all of them to the point
  /// Cells 0 to rows / 2: shares of the rings over the ring's area, integrated over the sphere from the pole to the
  /// point. Rings go on beyond the pole.
  std::vector<float> rings_before;
  std::vector<float> whole;  ///< of ring k - 2, to rows / 2 + 2: the same integral over all positions
};

/// The texels of a sixteenth of the cube, from -Z's middle towards +x and up to +Y, and the weights with which they and
/// their images reach the rings' texels of the same sixteenth.
///
/// The integral of a ring's and a column's share over a texel is one along its edges: of the column's share times the
/// ring's integral from the pole to the edge, by longitude. Edges along meridians give nothing, and what an edge gives
/// one texel it takes from the other, so that uniform light stays uniform. Gauss points stand for an edge's parts; they
/// are made to add up to the columns' exact integrals over the part.
class RingWeights {
 public:
  RingWeights(int face_size, int rows, const RingKernels& kernels = ring_kernels());

  /// Rows of texels: of -Z from the equator upwards, then of +Y from the middle of the face on.
  struct TexelRow {
    glm::ivec3 first;  ///< centre of the first texel, in half texels
    int count;         ///< the others follow in steps of two along x
    std::uint32_t record;
  };
  [[nodiscard]] const std::vector<TexelRow>& rows() const noexcept { return texel_rows_; }

  /// A record that is an image of another one.
  struct ImageRecord {
    std::uint32_t record;
    int image;
  };
  /// Records that come after the rows' texels.
  [[nodiscard]] const std::vector<ImageRecord>& images() const noexcept { return images_; }
  [[nodiscard]] std::size_t record_count() const noexcept { return texel_count_ + images_.size(); }

  /// Rings of a hemisphere, cut by their number alone.
  [[nodiscard]] int bands() const noexcept;
  [[nodiscard]] int first_ring(int band) const noexcept;  ///< of band `bands()`: one beyond the last

  /// Adds to `counts`, [ring of the band][column], how many taps each of the texels has.
  void count(int band, std::uint32_t* counts) const;

  /// Writes the band's taps, in an order that depends on the sizes alone. `next`: as `count` has it, where the taps of
  /// each texel begin in `taps`.
  void weigh(int band, std::uint32_t* next, RingTap* taps) const;

  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns a bound on the bytes of the object and of the threads in `weigh`.
  [[nodiscard]] static std::size_t making_bytes(int face_size, int rows, std::size_t threads) noexcept;

 private:
  class EdgeLine;
  class Workspace;
  /// Texels of a row.
  struct Range {
    int first;
    int end;
  };
  /// Rings that belong to a band, those that fold back into it included.
  struct Clip {
    int first;
    int end;
  };

  [[nodiscard]] static std::size_t parts_of_line(int texels, int rows) noexcept;
  [[nodiscard]] std::size_t corner(int row, int column) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(texels_ + 1) + static_cast<std::size_t>(column);
  }
  void find_angles(const double* y, const double* x, int count, double* angles) const;
  void find_corners();
  void find_images();
  [[nodiscard]] RingWindow window(int row, int column) const noexcept;
  [[nodiscard]] std::uint32_t record_of(int row, int column) const noexcept {
    return texel_rows_[static_cast<std::size_t>(row)].record + static_cast<std::uint32_t>(column);
  }
  [[nodiscard]] std::uint32_t images_of(const RingWindow& window) const noexcept;
  [[nodiscard]] Clip clip_of(int band) const noexcept;
  [[nodiscard]] Range range_of(int row, const Clip& clip) const;
  void weigh_side(const Clip& clip, const RingBand& band, Workspace& workspace) const;
  void weigh_top(const Clip& clip, const RingBand& band, Workspace& workspace) const;
  [[nodiscard]] WeighedTexel texel(int row, int column, const Clip& clip) const noexcept;
  template <class Find, class Weigh>
  void walk(int first_row, const Clip& clip, const Find& find, const Weigh& weigh) const;

  int texels_;  ///< of half a face's edge; the first one of an odd face is a half
  int rows_;
  int columns_;
  RingShares shares_;
  const RingKernels& kernels_;
  std::vector<double> lines_;      ///< between texels, on the face
  std::vector<int> side_columns_;  ///< [line]: that it lies on
  std::vector<int> side_rings_;    ///< of -Z's corners, [row][column]
  std::vector<int> top_rings_;     ///< of +Y's
  std::vector<int> top_columns_;
  std::vector<TexelRow> texel_rows_;
  std::vector<ImageRecord> images_;
  std::vector<std::uint16_t> image_bits_;    ///< [record]
  std::vector<std::uint32_t> first_images_;  ///< [record]
  std::uint32_t texel_count_ = 0;
  std::size_t parts_ = 0;         ///< of a line, at most
  std::size_t block_floats_ = 0;  ///< of a texel's window, at most
};

}  // namespace welkin::reflections
