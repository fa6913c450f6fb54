#include "projection/chunk_projection.h"

#include <algorithm>
#include <cstdlib>

#include "image/pixels.h"
#include "projection/tile_sums.h"
#include "simd/dispatch.h"

namespace welkin::projection {
namespace {

using simd::kLanes;

constexpr int kFaces = 6;
constexpr int kClasses = kMaximumClasses;

/// How many chunks a tile has: some 64 tiles a cubemap, enough for many cores, of 4 to 16 chunks, 24 576 to 98 304
/// texels, 10 to 50 microseconds: long against the microsecond that a tile's own work takes.
int chunks_per_tile(int chunk_count) { return std::clamp(chunk_count / 64, 4, 16); }

constexpr std::ptrdiff_t kCacheLine = 64;

/// Bytes. Data that fits stays cached between calls, so that prefetching it would only take time.
constexpr std::ptrdiff_t kSecondLevelCache = std::ptrdiff_t{1} << 20U;

bool is_beyond_cache(const CubemapView& cubemap) {
  const auto packed = static_cast<std::ptrdiff_t>(bytes_per_texel(cubemap.format)) * cubemap.size;
  const std::ptrdiff_t row_bytes = cubemap.row_stride_bytes != 0 ? std::abs(cubemap.row_stride_bytes) : packed;
  return row_bytes * cubemap.size * kFaces > kSecondLevelCache;
}

/// Stands in for the bottom row where a row is its own mirror image.
alignas(64) constexpr std::byte kZeros[kChunk * 16]{};

}  // namespace

int ChunkProjection::tile_count(const TexelWeights& weights) noexcept {
  const int chunks = weights.chunk_count();
  return (chunks + chunks_per_tile(chunks) - 1) / chunks_per_tile(chunks);
}

ChunkProjection::ChunkProjection(const CubemapView& cubemap, const ProjectionOptions& options,
                                 std::span<const int> faces, const Sanitizer& sanitizer, const TexelWeights& weights,
                                 bool one_of_many)
    : cubemap_(cubemap),
      faces_(faces),
      sanitizer_(sanitizer),
      weights_(weights),
      functions_(options.bands * options.bands),
      texel_bytes_(static_cast<std::ptrdiff_t>(bytes_per_texel(cubemap.format))),
      row_bytes_(cubemap.row_stride_bytes != 0 ? cubemap.row_stride_bytes : texel_bytes_ * cubemap.size),
      kernels_(projection_kernels()),
      direct_fold_(direct_fold(cubemap.format)),
      fetches_ahead_(options.bands == 3 && (one_of_many || is_beyond_cache(cubemap))) {}

FoldQuadrants ChunkProjection::direct_fold(PixelFormat format) const {
  if (sanitizer_.needs_every_texel()) return nullptr;
  const FoldFormat fold = fold_format(format);
  return fold == fold_format_count ? nullptr : kernels_.fold_quadrants[fold];
}

ChunkProjection::Scratch::Scratch(const ChunkProjection& projection)
    : Scratch(projection.functions_, projection.weights_.scratch_size()) {}

ChunkProjection::Scratch::Scratch(int functions, std::size_t weight_floats)
    : sums_(static_cast<std::size_t>(3 * functions)),
      floats_(kPlaneFloats + 4 * kRunFloats + weight_floats),
      doubles_(kFaces * sums_ * kSumLanes + 2 * sums_) {}

// A tile.

ChunkProjection::Chunks ChunkProjection::chunks_of(int tile) const {
  const int count = chunks_per_tile(weights_.chunk_count());
  return {tile * count, std::min((tile + 1) * count, weights_.chunk_count())};
}

void ChunkProjection::sum_tile(int index, Scratch& scratch) const {
  if (direct_fold_ != nullptr) sum_directly(chunks_of(index), scratch);
}

std::span<const double> ChunkProjection::face_sums(int index, int face, Scratch& scratch,
                                                   SanitizeRecord& record) const {
  const bool summed = direct_fold_ != nullptr && fold_face(face, scratch);
  if (!summed) sum_sanitized(chunks_of(index), face, scratch, record);
  return scratch.face_sums();
}

void ChunkProjection::clear_lanes(int face, Scratch& scratch) const {
  std::fill_n(scratch.lanes(face), 3 * functions_ * kSumLanes, 0.0);
}

bool ChunkProjection::fold_face(int face, Scratch& scratch) const {
  kernels_.fold_sum_lanes(scratch.lanes(face), 3 * functions_, scratch.face_sums().data());
  return all_finite(scratch.face_sums());
}

void ChunkProjection::sum_directly(const Chunks& chunks, Scratch& scratch) const {
  for (const int face : faces_) clear_lanes(face, scratch);
  for (int index = chunks.first; index < chunks.end; ++index) {
    const QuadrantChunk chunk = weights_.chunk(index);
    const float* const weights = weights_.chunk_weights(index, scratch.weights());
    for (std::size_t at = 0; at < faces_.size(); ++at) {
      const int face = faces_[at];
      const FetchAhead ahead = read_next(index, at);
      fold_directly(chunk, face, ahead, scratch);
      sum_planes(chunk, face, weights, ahead, scratch);
    }
  }
}

void ChunkProjection::sum_sanitized(const Chunks& chunks, int face, Scratch& scratch, SanitizeRecord& record) const {
  const std::span<double> total = scratch.sanitized_sums();
  const std::span<double> face_sums = scratch.face_sums();
  std::fill(total.begin(), total.end(), 0.0);
  for (int index = chunks.first; index < chunks.end; ++index) {
    const QuadrantChunk chunk = weights_.chunk(index);
    const float* const weights = weights_.chunk_weights(index, scratch.weights());
    clear_lanes(face, scratch);
    for (int row = 0; row < chunk.row_count; ++row) {
      const RowRun run = row_run(chunk, face, row);
      decode_and_sanitize(run, weights + run.position, scratch, record);
      fold_decoded(run, scratch);
    }
    sum_planes(chunk, face, weights, {}, scratch);
    if (!fold_face(face, scratch)) sum_in_double(chunk, face, weights, scratch);
    for (std::size_t k = 0; k < total.size(); ++k) total[k] += face_sums[k];
  }
  std::copy(total.begin(), total.end(), face_sums.begin());
}

void ChunkProjection::sum_planes(const QuadrantChunk& chunk, int face, const float* weights, const FetchAhead& ahead,
                                 Scratch& scratch) const {
  kernels_.weighted_sums(scratch.planes(), kClasses, weights, weights_.class_counts(), chunk.groups(), ahead,
                         scratch.lanes(face));
}

FetchAhead ChunkProjection::read_next(int index, std::size_t at) const {
  if (!fetches_ahead_) return {};
  const bool last_face = at + 1 == faces_.size();
  if (last_face && index + 1 == weights_.chunk_count()) return {};
  const QuadrantChunk chunk = weights_.chunk(last_face ? index + 1 : index);
  const int next_face = faces_[last_face ? 0 : at + 1];
  const RowRun first = row_run(chunk, next_face, 0);
  const RowRun last = row_run(chunk, next_face, chunk.row_count - 1);
  const std::byte* const bottom = last.bottom != nullptr ? last.bottom : last.top;
  const std::byte* const lowest_top = std::min(first.top, last.top);
  const std::byte* const lowest_bottom = std::min(bottom, first.bottom != nullptr ? first.bottom : bottom);
  const auto address = [](const std::byte* p) { return reinterpret_cast<const char*>(p); };
  const std::ptrdiff_t bytes = chunk.column_count * texel_bytes_ * chunk.row_count;
  const int lines = static_cast<int>(bytes / kCacheLine);
  if (chunk.row_count > 1) {  // whole rows: their left and right runs are one stretch, here cut in two
    return {{address(lowest_top), address(lowest_top) + bytes, address(lowest_bottom), address(lowest_bottom) + bytes},
            lines};
  }
  const std::ptrdiff_t skipped = first.first_column * texel_bytes_;
  return {{address(first.top + skipped), address(mirrored(first.top, first.first_column, chunk.column_count)),
           address(bottom + skipped), address(mirrored(bottom, first.first_column, chunk.column_count))},
          lines};
}

ChunkProjection::RowRun ChunkProjection::row_run(const QuadrantChunk& chunk, int face, int index) const {
  const int row = chunk.first_row + index;
  const int mirrored_row = cubemap_.size - 1 - row;
  const auto* const pixels = static_cast<const std::byte*>(cubemap_.faces[static_cast<std::size_t>(face)]);
  return {.top = pixels + row * row_bytes_,
          .bottom = row == mirrored_row ? nullptr : pixels + mirrored_row * row_bytes_,
          .face = face,
          .row = row,
          .mirrored_row = mirrored_row,
          .first_column = chunk.first_column,
          .count = chunk.column_count,
          // Columns from size / 2 on have no mirror image in u: at most the middle one of an odd size. Its right run is
          // 0, so the even classes hold it once. The odd ones hold it negated, where their functions' weights are 0,
          // for u is.
          .paired = std::min(chunk.column_count, cubemap_.size / 2 - chunk.first_column),
          .position = index * chunk.groups_per_row * kLanes};
}

const std::byte* ChunkProjection::mirrored(const std::byte* row, int first_column, int count) const {
  // Column k is mirrored to size - 1 - k, so columns first to first + count - 1 lie from size - first - count on, in
  // the opposite order.
  return row + (cubemap_.size - first_column - count) * texel_bytes_;
}

QuadrantRuns ChunkProjection::runs_in_place(const RowRun& run, int rows, int whole) const {
  const std::ptrdiff_t skipped = run.first_column * texel_bytes_;
  const bool has_bottom = run.bottom != nullptr;
  return {.top_left = run.top + skipped,
          .top_right = mirrored(run.top, run.first_column, whole),
          .bottom_left = has_bottom ? run.bottom + skipped : kZeros,
          .bottom_right = has_bottom ? mirrored(run.bottom, run.first_column, whole) : kZeros,
          .top_stride = row_bytes_,
          .bottom_stride = -row_bytes_,
          .rows = rows};
}

void ChunkProjection::fold_directly(const QuadrantChunk& chunk, int face, const FetchAhead& ahead,
                                    Scratch& scratch) const {
  // Only then half a row is whole groups, without a middle column or a rest.
  const bool at_once = cubemap_.size % (2 * kLanes) == 0;
  const int rows_at_once = at_once ? chunk.row_count : 1;
  for (int row = 0; row < chunk.row_count; row += rows_at_once) {
    const RowRun run = row_run(chunk, face, row);
    const int whole = run.paired / kLanes * kLanes;
    if (whole > 0) {
      direct_fold_(runs_in_place(run, rows_at_once, whole), row == 0 ? ahead : FetchAhead{}, whole / kLanes,
                   scratch.planes() + run.position);
    }
    if (whole < run.count) fold_rest(run, whole, scratch);
  }
}

void ChunkProjection::fold_rest(RowRun run, int whole, Scratch& scratch) const {
  run.first_column += whole;
  run.count -= whole;
  run.paired -= whole;
  run.position += whole;
  decode(run, scratch);
  fold_decoded(run, scratch);
}

void ChunkProjection::decode(const RowRun& run, Scratch& scratch) const {
  const int padded = (run.count + kLanes - 1) / kLanes * kLanes;
  const std::byte* const rows[2] = {run.top, run.bottom};
  for (std::size_t side = 0; side < 2; ++side) {
    float* const left = scratch.run(2 * side);
    float* const right = scratch.run(2 * side + 1);
    std::fill_n(left, 3 * padded, 0.0F);
    std::fill_n(right, 3 * padded, 0.0F);
    if (rows[side] == nullptr) continue;
    image::decode_texels(cubemap_.format, rows[side] + run.first_column * texel_bytes_, run.count, left);
    image::decode_texels(cubemap_.format, mirrored(rows[side], run.first_column, run.paired), run.paired,
                         right + 3 * (padded - run.paired));
  }
}

void ChunkProjection::decode_and_sanitize(const RowRun& run, const float* weights, Scratch& scratch,
                                          SanitizeRecord& record) const {
  decode(run, scratch);
  const int padded = (run.count + kLanes - 1) / kLanes * kLanes;
  const int right_column = cubemap_.size - run.first_column - run.paired;
  for (std::size_t side = 0; side < 2; ++side) {
    if (side == 1 && run.bottom == nullptr) break;
    const int row = side == 0 ? run.row : run.mirrored_row;
    sanitize({.rgb = scratch.run(2 * side),
              .count = run.count,
              .face = run.face,
              .row = row,
              .first_column = run.first_column,
              .weights = weights},
             record);
    sanitize({.rgb = scratch.run(2 * side + 1) + static_cast<std::ptrdiff_t>(3) * (padded - run.paired),
              .count = run.paired,
              .face = run.face,
              .row = row,
              .first_column = right_column,
              .weights = weights + run.paired - 1,
              .weight_step = -1},
             record);
  }
}

void ChunkProjection::sanitize(const TexelRun& run, SanitizeRecord& record) const {
  if (sanitizer_.may_change(cubemap_.format, run.rgb, run.count)) sanitizer_.sanitize(run, record);
}

void ChunkProjection::fold_decoded(const RowRun& run, Scratch& scratch) const {
  kernels_.fold_quadrants[fold_rgb32f]({scratch.run(0), scratch.run(1), scratch.run(2), scratch.run(3), 0, 0, 1}, {},
                                       (run.count + kLanes - 1) / kLanes, scratch.planes() + run.position);
}

void ChunkProjection::sum_in_double(const QuadrantChunk& chunk, int face, const float* weights,
                                    Scratch& scratch) const {
  std::fill_n(scratch.face_sums().data(), 3 * functions_, 0.0);
  double planes[3 * kClasses * kChunk] = {};
  for (int index = 0; index < chunk.row_count; ++index) {
    const RowRun run = row_run(chunk, face, index);
    SanitizeRecord counted_before;
    decode_and_sanitize(run, weights + run.position, scratch, counted_before);
    const int padded = (run.count + kLanes - 1) / kLanes * kLanes;
    for (int k = 0; k < padded; ++k) {
      for (int c = 0; c < 3; ++c) {
        const double tl = scratch.run(0)[3 * k + c];
        const double tr = scratch.run(1)[3 * (padded - 1 - k) + c];
        const double bl = scratch.run(2)[3 * k + c];
        const double br = scratch.run(3)[3 * (padded - 1 - k) + c];
        double* const plane = planes + c * kClasses * kChunk + run.position + k;
        plane[0] = (tl + tr) + (bl + br);
        plane[kChunk] = (tr - tl) + (br - bl);
        plane[2 * kChunk] = (bl + br) - (tl + tr);
        plane[3 * kChunk] = (br - bl) - (tr - tl);
      }
    }
  }
  weighted_sums_in_double(planes, kClasses, weights, weights_.class_counts(), chunk.groups() * kLanes,
                          scratch.face_sums().data());
}

}  // namespace welkin::projection
