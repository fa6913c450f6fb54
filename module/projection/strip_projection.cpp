#include "projection/strip_projection.h"

#include <algorithm>

#include "image/image_kernels.h"
#include "image/pixels.h"
#include "projection/projection_kernels.h"
#include "projection/tile_sums.h"

namespace welkin::projection {
namespace {

using simd::kLanes;

constexpr int kChannels = 3;
int segments_of(int size) { return (size / 2 + kSegment - 1) / kSegment; }

/// The most positions that a tile has.
int widest_segment(int size) { return std::min(kSegment, size / 2); }

}  // namespace

bool StripProjection::serves(int size, const ProjectionOptions& options) noexcept {
  return options.target_size.value_or(size) >= size && StripWeights::serve(size, options.bands);
}

int StripProjection::tile_count(int size) noexcept { return size / 2 / kStripRows * segments_of(size); }

StripProjection::StripProjection(const CubemapView& cubemap, const ProjectionOptions& options,
                                 std::span<const int> faces, const Sanitizer& sanitizer, const TexelWeights& weights)
    : cubemap_(cubemap),
      faces_(faces),
      sanitizer_(sanitizer),
      weights_(weights),
      functions_(options.bands * options.bands),
      midpoint_(options.quadrature == Quadrature::midpoint),
      texel_bytes_(static_cast<std::ptrdiff_t>(bytes_per_texel(cubemap.format))),
      row_bytes_(cubemap.row_stride_bytes != 0 ? cubemap.row_stride_bytes : texel_bytes_ * cubemap.size),
      strip_weights_(cubemap.size, options.bands, midpoint_, weights.weight_rows().data()) {
  if (!sanitizer.needs_every_texel()) direct_ = fold_format(cubemap.format);
}

// A worker's scratch memory, one part after the other.

StripProjection::Scratch::Scratch(const StripProjection& projection)
    : face_planes_(projection.strip_weights_.packed()
                       ? 0
                       : std::ptrdiff_t{kStripPlaneFloats} * projection.strip_weights_.moments()),
      face_lanes_(std::ptrdiff_t{kSumLanes} * projection.sums()),
      doubles_(static_cast<std::size_t>(6 * face_lanes_ + projection.sums())) {
  const StripWeights& strips = projection.strip_weights_;
  const int columns = widest_segment(projection.cubemap_.size);
  const std::ptrdiff_t piece = std::ptrdiff_t{kStripRows * kChannels} * columns;
  floats_ = platform::AlignedBuffer<float>(
      strips.size(columns) + strips.scratch_size(columns) +
      static_cast<std::size_t>(4 * piece + strip_scratch(strips.moments()) + 6 * face_planes_));
  weight_rows_ = weights() + strips.size(columns);
  for (int k = 0; k < 4; ++k) decoded_[k] = weight_rows_ + strips.scratch_size(columns) + k * piece;
  of_kernel_ = decoded_[3] + piece;
  planes_ = of_kernel_ + strip_scratch(strips.moments());
  totals_ = lanes(6);
}

// Where a tile lies.

StripProjection::Tile StripProjection::tile_at(int index) const noexcept {
  const int segments = segments_of(cubemap_.size);
  const int first = index % segments * kSegment;
  return {index / segments, first, std::min(kSegment, cubemap_.size / 2 - first)};
}

int StripProjection::first_column(const Tile& tile, const Piece& piece) const noexcept {
  return piece.right ? cubemap_.size - tile.first_column - tile.positions : tile.first_column;
}

int StripProjection::row_of(const Tile& tile, const Piece& piece, int index) const noexcept {
  const int row = tile.strip * kStripRows + index;
  return piece.bottom ? cubemap_.size - 1 - row : row;
}

const std::byte* StripProjection::texel(int face, int row, int column) const noexcept {
  return static_cast<const std::byte*>(cubemap_.faces[static_cast<std::size_t>(face)]) + row * row_bytes_ +
         column * texel_bytes_;
}

StripRows StripProjection::rows_in_place(const Tile& tile, int face, const Piece& piece) const noexcept {
  return {texel(face, row_of(tile, piece, 0), first_column(tile, piece)), piece.bottom ? -row_bytes_ : row_bytes_};
}

// Pixels to sums.

template <class RowsOf>
void StripProjection::sum_pieces(FoldFormat format, const Tile& tile, int face, const RowsOf& rows_of,
                                 Scratch& scratch) const {
  std::fill_n(scratch.lanes(face), sums() * kSumLanes, 0.0);
  const StripPieces pieces{rows_of({false, false}), rows_of({false, true}), rows_of({true, false}),
                           rows_of({true, true})};
  const StripFunctions& strips = strip_kernels().strips[format].of[strip_weights_.moments() - kMinMoments];
  if (strip_weights_.packed()) {
    strips.sum(pieces, tile.positions, scratch.weights(), scratch.of_kernel_, scratch.lanes(face));
  } else {
    strips.fold(pieces, tile.positions, scratch.of_kernel_, scratch.planes(face));
  }
}

/// Multiplies the moments that `sum_pieces` has summed by their weights. All faces take a moment's weights in turn:
/// those of all moments of ten bands are more than a second-level cache.
void StripProjection::weigh(const Tile& tile, std::span<const int> faces, Scratch& scratch) const {
  if (strip_weights_.packed()) return;
  for (int k = 0; k < strip_weights_.moments(); ++k) {
    const float* const moment = scratch.weights() + static_cast<std::ptrdiff_t>(k) * functions_ * kChunk;
    for (const int face : faces) {
      projection_kernels().weighted_sums(scratch.planes(face) + k * kStripPlaneFloats, kMaximumClasses, moment,
                                         weights_.class_counts(), tile.positions / simd::kLanes, {},
                                         scratch.lanes(face));
    }
  }
}

void StripProjection::sum_tile(int index, Scratch& scratch) const {
  const Tile tile = tile_at(index);
  strip_weights_.fill(tile.strip, tile.first_column, tile.positions, scratch.weights(), scratch.weight_rows_);
  if (direct_ == fold_format_count) return;
  for (const int face : faces_) {
    sum_pieces(
        direct_, tile, face, [&](const Piece& piece) { return rows_in_place(tile, face, piece); }, scratch);
  }
  weigh(tile, faces_, scratch);
}

std::span<const double> StripProjection::face_sums(int index, int face, Scratch& scratch,
                                                   SanitizeRecord& record) const {
  const std::span<double> total{scratch.totals_, static_cast<std::size_t>(sums())};
  if (direct_ != fold_format_count) {
    projection_kernels().fold_sum_lanes(scratch.lanes(face), sums(), total.data());
    if (all_finite(total)) return total;
  }
  const Tile tile = tile_at(index);
  sum_sanitized(tile, face, scratch, record);
  if (!all_finite(total)) sum_in_double(tile, face, scratch);
  return total;
}

// The careful way: every texel passes the policies.

StripRows StripProjection::decode_and_sanitize(const Tile& tile, int face, const Piece& piece, Scratch& scratch,
                                               SanitizeRecord& record) const {
  const int row_floats = kChannels * tile.positions;
  for (int k = 0; k < kStripRows; ++k) {
    float* const rgb = scratch.decoded_[piece.index()] + static_cast<std::ptrdiff_t>(k) * row_floats;
    const int row = row_of(tile, piece, k);
    image::decode_texels(cubemap_.format, texel(face, row, first_column(tile, piece)), tile.positions, rgb);
    sanitize(tile, face, piece, row, rgb, record);
  }
  return {scratch.decoded_[piece.index()], row_floats * static_cast<std::ptrdiff_t>(sizeof(float))};
}

void StripProjection::sanitize(const Tile& tile, int face, const Piece& piece, int row, float* rgb,
                               SanitizeRecord& record) const {
  if (!sanitizer_.may_change(cubemap_.format, rgb, tile.positions)) return;
  float solid_angles[kSegment];
  const int mirrored = std::min(row, cubemap_.size - 1 - row);
  image::texel_kernels().expand_texels({cubemap_.size, mirrored, tile.first_column, tile.positions, 1, midpoint_},
                                       weights_.weight_rows().data(), solid_angles, kSegment);
  sanitizer_.sanitize({.rgb = rgb,
                       .count = tile.positions,
                       .face = face,
                       .row = row,
                       .first_column = first_column(tile, piece),
                       .weights = piece.right ? solid_angles + tile.positions - 1 : solid_angles,
                       .weight_step = piece.right ? -1 : 1},
                      record);
}

void StripProjection::sum_sanitized(const Tile& tile, int face, Scratch& scratch, SanitizeRecord& record) const {
  sum_pieces(
      fold_rgb32f, tile, face,
      [&](const Piece& piece) { return decode_and_sanitize(tile, face, piece, scratch, record); }, scratch);
  const int faces[] = {face};
  weigh(tile, faces, scratch);
  projection_kernels().fold_sum_lanes(scratch.lanes(face), sums(), scratch.totals_);
}

/// For finite texels near the largest float, whose sums fit a double only: rare, so it is slow.
void StripProjection::sum_in_double(const Tile& tile, int face, Scratch& scratch) const {
  std::fill_n(scratch.totals_, sums(), 0.0);
  float* const weights = scratch.weight_rows_;
  float rgb[kChannels * kSegment];
  SanitizeRecord counted_before;
  for (int k = 0; k < kStripRows; ++k) {
    weights_.fill_row(tile.strip * kStripRows + k, tile.first_column, tile.positions, weights, tile.positions);
    for (const Piece& piece : {Piece{false, false}, Piece{false, true}, Piece{true, false}, Piece{true, true}}) {
      const int row = row_of(tile, piece, k);
      image::decode_texels(cubemap_.format, texel(face, row, first_column(tile, piece)), tile.positions, rgb);
      sanitize(tile, face, piece, row, rgb, counted_before);
      for (int t = 0; t < tile.positions; ++t) {
        const float* const texel_rgb = rgb + kChannels * (piece.right ? tile.positions - 1 - t : t);
        // The signs are those of `classes_of` (strip_kernels.cpp): odd in u is right less left, odd in v is bottom less
        // top, and odd in both is their product.
        // A position's sign in each class: by its piece.
        for (int f = 0, symmetry = -1, left = 0; f < functions_; ++f, --left) {
          while (left == 0) left = weights_.class_counts().count[++symmetry];
          const bool odd_in_u = symmetry % 2 == 1;
          const bool odd_in_v = symmetry >= 2;
          const bool negative = (odd_in_u && !piece.right) != (odd_in_v && !piece.bottom);
          const double weight = static_cast<double>(weights[f * tile.positions + t]) * (negative ? -1.0 : 1.0);
          for (int c = 0; c < kChannels; ++c) {
            scratch.totals_[c * functions_ + f] += weight * static_cast<double>(texel_rgb[c]);
          }
        }
      }
    }
  }
}

}  // namespace welkin::projection
