#include "tables/texel_weights.h"

#include <algorithm>
#include <utility>

#include "tables/basis_constants.h"
#include "tables/gauss_legendre.h"
#include "tables/table_cache.h"

namespace welkin::tables {
namespace {

using simd::kChunk;
using simd::kLanes;

constexpr std::size_t kCacheBytes = std::size_t{32} << 20U;
constexpr std::size_t kLargestTableBytes = std::size_t{2} << 20U;

/// Above this size the expansion in the texel's size is as exact as a float, and computing a chunk's weights
/// costs less than fetching them from beyond the second-level cache.
constexpr int kLargestIntegratedFace = 128;
constexpr int kExpansionBands = 3;

/// Orders the harmonics by symmetry: (even, even), (odd, even), (even, odd), (odd, odd) in (u, v).
/// Re (u + iv)^m is even in v and of m's parity in u; Im (u + iv)^m is odd in v and of m - 1's parity in u.
int symmetry_class(int m) {
  const int order = m < 0 ? -m : m;
  if (m >= 0) return order % 2 == 0 ? 0 : 1;
  return order % 2 == 0 ? 3 : 2;
}

TableCache<TexelWeightsKey, TexelWeights>& cache() {
  static TableCache<TexelWeightsKey, TexelWeights> tables(kCacheBytes);
  return tables;
}

}  // namespace

simd::GaussRule texel_rule(int size) {
  if (size == 1) return gauss_legendre(28);
  if (size == 2) return gauss_legendre(16);
  if (size < 8) return gauss_legendre(12);
  if (size < 32) return gauss_legendre(8);
  if (size <= kLargestIntegratedFace) return gauss_legendre(5);
  return gauss_legendre(3);
}

std::shared_ptr<const TexelWeights> TexelWeights::get(const TexelWeightsKey& key) {
  return cache().get(key, [&] { return std::make_shared<const TexelWeights>(key); });
}

TexelWeights::TexelWeights(const TexelWeightsKey& key)
    : key_(key),
      half_((key.size + 1) / 2),
      groups_per_row_((half_ + kLanes - 1) / kLanes),
      rows_per_chunk_(std::max(1, kChunk / kLanes / groups_per_row_)),
      chunks_per_row_((groups_per_row_ * kLanes + kChunk - 1) / kChunk),
      chunk_count_((half_ + rows_per_chunk_ - 1) / rows_per_chunk_ * chunks_per_row_),
      place_(static_cast<std::size_t>(key.bands * key.bands)) {
  int next = 0;
  for (int wanted = 0; wanted < simd::kMaximumClasses; ++wanted) {
    for (int l = 0; l < key.bands; ++l) {
      for (int m = -l; m <= l; ++m) {
        if (symmetry_class(m) != wanted) continue;
        place_[static_cast<std::size_t>(l * (l + 1) + m)] = next++;
        ++counts_.count[wanted];
      }
    }
  }
  if (key.target_size < key.size) target_ = get({key.target_size, key.bands, key.midpoint, key.target_size});
  const auto chunk_floats = static_cast<std::size_t>(key.bands * key.bands * kChunk);
  const auto total_floats = static_cast<std::size_t>(chunk_count_) * chunk_floats;
  if ((expandable() && !target_) || total_floats * sizeof(float) > kLargestTableBytes) return;
  AlignedBuffer<float> scratch(fill_scratch_size());
  AlignedBuffer<float> table(total_floats);
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
  return key_.bands <= kExpansionBands && key_.size > kLargestIntegratedFace;
}

void TexelWeights::fill_row(int row, int first_column, int count, float* weights, int stride) const {
  fill_run({key_.size, row, first_column, count, key_.bands, key_.midpoint}, weights, stride);
}

void TexelWeights::fill_run(const simd::TexelRun& run, float* weights, int stride) const {
  const simd::Kernels& kernels = simd::active_kernels();
  if (expandable()) {
    kernels.expand_texels(run, place_.data(), weights, stride);
  } else {
    kernels.integrate_texels(run, basis_constants(), texel_rule(key_.size), place_.data(), weights, stride);
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

}  // namespace welkin::tables
