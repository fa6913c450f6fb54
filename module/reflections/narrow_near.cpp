// The near parts of narrow lobes: sums over the texels about each direction. Directions that the cube's symmetries
// bring to each other share their weights.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/memory.h"
#include "reflections/narrow.h"
#include "reflections/narrow_kernels.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kLanes = simd::kLanes;
constexpr int kGroupsPerTile = 8;
constexpr int kLongestRun = 64;  ///< texels that floats add up without loss
/// Texels from the direction to the middles of those that are integrated in closed form.
constexpr double kClose = 2.0;
constexpr int kRowsBesidePole = 10;  ///< whose texels' series converge badly
constexpr double kInset = 0.2;       ///< of a texel from its middle, which counts if the near part reaches it

int whole_below(double number) {
  const int whole = static_cast<int>(number);
  return whole - (number < whole ? 1 : 0);
}

int whole_above(double number) { return -whole_below(-number); }

/// A position clear of lines between texels, whose corners it would see under no angle: some 1e-7 of a texel away, much
/// less than the narrowest lobe is wide.
double clear_of_lines(double position) {
  const double line = whole_below(position + 0.5);
  return std::abs(position - line) < 0x1p-23 ? line + 0x1p-23 : position;
}

/// The texels of a mip whose directions have a longitude from 0 to an eighth of a turn and a latitude of 0 or more:
/// their centres in half texels of the mip's cube.
std::vector<glm::ivec3> originals_of(int size) {
  const int first = size % 2 == 0 ? 1 : 0;
  std::vector<glm::ivec3> originals;
  for (int up = first; up < size; up += 2) {
    for (int across = first; across < size; across += 2) originals.emplace_back(across, up, size);
  }
  for (int out = first; out < size; out += 2) {
    for (int across = first; across <= out; across += 2) originals.emplace_back(across, size, out);
  }
  return originals;
}

using Directions = std::array<glm::dvec3, kLanes>;

/// Texels about each of 16 directions, rows and columns from the direction's own: those of each row from -rows to rows.
struct Window {
  int rows = 0;
  std::vector<RowRange> ranges;

  void clear(int rows_to_either_side) {
    rows = rows_to_either_side;
    ranges.clear();
  }
  void add(const ColumnRange& columns, const ColumnRange& close, bool beside_pole) {
    const auto within = [](const ColumnRange& all, const ColumnRange& part) -> ColumnRange {
      const ColumnRange both{std::max(all.first, part.first), std::min(all.end, part.end)};
      return both.first < both.end ? both : ColumnRange{all.end, all.end};
    };
    const ColumnRange all = within(columns, columns);
    ranges.push_back({all, within(all, close), beside_pole});
  }
  [[nodiscard]] const RowRange& range(int row) const { return ranges[static_cast<std::size_t>(row + rows)]; }
  /// Texels that are close in a row above a line or below it.
  [[nodiscard]] ColumnRange close_to_line(int row) const {
    ColumnRange all{0, 0};
    for (const int k : {std::max(row - 1, -rows), std::min(row, rows)}) {
      const ColumnRange& own = range(k).close;
      if (own.first >= own.end) continue;
      all = all.first >= all.end ? own : ColumnRange{std::min(all.first, own.first), std::max(all.end, own.end)};
    }
    return all;
  }
};

/// A worker's memory.
struct Scratch {
  Window window;
  platform::AlignedBuffer<float> corners;
  platform::AlignedBuffer<float> weights;
  std::vector<std::size_t> first_weights;  ///< of each row
  std::vector<TexelRun> runs;
  std::array<int, kLanes> column{};
  std::array<int, kLanes> row{};
  alignas(64) float sums[kLanes][kImageFloats] = {};
  alignas(64) float part[kImageFloats] = {};
  alignas(64) float bends[2][kLanes] = {};
  alignas(64) float shares[kLanes] = {};  ///< the near part in all

  static float* floats(platform::AlignedBuffer<float>& buffer, std::size_t count) {
    if (buffer.size() < count) {
      buffer = {};  // not both at the same time
      buffer = platform::AlignedBuffer<float>(count + count / 2);
    }
    return buffer.data();
  }
};

class NearField {
 public:
  NearField(const NearPart& part, const SplitLobe& lobe)
      : part_(part), lobe_(lobe), originals_(originals_of(part.size)) {
    for (int index = 0; index < kImages; ++index) {
      for (const bool cap : {false, true}) places_[cap ? 1 : 0][static_cast<std::size_t>(index)] = place_of(index, cap);
    }
    const TexelImages& images = part.images;
    if (images.cubemap()) return;
    const int columns = images.columns();
    for (int m = -columns / 2; m <= columns / 2; ++m) {
      const math::SineCosine value = math::sine_cosine_of_turns(0.5 * m / columns);
      column_table_.push_back(static_cast<float>(value.sine));
      column_table_.push_back(static_cast<float>(value.cosine));
    }
  }

  [[nodiscard]] std::int64_t groups() const noexcept {
    return (static_cast<std::int64_t>(originals_.size()) + kLanes - 1) / kLanes;
  }

  void add(std::int64_t group, Scratch& scratch) const {
    Directions directions;
    for (std::size_t k = 0; k < kLanes; ++k) directions[k] = glm::normalize(glm::dvec3(original(group, k)));
    for (auto& sums : scratch.sums) std::fill(std::begin(sums), std::end(sums), 0.0F);
    std::fill(std::begin(scratch.shares), std::end(scratch.shares), 0.0F);
    if (part_.images.cubemap()) {
      for (int patch = 0; patch < part_.images.patches(); ++patch) add_face(directions, patch, scratch);
    } else {
      add_lat_long(directions, scratch);
    }
    for (std::size_t k = 0; k < kLanes; ++k) {
      const std::size_t index = static_cast<std::size_t>(group) * kLanes + k;
      if (index < originals_.size()) write(originals_[index], scratch.sums[k], scratch.shares[k]);
    }
  }

 private:
  [[nodiscard]] const glm::ivec3& original(std::int64_t group, std::size_t lane) const {
    return originals_[std::min(static_cast<std::size_t>(group) * kLanes + lane, originals_.size() - 1)];
  }

  /// An image of all originals on the side, or the cap: steps in memory are even.
  struct Place {
    float* first = nullptr;
    std::ptrdiff_t across = 0;
    std::ptrdiff_t other = 0;
  };

  [[nodiscard]] Place place_of(int index, bool cap) const;
  void add_face(const Directions& directions, int patch, Scratch& scratch) const;
  void add_lat_long(const Directions& directions, Scratch& scratch) const;
  template <class Group>
  void add_window(const Group& group, int patch, Scratch& scratch) const;
  void add_lane(int patch, std::size_t lane, const float* weights, Scratch& scratch) const;
  void write(const glm::ivec3& original, const float* sums, float share) const;

  [[nodiscard]] MeasureLine<CubeGroup> measure(const CubeGroup&) const { return kernels_.measure_cube; }
  [[nodiscard]] MeasureLine<LatLongGroup> measure(const LatLongGroup&) const { return kernels_.measure_lat_long; }
  [[nodiscard]] WeighRow<CubeGroup> weigh(const CubeGroup&) const { return kernels_.weigh_cube; }
  [[nodiscard]] WeighRow<LatLongGroup> weigh(const LatLongGroup&) const { return kernels_.weigh_lat_long; }

  const NearPart& part_;
  SplitLobe lobe_;
  const NarrowKernels& kernels_ = narrow_kernels();
  std::vector<glm::ivec3> originals_;
  std::array<std::array<Place, kImages>, 2> places_;  ///< of the side, of the cap
  std::vector<float> column_table_;
};

NearField::Place NearField::place_of(int index, bool cap) const {
  const int size = part_.size;
  const auto pixel = [&](int across, int other) {
    const glm::ivec3 original = cap ? glm::ivec3(across, size, other) : glm::ivec3(across, other, size);
    const image::CubeTexel texel = image::texel_at(size, image::moved(image::cube_image_of(index), original));
    return part_.faces[static_cast<std::size_t>(texel.face)] +
           3 * (static_cast<std::ptrdiff_t>(texel.row) * size + texel.column);
  };
  const int first = size % 2 == 0 ? 1 : 0;
  float* const origin = pixel(first, first);
  if (size < 3) return {origin, 0, 0};
  return {origin, pixel(first + 2, first) - origin, pixel(first, first + 2) - origin};
}

/// Several images of a direction on a mirror's plane are the same texel.
void NearField::write(const glm::ivec3& original, const float* sums, float share) const {
  const bool cap = original.y == part_.size;
  const int across = original.x / 2;
  const int other = (cap ? original.z : original.y) / 2;
  const float scale = static_cast<float>(part_.energy) / share;
  const bool mirrored = original.x == 0 || original.y == 0 || original.x == original.z;
  std::array<float*, kImages> pixels;
  for (std::size_t index = 0; index < kImages; ++index) {
    const Place& place = places_[cap ? 1 : 0][index];
    float* const rgb = place.first + across * place.across + other * place.other;
    pixels[index] = rgb;
    const auto end = pixels.begin() + static_cast<std::ptrdiff_t>(index);
    if (mirrored && std::find(pixels.begin(), end, rgb) != end) continue;
    for (std::size_t c = 0; c < 3; ++c) rgb[c] += scale * sums[3 * index + c];
  }
}

/// The least and the largest of some numbers.
struct Extent {
  double least = 1e300;
  double largest = -1e300;
  void take(double value) {
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
};

constexpr float kNowhere = -100'000.0F;  ///< no window reaches a face from there

/// In the face's plane a circle of radius r about (u, v) is all but the ellipse (1 + v^2) du^2 - 2 u v du dv +
/// (1 + u^2) dv^2 = r^2 (1 + u^2 + v^2)^2.
void NearField::add_face(const Directions& directions, int patch, Scratch& scratch) const {
  const image::Frame& frame = image::face_frame(TexelImages::faces()[static_cast<std::size_t>(patch)]);
  const int size = part_.images.columns();
  const double reach = part_.split.reach;
  CubeGroup group{};
  group.size = static_cast<float>(size);
  Extent slant;
  Extent columns;  // of the directions, and where they are within theirs
  Extent rows;
  Extent part_rows;
  Extent part_columns;
  double height = 0.0;  // squares of the ellipse's half height and of its half width over that
  double width = 0.0;
  double texel = 0.0;  // the longest edge of one, radians
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double normal = glm::dot(directions[k], frame.normal);
    const double along_u = glm::dot(directions[k], frame.u);
    const double along_v = glm::dot(directions[k], frame.v);
    group.column[k] = group.row[k] = kNowhere;
    scratch.row[k] = scratch.column[k] = static_cast<int>(kNowhere);
    // the sine of the angle to the plane through the face's edge
    if (std::max(std::abs(along_u), std::abs(along_v)) - normal >= std::numbers::sqrt2 * reach) continue;
    const double u = along_u / normal;
    const double v = along_v / normal;
    const double column = clear_of_lines(0.5 * (u + 1.0) * size);
    const double row = clear_of_lines(0.5 * (v + 1.0) * size);
    scratch.column[k] = whole_below(column);
    scratch.row[k] = whole_below(row);
    group.u[k] = static_cast<float>(u);
    group.v[k] = static_cast<float>(v);
    group.column[k] = static_cast<float>(scratch.column[k]);
    group.row[k] = static_cast<float>(scratch.row[k]);
    group.part[k] = static_cast<float>(column - scratch.column[k]);
    group.part_row[k] = static_cast<float>(row - scratch.row[k]);
    columns.take(scratch.column[k]);
    rows.take(scratch.row[k]);
    part_columns.take(column - scratch.column[k]);
    part_rows.take(row - scratch.row[k]);
    const double wide = reach * std::sqrt(1.0 + u * u + v * v);
    slant.take(u * v / (1.0 + v * v));
    height = std::max(height, wide * wide * (1.0 + v * v));
    width = std::max(width, wide * wide * (1.0 + u * u + v * v) / (1.0 + v * v));
    texel = std::max(texel, 2.0 / size * std::sqrt(1.0 + std::max(u * u, v * v)) / (1.0 + u * u + v * v));
  }
  if (height == 0.0) return;
  Window& window = scratch.window;
  const double half = 0.5 * size;
  window.clear(static_cast<int>(std::ceil(half * std::sqrt(height))));
  const double close = kClose * texel / reach;
  for (int row = -window.rows; row <= window.rows; ++row) {
    // its middle, from the highest and the lowest of the directions
    const double high = row + 0.5 - part_rows.least;
    const double low = row + 0.5 - part_rows.largest;
    const double nearest = std::max({0.0, low - kInset, -high - kInset}) / half;
    const auto range_within = [&](double share) -> ColumnRange {  // of the reach
      const double left = share * share - nearest * nearest / height;
      if (left <= 0.0 || row + rows.largest < 0.0 || row + rows.least >= size) return {0, 0};
      const double side = half * std::sqrt(width * left) + kInset - 0.5;
      const auto [first, end] =
          std::minmax({slant.least * high, slant.largest * high, slant.least * low, slant.largest * low});
      const int from = whole_below(first - side + part_columns.least);
      const int to = whole_above(end + side + part_columns.largest);
      return {std::max(from, -static_cast<int>(columns.largest)), std::min(to, size - static_cast<int>(columns.least))};
    };
    window.add(range_within(1.0), range_within(close), false);
  }
  add_window(group, patch, scratch);
}

void NearField::add_lat_long(const Directions& directions, Scratch& scratch) const {
  const int columns = part_.images.columns();
  const int rows = part_.images.rows();
  const double reach = part_.split.reach;
  LatLongGroup group{};
  group.rows = static_cast<float>(rows);
  group.down = static_cast<float>(kPi / rows);
  group.across = static_cast<float>(2.0 * kPi / columns);
  group.columns = column_table_.data() + columns / 2 * 2;
  Extent latitude;  // turns
  Extent part_rows;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const glm::dvec3& d = directions[k];
    const double flat = std::sqrt(d.x * d.x + d.z * d.z);
    const double own = math::turns_of(d.y, flat);
    const double column = clear_of_lines((0.5 - math::turns_of(d.x, d.z)) * columns);
    const double row = clear_of_lines((0.25 - own) * 2.0 * rows);
    latitude.take(own);
    part_rows.take(row - whole_below(row));
    scratch.column[k] = whole_below(column);
    scratch.row[k] = std::min(whole_below(row), rows - 1);
    const math::SineCosine part = math::sine_cosine_of_turns(0.5 * (column - scratch.column[k]) / columns);
    group.sine[k] = static_cast<float>(d.y);
    group.cosine[k] = static_cast<float>(flat);
    group.sine_of_part[k] = static_cast<float>(part.sine);
    group.cosine_of_part[k] = static_cast<float>(part.cosine);
    const math::SineCosine middle = math::sine_cosine_of_turns(0.5 * (column - scratch.column[k] - 0.5) / columns);
    group.sine_of_middle[k] = static_cast<float>(middle.sine);
    group.cosine_of_middle[k] = static_cast<float>(middle.cosine);
    group.row[k] = static_cast<float>(scratch.row[k]);
    group.part_row[k] = static_cast<float>(row - scratch.row[k]);
  }
  Window& window = scratch.window;
  window.clear(static_cast<int>(std::ceil(reach * rows / kPi)));
  const int highest_row = *std::max_element(scratch.row.begin(), scratch.row.end());
  const int lowest_row = *std::min_element(scratch.row.begin(), scratch.row.end());
  const auto sine_squared = [](double radians) {
    const double sine = math::sine_cosine_of_turns(radians / (4.0 * kPi)).sine;
    return sine * sine;
  };
  const double own_cosine = math::sine_cosine_of_turns(latitude.largest).cosine;
  // sin^2 of half the way is sin^2(rows / 2) + cos cos sin^2(columns / 2)
  const auto range_of = [&](double cosines, double left) -> ColumnRange {
    if (left <= 0.0) return {0, 0};
    int side = columns / 2;
    if (left < 0.99 * cosines) {
      const double half_angle = math::arc_sine(std::sqrt(left / cosines));
      side = std::min(side, whole_above(half_angle * columns / kPi + kInset - 0.5));
    }
    return side == columns / 2 ? ColumnRange{-side, side} : ColumnRange{-side, side + 1};
  };
  const double texel = std::max(kPi / rows, 2.0 * kPi / columns * math::sine_cosine_of_turns(latitude.least).cosine);
  const double close = sine_squared(kClose * texel);
  const double all = sine_squared(reach);
  for (int row = -window.rows; row <= window.rows; ++row) {
    const double high = row + 0.5 - part_rows.least;
    const double low = row + 0.5 - part_rows.largest;
    const double nearest =
        row + highest_row < 0 ? 10.0 : sine_squared(std::max({0.0, low - kInset, -high - kInset}) * kPi / rows);
    const double other = latitude.largest + 0.5 * (0.5 - low) / rows;  // the northernmost
    const double cosines = other >= 0.25 ? 0.0 : own_cosine * math::sine_cosine_of_turns(other).cosine;
    window.add(range_of(cosines, all - nearest), range_of(cosines, close - nearest),
               row + lowest_row < kRowsBesidePole);
  }
  add_window(group, 0, scratch);
}

template <class Group>
void NearField::add_window(const Group& group, int patch, Scratch& scratch) const {
  const Window& window = scratch.window;
  const int cut = part_.images.cubemap() ? 0 : 1;  // a lat-long's own column is two: see `MeasureLine`
  ColumnRange all{0, 0};                           // that are close
  std::size_t texels = 0;
  scratch.first_weights.clear();
  for (const RowRange& row : window.ranges) {
    if (row.close.first < row.close.end) all = {std::min(all.first, row.close.first), std::max(all.end, row.close.end)};
    scratch.first_weights.push_back(texels);
    texels += static_cast<std::size_t>(row.columns.end - row.columns.first);
  }
  const auto width = static_cast<std::size_t>(all.end + 1 + cut - all.first) * kLanes;
  float* const corners = Scratch::floats(scratch.corners, 6 * width) - static_cast<std::ptrdiff_t>(all.first) * kLanes;
  float* const weights = Scratch::floats(scratch.weights, texels * kLanes);
  const auto line = [&](int row) -> CornerLine {
    float* const first = corners + (row & 1) * static_cast<std::ptrdiff_t>(3 * width);
    return {first, first + width, first + 2 * width, cut == 0 ? nullptr : scratch.bends[row & 1]};
  };
  for (int row = -window.rows; row <= window.rows + 1; ++row) {
    const ColumnRange close = window.close_to_line(row);
    if (close.first < close.end) measure(group)(lobe_, group, row, {close.first, close.end + 1 + cut}, line(row));
    if (row == -window.rows) continue;
    const RowRange& own = window.range(row - 1);
    if (own.columns.first >= own.columns.end) continue;
    const std::size_t first = scratch.first_weights[static_cast<std::size_t>(row - 1 + window.rows)];
    weigh(group)(lobe_, group, row - 1, own, line(row - 1), line(row),
                 weights + (static_cast<std::ptrdiff_t>(first) - own.columns.first) * kLanes, scratch.shares);
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) add_lane(patch, lane, weights + lane, scratch);
}

void NearField::add_lane(int patch, std::size_t lane, const float* weights, Scratch& scratch) const {
  const Window& window = scratch.window;
  const int column = scratch.column[lane];
  scratch.runs.clear();
  for (int row = -window.rows; row <= window.rows; ++row) {
    const auto index = static_cast<std::size_t>(row + window.rows);
    const ColumnRange own = window.ranges[index].columns;
    const TexelImages::Row& there = part_.images.row(patch, scratch.row[lane] + row);
    const int from = std::max(own.first, there.columns.first - column);
    const int end = std::min(own.end, there.columns.end - column);
    if (from >= end) continue;
    const std::size_t first = scratch.first_weights[index] + static_cast<std::size_t>(from - own.first);
    const float* texels =
        there.texels + static_cast<std::ptrdiff_t>(column + from - there.columns.first) * kImageFloats;
    const float* weight = weights + first * kLanes;
    for (int left = end - from; left > 0; left -= kLongestRun) {
      scratch.runs.push_back({texels, weight, std::min(left, kLongestRun)});
      texels += std::ptrdiff_t{kLongestRun} * kImageFloats;
      weight += kLongestRun * kLanes;
    }
  }
  if (scratch.runs.empty()) return;
  kernels_.sum_runs(scratch.runs.data(), static_cast<int>(scratch.runs.size()), scratch.part);
  for (int k = 0; k < kImageFloats; ++k) scratch.sums[lane][k] += scratch.part[k];
}

SplitLobe split_lobe(const NarrowSplit& split, double alpha) {
  const double square = alpha * alpha;
  const double rest = 1.0 - square;
  SplitLobe lobe{};
  lobe.width_squared = static_cast<float>(4.0 * square);
  lobe.offset = static_cast<float>(square / rest);
  lobe.inverse_end = static_cast<float>(1.0 / split.end(alpha));
  lobe.scale = static_cast<float>(square / (4.0 * kPi * rest * rest));
  lobe.far_scale = static_cast<float>(square / (4.0 * kPi * rest * rest * split.end(alpha) * split.end(alpha)));
  return lobe;
}

}  // namespace

// The near part's share is made exact: what even light gives must not depend on how a window ends.
void add_near_part(const NearPart& part, double alpha, const Control& control) {
  const NearField field(part, split_lobe(part.split, alpha));
  const std::int64_t groups = field.groups();
  const auto placement = jobs::placement_for(groups * kLanes * kImages * 10);
  std::vector<Scratch> scratch(jobs::worker_count(placement));
  jobs::run_tiles(static_cast<std::size_t>((groups + kGroupsPerTile - 1) / kGroupsPerTile), placement, scratch.size(),
                  control, [&](std::size_t tile, std::size_t worker) {
                    const auto first = static_cast<std::int64_t>(tile) * kGroupsPerTile;
                    for (std::int64_t group = first; group < std::min(groups, first + kGroupsPerTile); ++group)
                      field.add(group, scratch[worker]);
                  });
}

}  // namespace welkin::reflections
