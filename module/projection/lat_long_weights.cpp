#include "projection/lat_long_weights.h"

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <utility>

#include "math/basis.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "projection/projection_kernels.h"

namespace welkin::projection {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{64} << 20U;  // 16 bands of 32 768 rows take 36 MiB
constexpr double kPi = std::numbers::pi;

math::TableCache<LatLongWeightsKey, LatLongWeights>& cache() {
  static auto& tables = *new math::TableCache<LatLongWeightsKey, LatLongWeights>(kCacheBytes);  // never destroyed
  return tables;
}

/// Calls `use(cell, begin, end)` for each cell that [index, index + 1) overlaps; `cells` cells share `count`
/// indices evenly, begin and end are in units of indices.
template <class Use>
void for_each_overlap(int index, int count, int cells, const Use& use) {
  const std::int64_t n = count;
  const std::int64_t first = index * std::int64_t{cells} / n;
  for (std::int64_t cell = first; cell * n < (index + std::int64_t{1}) * cells; ++cell) {
    const double ratio = static_cast<double>(n) / static_cast<double>(cells);
    const double begin = std::max(static_cast<double>(index), static_cast<double>(cell) * ratio);
    const double end = std::min(index + 1.0, static_cast<double>(cell + 1) * ratio);
    if (end > begin) use(static_cast<int>(cell), begin, end);
  }
}

/// Integral of cos(m lon) (m >= 0) or sin(|m| lon) over column `index` of `width`, or width times the value
/// at its centre. The integral over a width d is the centre's value times 2 sin(m d / 2) / m.
double column_integral(int m, int index, int width, bool midpoint) {
  const int order = m < 0 ? -m : m;
  const double step = 2.0 * kPi / width;
  if (order == 0) return step;
  // lon = pi - 2 pi (index + 1/2) / width, in turns.
  const double longitude = 0.5 - (index + 0.5) / width;
  const math::SineCosine centre = math::sine_cosine_of_turns(order * longitude);
  const double extent = midpoint ? step : 2.0 * math::sine_cosine_of_turns(0.5 * order / width).sine / order;
  return (m < 0 ? centre.sine : centre.cosine) * extent;
}

/// Sine of the latitude at `row` (which need not be whole) of `height`, from the top, and its cosine.
math::SineCosine at_latitude(double row, int height) { return math::sine_cosine_of_turns(0.25 - row / (2.0 * height)); }

/// Solid angle per unit of longitude of rows `begin` to `end`: the difference of the latitudes' sines,
/// written as a product so that nothing cancels.
double row_extent(double begin, double end, int height) {
  return 2.0 * at_latitude(0.5 * (begin + end), height).cosine *
         math::sine_cosine_of_turns((end - begin) / (4.0 * height)).sine;
}

/// Adds scale x q(l, m)(sin lat) cos^m(lat) at l (l + 1) / 2 + m.
void add_latitude_functions(math::SineCosine latitude, double scale, int bands, double* sums) {
  // At longitude 0 the basis is its latitude part; orders below zero vanish.
  math::for_each_basis_value(math::basis_constants(), latitude.cosine, 0.0, latitude.sine, scale, bands,
                             [&](int index, double value) {
                               int l = 0;
                               while ((l + 1) * (l + 1) <= index) ++l;
                               const int m = index - l * (l + 1);
                               if (m >= 0) sums[l * (l + 1) / 2 + m] += value;
                             });
}

/// Integrals over one row's latitudes, times the cosine of latitude.
void integrate_row(int row, int height, int bands, bool midpoint, double* sums) {
  if (midpoint) {
    add_latitude_functions(at_latitude(row + 0.5, height), row_extent(row, row + 1.0, height), bands, sums);
    return;
  }
  // The integrands are trigonometric polynomials of degree up to 16: sixteen points carry them over half a
  // turn, fewer over less.
  const math::GaussRule rule = math::gauss_legendre(height < 4 ? 24 : height < 64 ? 12 : 6);
  for (int i = 0; i < rule.order; ++i) {
    const math::SineCosine latitude = at_latitude(row + 0.5 * (1.0 + rule.nodes[i]), height);
    const double scale = rule.weights[i] * 0.5 * kPi / height * latitude.cosine;
    add_latitude_functions(latitude, scale, bands, sums);
  }
}

}  // namespace

std::shared_ptr<const LatLongWeights> LatLongWeights::get(const LatLongWeightsKey& key) {
  return cache().get(key, [&] { return std::make_shared<const LatLongWeights>(key); });
}

LatLongWeights::LatLongWeights(const LatLongWeightsKey& key)
    : bands_(key.bands),
      paired_(key.width % 2 == 0),
      column_count_(paired_ ? key.width / 2 : key.width),
      place_(static_cast<std::size_t>(2 * key.bands - 1)) {
  // Class 0: even orders (or all, without pairs); class 1: odd orders. m = 0 first of all.
  int next = 0;
  for (int parity = 0; parity < 2; ++parity) {
    for (int order = 0; order < bands_; ++order) {
      const int symmetry = paired_ ? order % 2 : 0;
      if (symmetry != parity) continue;
      place_[static_cast<std::size_t>(bands_ - 1 + order)] = next++;
      if (order > 0) place_[static_cast<std::size_t>(bands_ - 1 - order)] = next++;
      counts_.count[parity] += order > 0 ? 2 : 1;
    }
  }
  fill_columns(key);
  fill_rows(key);
}

void LatLongWeights::fill_columns(const LatLongWeightsKey& key) {
  const int functions = 2 * bands_ - 1;
  const int cells = key.target_size > 0 ? std::min(key.width, 4 * key.target_size) : key.width;
  columns_ = platform::AlignedBuffer<float>(static_cast<std::size_t>(chunk_count() * functions * kChunk));
  std::fill_n(columns_.data(), columns_.size(), 0.0F);
  const double cells_per_column = static_cast<double>(cells) / key.width;
  for (int column = 0; column < column_count_; ++column) {
    float* const chunk = columns_.data() + column / kChunk * functions * kChunk;
    for (int m = 1 - bands_; m < bands_; ++m) {
      double weight = 0.0;
      for_each_overlap(column, key.width, cells, [&](int cell, double begin, double end) {
        weight += (end - begin) * cells_per_column * column_integral(m, cell, cells, key.midpoint);
      });
      chunk[place(m) * kChunk + column % kChunk] = static_cast<float>(weight);
    }
  }
}

void LatLongWeights::fill_rows(const LatLongWeightsKey& key) {
  const std::size_t functions = static_cast<std::size_t>(bands_) * static_cast<std::size_t>(bands_ + 1) / 2;
  const int cells = key.target_size > 0 ? std::min(key.height, 2 * key.target_size) : key.height;
  std::vector<double> cell_weights(functions * static_cast<std::size_t>(cells));
  for (int cell = 0; cell < cells; ++cell) {
    integrate_row(cell, cells, bands_, key.midpoint, cell_weights.data() + static_cast<std::size_t>(cell) * functions);
  }
  if (cells == key.height) {
    rows_ = std::move(cell_weights);
    return;
  }
  rows_.assign(functions * static_cast<std::size_t>(key.height), 0.0);
  const double rows_per_cell = static_cast<double>(key.height) / cells;
  for (int row = 0; row < key.height; ++row) {
    for_each_overlap(row, key.height, cells, [&](int cell, double begin, double end) {
      // Exact: the share of the cell's solid angle. Midpoint: of its pixels.
      const double share = key.midpoint ? (end - begin) / rows_per_cell
                                        : row_extent(begin, end, key.height) / row_extent(cell, cell + 1.0, cells);
      for (std::size_t f = 0; f < functions; ++f) {
        rows_[static_cast<std::size_t>(row) * functions + f] +=
            share * cell_weights[static_cast<std::size_t>(cell) * functions + f];
      }
    });
  }
}

const float* LatLongWeights::chunk_weights(int chunk) const noexcept {
  return columns_.data() + static_cast<std::size_t>(chunk * (2 * bands_ - 1) * kChunk);
}

const double* LatLongWeights::row_weights(int row) const noexcept {
  return rows_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(bands_ * (bands_ + 1) / 2);
}

std::size_t LatLongWeights::bytes() const noexcept {
  return sizeof(*this) + columns_.bytes() + rows_.size() * sizeof(double);
}

}  // namespace welkin::projection
