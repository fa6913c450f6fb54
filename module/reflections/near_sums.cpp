#include "reflections/near_sums.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numbers>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kCacheBytes = std::size_t{96} << 20U;
constexpr std::size_t kLargestTable = std::size_t{128} << 20U;  ///< by its bound, which is twice of what it takes
constexpr std::int64_t kTexelsOfTap = 10;                       ///< whose sanitizing takes as long as a weight

/// Returns texels that a radian takes, root of those of a steradian where they are largest: (face / 2)^2 at the middle
/// of a face, which spans du dv = 4, and face / (2 pi) rows / pi on the equator.
double texels_of_radian(const NearSplit& split) {
  return split.cubemap() ? 0.5 * split.face : std::sqrt(split.face / (2.0 * kPi) * split.rows / kPi);
}

double directions_of(const NearSplit& split) { return static_cast<double>(NearWeights::directions_of(split)); }

/// Returns a bound on the weights of all of them. In the mean over the sphere a cap of `reach` has reach^2 / 4 of all
/// texels: with t = reach `texels_of_radian` that is 6 t^2 of a cubemap's, pi^2 / 2 t^2 of a lat-long's. The rest is
/// for texels that its end cuts.
double taps_of(const NearSplit& split) {
  const double texels = split.reach * texels_of_radian(split);
  return directions_of(split) * (7.0 * texels * texels + 16.0 * texels + 40.0);
}

std::size_t bytes_of_tiles(const NearSplit& split) {
  const double runs = directions_of(split) * (6.0 * split.reach * texels_of_radian(split) + 12.0);
  return static_cast<std::size_t>(taps_of(split) * sizeof(float) + runs * sizeof(NearRun));
}

/// Returns the rows of the parts of a source that directions with weights may see, no column of them seen.
std::vector<ColumnRange> rows_of(const NearSplit& split) {
  const auto count =
      split.cubemap() ? kNearFaces.size() * static_cast<std::size_t>(split.face) : static_cast<std::size_t>(split.rows);
  return std::vector<ColumnRange>(count, ColumnRange{0, 0});
}

void widen(ColumnRange& range, const ColumnRange& by) {
  if (by.first >= by.end) return;
  range = range.first < range.end ? ColumnRange{std::min(range.first, by.first), std::max(range.end, by.end)} : by;
}

constexpr int kParts = static_cast<int>(kNearFaces.size());
constexpr int kTurns = 3;  ///< of the axes, from x to y to z: with `kRingImages`, all of a cube's symmetries

int turns_of(const NearSplit& split) { return split.cubemap() ? kTurns : 1; }

/// Returns where an image has a texel of the mip, or of the source.
image::CubeTexel image_of(int size, glm::ivec3 point, int rotation, int image) {
  for (int k = 0; k < rotation; ++k) point = {point.y, point.z, point.x};
  return image::texel_at(size, image::moved(image::cube_image_of(image), point));
}

}  // namespace

NearTable::NearTable(const NearSplit& split)
    : split_(split),
      far_(far_spectrum(split.alpha, split.end(), split.bands + split.bands / 2)),
      weights_(split, 1.0 - far_.front()),
      rows_(rows_of(split)) {
  struct Worker {
    NearWeights::Scratch scratch;
    NearTile tile;
    std::vector<ColumnRange> rows;
  };
  const bool kept = bytes_of_tiles(split) <= kLargestTable;
  if (kept) tiles_.resize(weights_.tiles());
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(taps_of(split)) * kTexelsOfTap);
  std::vector<Worker> workers(jobs::worker_count(placement));
  for (Worker& worker : workers) worker.rows = rows_;
  jobs::run_tiles(weights_.tiles(), placement, workers.size(), {}, [&](std::size_t index, std::size_t number) {
    Worker& worker = workers[number];
    NearTile& tile = kept ? tiles_[index] : worker.tile;
    weights_.make(index, tile, worker.scratch);
    for (const NearRun& run : tile.runs)
      widen(worker.rows[static_cast<std::size_t>(run.row)], {run.first, run.first + run.count});
  });
  for (const Worker& worker : workers) {
    for (std::size_t row = 0; row < rows_.size(); ++row) widen(rows_[row], worker.rows[row]);
  }
}

std::shared_ptr<const NearTable> NearTable::get(const NearSplit& split) {
  static auto& cache = *new math::TableCache<NearSplit, NearTable>(kCacheBytes);  // never destroyed
  return cache.get(split, [&] { return std::make_shared<const NearTable>(split); });
}

const NearTile& NearTable::tile(std::size_t index, NearTile& made, NearWeights::Scratch& scratch) const {
  if (!tiles_.empty()) return tiles_[index];
  weights_.make(index, made, scratch);
  return made;
}

std::size_t NearTable::bytes() const noexcept {
  std::size_t sum = sizeof(*this) + far_.size() * sizeof(double) + weights_.directions().size() * sizeof(glm::ivec3) +
                    rows_.size() * sizeof(ColumnRange);
  for (const NearTile& tile : tiles_) sum += tile.bytes();
  return sum;
}

std::size_t NearTable::most_bytes(const NearSplit& split) noexcept {
  const std::size_t tiles = bytes_of_tiles(split);
  return (tiles > kLargestTable ? tiles / 64 : tiles) + static_cast<std::size_t>(12.0 * directions_of(split)) +
         (std::size_t{1} << 17U);
}

namespace {

/// The texels of a source that the directions with weights reach, with 16 images of each side by side: one weight
/// does for all of them. A symmetry G of the source's grid takes the weight of texel t for direction d to that of G t
/// for G d. So the sum for G d is Sum_t weight(d, t) L(G t), and a record of t holds L(G t) of all sixteen G as
/// `cube_image_of` numbers them. A cubemap's other 32 symmetries are these after one or two rotations of the axes.
class NearRecords {
 public:
  /// `columns`: of each row, see `NearTable::rows`.
  NearRecords(const NearSplit& split, const std::vector<ColumnRange>& columns);

  [[nodiscard]] const float* data() const noexcept { return records_.data(); }
  [[nodiscard]] const std::ptrdiff_t* rows() const noexcept { return rows_.data(); }  ///< see `NearTaps`
  void gather(const std::vector<const float*>& rows, int rotation, const Control& control);

 private:
  /// Columns of a row whose records stay in a core's nearest cache.
  struct Piece {
    int row;
    ColumnRange columns;
  };

  void copy_of_face(const std::vector<const float*>& rows, const Piece& piece, int rotation, int image);
  void copy_of_lat_long(const std::vector<const float*>& rows, const Piece& piece, int image);

  NearSplit split_;
  std::vector<Piece> pieces_;
  std::vector<image::FaceImage> images_;  ///< of a cubemap, [turn][part][image]
  std::vector<std::ptrdiff_t> rows_;
  platform::AlignedBuffer<float> records_;
};

NearRecords::NearRecords(const NearSplit& split, const std::vector<ColumnRange>& columns) : split_(split) {
  constexpr int kColumns = 64;
  std::ptrdiff_t next = 0;
  for (std::size_t row = 0; row < columns.size(); ++row) {
    const auto [first, end] = columns[row];
    rows_.push_back(next - std::ptrdiff_t{first} * kRecordFloats);
    next += std::ptrdiff_t{end - first} * kRecordFloats;
    for (int column = first; column < end; column += kColumns)
      pieces_.push_back({static_cast<int>(row), {column, std::min(end, column + kColumns)}});
  }
  records_ = platform::AlignedBuffer<float>(static_cast<std::size_t>(next));
  for (int k = 0; split.cubemap() && k < kTurns * kParts * kRingImages; ++k) {
    images_.push_back(image::image_of_face(
        kNearFaces[static_cast<std::size_t>(k / kRingImages % kParts)], [&](const image::CubeTexel& texel) {
          return image_of(split.face, image::point_of(split.face, texel), k / kRingImages / kParts, k % kRingImages);
        }));
  }
}

void NearRecords::gather(const std::vector<const float*>& rows, int rotation, const Control& control) {
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(records_.size() / 4));
  jobs::run_tiles(pieces_.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t /*worker*/) {
                    for (int image = 0; image < kRingImages; ++image) {
                      if (split_.cubemap())
                        copy_of_face(rows, pieces_[tile], rotation, image);
                      else
                        copy_of_lat_long(rows, pieces_[tile], image);
                    }
                  });
}

void NearRecords::copy_of_face(const std::vector<const float*>& rows, const Piece& piece, int rotation, int image) {
  const int size = split_.face;
  const int part = piece.row / size;
  const int row = piece.row % size;
  const auto [first, end] = piece.columns;
  const image::FaceImage& from = images_[static_cast<std::size_t>((rotation * kParts + part) * kRingImages + image)];
  const RecordCopy copy{rows.data(),
                        from.face * size + from.row + first * from.across_rows + row * from.down_rows,
                        from.across_rows,
                        from.column + first * from.across_columns + row * from.down_columns,
                        from.across_columns,
                        end - first,
                        size};
  copy.to(records_.data() + rows_[static_cast<std::size_t>(piece.row)] + std::ptrdiff_t{first} * kRecordFloats, image);
}

void NearRecords::copy_of_lat_long(const std::vector<const float*>& rows, const Piece& piece, int image) {
  const int columns = split_.face;
  const auto [first, end] = piece.columns;
  const image::CubeImage how = image::cube_image_of(image);
  const int row = how.below ? split_.rows - 1 - piece.row : piece.row;
  // Columns follow the longitude atan2(x, z) downwards. A mirror, x to -x, negates it: column c goes to columns - 1 -
  // c. A quarter turn from x towards z takes (x, z) to (-z, x): 90 degrees less, which are columns / 4 more. A run
  // of columns that crosses the row's end is copied in two.
  int column = (how.mirrored ? columns - 1 - first : first) + how.quarter * (columns / 4);
  column = ((column % columns) + columns) % columns;
  float* to = records_.data() + rows_[static_cast<std::size_t>(piece.row)] + std::ptrdiff_t{first} * kRecordFloats;
  for (int k = first; k < end;) {
    const int count = std::min(end - k, how.mirrored ? column + 1 : columns - column);
    RecordCopy{rows.data(), row, 0, column, how.mirrored ? -1 : 1, count, columns}.to(to, image);
    k += count;
    to += std::ptrdiff_t{count} * kRecordFloats;
    column = how.mirrored ? columns - 1 : 0;
  }
}

/// Sums of one mip.
class NearSums {
 public:
  struct Scratch {
    NearTile tile;
    NearWeights::Scratch weights;
    alignas(64) float sums[kRecordFloats] = {};
  };

  NearSums(const NearTable& table, const std::array<float*, 6>& faces) : table_(table), faces_(faces) {
    for (int rotation = 0; rotation < turns_of(table.split()); ++rotation) {
      for (int image = 0; image < kRingImages; ++image) {
        for (const bool cap : {false, true}) rows_[rotation][cap ? 1 : 0][image] = mirrored_row(rotation, image, cap);
      }
    }
  }

  void add(std::size_t tile, int rotation, const NearRecords& records, Scratch& scratch) const;

 private:
  /// An image of all directions on +y, or on +z: steps in memory are even.
  struct MirroredRow {
    float* first = nullptr;
    std::ptrdiff_t across = 0;
    std::ptrdiff_t other = 0;
  };

  [[nodiscard]] MirroredRow mirrored_row(int rotation, int image, bool cap) const;

  const NearTable& table_;
  std::array<float*, 6> faces_;
  MirroredRow rows_[kTurns][2][kRingImages];
};

NearSums::MirroredRow NearSums::mirrored_row(int rotation, int image, bool cap) const {
  const int size = table_.split().size;
  const auto pixel = [&](int across, int other) {
    const glm::ivec3 point = cap ? glm::ivec3(across, size, other) : glm::ivec3(across, other, size);
    const image::CubeTexel texel = image_of(size, point, rotation, image);
    return faces_[static_cast<std::size_t>(texel.face)] +
           3 * (static_cast<std::ptrdiff_t>(texel.row) * size + texel.column);
  };
  const int first = size % 2 == 0 ? 1 : 0;
  float* const origin = pixel(first, first);
  if (size < 3) return {origin, 0, 0};
  return {origin, pixel(first + 2, first) - origin, pixel(first, first + 2) - origin};
}

// A direction that is its own image adds its share to that texel several times.
void NearSums::add(std::size_t tile, int rotation, const NearRecords& records, Scratch& scratch) const {
  const NearTile& made = table_.tile(tile, scratch.tile, scratch.weights);
  const glm::ivec3* direction = table_.weights().directions().data() + NearWeights::first_of(tile);
  const NearKernels& kernels = near_kernels();
  NearTaps taps{records.data(), records.rows(), made.runs.data(), 0, made.weights.data()};
  std::array<float*, kRingImages> texels{};
  for (std::size_t k = 0; k < made.runs_ends.size(); ++k, ++direction) {
    taps.count = static_cast<int>(made.runs.data() + made.runs_ends[k] - taps.runs);
    taps.weights = kernels.sum_runs(taps, scratch.sums);
    taps.runs += taps.count;
    const bool cap = direction->y == table_.split().size;
    const auto& positions = rows_[rotation][cap ? 1 : 0];
    const bool next = k > 0 && direction->x == direction[-1].x + 2;  // in its row
    for (std::size_t image = 0; image < kRingImages; ++image) {
      const MirroredRow& row = positions[image];
      if (next)
        texels[image] += row.across;
      else
        texels[image] = row.first + direction->x / 2 * row.across + (cap ? direction->z : direction->y) / 2 * row.other;
      for (std::size_t c = 0; c < 3; ++c) texels[image][c] += scratch.sums[3 * image + c];
    }
  }
}

}  // namespace

void add_near_sums(const std::vector<const float*>& rows, const std::vector<NearMip>& mips, const Control& control) {
  const NearSplit& split = mips.front().table->split();
  std::vector<NearSums> sums;
  std::vector<ColumnRange> columns = rows_of(split);
  for (const NearMip& mip : mips) {
    sums.emplace_back(*mip.table, mip.faces);
    for (std::size_t row = 0; row < columns.size(); ++row) widen(columns[row], mip.table->rows()[row]);
  }
  NearRecords records(split, columns);
  const int turns = turns_of(split);
  const double steps = static_cast<double>(turns) * static_cast<double>(sums.size());
  double done = 0.0;
  for (int rotation = 0; rotation < turns; ++rotation) {
    records.gather(rows, rotation, {control.stop, {}});
    for (std::size_t k = 0; k < sums.size(); ++k, done += 1.0) {
      const NearTable& table = *mips[k].table;
      const auto placement = jobs::placement_for(static_cast<std::int64_t>(taps_of(table.split())));
      std::vector<NearSums::Scratch> scratches(jobs::worker_count(placement));
      jobs::run_tiles(
          table.weights().tiles(), placement, scratches.size(),
          jobs::part_of(control, done / steps, (done + 1.0) / steps),
          [&](std::size_t tile, std::size_t worker) { sums[k].add(tile, rotation, records, scratches[worker]); });
    }
  }
}

std::size_t near_sums_bytes(const NearSplit& split) noexcept {
  const double texels = split.reach * texels_of_radian(split);
  double records = 0.0;
  if (split.cubemap()) {
    const double edge = 0.5 * split.face + 5.0 * texels + 6.0;
    records = std::min(3.0 * split.face * split.face, edge * edge);
  } else {
    // of rows the northern half and the reach below the equator
    records = (0.125 + 1.5 * split.reach) * split.face * (0.5 * split.rows + texels);
  }
  return static_cast<std::size_t>((records + 4.0 * split.face) * kRecordFloats * sizeof(float));
}

namespace {

// Measured on one core of a Zen 5 with AVX-512. Records of large faces do not stay in its caches.
// A 48th or a 16th of the mip's size^2 directions has weights, but each serves as many images, so sums take as long as
// size^2 directions times the texels within the reach.
constexpr double kNearMilliseconds = 3e-6;       ///< times size^2 (reach / texel)^2
constexpr double kRecordMilliseconds = 0.2;      ///< of faces of 128, by the fourth power of their size
constexpr double kHarmonicsMilliseconds = 0.55;  ///< of 144 bands, from rings to a mip
constexpr double kHarmonicsPower = 2.7;

constexpr int kMaxBands = 1024;
constexpr int kMinBands = 120;
constexpr double kBandsTimesReach = 12.0;  ///< what the far part's polynomial was made for
constexpr double kTexelsOfReach = 3.0;     ///< at least
constexpr double kBalance = 5.6;           ///< see `near_far_split`: measured

/// Returns the parts that an edge of texels is cut into. With kMinBands bands the reach is kBandsTimesReach / kMinBands
/// = 0.1 radians, which holds kTexelsOfReach texels from 30 per radian on.
int parts_of(double texels_of_radian) {
  constexpr double least = kMinBands * kTexelsOfReach / kBandsTimesReach;
  return std::max(1, static_cast<int>(std::ceil(least / texels_of_radian - 0.01)));
}

}  // namespace

double milliseconds_of_harmonics(int bands) noexcept {
  return kHarmonicsMilliseconds * math::exponential(kHarmonicsPower * math::logarithm(bands / 144.0));
}

// A texel is 2 / face radians wide, so the reach has face reach / 2 of them.
double milliseconds_of(const NearSplit& split) noexcept {
  const double texels = 0.5 * split.size * split.face * split.reach;
  const double squared = split.face / 128.0 * split.face / 128.0;
  return kNearMilliseconds * texels * texels + kRecordMilliseconds * squared * squared +
         milliseconds_of_harmonics(split.bands);
}

NearSplit cheapest_split(int face, int size, double alpha, double bands_of_reach) noexcept {
  constexpr double kMaxReach = 0.5;
  constexpr int kStep = 8;
  NearSplit best{face, size, alpha, 0.0, 0};
  for (int bands = kStep; bands <= 1024; bands += bands < 128 ? kStep : 2 * kStep) {
    // The product of bands and reach decides what the far part's end leaves out, so that all of these are as exact:
    // they differ in time alone, and the sums' falls with bands^-2.
    const double reach = bands_of_reach / bands;
    if (reach > kMaxReach) continue;
    const NearSplit split{face, size, alpha, reach, bands};
    if (reach < std::max(split.reach_of_lobe(), split.reach_of_texels())) break;
    if (best.bands == 0 || milliseconds_of(split) < milliseconds_of(best)) best = split;
  }
  return best;
}

// With t texels in all, a mip's near part takes size^2 t / bands^2, as the reach is proportional to 1 / bands, and its
// far part bands^3. Their sum a size^2 t / bands^2 + b bands^3 is least where -2 a size^2 t / bands^3 + 3 b bands^2 =
// 0, at bands = (2 a / 3 b)^(1/5) (size sqrt(t))^(2/5): `wanted`, with kBalance for the constants. t counts per
// steradian. The reach must hold kTexelsOfReach texels of the largest size, which is `most` bands.
NearSplit near_far_split(int columns, int rows, int size, double alpha) {
  NearSplit split{.size = size, .alpha = alpha};
  int parts = parts_of(0.5 * columns / (rows == 0 ? 1.0 : kPi));
  // quarter turns must take columns to columns
  while (rows > 0 && columns * parts % 4 != 0) ++parts;
  split.face = columns * parts;
  split.rows = rows == 0 ? 0 : rows * parts_of(rows / kPi);
  const double texels = rows == 0 ? 6.0 * split.face * split.face : 1.0 * split.face * split.rows;
  const double wanted = kBalance * math::exponential(0.4 * math::logarithm(size * std::sqrt(texels / (4.0 * kPi))));
  const double of_radian = rows == 0 ? 0.5 * split.face : std::min(0.5 * split.face, 1.0 * split.rows) / kPi;
  const double most = kBandsTimesReach / kTexelsOfReach * of_radian;  // texels of a radian, where they are largest
  split.bands = std::clamp(8 * static_cast<int>(std::min(wanted, most) / 8.0), kMinBands, kMaxBands);
  split.reach = kBandsTimesReach / split.bands;
  return split;
}

SourceRows cut_rows(std::vector<const float*> source, int columns, const NearSplit& split) {
  const auto rows = static_cast<std::size_t>(split.cubemap() ? 6 * split.face : split.rows);
  const int across = split.face / columns;
  const std::size_t down = rows / source.size();
  if (across == 1 && down == 1) return {std::move(source)};
  SourceRows cut{{},
                 platform::AlignedBuffer<float>(std::size_t{3} * static_cast<std::size_t>(split.face) * source.size())};
  float* next = cut.owned.data();
  for (const float* const row : source) {
    cut.rows.insert(cut.rows.end(), down, next);
    for (int column = 0; column < split.face; ++column)
      next = std::copy_n(row + std::ptrdiff_t{3} * (column / across), 3, next);
  }
  return cut;
}

}  // namespace welkin::reflections
