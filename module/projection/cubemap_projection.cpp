// The projection of a cubemap, from tiles down to rows.
//
// A tile is a few chunks of the face's top left quadrant, taken over all six faces: what a position there
// weighs is looked up or computed once and used for 24 texels. Per chunk and face: rows are folded into
// symmetry classes (FoldQuadrants), and the planes of sums and differences multiplied with the weights
// (WeightedSums). Per tile and face the sums turn from the face's frame to the world's.
//
// Finite pixels pay nothing for the policies: a NaN or an infinity anywhere makes a tile's sums of that face
// non-finite, and only then (or when an option wants every texel looked at) are its texels decoded, sanitized
// and summed again.
#include "projection/cubemap_projection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/memory.h"
#include "projection/project.h"
#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "projection/strip_projection.h"
#include "projection/texel_weights.h"
#include "simd/dispatch.h"
#include "transform/frame_transform.h"

namespace welkin::projection {
namespace {

using projection::QuadrantChunk;
using simd::kLanes;

constexpr int kFaces = 6;
constexpr int kClasses = kMaximumClasses;
/// How many chunks a tile has: some 64 tiles a cubemap, enough for many cores, of 4 to 16 chunks, 24 576 to 98 304
/// texels, 10 to 50 microseconds: long against the microsecond that a tile's own work takes.
int chunks_per_tile(int chunk_count) { return std::clamp(chunk_count / 64, 4, 16); }

constexpr std::array<int, kFaces> kAllFaces{0, 1, 2, 3, 4, 5};

TexelWeightsKey weights_key(int size, const ProjectionOptions& options) {
  return {size, options.bands, options.quadrature == Quadrature::midpoint, options.target_size.value_or(size)};
}

std::size_t tiles_of(int size, const ProjectionOptions& options, const TexelWeights& weights) {
  if (StripProjection::serves(size, options)) return static_cast<std::size_t>(StripProjection::tile_count(size));
  const int chunks = weights.chunk_count();
  return static_cast<std::size_t>((chunks + chunks_per_tile(chunks) - 1) / chunks_per_tile(chunks));
}

constexpr std::ptrdiff_t kCacheLine = 64;

/// What fits here stays there between calls, and fetching it would only take time.
constexpr std::ptrdiff_t kSecondLevelCache = std::ptrdiff_t{1} << 20U;

bool is_beyond_cache(const CubemapView& cubemap) {
  const auto packed = static_cast<std::ptrdiff_t>(bytes_per_texel(cubemap.format)) * cubemap.size;
  const std::ptrdiff_t row_bytes = cubemap.row_stride_bytes != 0 ? std::abs(cubemap.row_stride_bytes) : packed;
  return row_bytes * cubemap.size * kFaces > kSecondLevelCache;
}

/// Stands in for the bottom row where a row is its own mirror image.
alignas(64) constexpr std::byte kZeros[kChunk * 16]{};

/// What one worker needs; made before the tiles run, in two pieces (a small cubemap takes ten microseconds,
/// and every allocation a tenth of one).
class Scratch {
 public:
  Scratch(int functions, std::size_t weight_floats)
      : floats_(kPlaneFloats + kRunFloats + weight_floats),
        doubles_(static_cast<std::size_t>(kFaces * 3 * functions) * kSumLanes + 2 * sums_of(functions)),
        functions_(functions) {}

  [[nodiscard]] float* planes() noexcept { return floats_.data(); }  ///< [3][kClasses][kChunk]
  /// Decoded runs of a row: top left, top right, bottom left, bottom right.
  [[nodiscard]] float* run(int index) noexcept { return planes() + kPlaneFloats + std::ptrdiff_t{3} * kChunk * index; }
  [[nodiscard]] float* weights() noexcept { return planes() + kPlaneFloats + kRunFloats; }

  /// A face's sums, spread over lanes: [3][functions][kSumLanes].
  [[nodiscard]] double* lanes(int face) noexcept {
    return doubles_.data() + static_cast<std::size_t>(face) * sums_of(functions_) * kSumLanes;
  }
  /// One face's sums, [3][functions]; and those of its sanitized chunks so far.
  [[nodiscard]] std::span<double> face_sums() noexcept { return {lanes(kFaces), sums_of(functions_)}; }
  [[nodiscard]] std::span<double> sanitized_sums() noexcept {
    return {lanes(kFaces) + sums_of(functions_), sums_of(functions_)};
  }

 private:
  static constexpr std::size_t kPlaneFloats = std::size_t{3} * kClasses * kChunk;
  static constexpr std::size_t kRunFloats = std::size_t{4} * 3 * kChunk;

  static std::size_t sums_of(int functions) { return static_cast<std::size_t>(3 * functions); }

  platform::AlignedBuffer<float> floats_;
  platform::AlignedBuffer<double> doubles_;
  int functions_;
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

ProjectionDiagnostics diagnostics_at(int size, std::span<const glm::dvec3> radiance, const SanitizeRecord& record) {
  // Weight 0 is the solid angle times Y(0,0) = 1 / sqrt(4 pi).
  ProjectionDiagnostics diagnostics = diagnostics_of(radiance, record, 2.0 * std::sqrt(std::numbers::pi));
  diagnostics.texels =
      static_cast<std::uint64_t>(kFaces) * static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size);
  return diagnostics;
}

Projection projection_of(SphericalHarmonics radiance, const SanitizeRecord& record, int size) {
  throw_if_rejected(record, true);
  Projection projection{std::move(radiance), {}};
  projection.diagnostics = diagnostics_at(size, projection.radiance.coefficients(), record);
  return projection;
}

class CubemapProjection {
 public:
  /// `weights` are those of the cubemap's size and must stay.
  CubemapProjection(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                    const TexelWeights& weights)
      : cubemap_(cubemap),
        faces_(faces),
        sanitizer_(options.pixels),
        functions_(options.bands * options.bands),
        bands_(options.bands),
        texel_bytes_(static_cast<std::ptrdiff_t>(bytes_per_texel(cubemap.format))),
        row_bytes_(cubemap.row_stride_bytes != 0 ? cubemap.row_stride_bytes : texel_bytes_ * cubemap.size),
        kernels_(projection_kernels()),
        direct_fold_(direct_fold(cubemap.format)),
        fetches_ahead_(options.bands == 3 && is_beyond_cache(cubemap)),
        weights_(&weights),
        tile_chunks_(chunks_per_tile(weights.chunk_count())),
        tile_count_(static_cast<int>(tiles_of(cubemap.size, options, weights))) {
    if (StripProjection::serves(cubemap.size, options)) {
      strips_.emplace(cubemap, options, faces, sanitizer_, weights_->place().data());
    }
  }

  Projection run(const Control& control) {
    TileSums sums(static_cast<std::size_t>(tile_count_), bands_);
    // Shared tables are built here, not inside a tile.
    for (int face = 0; face < kFaces; ++face) static_cast<void>(transforms::face_transform(face, bands_));
    run_tiles(control, [&](std::size_t tile, int face, const double* face_sums, const SanitizeRecord& record) {
      transforms::face_transform(face, bands_).add(face_sums, weights_->place().data(), sums.values(tile));
      sums.record(tile).add(record);
    });
    return projection_of(sums.total(), sums.total_record(), cubemap_.size);
  }

  /// In the calling thread, of a cubemap that has no strips. `slot`: [3][functions], of a tile; `sums`: likewise, of
  /// all.
  /// `one_of_many`: its pixels are not in a cache.
  void run_alone(bool one_of_many, Scratch& scratch, std::span<double> slot, std::span<double> sums,
                 SanitizeRecord& record) {
    fetches_ahead_ = fetches_ahead_ || (one_of_many && bands_ == 3);
    std::fill(sums.begin(), sums.end(), 0.0);
    for (std::size_t tile = 0; tile < static_cast<std::size_t>(tile_count_); ++tile) {
      std::fill(slot.begin(), slot.end(), 0.0);
      SanitizeRecord of_tile;
      sum_tile(tile, scratch, [&](std::size_t, int face, const double* face_sums, const SanitizeRecord& of_face) {
        transforms::face_transform(face, bands_).add(face_sums, weights_->place().data(), slot.data());
        of_tile.add(of_face);
      });
      for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += slot[k];
      record.add(of_tile);
    }
  }

  SixFaceSums run_faces(const Control& control) {
    std::array<std::shared_ptr<FaceSums>, kFaces> kept;
    for (const int face : faces_) {
      kept[static_cast<std::size_t>(face)] = std::make_shared<FaceSums>(static_cast<std::size_t>(tile_count_), bands_);
    }
    run_tiles(control, [&](std::size_t tile, int face, const double* face_sums, const SanitizeRecord& record) {
      FaceSums& sums = *kept[static_cast<std::size_t>(face)];
      std::copy_n(face_sums, 3 * functions_, sums.tile(tile));
      sums.records[tile] = record;
    });
    SanitizeRecord all;
    for (const int face : faces_) {
      for (const SanitizeRecord& record : kept[static_cast<std::size_t>(face)]->records) all.add(record);
    }
    throw_if_rejected(all, true);
    SixFaceSums result;
    std::move(kept.begin(), kept.end(), result.begin());
    return result;
  }

 private:
  /// Calls keep(tile, face, sums, record) for all tiles and faces, from whichever thread.
  template <class Keep>
  void run_tiles(const Control& control, const Keep& keep) {
    const auto texels = static_cast<std::int64_t>(faces_.size()) * cubemap_.size * cubemap_.size;
    const jobs::Placement placement = jobs::placement_for(texels);
    const std::size_t workers = jobs::worker_count(placement);
    if (strips_) {
      run_strips(placement, workers, control, keep);
      return;
    }
    std::vector<Scratch> scratch;
    scratch.reserve(workers);
    for (std::size_t worker = 0; worker < workers; ++worker) {
      scratch.emplace_back(functions_, weights_->scratch_size());
    }
    jobs::run_tiles(static_cast<std::size_t>(tile_count_), placement, workers, control,
                    [&](std::size_t tile, std::size_t worker) { sum_tile(tile, scratch[worker], keep); });
  }

  template <class Keep>
  void run_strips(jobs::Placement placement, std::size_t workers, const Control& control, const Keep& keep) {
    std::vector<StripProjection::Scratch> scratch;
    scratch.reserve(workers);
    for (std::size_t worker = 0; worker < workers; ++worker) scratch.emplace_back(*strips_);
    jobs::run_tiles(static_cast<std::size_t>(tile_count_), placement, workers, control,
                    [&](std::size_t tile, std::size_t worker) {
                      strips_->sum_tile(static_cast<int>(tile), scratch[worker]);
                      for (const int face : faces_) {
                        SanitizeRecord record;
                        const std::span<const double> sums =
                            strips_->face_sums(static_cast<int>(tile), face, scratch[worker], record);
                        keep(tile, face, sums.data(), record);
                      }
                    });
  }

  FoldQuadrants direct_fold(PixelFormat format) const {
    if (sanitizer_.looks_at_every_texel()) return nullptr;
    switch (format) {
      case PixelFormat::rgb32f: return kernels_.fold_quadrants[fold_rgb32f];
      case PixelFormat::rgba32f: return kernels_.fold_quadrants[fold_rgba32f];
      case PixelFormat::rgba16f: return kernels_.fold_quadrants[fold_rgba16f];
      default: return nullptr;
    }
  }

  /// A tile's chunks, first to end - 1.
  struct Chunks {
    int first;
    int end;
  };

  [[nodiscard]] Chunks chunks_of(std::size_t tile) const {
    const int first = static_cast<int>(tile) * tile_chunks_;
    return {first, std::min(first + tile_chunks_, weights_->chunk_count())};
  }

  template <class Keep>
  void sum_tile(std::size_t tile, Scratch& scratch, const Keep& keep) {
    if (direct_fold_ != nullptr) sum_directly(chunks_of(tile), scratch);
    for (const int face : faces_) {
      SanitizeRecord record;
      const bool summed = direct_fold_ != nullptr && fold_face(face, scratch);
      if (!summed) sum_sanitized(chunks_of(tile), face, scratch, record);
      keep(tile, face, scratch.face_sums().data(), record);
    }
  }

  void clear_lanes(int face, Scratch& scratch) const {
    std::fill_n(scratch.lanes(face), 3 * functions_ * kSumLanes, 0.0);
  }

  /// Brings a face's sums from their lanes to scratch.face_sums(); false if they are not all finite.
  [[nodiscard]] bool fold_face(int face, Scratch& scratch) const {
    kernels_.fold_sum_lanes(scratch.lanes(face), 3 * functions_, scratch.face_sums().data());
    return all_finite(scratch.face_sums());
  }

  /// The fast way: all faces of a chunk while its weights are at hand.
  void sum_directly(const Chunks& chunks, Scratch& scratch) {
    for (const int face : faces_) clear_lanes(face, scratch);
    for (int index = chunks.first; index < chunks.end; ++index) {
      const QuadrantChunk chunk = weights_->chunk(index);
      const float* const weights = weights_->chunk_weights(index, scratch.weights());
      for (std::size_t at = 0; at < faces_.size(); ++at) {
        const int face = faces_[at];
        const FetchAhead ahead = read_next(index, at);
        fold_directly(chunk, face, ahead, scratch);
        sum_planes(chunk, face, weights, ahead, scratch);
      }
    }
  }

  /// The careful way for one face, chunk by chunk: every texel passes the policies. Leaves scratch.face_sums().
  void sum_sanitized(const Chunks& chunks, int face, Scratch& scratch, SanitizeRecord& record) {
    const std::span<double> total = scratch.sanitized_sums();
    const std::span<double> face_sums = scratch.face_sums();
    std::fill(total.begin(), total.end(), 0.0);
    for (int index = chunks.first; index < chunks.end; ++index) {
      const QuadrantChunk chunk = weights_->chunk(index);
      const float* const weights = weights_->chunk_weights(index, scratch.weights());
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

  void sum_planes(const QuadrantChunk& chunk, int face, const float* weights, const FetchAhead& ahead,
                  Scratch& scratch) {
    kernels_.weighted_sums(scratch.planes(), kClasses, weights, weights_->class_counts(), chunk.groups(), ahead,
                           scratch.lanes(face));
  }

  /// What is read after a chunk on a face: the same chunk on the next face, or the next chunk on the first.
  /// Several short rows count as one stretch each at the top and at the bottom, as if rows were packed.
  /// (The next tile's first chunk too: as a rule the same thread goes on with it.)
  [[nodiscard]] FetchAhead read_next(int index, std::size_t at) const {
    if (!fetches_ahead_) return {};
    const bool last_face = at + 1 == faces_.size();
    if (last_face && index + 1 == weights_->chunk_count()) return {};
    const QuadrantChunk chunk = weights_->chunk(last_face ? index + 1 : index);
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
      return {
          {address(lowest_top), address(lowest_top) + bytes, address(lowest_bottom), address(lowest_bottom) + bytes},
          lines};
    }
    const std::ptrdiff_t skipped = first.first_column * texel_bytes_;
    return {{address(first.top + skipped), address(mirrored(first.top, first.first_column, chunk.column_count)),
             address(bottom + skipped), address(mirrored(bottom, first.first_column, chunk.column_count))},
            lines};
  }

  [[nodiscard]] RowRun row_run(const QuadrantChunk& chunk, int face, int index) const {
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
            .paired = std::min(chunk.column_count, cubemap_.size / 2 - chunk.first_column),
            .position = index * chunk.groups_per_row * kLanes};
  }

  /// First texel of the run's mirror image in u, `count` texels in memory order.
  [[nodiscard]] const std::byte* mirrored(const std::byte* row, int first_column, int count) const {
    return row + (cubemap_.size - first_column - count) * texel_bytes_;
  }

  /// Where `whole` positions of `rows` rows from `run` on and their mirror images lie.
  [[nodiscard]] QuadrantRuns runs_in_place(const RowRun& run, int rows, int whole) const {
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

  /// Folds a chunk in place: all rows at once where they consist of whole groups and each has a mirror image.
  void fold_directly(const QuadrantChunk& chunk, int face, const FetchAhead& ahead, Scratch& scratch) {
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

  /// The positions from `whole` on: less than a group, or a middle column.
  void fold_rest(RowRun run, int whole, Scratch& scratch) {
    run.first_column += whole;
    run.count -= whole;
    run.paired -= whole;
    run.position += whole;
    decode(run, scratch);
    fold_decoded(run, scratch);
  }

  /// Decodes a row's four runs, each padded with zeros to whole groups so that position k
  /// meets its mirror image: left runs start at 0, right ones end at the end.
  void decode(const RowRun& run, Scratch& scratch) const {
    const int padded = (run.count + kLanes - 1) / kLanes * kLanes;
    const std::byte* const rows[2] = {run.top, run.bottom};
    for (int side = 0; side < 2; ++side) {
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

  /// `weights`: of the run's first position, row 0 being the solid angle.
  void decode_and_sanitize(const RowRun& run, const float* weights, Scratch& scratch, SanitizeRecord& record) const {
    decode(run, scratch);
    const int padded = (run.count + kLanes - 1) / kLanes * kLanes;
    const int right_column = cubemap_.size - run.first_column - run.paired;
    for (int side = 0; side < 2; ++side) {
      if (side == 1 && run.bottom == nullptr) break;
      const int row = side == 0 ? run.row : run.mirrored_row;
      sanitize({.rgb = scratch.run(2 * side),
                .count = run.count,
                .face = run.face,
                .row = row,
                .first_column = run.first_column,
                .weights = weights,
                .weight_step = 1,
                .weight_scale = 1.0},
               record);
      sanitize({.rgb = scratch.run(2 * side + 1) + static_cast<std::ptrdiff_t>(3) * (padded - run.paired),
                .count = run.paired,
                .face = run.face,
                .row = row,
                .first_column = right_column,
                .weights = weights + run.paired - 1,
                .weight_step = -1,
                .weight_scale = 1.0},
               record);
    }
  }

  void sanitize(const TexelRun& run, SanitizeRecord& record) const {
    if (!sanitizer_.gamma() && !kernels_.any_outside(run.rgb, 3 * run.count, sanitizer_.low(), sanitizer_.high()))
      return;
    sanitizer_.sanitize(run, record);
  }

  void fold_decoded(const RowRun& run, Scratch& scratch) {
    kernels_.fold_quadrants[fold_rgb32f]({scratch.run(0), scratch.run(1), scratch.run(2), scratch.run(3), 0, 0, 1}, {},
                                         (run.count + kLanes - 1) / kLanes, scratch.planes() + run.position);
  }

  /// Leaves a chunk's sums on one face in scratch.face_sums(). For finite texels near the largest float, whose
  /// sums fit a double only: rare, so it may be slow and use the stack.
  void sum_in_double(const QuadrantChunk& chunk, int face, const float* weights, Scratch& scratch) const {
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
    weighted_sums_in_double(planes, kClasses, weights, weights_->class_counts(), chunk.groups() * kLanes,
                            scratch.face_sums().data());
  }

  const CubemapView& cubemap_;
  std::span<const int> faces_;
  Sanitizer sanitizer_;
  int functions_;
  int bands_;
  std::ptrdiff_t texel_bytes_;
  std::ptrdiff_t row_bytes_;
  const ProjectionKernels& kernels_;
  FoldQuadrants direct_fold_;
  bool fetches_ahead_;
  const TexelWeights* weights_;
  int tile_chunks_;
  int tile_count_;
  std::optional<StripProjection> strips_;  ///< where they serve; else chunks
};

}  // namespace

Projection project_cubemap(const CubemapView& cubemap, const ProjectionOptions& options, const Control& control) {
  const auto weights = TexelWeights::get(weights_key(cubemap.size, options));
  return CubemapProjection(cubemap, options, kAllFaces, *weights).run(control);
}

SixFaceSums sum_faces(const CubemapView& cubemap, const ProjectionOptions& options, std::span<const int> faces,
                      const Control& control) {
  const auto weights = TexelWeights::get(weights_key(cubemap.size, options));
  return CubemapProjection(cubemap, options, faces, *weights).run_faces(control);
}

std::size_t tiles_of_face(int size, const ProjectionOptions& options) {
  return tiles_of(size, options, *TexelWeights::get(weights_key(size, options)));
}

Projection total_of_faces(const SixFaceSums& faces, int size, const ProjectionOptions& options) {
  const std::shared_ptr<const TexelWeights> weights = TexelWeights::get(weights_key(size, options));
  TileSums sums(faces.front()->records.size(), options.bands);
  for (std::size_t tile = 0; tile < faces.front()->records.size(); ++tile) {
    for (int face = 0; face < kFaces; ++face) {
      const FaceSums& kept = *faces[static_cast<std::size_t>(face)];
      transforms::face_transform(face, options.bands).add(kept.tile(tile), weights->place().data(), sums.values(tile));
      sums.record(tile).add(kept.records[tile]);
    }
  }
  return projection_of(sums.total(), sums.total_record(), size);
}

namespace {

double estimate_at(int size, std::span<const glm::dvec3> radiance, const ProjectionOptions& options) {
  const bool midpoint = options.quadrature == Quadrature::midpoint;
  return estimate_error(
      radiance, {midpoint ? static_cast<double>(size) : 0.0, static_cast<double>(options.target_size.value_or(0))});
}

}  // namespace

void describe_projection(Projection& projection, int size, const ProjectionOptions& options) {
  ProjectionDiagnostics& diagnostics = projection.diagnostics;
  diagnostics.error_estimate = estimate_at(size, projection.radiance.coefficients(), options);
  if (const int target = options.target_size.value_or(0); target > 0) {
    diagnostics.passes.push_back({"reduce", PassAction::skip,
                                  "averaging by solid angle to " + std::to_string(target) + " is part of the weights"});
  }
  diagnostics.passes.push_back(
      {"project", PassAction::run, "six faces of " + std::to_string(size) + " x " + std::to_string(size) + " texels"});
}

// Small cubemaps, one after the other.

struct SmallCubemaps::Room {
  Room(int functions, std::size_t weight_floats)
      : scratch(functions, weight_floats), slot(static_cast<std::size_t>(3 * functions)), sums(slot.size()) {}

  Scratch scratch;
  std::vector<double> slot;
  std::vector<double> sums;
};

SmallCubemaps::SmallCubemaps(const ProjectionOptions& options, bool one_of_many)
    : options_(options), one_of_many_(one_of_many) {
  // Shared tables are built here, not inside a tile.
  for (int face = 0; face < kFaces; ++face) static_cast<void>(transforms::face_transform(face, options.bands));
}

SmallCubemaps::~SmallCubemaps() = default;

bool SmallCubemaps::serves(int size, const ProjectionOptions& options) noexcept {
  if (options.quadrature == Quadrature::midpoint && effective_target(size, options)) return false;
  const std::int64_t texels = std::int64_t{kFaces} * size * size;
  return jobs::placement_for(texels) == jobs::Placement::calling_thread && !StripProjection::serves(size, options);
}

ProjectionOptions SmallCubemaps::options_at(int size) const {
  ProjectionOptions options = options_;
  options.target_size = effective_target(size, options_);
  return options;
}

void SmallCubemaps::prepare(int size) {
  const auto at = static_cast<std::size_t>(size);
  if (weights_.size() <= at) weights_.resize(at + 1);
  if (!weights_[at]) weights_[at] = TexelWeights::get(weights_key(size, options_at(size)));
}

void SmallCubemaps::make_rooms(std::size_t workers) {
  std::size_t weight_floats = 0;
  for (const auto& weights : weights_) weight_floats = std::max(weight_floats, weights ? weights->scratch_size() : 0);
  rooms_.clear();
  rooms_.reserve(workers);
  while (rooms_.size() < workers) {
    rooms_.push_back(std::make_unique<Room>(options_.bands * options_.bands, weight_floats));
  }
}

ProjectionDiagnostics SmallCubemaps::project(const CubemapView& cubemap, std::size_t worker,
                                             std::span<glm::dvec3> radiance, SanitizeRecord& record) const {
  Room& room = *rooms_[worker];
  const ProjectionOptions options = options_at(cubemap.size);
  const TexelWeights& weights = *weights_[static_cast<std::size_t>(cubemap.size)];
  CubemapProjection(cubemap, options, kAllFaces, weights)
      .run_alone(one_of_many_, room.scratch, room.slot, room.sums, record);
  const std::size_t functions = radiance.size();
  for (std::size_t f = 0; f < functions; ++f) {
    radiance[f] = {room.sums[f], room.sums[functions + f], room.sums[2 * functions + f]};
  }
  ProjectionDiagnostics diagnostics = diagnostics_at(cubemap.size, radiance, record);
  diagnostics.error_estimate = estimate_at(cubemap.size, radiance, options);
  return diagnostics;
}

}  // namespace welkin::projection
