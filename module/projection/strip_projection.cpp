#include "projection/strip_projection.h"

#include <algorithm>
#include <array>

#include "image/image_kernels.h"
#include "image/pixels.h"
#include "projection/projection_kernels.h"
#include "projection/tile_sums.h"

namespace welkin::projection {
namespace {

using simd::kLanes;

constexpr int kBands = 3;
constexpr int kChannels = 3;
constexpr int kSums = kChannels * kStripFunctions;
constexpr int kPieces = 4;
constexpr std::ptrdiff_t kCacheLine = 64;

int segments_of(int size) { return (size / 2 + kSegment - 1) / kSegment; }

/// The most positions that a tile has.
int widest_segment(int size) { return std::min(kSegment, size / 2); }

std::size_t piece_floats(int moments, int positions) {
  return static_cast<std::size_t>(moments * moment_stride(positions));
}

std::size_t spare_floats(const StripWeights& weights, int positions) {
  return std::max(weights.scratch_size(positions), piece_floats(weights.moments(), positions));
}

/// What SumMoments asks for at a time: about half a face's piece of three floats a texel. (Measured at 1024 on Zen 4,
/// in cycles for 64 texels: nothing asked for 175, all of it by SumStrip 150, shared 142.)
constexpr int kLinesAProduct = 8;

int lines_in(std::ptrdiff_t bytes) { return static_cast<int>((bytes + kCacheLine - 1) / kCacheLine); }

}  // namespace

bool StripProjection::serves(int size, const ProjectionOptions& options) noexcept {
  return options.bands == kBands && options.target_size.value_or(size) >= size && StripWeights::serve(size);
}

int StripProjection::tile_count(int size) noexcept { return size / 2 / kStripRows * segments_of(size); }

StripProjection::StripProjection(const CubemapView& cubemap, const ProjectionOptions& options,
                                 std::span<const int> faces, const Sanitizer& sanitizer, const int* weight_rows)
    : cubemap_(cubemap),
      faces_(faces),
      sanitizer_(sanitizer),
      weight_rows_(weight_rows),
      midpoint_(options.quadrature == Quadrature::midpoint),
      texel_bytes_(static_cast<std::ptrdiff_t>(bytes_per_texel(cubemap.format))),
      row_bytes_(cubemap.row_stride_bytes != 0 ? cubemap.row_stride_bytes : texel_bytes_ * cubemap.size),
      strip_weights_(cubemap.size, midpoint_, weight_rows),
      moments_(strip_weights_.moments()),
      kernels_(strip_kernels()),
      sum_decoded_(kernels_.sum_strip[strip_rgb32f][moments_ - kFewestMoments]) {
  if (sanitizer.looks_at_every_texel()) return;
  const auto direct = [&](StripFormat format) { return kernels_.sum_strip[format][moments_ - kFewestMoments]; };
  switch (cubemap.format) {
    case PixelFormat::rgb32f: sum_direct_ = direct(strip_rgb32f); break;
    case PixelFormat::rgba32f: sum_direct_ = direct(strip_rgba32f); break;
    case PixelFormat::rgba16f: sum_direct_ = direct(strip_rgba16f); break;
    default: break;
  }
  // As many lines as 16 values of 16 rows are: what is asked for keeps up with what is read.
  lines_a_step_ = cubemap.format == PixelFormat::rgba16f ? kStripRows / 2 : kStripRows;
}

// A worker's scratch memory, one part after the other.

StripProjection::Scratch::Scratch(const StripProjection& projection) {
  const int positions = widest_segment(projection.cubemap_.size);
  const int moments = projection.moments_;
  floats_ = platform::AlignedBuffer<float>(projection.strip_weights_.room_size(positions) +
                                           kFacesAtOnce * kPieces * piece_floats(moments, positions) +
                                           spare_floats(projection.strip_weights_, positions) +
                                           static_cast<std::size_t>(kStripRows * kChannels * positions));
  doubles_ = platform::AlignedBuffer<double>(static_cast<std::size_t>(6 * kSums * kSumLanes + kSums));
}

float* StripProjection::room(Scratch& scratch) noexcept { return scratch.floats_.data(); }

float* StripProjection::face_moments(Scratch& scratch, int index) const noexcept {
  const int positions = widest_segment(cubemap_.size);
  return room(scratch) + strip_weights_.room_size(positions) +
         static_cast<std::size_t>(index * kPieces) * piece_floats(moments_, positions);
}

float* StripProjection::spare(Scratch& scratch) const noexcept { return face_moments(scratch, kFacesAtOnce); }

float* StripProjection::decoded(Scratch& scratch) const noexcept {
  return spare(scratch) + spare_floats(strip_weights_, widest_segment(cubemap_.size));
}

double* StripProjection::lanes(Scratch& scratch, int face) noexcept {
  return scratch.doubles_.data() + static_cast<std::ptrdiff_t>(face) * kSums * kSumLanes;
}

double* StripProjection::totals(Scratch& scratch) noexcept { return lanes(scratch, 6); }

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

namespace {

constexpr std::array<std::array<bool, 2>, kPieces> kPieceSides{
    {{false, false}, {false, true}, {true, false}, {true, true}}};

}  // namespace

FetchList StripProjection::lines_of(const Tile& tile, int face) const noexcept {
  FetchList list;
  if (tile.first_column + tile.positions == cubemap_.size / 2) {  // left and right are one
    const std::ptrdiff_t bytes = 2 * tile.positions * texel_bytes_;
    const bool whole_rows = bytes == row_bytes_;
    list.area_count = 2;
    for (int k = 0; k < 2; ++k) {
      const std::byte* const first =
          texel(face, row_of(tile, {k == 1, false}, k == 1 ? kStripRows - 1 : 0), tile.first_column);
      list.areas[k] = {reinterpret_cast<const char*>(first), row_bytes_,
                       lines_in(whole_rows ? kStripRows * bytes : bytes), whole_rows ? 1 : kStripRows};
    }
    return list;
  }
  list.area_count = kPieces;
  for (int k = 0; k < kPieces; ++k) {
    const auto [bottom, right] = kPieceSides[static_cast<std::size_t>(k)];
    const Piece piece{bottom, right};
    const std::byte* const first =
        texel(face, row_of(tile, piece, bottom ? kStripRows - 1 : 0), first_column(tile, piece));
    list.areas[k] = {reinterpret_cast<const char*>(first), row_bytes_, lines_in(tile.positions * texel_bytes_),
                     kStripRows};
  }
  return list;
}

/// What is read after a tile on the at-th face. (The next tile's first face too: as a rule the same thread goes on.)
FetchList StripProjection::lines_after(int tile, std::size_t at) const noexcept {
  if (at + 1 < faces_.size()) return lines_of(tile_at(tile), faces_[at + 1]);
  if (tile + 1 < tile_count(cubemap_.size)) return lines_of(tile_at(tile + 1), faces_[0]);
  return {};
}

// Pixels to sums.

void StripProjection::sum_piece(SumStrip sum, const StripRows& rows, const Tile& tile, int piece, FetchList& fetch,
                                int lines, float* moments, Scratch& scratch) const {
  const int stride = moment_stride(tile.positions);
  float* const to = moments + static_cast<std::size_t>(piece) * piece_floats(moments_, tile.positions);
  const bool right = kPieceSides[static_cast<std::size_t>(piece)][1];
  float* const summed = right ? spare(scratch) : to;
  sum(rows, tile.positions, fetch, lines, summed, stride);
  if (right) kernels_.reverse_moments(summed, moments_, tile.positions, stride, to);
}

void StripProjection::sum_tile(int index, Scratch& scratch) const {
  const Tile tile = tile_at(index);
  scratch.weights_ = strip_weights_.at(tile.strip, tile.first_column, tile.positions, room(scratch), spare(scratch));
  if (sum_direct_ == nullptr) return;
  const int groups = tile.positions / kLanes;
  for (std::size_t first = 0; first < faces_.size(); first += kFacesAtOnce) {
    const std::size_t count = std::min<std::size_t>(kFacesAtOnce, faces_.size() - first);
    StripMoments strip{};
    strip.face_count = static_cast<int>(count);
    FetchList fetch;
    for (std::size_t k = 0; k < count; ++k) {
      const int face = faces_[first + k];
      strip.faces[k] = face_moments(scratch, static_cast<int>(k));
      strip.sums[k] = lanes(scratch, face);
      std::fill_n(strip.sums[k], kSums * kSumLanes, 0.0);
      fetch = lines_after(index, first + k);
      // The last face's moments are read while their products ask for the other half.
      const int lines = k + 1 < count ? lines_a_step_ : lines_a_step_ / 2;
      for (int p = 0; p < kPieces; ++p) {
        const auto [bottom, right] = kPieceSides[static_cast<std::size_t>(p)];
        sum_piece(sum_direct_, rows_in_place(tile, face, {bottom, right}), tile, p, fetch, lines,
                  face_moments(scratch, static_cast<int>(k)), scratch);
      }
    }
    kernels_.sum_moments(strip, moments_, groups, scratch.weights_, fetch, kLinesAProduct);
  }
}

std::span<const double> StripProjection::face_sums(int index, int face, Scratch& scratch,
                                                   SanitizeRecord& record) const {
  const std::span<double> sums{totals(scratch), kSums};
  if (sum_direct_ != nullptr) {
    projection_kernels().fold_sum_lanes(lanes(scratch, face), kSums, sums.data());
    if (all_finite(sums)) return sums;
  }
  const Tile tile = tile_at(index);
  sum_sanitized(tile, face, scratch, record);
  if (!all_finite(sums)) sum_in_double(tile, face, scratch);
  return sums;
}

// The careful way: every texel passes the policies.

void StripProjection::decode_and_sanitize(const Tile& tile, int face, const Piece& piece, Scratch& scratch,
                                          SanitizeRecord& record) const {
  for (int k = 0; k < kStripRows; ++k) {
    float* const rgb = decoded(scratch) + static_cast<std::ptrdiff_t>(k) * kChannels * tile.positions;
    const int row = row_of(tile, piece, k);
    image::decode_texels(cubemap_.format, texel(face, row, first_column(tile, piece)), tile.positions, rgb);
    sanitize(tile, face, piece, row, rgb, record);
  }
}

void StripProjection::sanitize(const Tile& tile, int face, const Piece& piece, int row, float* rgb,
                               SanitizeRecord& record) const {
  if (!sanitizer_.may_change(cubemap_.format, rgb, tile.positions)) return;
  float solid_angles[kSegment];
  const int mirrored = std::min(row, cubemap_.size - 1 - row);
  image::texel_kernels().expand_texels({cubemap_.size, mirrored, tile.first_column, tile.positions, 1, midpoint_},
                                       weight_rows_, solid_angles, kSegment);
  sanitizer_.sanitize({.rgb = rgb,
                       .count = tile.positions,
                       .face = face,
                       .row = row,
                       .first_column = first_column(tile, piece),
                       .weights = piece.right ? solid_angles + tile.positions - 1 : solid_angles,
                       .weight_step = piece.right ? -1 : 1,
                       .weight_scale = 1.0},
                      record);
}

void StripProjection::sum_sanitized(const Tile& tile, int face, Scratch& scratch, SanitizeRecord& record) const {
  FetchList nothing;
  const std::ptrdiff_t row_bytes =
      std::ptrdiff_t{kChannels} * tile.positions * static_cast<std::ptrdiff_t>(sizeof(float));
  for (int p = 0; p < kPieces; ++p) {
    const auto [bottom, right] = kPieceSides[static_cast<std::size_t>(p)];
    decode_and_sanitize(tile, face, {bottom, right}, scratch, record);
    sum_piece(sum_decoded_, {decoded(scratch), row_bytes}, tile, p, nothing, 0, face_moments(scratch, 0), scratch);
  }
  std::fill_n(lanes(scratch, face), kSums * kSumLanes, 0.0);
  StripMoments strip{};
  strip.face_count = 1;
  strip.faces[0] = face_moments(scratch, 0);
  strip.sums[0] = lanes(scratch, face);
  kernels_.sum_moments(strip, moments_, tile.positions / kLanes, scratch.weights_, nothing, 0);
  projection_kernels().fold_sum_lanes(lanes(scratch, face), kSums, totals(scratch));
}

/// For finite texels near the largest float, whose sums fit a double only: rare, so it is slow and uses the stack.
void StripProjection::sum_in_double(const Tile& tile, int face, Scratch& scratch) const {
  std::fill_n(totals(scratch), kSums, 0.0);
  alignas(64) float weights[kStripFunctions * kSegment];
  float rgb[kChannels * kSegment];
  // A position's sign in each class: by its piece.
  constexpr int kFunctionsOfClasses[kMaximumClasses] = {4, 2, 2, 1};
  SanitizeRecord counted_before;
  for (int k = 0; k < kStripRows; ++k) {
    image::texel_kernels().expand_texels(
        {cubemap_.size, tile.strip * kStripRows + k, tile.first_column, tile.positions, kBands, midpoint_},
        weight_rows_, weights, kSegment);
    for (const auto [bottom, right] : kPieceSides) {
      const Piece piece{bottom, right};
      const int row = row_of(tile, piece, k);
      image::decode_texels(cubemap_.format, texel(face, row, first_column(tile, piece)), tile.positions, rgb);
      sanitize(tile, face, piece, row, rgb, counted_before);
      for (int t = 0; t < tile.positions; ++t) {
        const float* const texel_rgb = rgb + kChannels * (right ? tile.positions - 1 - t : t);
        for (int f = 0, symmetry = 0, left = kFunctionsOfClasses[0]; f < kStripFunctions; ++f, --left) {
          if (left == 0) left = kFunctionsOfClasses[++symmetry];
          const bool odd_in_u = symmetry % 2 == 1;
          const bool odd_in_v = symmetry >= 2;
          const bool negative = (odd_in_u && !right) != (odd_in_v && !bottom);
          const double weight = static_cast<double>(weights[f * kSegment + t]) * (negative ? -1.0 : 1.0);
          for (int c = 0; c < kChannels; ++c) {
            totals(scratch)[c * kStripFunctions + f] += weight * static_cast<double>(texel_rgb[c]);
          }
        }
      }
    }
  }
}

}  // namespace welkin::projection
