#include "image/area_weights.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "math/elementary.h"
#include "math/table_cache.h"

namespace welkin::image {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kGroup = 4;
constexpr std::size_t kRoomFloats = 16384;  ///< of weights at a time, if one tile does not need more
constexpr int kStretch = 32;                ///< tiles whose patches have one size at least

int groups_for(int columns) noexcept { return (columns + kGroup - 1) / kGroup; }

/// The bounds of a tile.
struct Extent {
  double left, right, top, bottom;
};

Extent extent_of(const TileSide* sides, int number) noexcept {
  Extent all{sides[0].longitude, sides[0].longitude, sides[0].from, sides[0].from};
  for (int s = 0; s < number; ++s) {
    all.left = std::min(all.left, sides[s].longitude);
    all.right = std::max(all.right, sides[s].longitude);
    all.top = std::min(all.top, sides[s].to);
    all.bottom = std::max(all.bottom, sides[s].to);
  }
  return all;
}

}  // namespace

TileScratch::TileScratch(const TileWeights& weights)
    : weights_(std::max(kRoomFloats, weights.largest_patch())), polar_(weights.tiling()) {
  const auto count = static_cast<std::size_t>(weights.tiling().half()) + 1;
  for (auto* indices : {&rows_, &columns_}) indices->resize(count);
  for (auto* counts : {&down_count_, &across_count_}) counts->resize(count, 1);
  for (auto* values : {&areas_, &upper_, &lower_}) values->resize(count);
  down_shares_.resize(static_cast<std::size_t>(TileRun::kMaxSides) * static_cast<std::size_t>(weights.height() + 8));
}

TileWeights::TileWeights(int width, int height, int size, bool soft)
    : tiling_(size),
      width_(width),
      height_(height),
      soft_(soft),
      columns_per_radian_(0.5 * width / kPi),
      reach_((size % 2 != 0 ? (width + 7) / 8 : 0) + kSpareColumns),
      rows_(soft_rows()) {
  for (const TileKind kind : {TileKind::side, TileKind::polar}) {
    for (const TileImage& image : images_of(kind)) needed_[static_cast<std::size_t>(rest_of(image, width))] = true;
  }
  for (int rest = 0; rest < 4; ++rest) {
    const bool needed = needed_[static_cast<std::size_t>(rest)];
    columns_.push_back(needed ? soft_columns(0.25 * rest) : SoftCells({0.0, 1.0}, {0.0, 0.0}));
    side_columns_.push_back(needed ? columns_of_sides(columns_.back()) : SideColumns{});
  }
}

TileKind TileWeights::kind_of(bool polar, int row) const noexcept {
  if (!polar) return TileKind::side;
  return row == 0 && size() % 2 != 0 ? TileKind::pole : TileKind::polar;
}

int TileWeights::tiles_of(TileKind kind, int row) const noexcept { return kind == TileKind::side ? lines() : row + 1; }

/// Half a ramp's length, in texels of the source, where one of the result is `texels` of them wide: linear
/// interpolation where it is narrower, which keeps slopes even; nothing where it is twice as wide and evens them out
/// itself.
double TileWeights::half_ramp(double texels) const { return soft_ ? 0.5 * std::clamp(2.0 - texels, 0.0, 1.0) : 0.0; }

// A texel's height is 2 / size cos^2 of the latitude on a side face, sin^2 of it at the poles.
SoftCells TileWeights::soft_rows() const {
  std::vector<double> edges;
  for (int row = 0; row <= height_; ++row) {
    edges.push_back(-math::sine_cosine_of_turns(0.5 * row / height_).cosine);
  }
  std::vector<double> half_ramps(edges.size(), 0.0);
  for (int row = 1; row < height_; ++row) {
    const auto k = static_cast<std::size_t>(row);
    // On a side face v = tan(lat) / cos(lon): in the middle column dv = d lat / cos^2, so a texel of dv = 2 / size has
    // the height 2 / size cos^2(lat). On +-Y the distance from the middle is tan of the polar angle, and cos^2 of that
    // is sin^2(lat). The larger of the two is that of the face the latitude lies on. edges are -sin(lat).
    const double squared = edges[k] * edges[k];
    const double texels = height_ / kPi * 2.0 / size() * std::max(squared, 1.0 - squared);
    // Heights of rows differ. A ramp must not reach beyond the middle of a neighbour, where the next ramp may begin:
    // half of the lower row at most.
    half_ramps[k] = half_ramp(texels) * std::min(edges[k] - edges[k - 1], edges[k + 1] - edges[k]);
  }
  return {std::move(edges), std::move(half_ramps)};
}

// A column's width is 2 / size cos^2 of the longitude from the middle of a face. Cells are counted from -reach_ on;
// where the distance is 0, cell reach_ begins `offset` before.
SoftCells TileWeights::soft_columns(double offset) const {
  std::vector<double> edges;
  std::vector<double> half_ramps;
  const int count = width_ / 2 + 2 * reach_ + 2;
  for (int k = 0; k <= count; ++k) {
    const double distance = k - reach_ - offset;
    // u = tan(longitude from the face's middle): d lon = 2 / size cos^2(lon). The middles are quarters of a turn apart,
    // and the nearest one counts.
    const double turns = distance / width_;
    const double cosine = math::sine_cosine_of_turns(turns - 0.25 * std::floor(4.0 * turns + 0.5)).cosine;
    edges.push_back(distance);
    half_ramps.push_back(half_ramp(columns_per_radian_ * 2.0 / size() * cosine * cosine));
  }
  return {std::move(edges), std::move(half_ramps)};
}

TileWeights::SideColumns TileWeights::columns_of_sides(const SoftCells& columns) const {
  SideColumns result;
  int most = 1;
  int guess = 0;
  const auto position = [&](int index) { return tiling_.longitude(index) * columns_per_radian_; };
  for (int k = 0; k < tiling_.half(); ++k) {
    guess = columns.first_beyond(position(k), guess);
    result.columns.push_back(guess - reach_);
    most = std::max(most, columns.last_before(position(k + 1), guess) - guess + 1);
  }
  result.groups = groups_for(most);
  const int across = kGroup * result.groups;
  for (int k = 0; k < tiling_.half(); ++k) {
    const int first = result.columns[static_cast<std::size_t>(k)] + reach_;
    columns.for_each_share(first, across, position(k), position(k + 1), [&](double share) {
      result.weights.push_back(static_cast<float>(std::max(0.0, share / (position(k + 1) - position(k)))));
    });
  }
  return result;
}

/// Returns the maximum number of weights that one tile may need, and so the minimum to reserve.
std::size_t TileWeights::largest_patch() const noexcept {
  // A texel is at most sqrt(8) / size radians high and, but for the one around a pole, a quarter turn wide.
  const double rows = 3.0 / size() * height_ / kPi + 4.0;
  const double columns = size() % 2 != 0 ? width_ + 8.0 : 0.25 * width_ + 16.0;
  return static_cast<std::size_t>(std::min(rows, 1.0 * height_) + 1.0) * static_cast<std::size_t>(columns);
}

void TileWeights::weigh(TileKind kind, int row, TileScratch& scratch, const RunSink& sink) const {
  if (kind == TileKind::pole) return weigh_pole(scratch, sink);
  if (kind == TileKind::polar) return weigh_polar(row, scratch, sink);
  if (scratch.line_ != row) tiling_.side_heights(row, scratch.lower_.data());
  std::swap(scratch.upper_, scratch.lower_);
  tiling_.side_heights(row + 1, scratch.lower_.data());
  scratch.line_ = row + 1;
  row == 0 ? weigh_border(scratch, sink) : weigh_rectangles(row, scratch, sink);
}

TileWeights::PatchSize TileWeights::patch_size(const TileScratch& scratch, int first, int end) const noexcept {
  int rows = 1;
  int columns = 1;
  for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(end); ++k) {
    rows = std::max(rows, scratch.down_count_[k]);
    columns = std::max(columns, scratch.across_count_[k]);
  }
  return {std::min(rows, rows_.count()), groups_for(columns)};
}

/// A line's tiles differ: next to a pole the widest patch and the highest one belong to different tiles.
int TileWeights::tiles_together(const TileScratch& scratch, int first, int end, PatchSize& size) const noexcept {
  int last = std::min(first + kStretch, end);
  size = patch_size(scratch, first, last);
  while (last < end) {
    const int next = std::min(last + kStretch, end);
    if (patch_size(scratch, last, next) != size) break;
    last = next;
  }
  return last - first;
}

void TileWeights::weigh_rectangles(int row, TileScratch& scratch, const RunSink& sink) const {
  const int half = tiling_.half();
  int guess = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(half); ++k) {
    guess = scratch.rows_[k] = rows_.first_beyond(scratch.upper_[k], guess);
    scratch.down_count_[k] = rows_.last_before(scratch.lower_[k], guess) - guess + 1;
    scratch.across_count_[k] = 1;
  }
  WeighedRun run{TileKind::side, half - 1 - row, 0, 0, {}, scratch.areas_.data()};
  for (int first = 0; first < half;) {
    PatchSize size;
    int count = tiles_together(scratch, first, half, size);
    count = std::min(count, std::max(1, static_cast<int>(scratch.weights_.size()) / size.rows));
    run.patches.patch_rows = size.rows;
    float* weights = scratch.weights_.data();
    for (int k = 0; k < count; ++k) {
      const auto at = static_cast<std::size_t>(first + k);
      const double top = scratch.upper_[at];
      const double bottom = scratch.lower_[at];
      scratch.rows_[at] = std::min(scratch.rows_[at], rows_.count() - size.rows);
      // A rectangle's weights are products: the shares of its height over the height, times the shares of its columns.
      const double scale = 1.0 / (bottom - top);
      rows_.for_each_share(scratch.rows_[at], size.rows, top, bottom,
                           [&](double share) { *weights++ = static_cast<float>(std::max(0.0, share * scale)); });
      const double width = tiling_.longitude(first + k + 1) - tiling_.longitude(first + k);
      scratch.areas_[static_cast<std::size_t>(k)] = width * columns_per_radian_ * (bottom - top);
    }
    run.first = first;
    run.patches.count = count;
    run.patches.rows = scratch.rows_.data() + first;
    run.patches.row_weights = scratch.weights_.data();
    for (int rest = 0; rest < 4; ++rest) {
      if (!needed_[static_cast<std::size_t>(rest)]) continue;
      const SideColumns& columns = side_columns(rest);
      run.rest = rest;
      run.patches.patch_groups = columns.groups;
      run.patches.columns = columns.columns.data() + first;
      run.patches.weights = columns.weights.data() + std::ptrdiff_t{first} * kGroup * columns.groups;
      sink(run);
    }
    first += count;
  }
}

void TileWeights::weigh_border(TileScratch& scratch, const RunSink& sink) const {
  const auto sides = [&](int column, TileSide* side) {
    const CubeTiling::Border border = tiling_.border(column);
    const double lower = scratch.lower_[static_cast<std::size_t>(column)];
    // The upper boundary lies at first_height up to the longitude `middle` and at second_height from there on; the
    // lower one at `lower`. Going round it has three upright sides.
    side[0] = {border.middle, border.first_height, border.second_height};
    side[1] = {tiling_.longitude(column + 1), border.second_height, lower};
    side[2] = {tiling_.longitude(column), lower, border.first_height};
    return 3;
  };
  weigh_line({TileKind::side, tiling_.half() - 1, 0, 0, {}, nullptr}, tiling_.half(), sides, scratch, sink);
}

void TileWeights::weigh_polar(int row, TileScratch& scratch, const RunSink& sink) const {
  scratch.polar_.place(row);
  const auto sides = [&](int column, TileSide* side) { return scratch.polar_.sides(column, side); };
  weigh_line({TileKind::polar, row, 0, 0, {}, nullptr}, row + 1, sides, scratch, sink);
}

/// The texel around the pole of an odd number: all columns alike.
void TileWeights::weigh_pole(TileScratch& scratch, const RunSink& sink) const {
  scratch.polar_.place(0);
  // A cap from height -1 (the pole) to `height`: its solid angle is 2 pi (height + 1), in columns times height
  // (height + 1) width.
  const double height = scratch.polar_.outer_height(0);
  const double area = (height + 1.0) * width_;
  WeighedRun run{TileKind::pole, 0, 0, 0, {}, &area};
  // All columns have the same share, 1 / width of that of a row.
  run.patches.patch_rows = rows_.last_before(height, 0) + 1;
  run.patches.patch_groups = groups_for(width_);
  float* weight = scratch.weights_.data();
  rows_.for_each_share(0, run.patches.patch_rows, -1.0, height, [&](double share) {
    for (int column = 0; column < kGroup * run.patches.patch_groups; ++column)
      *weight++ = column < width_ ? static_cast<float>(std::max(0.0, share) / area) : 0.0F;
  });
  constexpr std::int32_t zero = 0;
  run.patches.rows = run.patches.columns = &zero;
  run.patches.weights = scratch.weights_.data();
  run.patches.count = 1;
  sink(run);
}

/// `sides(column, out)`: a tile's; how many there are.
/// A texel's share is a product x(longitude) y(height). With X = Int x, Y = Int y Green's theorem makes the integral
/// over a tile one around it, Int x y = sum over its sides of X(longitude) (Y(to) - Y(from)): sides along latitudes
/// have no change of Y and drop out, and the tile's area is the same sum with X = longitude, Y = height (`weigh_tile`).
template <class Sides>
void TileWeights::weigh_line(WeighedRun run, int count, const Sides& sides, TileScratch& scratch,
                             const RunSink& sink) const {
  for (run.rest = 0; run.rest < 4; ++run.rest) {
    if (!needed_[static_cast<std::size_t>(run.rest)]) continue;
    const SoftCells& columns = columns_[static_cast<std::size_t>(run.rest)];
    // First what each tile covers, then stretches of them with patches of one size.
    int row_guess = 0;
    for (int k = 0; k < count; ++k) {
      TileSide side[TileRun::kMaxSides];
      const Extent extent = extent_of(side, sides(k, side));
      const auto at = static_cast<std::size_t>(k);
      const int guess = static_cast<int>(extent.left * columns_per_radian_) + reach_;
      scratch.columns_[at] = columns.first_beyond(extent.left * columns_per_radian_, guess);
      scratch.rows_[at] = row_guess = rows_.first_beyond(extent.top, row_guess);
      scratch.across_count_[at] =
          columns.last_before(extent.right * columns_per_radian_, scratch.columns_[at]) - scratch.columns_[at] + 1;
      scratch.down_count_[at] = rows_.last_before(extent.bottom, row_guess) - row_guess + 1;
    }
    PatchRun& patches = run.patches;
    for (run.first = 0; run.first < count; run.first += patches.count) {
      PatchSize size;
      const int together = tiles_together(scratch, run.first, count, size);
      patches.patch_rows = size.rows;
      patches.patch_groups = size.groups;
      const auto patch = static_cast<std::size_t>(size.rows * size.groups * kGroup);
      patches.count = std::min(together, static_cast<int>(std::max<std::size_t>(1, scratch.weights_.size() / patch)));
      for (int k = 0; k < patches.count; ++k) {
        const auto at = static_cast<std::size_t>(run.first + k);
        // Patches of one size: those that need fewer rows than the widest are moved up at the lower end, where further
        // rows would not exist. Rows that a tile does not touch weigh 0.
        scratch.rows_[at] = std::min(scratch.rows_[at], rows_.count() - patches.patch_rows);
        TileSide side[TileRun::kMaxSides];
        const TileRun tile{side,
                           sides(run.first + k, side),
                           columns_per_radian_,
                           columns.from(scratch.columns_[at]),
                           rows_.from(scratch.rows_[at]),
                           patches.patch_rows,
                           patches.patch_groups,
                           scratch.down_shares_.data()};
        scratch.areas_[static_cast<std::size_t>(k)] =
            image_kernels().weigh_tile(tile, scratch.weights_.data() + static_cast<std::size_t>(k) * patch);
        scratch.columns_[at] -= reach_;  // from here on counted from the place of distance 0
      }
      patches.rows = scratch.rows_.data() + run.first;
      patches.columns = scratch.columns_.data() + run.first;
      patches.weights = scratch.weights_.data();
      run.areas = scratch.areas_.data();
      sink(run);
    }
  }
}

SoftCells::SoftCells(std::vector<double> edges, std::vector<double> half_ramps)
    : cells_(static_cast<int>(edges.size()) - 1), edges_(std::move(edges)), half_ramps_(std::move(half_ramps)) {
  const std::size_t padded = 2 * edges_.size() + 16;
  edges_.resize(padded, edges_.back());
  half_ramps_.resize(padded, half_ramps_.back());
  for (const double half : half_ramps_) inverses_.push_back(half > 0.0 ? 1.0 / (4.0 * half) : 0.0);
}

int SoftCells::first_beyond(double position, int guess) const noexcept {
  const auto ends_beyond = [&](int cell) {
    const auto end = static_cast<std::size_t>(cell + 1);
    return edges_[end] + half_ramps_[end] > position;
  };
  int cell = std::clamp(guess, 0, count() - 1);
  while (cell > 0 && ends_beyond(cell - 1)) --cell;
  while (cell < count() - 1 && !ends_beyond(cell)) ++cell;
  return cell;
}

int SoftCells::last_before(double position, int guess) const noexcept {
  const auto begins_before = [&](int cell) {
    const auto begin = static_cast<std::size_t>(cell);
    return edges_[begin] - half_ramps_[begin] < position;
  };
  int cell = std::clamp(guess, 0, count() - 1);
  while (cell < count() - 1 && begins_before(cell + 1)) ++cell;
  while (cell > 0 && !begins_before(cell)) --cell;
  return cell;
}

namespace {

constexpr std::size_t kCacheBytes = std::size_t{128} << 20U;
constexpr std::size_t kLargestTableBytes = std::size_t{96} << 20U;  // 2048 texels from 4096 x 2048 take 53 MiB

math::TableCache<TileWeightKey, TileWeightTable>& cache() {
  static auto& tables = *new math::TableCache<TileWeightKey, TileWeightTable>(kCacheBytes);  // never destroyed
  return tables;
}

}  // namespace

std::shared_ptr<const TileWeightTable> TileWeightTable::find(const TileWeightKey& key) { return cache().find(key); }

void TileWeightTable::keep(const TileWeightKey& key, const std::shared_ptr<const TileWeightTable>& table) {
  (void)cache().get(key, [&] { return table; });
}

TileWeightTable::TileWeightTable(const TileWeightKey& key)
    : weights_(key.width, key.height, key.size, true),
      // Distances are counted from quarters of the width: whole columns if it divides by four (rest 0), halves if by
      // two (rests 0 and 2), else quarters of a column.
      rests_(key.width % 4 == 0   ? 1
             : key.width % 2 == 0 ? 3
                                  : 4) {
  const auto rests = static_cast<std::size_t>(rests_);
  std::size_t floats = 0;
  std::size_t indices = 0;
  for (const bool polar : {false, true}) {
    for (int row = 0; row < weights_.lines(); ++row) {
      const TileKind kind = weights_.kind_of(polar, row);
      const std::size_t reserved = floats_for(kind, row);
      const auto tiles = static_cast<std::size_t>(weights_.tiles_of(kind, row));
      const std::size_t runs = std::min(tiles, tiles / kStretch + 2 + reserved / (kRoomFloats / 2));
      lines_.push_back({floats, indices, runs_.size(), reserved, runs, false, {}});
      runs_.resize(runs_.size() + runs * rests);
      floats += reserved * rests;
      indices += 2 * rests * tiles;
      if ((floats + indices) * sizeof(float) > kLargestTableBytes) {
        lines_.clear();
        runs_.clear();
        return;
      }
    }
  }
  floats_ = platform::AlignedBuffer<float>(floats);
  indices_ = platform::AlignedBuffer<std::int32_t>(indices);
}

/// Returns an upper estimate of a line's weights; a line that needs more after all is weighed again each time.
///
/// On +Y a texel in row r and column t r covers the longitudes from atan(t r / (r + 1)) to atan((t r + 1) / r), about
/// (1 + t) / (1 + t^2) / r radians: most where t = sqrt(2) - 1. It is deepest on the diagonal, sqrt(2) times as deep as
/// next to the axis.
std::size_t TileWeightTable::floats_for(TileKind kind, int row) const noexcept {
  constexpr double kWidest = 0.5 * (1.0 + std::numbers::sqrt2);
  const auto touched = [](double cells) { return static_cast<int>(std::ceil(cells)) + 2; };  // with their ramps
  const auto tiles = static_cast<std::size_t>(weights_.tiles_of(kind, row));
  const double texel = 2.0 / weights_.size();  // of a face whose edges are 2 long, in the middle radians
  // From the tangents: (t r + 1) / r - t r / (r + 1) = (1 + t) / r to the first order, and d atan = d tan / (1 + t^2).
  // Its derivative in t is 0 where 1 - 2 t - t^2 = 0, t = sqrt(2) - 1, and its value there (1 + sqrt(2)) / 2 = kWidest.
  const double texel_rows = texel * weights_.height() / kPi;
  if (kind == TileKind::side && row > 0) return tiles * static_cast<std::size_t>(touched(texel_rows));
  double radians = texel;
  double depth = std::numbers::sqrt2;
  if (kind != TileKind::side) {
    const double inner = row - (weights_.size() % 2 != 0 ? 0.5 : 0.0);
    radians = inner > 0.0 ? std::min(0.5 * kPi, kWidest / inner) : 0.5 * kPi;
    depth /= 1.0 + std::max(inner, 0.0) * texel * std::max(inner, 0.0) * texel;
  }
  if (kind == TileKind::pole) radians = 2.0 * kPi;
  const int rows = std::min(touched(depth * texel_rows), weights_.height());
  const int groups = groups_for(touched(radians * weights_.width() / (2.0 * kPi)));
  return tiles * static_cast<std::size_t>(kGroup * rows * groups);
}

std::size_t TileWeightTable::bytes() const noexcept {
  return floats_.bytes() + indices_.bytes() + lines_.size() * sizeof(Line) + runs_.size() * sizeof(Run) + sizeof(*this);
}

bool TileWeightTable::complete() const noexcept {
  return !lines_.empty() && std::all_of(lines_.begin(), lines_.end(), [](const Line& line) { return line.kept; });
}

void TileWeightTable::fill(bool polar, int row, TileScratch& scratch, const RunSink& sink) {
  const TileKind kind = weights_.kind_of(polar, row);
  if (lines_.empty()) return weights_.weigh(kind, row, scratch, sink);
  Line& line = lines_[line_index(polar, row)];
  const auto tiles = static_cast<std::size_t>(weights_.tiles_of(kind, row));
  std::size_t used[4] = {};  // floats, of each rest
  line.kept = true;
  const auto keep = [&](const WeighedRun& run) {
    sink(run);
    const PatchRun& patches = run.patches;
    const auto rest = static_cast<std::size_t>(run.rest);
    const auto count = static_cast<std::size_t>(patches.count);
    const bool product = patches.row_weights != nullptr;
    const std::size_t floats =
        count * static_cast<std::size_t>(patches.patch_rows * (product ? 1 : 4 * patches.patch_groups));
    if (run.rest >= rests_ || used[rest] + floats > line.floats || line.runs_of[rest] == line.runs) {
      line.kept = false;
      return;
    }
    const std::size_t run_at = line.first_run + rest * line.runs + line.runs_of[rest]++;
    runs_[run_at] = {run.first, patches.count, patches.patch_rows, patches.patch_groups, used[rest]};
    std::copy_n(product ? patches.row_weights : patches.weights, floats,
                floats_.data() + line.first_float + rest * line.floats + used[rest]);
    used[rest] += floats;
    std::int32_t* const indices =
        indices_.data() + line.first_index + 2 * rest * tiles + static_cast<std::size_t>(run.first);
    std::copy_n(patches.rows, count, indices);
    std::copy_n(patches.columns, count, indices + tiles);
  };
  weights_.weigh(kind, row, scratch, std::ref(keep));
}

void TileWeightTable::read(bool polar, int row, TileScratch* scratch, const RunSink& sink) const {
  const TileKind kind = weights_.kind_of(polar, row);
  if (lines_.empty() || !lines_[line_index(polar, row)].kept) return weights_.weigh(kind, row, *scratch, sink);
  const Line& line = lines_[line_index(polar, row)];
  const auto tiles = static_cast<std::size_t>(weights_.tiles_of(kind, row));
  const bool product = kind == TileKind::side && row > 0;
  WeighedRun run{kind, polar ? row : weights_.lines() - 1 - row, 0, 0, {}, nullptr};
  for (run.rest = 0; run.rest < rests_; ++run.rest) {
    const auto rest = static_cast<std::size_t>(run.rest);
    const TileWeights::SideColumns& columns = weights_.side_columns(run.rest);
    for (std::size_t k = 0; k < line.runs_of[rest]; ++k) {
      const Run& stored = runs_[line.first_run + rest * line.runs + k];
      const float* const weights = floats_.data() + line.first_float + rest * line.floats + stored.float_offset;
      run.first = stored.first;
      run.patches.count = stored.count;
      run.patches.patch_rows = stored.rows;
      run.patches.patch_groups = stored.groups;
      run.patches.rows = indices_.data() + line.first_index + 2 * rest * tiles + static_cast<std::size_t>(stored.first);
      run.patches.columns = run.patches.rows + tiles;
      run.patches.weights =
          product ? columns.weights.data() + std::ptrdiff_t{kGroup} * columns.groups * stored.first : weights;
      run.patches.row_weights = product ? weights : nullptr;
      sink(run);
    }
  }
}

}  // namespace welkin::image
