// The projection of large faces to three bands or more, strip by strip.
//
// A strip is 16 rows at the top of a face and the 16 mirrored ones at the bottom, and a segment of at most 256 columns
// at the left with the mirrored ones at the right: a tile is one of those on all faces. Its pixels are read once, as
// they lie (SumStrips, FoldStrips), and its weights computed once for all faces.
//
// Pixels that a policy changes, and formats that the kernels do not read, take the same way by rows of floats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "platform/memory.h"
#include "projection/sanitizer.h"
#include "projection/strip_kernels.h"
#include "projection/strip_weights.h"
#include "projection/texel_weights.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {

class StripProjection {
 public:
  /// Whether strips can do it; else chunks (chunk_projection.h) do.
  [[nodiscard]] static bool serves(int size, const ProjectionOptions& options) noexcept;
  [[nodiscard]] static int tile_count(int size) noexcept;

  /// All but `options` must stay; `weights` are those of the cubemap's size.
  StripProjection(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                  const Sanitizer& sanitizer, const TexelWeights& weights);

  /// One worker's scratch, in two pieces.
  class Scratch {
   public:
    explicit Scratch(const StripProjection& projection);

   private:
    friend class StripProjection;
    [[nodiscard]] float* weights() noexcept { return floats_.data(); }
    [[nodiscard]] float* planes(int face) noexcept { return planes_ + face * face_planes_; }
    [[nodiscard]] double* lanes(int face) noexcept { return doubles_.data() + face * face_lanes_; }

    std::ptrdiff_t face_planes_;  ///< none where weights are packed
    std::ptrdiff_t face_lanes_;
    platform::AlignedBuffer<float> floats_;
    platform::AlignedBuffer<double> doubles_;
    float* weight_rows_;
    float* decoded_[4];  ///< rows of the pieces: top left, top right, bottom left, bottom right
    float* of_kernel_;
    float* planes_;
    double* totals_;
  };

  /// The sums of a tile on each of the faces, [3][bands^2] in the order of the weights.
  void sum_tile(int index, Scratch& scratch) const;
  /// Returns one face's sums from what `sum_tile` left there, of sanitized texels if they were not all finite.
  [[nodiscard]] std::span<const double> face_sums(int index, int face, Scratch& scratch, SanitizeRecord& record) const;

 private:
  /// A strip's segment; and one of its four mirrored pieces.
  struct Tile {
    int strip;
    int first_column;
    int positions;
  };
  struct Piece {
    bool bottom;
    bool right;

    [[nodiscard]] std::size_t index() const noexcept { return (bottom ? 2U : 0U) + (right ? 1U : 0U); }
  };

  [[nodiscard]] int sums() const noexcept { return 3 * functions_; }
  [[nodiscard]] Tile tile_at(int index) const noexcept;
  [[nodiscard]] int first_column(const Tile& tile, const Piece& piece) const noexcept;
  [[nodiscard]] int row_of(const Tile& tile, const Piece& piece, int index) const noexcept;
  [[nodiscard]] const std::byte* texel(int face, int row, int column) const noexcept;
  [[nodiscard]] StripRows rows_in_place(const Tile& tile, int face, const Piece& piece) const noexcept;
  template <class RowsOf>
  void sum_pieces(FoldFormat format, const Tile& tile, int face, const RowsOf& rows_of, Scratch& scratch) const;
  void weigh(const Tile& tile, std::span<const int> faces, Scratch& scratch) const;
  [[nodiscard]] StripRows decode_and_sanitize(const Tile& tile, int face, const Piece& piece, Scratch& scratch,
                                              SanitizeRecord& record) const;
  void sanitize(const Tile& tile, int face, const Piece& piece, int row, float* rgb, SanitizeRecord& record) const;
  void sum_sanitized(const Tile& tile, int face, Scratch& scratch, SanitizeRecord& record) const;
  void sum_in_double(const Tile& tile, int face, Scratch& scratch) const;

  const CubemapView& cubemap_;
  std::span<const int> faces_;
  const Sanitizer& sanitizer_;
  const TexelWeights& weights_;
  int functions_;
  bool midpoint_;
  std::ptrdiff_t texel_bytes_;
  std::ptrdiff_t row_bytes_;
  StripWeights strip_weights_;
  FoldFormat direct_ = fold_format_count;  ///< that: no texel is taken as it lies
};

}  // namespace welkin::projection
