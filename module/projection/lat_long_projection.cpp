#include "projection/lat_long_projection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "math/basis.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/memory.h"
#include "projection/projection_error.h"
#include "projection/projection_kernels.h"
#include "projection/sanitizer.h"
#include "projection/tile_sums.h"
#include "simd/dispatch.h"
#include "transform/frame_transform.h"

namespace welkin::projection {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{64} << 20U;  // 16 bands of 32 768 rows take 36 MiB
constexpr double kPi = std::numbers::pi;

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
/// With d the column's width,
///   Int e^(i m x) dx over it = e^(i m lon) (e^(i m d / 2) - e^(-i m d / 2)) / (i m) = e^(i m lon) 2 sin(m d / 2) / m,
/// and the cosine is the real part, the sine the imaginary one. For d = 2 pi / width, m d / 2 is order / (2 width) of a
/// turn.
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
/// sin(a) - sin(b) = 2 cos((a + b) / 2) sin((a - b) / 2); rows are pi / height apart, so (a - b) / 2 is (end - begin) /
/// (4 height) of a turn.
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
  // (q(l, m) cos^m has the degree l <= 15 in sine and cosine, and the solid angle's cosine adds 1.) Errors of
  // e^(i d lat) for all d <= 16, relative to the row's extent in latitude, computed: 3e-10 for one row (24 points),
  // below 1e-15 for two and three; 1.5e-12 for four (12 points), below 1e-14 up to 63; 1.3e-14 from 64 on (6 points).
  const math::GaussRule rule = math::gauss_legendre(height < 4 ? 24 : height < 64 ? 12 : 6);
  for (int i = 0; i < rule.order; ++i) {
    const math::SineCosine latitude = at_latitude(row + 0.5 * (1.0 + rule.nodes[i]), height);
    const double scale = rule.weights[i] * 0.5 * kPi / height * latitude.cosine;
    add_latitude_functions(latitude, scale, bands, sums);
  }
}

}  // namespace

std::shared_ptr<const LatLongWeights> LatLongWeights::get(const LatLongWeightsKey& key) {
  static auto& cache = *new math::TableCache<LatLongWeightsKey, LatLongWeights>(kCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const LatLongWeights>(key); });
}

LatLongWeights::LatLongWeights(const LatLongWeightsKey& key)
    : bands_(key.bands),
      paired_(key.width % 2 == 0),
      column_count_(paired_ ? key.width / 2 : key.width),
      weight_rows_(static_cast<std::size_t>(2 * key.bands - 1)) {
  // Class 0: even orders (or all, without pairs); class 1: odd orders. m = 0 first of all.
  int next = 0;
  for (int parity = 0; parity < 2; ++parity) {
    for (int order = 0; order < bands_; ++order) {
      const int symmetry = paired_ ? order % 2 : 0;
      if (symmetry != parity) continue;
      weight_rows_[static_cast<std::size_t>(bands_ - 1 + order)] = next++;
      if (order > 0) weight_rows_[static_cast<std::size_t>(bands_ - 1 - order)] = next++;
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
        // A column's share of a cell is (end - begin) columns of width / cells each, times what the cell weighs.
        weight += (end - begin) * cells_per_column * column_integral(m, cell, cells, key.midpoint);
      });
      chunk[weight_row(m) * kChunk + column % kChunk] = static_cast<float>(weight);
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

namespace {

// Along a row the latitude is constant, so a harmonic is a factor times cos(m lon) or sin(m lon): a row is
// read once for its 2 bands - 1 sums over longitude, and those are multiplied by the row's integrals over
// latitude. Texels 180 degrees apart share their weights up to the sign of odd orders and are folded first.

using simd::kLanes;

constexpr int kClasses = 2;
constexpr int kTexelsPerBlock = 32'768;

/// Stands in for the second half of a row of odd width.
alignas(64) constexpr std::byte kZeros[kChunk * 16]{};

/// One worker's scratch.
struct Scratch {
  Scratch(int orders, int functions)
      : planes(std::size_t{3} * kClasses * kChunk),
        runs(std::size_t{2} * 3 * kChunk),
        sum_lanes(static_cast<std::size_t>(3 * orders * kSumLanes)),
        exact_lanes(sum_lanes.size()),
        chunk_sums(static_cast<std::size_t>(3 * orders)),
        exact_chunk_sums(chunk_sums.size()),
        row_sums(chunk_sums.size()),
        exact_row_sums(chunk_sums.size()),
        local_sums(static_cast<std::size_t>(3 * functions)),
        exact_local_sums(local_sums.size()) {}

  platform::AlignedBuffer<float> planes;        ///< [3][kClasses][kChunk]
  platform::AlignedBuffer<float> runs;          ///< two decoded runs
  platform::AlignedBuffer<double> sum_lanes;    ///< [3][orders][kSumLanes]
  platform::AlignedBuffer<double> exact_lanes;  ///< the same of whole texels as areas, where cells are wider
  std::vector<double> chunk_sums;               ///< [3][orders]
  std::vector<double> exact_chunk_sums;
  std::vector<double> row_sums;  ///< [3][orders]
  std::vector<double> exact_row_sums;
  std::vector<double> local_sums;        ///< [3][functions], of a block
  std::vector<double> exact_local_sums;  ///< local sums of whole texels as areas
};

/// A chunk of columns of one row; `second` is 180 degrees on, or nullptr.
struct ColumnRun {
  const std::byte* first;
  const std::byte* second;
  int row;
  int first_column;
  int count;
  const float* weights;  ///< of the chunk
  const float* exact;    ///< of whole texels as areas, where cells are wider; else nullptr
  double row_weight;     ///< solid angle per unit of a column's weight
};

FoldHalves direct_fold(PixelFormat format, const ProjectionKernels& kernels) {
  const FoldFormat fold = fold_format(format);
  return fold == fold_format_count ? nullptr : kernels.fold_halves[fold];
}

/// Returns the ratios of the mean of cos(m lon) over a column to its value at the centre.
/// (2 sin(m d / 2) / m) / d with d = 2 pi / width: what turns sums by the midpoint rule into sums over areas.
double mean_over_centre(int order, int width) {
  if (order == 0) return 1.0;
  return 2.0 * math::sine_cosine_of_turns(0.5 * order / width).sine / (order * 2.0 * kPi / width);
}

int rows_per_block_of(int width, int height) { return std::clamp(kTexelsPerBlock / width, 1, height); }

}  // namespace

struct LatLongProjector::State {
  State(int width_, int height_, const ProjectionOptions& options_, std::size_t workers)
      : width(width_),
        height(height_),
        options(options_),
        sanitizer(options_.pixels),
        kernels(projection_kernels()),
        reduced(is_reduced(width_, height_, options_)),
        midpoint(options_.quadrature == Quadrature::midpoint),
        weights(LatLongWeights::get({width_, height_, options_.bands, midpoint, reduced ? *options_.target_size : 0})),
        exact_weights(LatLongWeights::get({width_, height_, options_.bands, false, 0})),
        rows_per_block(rows_per_block_of(width_, height_)),
        block_count((height_ + rows_per_block - 1) / rows_per_block),
        orders(2 * options_.bands - 1),
        functions(options_.bands * options_.bands),
        identity(static_cast<std::size_t>(functions)),
        sums(static_cast<std::size_t>(block_count), options_.bands),
        exact_sums(errs() ? static_cast<std::size_t>(block_count) : 0, options_.bands),
        over_centre(static_cast<std::size_t>(options_.bands)) {
    for (int m = 0; m < options_.bands; ++m) over_centre[static_cast<std::size_t>(m)] = mean_over_centre(m, width_);
    for (int f = 0; f < functions; ++f) identity[static_cast<std::size_t>(f)] = f;
    for (std::size_t worker = 0; worker < workers; ++worker) scratches.emplace_back(orders, functions);
    static_cast<void>(transforms::lat_long_transform(options_.bands));  // built here, not inside a block
  }

  static bool is_reduced(int width, int height, const ProjectionOptions& options) {
    return options.target_size && (4 * *options.target_size < width || 2 * *options.target_size < height);
  }

  /// Returns whether it differs from the exact rule at the image's own size, which is then summed as well.
  [[nodiscard]] bool errs() const noexcept { return reduced || midpoint; }

  void project_block(int block, const LatLongView& rows, Scratch& scratch) noexcept;
  void sum_row(const std::byte* texels, const std::byte* next_row, PixelFormat format, int row, Scratch& scratch,
               SanitizeRecord& record) noexcept;
  [[nodiscard]] ColumnRun column_run(const std::byte* texels, PixelFormat format, int row, int chunk) const;
  void clear_lanes(Scratch& scratch) const noexcept;
  bool fold_lanes(Scratch& scratch, std::vector<double>& sums_of_orders, std::vector<double>& exact) const noexcept;
  [[nodiscard]] FetchAhead read_next(const std::byte* texels, const std::byte* next_row, PixelFormat format,
                                     int chunk) const noexcept;
  void fold_directly(const ColumnRun& run, PixelFormat format, FoldHalves fold, const FetchAhead& ahead,
                     Scratch& scratch) noexcept;
  static void decode(const ColumnRun& run, PixelFormat format, Scratch& scratch) noexcept;
  void sanitize(const ColumnRun& run, PixelFormat format, Scratch& scratch, SanitizeRecord& record) noexcept;
  void fold_decoded(const ColumnRun& run, int position, Scratch& scratch) noexcept;
  void sum_planes(const ColumnRun& run, const FetchAhead& ahead, Scratch& scratch) noexcept;
  void sum_in_double(const ColumnRun& run, Scratch& scratch) noexcept;
  void add_row(int row, Scratch& scratch) noexcept;

  int width;
  int height;
  ProjectionOptions options;
  Sanitizer sanitizer;
  const ProjectionKernels& kernels;
  bool reduced;
  bool midpoint;
  std::shared_ptr<const LatLongWeights> weights;
  std::shared_ptr<const LatLongWeights> exact_weights;
  int rows_per_block;
  int block_count;
  int orders;
  int functions;
  std::vector<int> identity;  ///< the local sums are in canonical order already
  TileSums sums;
  TileSums exact_sums;
  std::vector<double> over_centre;  ///< by order, see `mean_over_centre`
  std::vector<Scratch> scratches;
};

void LatLongProjector::State::project_block(int block, const LatLongView& rows, Scratch& scratch) noexcept {
  std::fill(scratch.local_sums.begin(), scratch.local_sums.end(), 0.0);
  std::fill(scratch.exact_local_sums.begin(), scratch.exact_local_sums.end(), 0.0);
  const auto row_of = [&rows](int index) { return static_cast<const std::byte*>(image::row_of(rows, index)); };
  SanitizeRecord& record = sums.records[static_cast<std::size_t>(block)];
  for (int index = 0; index < rows.height; ++index) {
    const int row = block * rows_per_block + index;
    sum_row(row_of(index), index + 1 < rows.height ? row_of(index + 1) : nullptr, rows.format, row, scratch, record);
    add_row(row, scratch);
  }
  transforms::lat_long_transform(options.bands)
      .add(scratch.local_sums.data(), identity.data(), sums.tile(static_cast<std::size_t>(block)));
  if (!errs()) return;
  transforms::lat_long_transform(options.bands)
      .add(scratch.exact_local_sums.data(), identity.data(), exact_sums.tile(static_cast<std::size_t>(block)));
}

ColumnRun LatLongProjector::State::column_run(const std::byte* texels, PixelFormat format, int row, int chunk) const {
  const auto texel_bytes = static_cast<std::ptrdiff_t>(bytes_per_texel(format));
  const int first_column = chunk * kChunk;
  const std::byte* const first = texels + first_column * texel_bytes;
  return {.first = first,
          .second = weights->paired() ? first + weights->column_count() * texel_bytes : nullptr,
          .row = row,
          .first_column = first_column,
          .count = std::min(kChunk, weights->column_count() - first_column),
          .weights = weights->chunk_weights(chunk),
          .exact = reduced ? exact_weights->chunk_weights(chunk) : nullptr,
          // Row factor 0 is the row's extent times Y(0,0) = 1 / sqrt(4 pi).
          .row_weight = weights->row_weights(row)[0] * 2.0 * std::sqrt(std::numbers::pi)};
}

/// Leaves the row's sums over longitude in room.row_sums: the fast way, if the format allows it and the sums
/// come out finite, else with every texel passing the policies.
void LatLongProjector::State::sum_row(const std::byte* texels, const std::byte* next_row, PixelFormat format, int row,
                                      Scratch& scratch, SanitizeRecord& record) noexcept {
  const FoldHalves fold = sanitizer.needs_every_texel() ? nullptr : direct_fold(format, kernels);
  if (fold != nullptr) {
    clear_lanes(scratch);
    for (int chunk = 0; chunk < weights->chunk_count(); ++chunk) {
      const ColumnRun run = column_run(texels, format, row, chunk);
      const FetchAhead ahead = read_next(texels, next_row, format, chunk);
      fold_directly(run, format, fold, ahead, scratch);
      sum_planes(run, ahead, scratch);
    }
    if (fold_lanes(scratch, scratch.row_sums, scratch.exact_row_sums)) return;
  }
  std::fill(scratch.row_sums.begin(), scratch.row_sums.end(), 0.0);
  std::fill(scratch.exact_row_sums.begin(), scratch.exact_row_sums.end(), 0.0);
  for (int chunk = 0; chunk < weights->chunk_count(); ++chunk) {
    const ColumnRun run = column_run(texels, format, row, chunk);
    clear_lanes(scratch);
    decode(run, format, scratch);
    sanitize(run, format, scratch, record);
    fold_decoded(run, 0, scratch);
    sum_planes(run, {}, scratch);
    if (!fold_lanes(scratch, scratch.chunk_sums, scratch.exact_chunk_sums)) sum_in_double(run, scratch);
    for (std::size_t k = 0; k < scratch.row_sums.size(); ++k) {
      scratch.row_sums[k] += scratch.chunk_sums[k];
      scratch.exact_row_sums[k] += scratch.exact_chunk_sums[k];
    }
  }
}

void LatLongProjector::State::clear_lanes(Scratch& scratch) const noexcept {
  std::fill_n(scratch.sum_lanes.data(), scratch.sum_lanes.size(), 0.0);
  if (reduced) std::fill_n(scratch.exact_lanes.data(), scratch.exact_lanes.size(), 0.0);
}

/// False if the sums are not all finite.
bool LatLongProjector::State::fold_lanes(Scratch& scratch, std::vector<double>& sums_of_orders,
                                         std::vector<double>& exact) const noexcept {
  kernels.fold_sum_lanes(scratch.sum_lanes.data(), 3 * orders, sums_of_orders.data());
  if (reduced) kernels.fold_sum_lanes(scratch.exact_lanes.data(), 3 * orders, exact.data());
  return all_finite(sums_of_orders) && all_finite(exact);
}

/// Returns the memory that is read after a run: the next chunk of the row, or the next row's first, if there is one;
/// each of its halves as two stretches.
FetchAhead LatLongProjector::State::read_next(const std::byte* texels, const std::byte* next_row, PixelFormat format,
                                              int chunk) const noexcept {
  const bool row_ends = chunk + 1 == weights->chunk_count();
  if (!weights->paired() || (row_ends && next_row == nullptr)) return {};
  const ColumnRun next = row_ends ? column_run(next_row, format, 0, 0) : column_run(texels, format, 0, chunk + 1);
  constexpr std::ptrdiff_t cache_line = 64;
  const std::ptrdiff_t half = next.count * static_cast<std::ptrdiff_t>(bytes_per_texel(format)) / 2;
  const auto address = [](const std::byte* p) { return reinterpret_cast<const char*>(p); };
  return {{address(next.first), address(next.first) + half, address(next.second), address(next.second) + half},
          static_cast<int>(half / cache_line)};
}

void LatLongProjector::State::fold_directly(const ColumnRun& run, PixelFormat format, FoldHalves fold,
                                            const FetchAhead& ahead, Scratch& scratch) noexcept {
  const int whole = run.count / kLanes * kLanes;
  if (whole > 0) {
    fold(run.first, run.second != nullptr ? run.second : kZeros, ahead, whole / kLanes, scratch.planes.data());
  }
  if (whole == run.count) return;
  const auto skipped = whole * static_cast<std::ptrdiff_t>(bytes_per_texel(format));
  ColumnRun rest = run;
  rest.first += skipped;
  if (rest.second != nullptr) rest.second += skipped;
  rest.count -= whole;
  decode(rest, format, scratch);
  fold_decoded(rest, whole, scratch);
}

void LatLongProjector::State::decode(const ColumnRun& run, PixelFormat format, Scratch& scratch) noexcept {
  const int padded = (run.count + kLanes - 1) / kLanes * kLanes;
  const std::byte* const halves[2] = {run.first, run.second};
  for (int half = 0; half < 2; ++half) {
    float* const rgb = scratch.runs.data() + static_cast<std::ptrdiff_t>(half * 3) * kChunk;
    std::fill_n(rgb, 3 * padded, 0.0F);
    if (halves[half] != nullptr) image::decode_texels(format, halves[half], run.count, rgb);
  }
}

void LatLongProjector::State::sanitize(const ColumnRun& run, PixelFormat format, Scratch& scratch,
                                       SanitizeRecord& record) noexcept {
  for (int half = 0; half < (run.second != nullptr ? 2 : 1); ++half) {
    const TexelRun texels{.rgb = scratch.runs.data() + static_cast<std::ptrdiff_t>(half * 3) * kChunk,
                          .count = run.count,
                          .row = run.row,
                          .first_column = run.first_column + half * weights->column_count(),
                          .weights = run.weights,
                          .weight_scale = run.row_weight};
    if (sanitizer.may_change(format, texels.rgb, run.count)) sanitizer.sanitize(texels, record);
  }
}

void LatLongProjector::State::fold_decoded(const ColumnRun& run, int position, Scratch& scratch) noexcept {
  const float* const runs = scratch.runs.data();
  kernels.fold_halves[fold_rgb32f](runs, runs + std::ptrdiff_t{3} * kChunk, {}, (run.count + kLanes - 1) / kLanes,
                                   scratch.planes.data() + position);
}

void LatLongProjector::State::sum_planes(const ColumnRun& run, const FetchAhead& ahead, Scratch& scratch) noexcept {
  const int groups = (run.count + kLanes - 1) / kLanes;
  kernels.weighted_sums(scratch.planes.data(), kClasses, run.weights, weights->class_counts(), groups, ahead,
                        scratch.sum_lanes.data());
  if (!reduced) return;
  kernels.weighted_sums(scratch.planes.data(), kClasses, run.exact, weights->class_counts(), groups, {},
                        scratch.exact_lanes.data());
}

/// Leaves a run's sums in room.chunk_sums. Its decoded texels are finite, but their sums fit a double only.
void LatLongProjector::State::sum_in_double(const ColumnRun& run, Scratch& scratch) noexcept {
  std::fill(scratch.chunk_sums.begin(), scratch.chunk_sums.end(), 0.0);
  double planes[3 * kClasses * kChunk] = {};
  const float* const first = scratch.runs.data();
  const float* const second = first + std::ptrdiff_t{3} * kChunk;
  for (int k = 0; k < run.count; ++k) {
    for (int c = 0; c < 3; ++c) {
      const double a = first[3 * k + c];
      const double b = second[3 * k + c];
      planes[c * kClasses * kChunk + k] = a + b;
      planes[(c * kClasses + 1) * kChunk + k] = a - b;
    }
  }
  weighted_sums_in_double(planes, kClasses, run.weights, weights->class_counts(), run.count, scratch.chunk_sums.data());
  if (!reduced) return;
  std::fill(scratch.exact_chunk_sums.begin(), scratch.exact_chunk_sums.end(), 0.0);
  weighted_sums_in_double(planes, kClasses, run.exact, weights->class_counts(), run.count,
                          scratch.exact_chunk_sums.data());
}

/// local(l, m) += row's factor of (l, |m|) times its sum of order m.
void LatLongProjector::State::add_row(int row, Scratch& scratch) noexcept {
  const double* const factors = weights->row_weights(row);
  const double* const exact_factors = exact_weights->row_weights(row);
  for (int channel = 0; channel < 3; ++channel) {
    const auto first_order = static_cast<std::ptrdiff_t>(channel) * orders;
    const auto first_function = static_cast<std::ptrdiff_t>(channel) * functions;
    const double* const row_sums = scratch.row_sums.data() + first_order;
    double* const local = scratch.local_sums.data() + first_function;
    const double* const exact_sums_of_row = (reduced ? scratch.exact_row_sums : scratch.row_sums).data() + first_order;
    double* const exact_local = scratch.exact_local_sums.data() + first_function;
    for (int l = 0; l < options.bands; ++l) {
      for (int m = -l; m <= l; ++m) {
        const int order = m < 0 ? -m : m;
        const int factor = l * (l + 1) / 2 + order;
        local[l * (l + 1) + m] += factors[factor] * row_sums[weights->weight_row(m)];
        if (!errs()) continue;
        // The midpoint rule's column weights are d cos(m lon), the exact ones that times `mean_over_centre`, the same
        // for all columns; rows have factors of both rules. So the exact coefficients follow from the same sums over a
        // row.
        const double to_mean = reduced ? 1.0 : over_centre[static_cast<std::size_t>(order)];
        exact_local[l * (l + 1) + m] += exact_factors[factor] * to_mean * exact_sums_of_row[weights->weight_row(m)];
      }
    }
  }
}

LatLongProjector::LatLongProjector(int width, int height, const ProjectionOptions& options, std::size_t workers) {
  image::check_lat_long_size(width, height);
  check_options(options);
  state_ = std::make_unique<State>(width, height, options, workers);
}

LatLongProjector::~LatLongProjector() = default;

int LatLongProjector::rows_per_block() const noexcept { return state_->rows_per_block; }
int LatLongProjector::block_count() const noexcept { return state_->block_count; }

void LatLongProjector::project_block(int block, const LatLongView& rows, std::size_t worker) noexcept {
  state_->project_block(block, rows, state_->scratches[worker]);
}

Projection LatLongProjector::finish() {
  const SanitizeRecord record = state_->sums.total_record();
  throw_if_rejected(record, false);
  Projection projection{SphericalHarmonics(state_->options.bands), {}};
  const std::span<glm::dvec3> radiance = projection.radiance.coefficients();
  state_->sums.total(radiance);
  projection.diagnostics = diagnostics_of(radiance, record, 1.0);
  projection.diagnostics.texels =
      static_cast<std::uint64_t>(state_->width) * static_cast<std::uint64_t>(state_->height);
  SphericalHarmonics exact = projection.radiance;
  if (state_->errs()) state_->exact_sums.total(exact.coefficients());
  projection.diagnostics.error_estimate = relative_error(radiance, exact.coefficients());
  return projection;
}

}  // namespace welkin::projection
