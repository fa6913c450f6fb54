// Weights of a face that is averaged by solid angle into target x target cells first.
//
// The average is linear, so it needs no pass of its own: with W the solid angle of a piece of a texel, a
// cell's mean radiance is sum L W(piece) / W(cell), and the cell then weighs Int Y over it. Together a texel
// weighs
//
//   sum over the cells it touches of  W(piece) / W(cell) Int_cell Y,
//
// at any ratio of sizes, and the projection reads it like any other weight.
#include "projection/texel_weights.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "math/basis.h"
#include "math/quadrature.h"
#include "math/table_cache.h"

namespace welkin::projection {
namespace {

using simd::kLanes;

constexpr std::size_t kCacheBytes = std::size_t{32} << 20U;
constexpr std::size_t kLargestTableBytes = std::size_t{2} << 20U;

constexpr int kExpansionBands = 3;

/// Orders the harmonics by symmetry: (even, even), (odd, even), (even, odd), (odd, odd) in (u, v).
/// Re (u + iv)^m is even in v and of m's parity in u; Im (u + iv)^m is odd in v and of m - 1's parity in u.
/// (u + i v)^m changes to its conjugate for -v, and to (-1)^m times the conjugate for -u: the real part is even in v
/// and has m's parity in u, the imaginary one is odd in v and has the other. q(l, m) depends on the normal's component
/// alone, which neither changes.
int symmetry_class(int m) {
  const int order = m < 0 ? -m : m;
  if (m >= 0) return order % 2 == 0 ? 0 : 1;
  return order % 2 == 0 ? 3 : 2;
}

}  // namespace

math::GaussRule weights_rule(int size, int bands) {
  constexpr int kTexelsPerBand = 64;
  // The rules' integrals over [-h, h] are off by h^5 / 135 times a fourth derivative (two points) and h^7 / 15750 times
  // a sixth (three), and a harmonic of degree l has derivatives of order k of at most l^k of its size. With h = 1 / N
  // the mean over a texel is off by at most (1 / 64)^4 / 270 = 2.2e-10 for N >= 64 bands, and by (1 / 16)^6 / 31500 =
  // 1.9e-12 for N >= 16 bands.
  if (size > math::kLargestIntegratedFace && size >= kTexelsPerBand * bands) return math::gauss_legendre(2);
  return math::gauss_legendre(size >= 64 && size >= 16 * bands ? 3 : math::texel_rule(size).order);
}

TexelWeightsKey weights_key(int size, const ProjectionOptions& options) noexcept {
  return {size, options.bands, options.quadrature == Quadrature::midpoint, options.target_size.value_or(size)};
}

std::shared_ptr<const TexelWeights> TexelWeights::get(const TexelWeightsKey& key) {
  static auto& cache = *new math::TableCache<TexelWeightsKey, TexelWeights>(kCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const TexelWeights>(key); });
}

TexelWeights::TexelWeights(const TexelWeightsKey& key)
    : key_(key),
      half_((key.size + 1) / 2),
      groups_per_row_((half_ + kLanes - 1) / kLanes),
      rows_per_chunk_(std::max(1, kChunk / kLanes / groups_per_row_)),
      chunks_per_row_((groups_per_row_ * kLanes + kChunk - 1) / kChunk),
      chunk_count_((half_ + rows_per_chunk_ - 1) / rows_per_chunk_ * chunks_per_row_),
      weight_rows_(static_cast<std::size_t>(key.bands * key.bands)) {
  int next = 0;
  for (int wanted = 0; wanted < kMaximumClasses; ++wanted) {
    for (int l = 0; l < key.bands; ++l) {
      for (int m = -l; m <= l; ++m) {
        if (symmetry_class(m) != wanted) continue;
        weight_rows_[static_cast<std::size_t>(l * (l + 1) + m)] = next++;
        ++counts_.count[wanted];
      }
    }
  }
  if (key.target_size < key.size) target_ = get({key.target_size, key.bands, key.midpoint, key.target_size});
  const auto chunk_floats = static_cast<std::size_t>(key.bands * key.bands * kChunk);
  const auto total_floats = static_cast<std::size_t>(chunk_count_) * chunk_floats;
  if ((expandable() && !target_) || total_floats * sizeof(float) > kLargestTableBytes) return;
  platform::AlignedBuffer<float> scratch(fill_scratch_size());
  platform::AlignedBuffer<float> table(total_floats);
  for (int index = 0; index < chunk_count_; ++index) {
    fill_chunk(index, table.data() + static_cast<std::size_t>(index) * chunk_floats, scratch.data());
  }
  table_ = std::move(table);
}

QuadrantChunk TexelWeights::chunk(int index) const noexcept {
  const int first_row = index / chunks_per_row_ * rows_per_chunk_;
  const int first_column = index % chunks_per_row_ * kChunk;
  const int columns = std::min(kChunk, half_ - first_column);
  return {first_row, std::min(rows_per_chunk_, half_ - first_row), first_column, columns,
          (columns + kLanes - 1) / kLanes};
}

std::size_t TexelWeights::scratch_size() const noexcept { return table_.size() > 0 ? 0 : fill_scratch_size(); }

std::size_t TexelWeights::fill_scratch_size() const noexcept {
  // A chunk's weights; and, for a reduced face, a row of the target's weights and one of solid angles.
  const auto functions = static_cast<std::size_t>(key_.bands * key_.bands);
  return functions * kChunk + (target_ ? (functions + 1) * (kChunk + kLanes) : 0);
}

const float* TexelWeights::chunk_weights(int index, float* scratch) const {
  const int chunk_floats = key_.bands * key_.bands * kChunk;
  if (table_.size() > 0)
    return table_.data() + static_cast<std::size_t>(index) * static_cast<std::size_t>(chunk_floats);
  fill_chunk(index, scratch, scratch + chunk_floats);
  return scratch;
}

void TexelWeights::fill_chunk(int index, float* weights, float* scratch) const {
  const QuadrantChunk part = chunk(index);
  for (int row = 0; row < part.row_count; ++row) {
    float* const row_weights = weights + row * part.groups_per_row * kLanes;
    if (target_) {
      fill_reduced_row(part.first_row + row, part.first_column, part.column_count, row_weights, scratch);
    } else {
      fill_row(part.first_row + row, part.first_column, part.column_count, row_weights, kChunk);
    }
  }
}

bool TexelWeights::expandable() const noexcept {
  return key_.bands <= kExpansionBands && key_.size > math::kLargestIntegratedFace;
}

void TexelWeights::fill_row(int row, int first_column, int count, float* weights, int stride) const {
  fill_run({key_.size, row, first_column, count, key_.bands, key_.midpoint}, weights, stride);
}

void TexelWeights::fill_run(const image::TexelRun& run, float* weights, int stride) const {
  const image::TexelKernels& kernels = image::texel_kernels();
  if (expandable()) {
    kernels.expand_texels(run, weight_rows_.data(), weights, stride);
  } else {
    kernels.integrate_texels(run, math::basis_constants(), weights_rule(key_.size, key_.bands), weight_rows_.data(),
                             weights, stride);
  }
}

void TexelWeights::copy_row(int row, int first_column, int count, float* weights, int stride) const {
  if (table_.size() == 0) {
    fill_row(row, first_column, count, weights, stride);
    return;
  }
  for (int k = 0; k < count; ++k) {
    const int column = first_column + k;
    const int index = row / rows_per_chunk_ * chunks_per_row_ + column / kChunk;
    const int position = row % rows_per_chunk_ * chunk(index).groups_per_row * kLanes + column % kChunk;
    const float* const stored = chunk_weights(index, nullptr) + position;
    for (int f = 0; f < key_.bands * key_.bands; ++f) weights[f * stride + k] = stored[f * kChunk];
  }
}

namespace {

constexpr int kTargetStride = kChunk + kLanes;  // a chunk's columns touch at most kChunk + 1 cells
constexpr double kY00 = 0.28209479177387814;    // sqrt(1 / 4 pi)

/// A stretch of a texel's extent that lies in one cell, in texels from the face's edge.
struct Piece {
  double begin;
  double end;
  int cell;
};

struct Pieces {
  int count;
  Piece piece[2];
};

/// Returns the one or two cells that texel [index, index + 1) overlaps. Cells are size / target > 1 texels wide, so
/// there are no more than two. The cell and its boundary are found in whole numbers (in units of 1 / target of a
/// texel): a texel that ends exactly on a boundary is not given a second piece of width 0 by a rounding.
Pieces cut_texel(int index, int size, int target) {
  const std::int64_t n = size;
  const std::int64_t t = target;
  const std::int64_t cell = index * t / n;
  const std::int64_t boundary = (cell + 1) * n;  // in 1/target of a texel
  const auto first = static_cast<int>(cell);
  if (boundary >= (index + std::int64_t{1}) * t) return {1, {{static_cast<double>(index), index + 1.0, first}, {}}};
  const double cut = static_cast<double>(boundary) / static_cast<double>(target);
  return {2, {{static_cast<double>(index), cut, first}, {cut, index + 1.0, first + 1}}};
}

/// Solid angle of a rectangle of texels on the face, by a Gauss rule.
double solid_angle(const Piece& columns, const Piece& rows, int size, const math::GaussRule& rule) {
  const double h = 1.0 / static_cast<double>(size);
  const double u_half = h * (columns.end - columns.begin);
  const double v_half = h * (rows.end - rows.begin);
  const double u_centre = h * (columns.begin + columns.end) - 1.0;
  const double v_centre = h * (rows.begin + rows.end) - 1.0;
  return math::rectangle_solid_angle(u_centre, v_centre, u_half, v_half, rule);
}

/// A cell beyond the middle is the mirror image of one in the quadrant: odd functions change sign.
struct QuadrantCell {
  int index;
  bool mirrored;
};

QuadrantCell in_quadrant(int cell, int target) {
  const int half = (target + 1) / 2;
  return cell < half ? QuadrantCell{cell, false} : QuadrantCell{target - 1 - cell, true};
}

/// weights[f] += share x cell[f], with the signs of a mirrored cell.
void add_share(float share, const float* cell, bool mirrored_in_u, bool mirrored_in_v, const ClassCounts& counts,
               float* weights) {
  int f = 0;
  for (int symmetry = 0; symmetry < kMaximumClasses; ++symmetry) {
    // The cell's weights are those of its mirror image in the quadrant: a function that is odd in a mirrored coordinate
    // has the opposite sign there, and odd in both the signs cancel.
    const bool odd_in_u = symmetry == 1 || symmetry == 3;
    const bool odd_in_v = symmetry >= 2;
    const bool negative = (mirrored_in_u && odd_in_u) != (mirrored_in_v && odd_in_v);
    const float signed_share = negative ? -share : share;
    for (int i = 0; i < counts.count[symmetry]; ++i, ++f) {
      weights[f * kChunk] += signed_share * cell[f * kTargetStride];
    }
  }
}

}  // namespace

void TexelWeights::fill_reduced_row(int row, int first_column, int count, float* weights, float* scratch) const {
  const int functions = key_.bands * key_.bands;
  const int target = key_.target_size;
  const math::GaussRule rule = math::texel_rule(key_.size);
  float* const whole_texels = scratch + functions * kTargetStride;  // solid angle times Y00, of the whole row
  fill_run({key_.size, row, first_column, count, 1, key_.midpoint}, whole_texels, kTargetStride);

  // Whole texels (most of them where cells are large) take their solid angle from the same expansion as the weights of
  // the face at its own size, function 0 of one band; only texels that a boundary cuts need a rule of their own.
  const int padded = (count + kLanes - 1) / kLanes * kLanes;
  for (int f = 0; f < functions; ++f) std::fill_n(weights + f * kChunk, padded, 0.0F);

  const int first_cell = in_quadrant(cut_texel(first_column, key_.size, target).piece[0].cell, target).index;
  const Pieces last = cut_texel(first_column + count - 1, key_.size, target);
  const int end_cell = std::min(last.piece[last.count - 1].cell + 1, (target + 1) / 2);
  const Pieces rows = cut_texel(row, key_.size, target);
  for (int r = 0; r < rows.count; ++r) {
    const QuadrantCell cell_row = in_quadrant(rows.piece[r].cell, target);
    target_->copy_row(cell_row.index, first_cell, end_cell - first_cell, scratch, kTargetStride);
    for (int k = 0; k < count; ++k) {
      const Pieces columns = cut_texel(first_column + k, key_.size, target);
      for (int c = 0; c < columns.count; ++c) {
        const QuadrantCell cell_column = in_quadrant(columns.piece[c].cell, target);
        const float* const cell = scratch + (cell_column.index - first_cell);
        // Function 0 is Y(0, 0) = kY00 over the cell, so cell[0] = kY00 W(cell), and `piece` is kY00 W(piece): their
        // quotient is the share W(piece) / W(cell).
        const bool whole = rows.count == 1 && columns.count == 1;
        const double piece = whole ? static_cast<double>(whole_texels[k])
                                   : kY00 * solid_angle(columns.piece[c], rows.piece[r], key_.size, rule);
        add_share(static_cast<float>(piece / static_cast<double>(cell[0])), cell, cell_column.mirrored,
                  cell_row.mirrored, counts_, weights + k);
      }
    }
  }
}

}  // namespace welkin::projection
