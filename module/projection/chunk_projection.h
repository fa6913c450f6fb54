// The projection of faces to any number of bands, chunk by chunk.
//
// A tile is a few chunks of the face's top left quadrant, taken over all faces: what a position there weighs is looked
// up or computed once and used for up to 24 texels. Per chunk and face: rows are folded into symmetry classes
// (FoldQuadrants), and the planes of sums and differences multiplied with the weights (`weighted_sums`).
//
// Finite pixels pay nothing for the policies: a NaN or an infinity anywhere makes a tile's sums of that face
// non-finite, and only then (or when an option wants every texel looked at) are its texels decoded, sanitized and
// summed again.
#pragma once

#include <cstddef>
#include <span>

#include "platform/memory.h"
#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "projection/texel_weights.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {

class ChunkProjection {
 public:
  [[nodiscard]] static int tile_count(const TexelWeights& weights) noexcept;

  /// `cubemap`, `faces`, `sanitizer` and `weights`, which are those of the cubemap's size, must stay.
  /// `one_of_many`: its pixels are not in a cache, however few they are.
  ChunkProjection(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                  const Sanitizer& sanitizer, const TexelWeights& weights, bool one_of_many = false);

  /// One worker's scratch, made before the tiles run, in two pieces (a small cubemap takes ten microseconds, and every
  /// allocation a tenth of one).
  class Scratch {
   public:
    explicit Scratch(const ChunkProjection& projection);
    /// For every projection to `functions` harmonics whose weights need no more scratch than `weight_floats`.
    Scratch(int functions, std::size_t weight_floats);

   private:
    friend class ChunkProjection;

    static constexpr std::size_t kPlaneFloats = std::size_t{3} * kMaximumClasses * kChunk;
    static constexpr std::size_t kRunFloats = std::size_t{3} * kChunk;

    // One part after the other.
    [[nodiscard]] float* planes() noexcept { return floats_.data(); }  ///< [3][kMaximumClasses][kChunk]
    /// Decoded runs of a row: top left, top right, bottom left, bottom right.
    [[nodiscard]] float* run(std::size_t index) noexcept { return planes() + kPlaneFloats + kRunFloats * index; }
    [[nodiscard]] float* weights() noexcept { return run(4); }
    /// A face's sums, spread over lanes: [3][functions][kSumLanes].
    [[nodiscard]] double* lanes(int face) noexcept {
      return doubles_.data() + static_cast<std::size_t>(face) * sums_ * kSumLanes;
    }
    /// One face's sums, [3][functions]; and those of its sanitized chunks so far.
    [[nodiscard]] std::span<double> face_sums() noexcept { return {lanes(6), sums_}; }
    [[nodiscard]] std::span<double> sanitized_sums() noexcept { return {lanes(6) + sums_, sums_}; }

    std::size_t sums_;  ///< of a face
    platform::AlignedBuffer<float> floats_;
    platform::AlignedBuffer<double> doubles_;
  };

  /// The sums of a tile on each of the faces, as far as its texels can be taken as they lie.
  void sum_tile(int index, Scratch& scratch) const;
  /// Returns one face's sums from what `sum_tile` left there, [3][functions] in the order of the weights, of sanitized
  /// texels if they were not all finite. They stay until the next face's.
  [[nodiscard]] std::span<const double> face_sums(int index, int face, Scratch& scratch, SanitizeRecord& record) const;

 private:
  /// A tile's chunks, first to end - 1.
  struct Chunks {
    int first;
    int end;
  };
  /// One row of a chunk on one face.
  struct RowRun {
    const std::byte* top;     ///< the row's first texel
    const std::byte* bottom;  ///< the mirrored row's, or nullptr if it is the same row
    int face;
    int row;
    int mirrored_row;
    int first_column;
    int count;     ///< positions
    int paired;    ///< of which this many have a mirror image in u; at most one has not
    int position;  ///< of the first one in the chunk's planes
  };

  [[nodiscard]] FoldQuadrants direct_fold(PixelFormat format) const;
  [[nodiscard]] Chunks chunks_of(int tile) const;
  void clear_lanes(int face, Scratch& scratch) const;
  /// Brings a face's sums from their lanes to scratch.face_sums(); false if they are not all finite.
  [[nodiscard]] bool fold_face(int face, Scratch& scratch) const;
  /// The fast way: all faces of a chunk while its weights are at hand.
  void sum_directly(const Chunks& chunks, Scratch& scratch) const;
  /// The careful way for one face, chunk by chunk: every texel passes the policies. Leaves scratch.face_sums().
  void sum_sanitized(const Chunks& chunks, int face, Scratch& scratch, SanitizeRecord& record) const;
  void sum_planes(const QuadrantChunk& chunk, int face, const float* weights, const FetchAhead& ahead,
                  Scratch& scratch) const;
  /// Returns the memory that is read after a chunk on a face: the same chunk on the next face, or the next chunk on the
  /// first. Several short rows count as one stretch each at the top and at the bottom, as if rows were packed. (The
  /// next tile's first chunk too: usually the same thread continues with it.)
  [[nodiscard]] FetchAhead read_next(int index, std::size_t at) const;
  [[nodiscard]] RowRun row_run(const QuadrantChunk& chunk, int face, int index) const;
  /// First texel of the run's mirror image in u, `count` texels in memory order.
  [[nodiscard]] const std::byte* mirrored(const std::byte* row, int first_column, int count) const;
  /// Where `whole` positions of `rows` rows from `run` on and their mirror images lie.
  [[nodiscard]] QuadrantRuns runs_in_place(const RowRun& run, int rows, int whole) const;
  /// Folds a chunk in place: all rows at once where they consist of whole groups and each has a mirror image.
  void fold_directly(const QuadrantChunk& chunk, int face, const FetchAhead& ahead, Scratch& scratch) const;
  /// The positions from `whole` on: less than a group, or a middle column.
  void fold_rest(RowRun run, int whole, Scratch& scratch) const;
  /// Decodes a row's four runs, each padded with zeros to whole groups so that position k
  /// meets its mirror image: left runs start at 0, right ones end at the end.
  void decode(const RowRun& run, Scratch& scratch) const;
  /// `weights`: of the run's first position, row 0 being the solid angle.
  void decode_and_sanitize(const RowRun& run, const float* weights, Scratch& scratch, SanitizeRecord& record) const;
  void sanitize(const TexelRun& run, SanitizeRecord& record) const;
  void fold_decoded(const RowRun& run, Scratch& scratch) const;
  /// Leaves a chunk's sums on one face in scratch.face_sums(). For finite texels near the largest float, whose
  /// sums fit a double only: rare, so it may be slow and use the stack.
  void sum_in_double(const QuadrantChunk& chunk, int face, const float* weights, Scratch& scratch) const;

  const CubemapView& cubemap_;
  std::span<const int> faces_;
  const Sanitizer& sanitizer_;
  const TexelWeights& weights_;
  int functions_;
  std::ptrdiff_t texel_bytes_;
  std::ptrdiff_t row_bytes_;
  const ProjectionKernels& kernels_;
  FoldQuadrants direct_fold_;  ///< null: no texel is taken as it lies
  bool fetches_ahead_;
};

}  // namespace welkin::projection
