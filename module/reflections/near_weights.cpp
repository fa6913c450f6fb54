#include "reflections/near_weights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "image/geometry.h"
#include "math/elementary.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kLanes = simd::kLanes;
constexpr std::size_t kGroupsPerTile = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Texels that are wide relative to the lobe are integrated in closed form up to kClose texels from the direction, and
// finely up to kFine. Others are integrated finely up to kClose.
constexpr double kMaxTexel = 2.5;  ///< over alpha
constexpr int kClose = 2;
constexpr int kFine = 4;
constexpr int kNowhere = -100'000;  ///< column and row of a direction that no window reaches a face from
constexpr double kInset = 0.2;      ///< of a texel from its middle, which counts if the near part reaches it

int whole_below(double number) {
  const int whole = static_cast<int>(number);
  return whole - (number < whole ? 1 : 0);
}

int whole_above(double number) { return -whole_below(-number); }

/// Returns a position clear of lines between texels: 2^-23 of a texel (1.2e-7) away, much less than the narrowest lobe
/// is wide. On a line, `cross` of an edge would be 0 or rounding's, and the signs of a texel's edges could not
/// show whether it or its neighbour has the direction. The error of that move is part of the estimate
/// (`error_of_weights`).
double clear_of_lines(double position) {
  const double line = whole_below(position + 0.5);
  return std::abs(position - line) < 0x1p-23 ? line + 0x1p-23 : position;
}

/// Returns s = sin^2(radians / 2). Angles count in turns, so sin(radians / 2) is that of radians / (4 pi) turns.
double sine_squared_of_half(double radians) {
  const double sine = math::sine_cosine_of_turns(radians / (4.0 * kPi)).sine;
  return sine * sine;
}

/// An interval from the minimum to the maximum of some numbers.
struct Interval {
  void take(double value) {
    first = std::min(first, value);
    end = std::max(end, value);
  }

  double first = kInfinity;
  double end = -kInfinity;
};

/// Returns the columns, or rows, that lie within an interval from -1 to 1 of a face of `size`.
ColumnRange texels_of(const Interval& interval, int size) {
  const auto position = [&](double at) { return 0.5 * size * (1.0 + std::clamp(at, -1.0, 1.0)); };
  if (!(interval.first < 1.0 && interval.end > -1.0)) return {0, 0};
  return {static_cast<int>(position(interval.first)), std::min(size, static_cast<int>(position(interval.end)) + 1)};
}

constexpr bool empty(const ColumnRange& range) { return range.first >= range.end; }

/// Returns the part of a range that lies within another; at its end if there is none.
ColumnRange within(const ColumnRange& all, const ColumnRange& part) {
  const ColumnRange both{std::max(all.first, part.first), std::min(all.end, part.end)};
  return empty(both) ? ColumnRange{all.end, all.end} : both;
}

RowRange nested(const ColumnRange& columns, const ColumnRange& fine, const ColumnRange& close) {
  const ColumnRange all = empty(columns) ? ColumnRange{0, 0} : columns;
  const ColumnRange inner = within(all, fine);
  return {all, inner, within(inner, close)};
}

// With s = sin^2(theta / 2), dw = 2 pi sin(theta) dtheta = 4 pi ds. So 1 / (q + s)^2 has within s
//   4 pi (1 / q - 1 / (q + s)) = 4 pi s / (q (q + s)),
// 4 pi / (q (q + 1)) over the whole sphere, and a share of s (q + 1) / (q + s) within s. In the stereographic plane
// r = 2 tan(theta / 2), s = r^2 / (4 + r^2); with q = alpha^2 / (1 - alpha^2), q / (q + 1) = alpha^2 and the share is
//   r^2 / (r^2 + 4 q / (q + 1)) = r^2 / (r^2 + (2 alpha)^2).
// That is all of the GGX lobe D(half vector) but for its cosine: alpha^2 + (1 - alpha^2) s = (1 - alpha^2) (q + s).
// The lobe of integral 1 is therefore q (q + 1) / (4 pi) / (q + s)^2. With x = (q + s) / end it is far_scale / x^2,
// far_scale = q (q + 1) / (4 pi end^2), and q (q + 1) = alpha^2 / (1 - alpha^2)^2.
SplitLobe split_lobe(const NearSplit& split, bool fine) {
  const double square = split.alpha * split.alpha;
  const double rest = (1.0 - split.alpha) * (1.0 + split.alpha);
  SplitLobe lobe{};
  lobe.width_squared = static_cast<float>(4.0 * square);
  lobe.offset = static_cast<float>(square / rest);
  lobe.inverse_end = static_cast<float>(1.0 / split.end());
  lobe.far_scale = static_cast<float>(square / (4.0 * kPi * rest * rest * split.end() * split.end()));
  lobe.fine = fine;
  return lobe;
}

/// Returns how many images a direction is of itself.
/// `NearSums::add` adds a direction's sum to every image's texel, so a direction that is its own image gets it so many
/// times: on the equator from both hemispheres, on the planes x = 0 and x = z from both mirror images, at a pole from
/// all eight of a hemisphere.
int times_itself(const glm::ivec3& direction) {
  const int below = direction.y == 0 ? 2 : 1;
  if (direction.x == 0 && direction.z == 0) return 8 * below;
  return below * (direction.x == 0 ? 2 : 1) * (direction.x == direction.z ? 2 : 1);
}

}  // namespace

double NearSplit::end() const noexcept {
  return alpha * alpha / ((1.0 - alpha) * (1.0 + alpha)) + sine_squared_of_half(reach);
}

std::size_t NearTile::bytes() const noexcept {
  return sizeof(*this) + runs.size() * sizeof(NearRun) + runs_ends.size() * sizeof(std::size_t) +
         weights.size() * sizeof(float);
}

NearWeights::NearWeights(const NearSplit& split, double share) : split_(split), share_(share) {
  // radians of an edge where texels are largest: a cubemap's at the middle of a face, a lat-long's at the equator
  const double texel = split.cubemap() ? 2.0 / split.face : kPi * std::max(1.0 / split.rows, 2.0 / split.face);
  closed_ = texel > kMaxTexel * split.alpha;
  lobe_ = split_lobe(split, !closed_);
  const int size = split.size;
  const int first = size % 2 == 0 ? 1 : 0;
  directions_.reserve(directions_of(split));
  for (int up = first; up < size && !split.cubemap(); up += 2) {
    for (int across = first; across < size; across += 2) directions_.emplace_back(across, up, size);
  }
  for (int out = first; out < size; out += 2) {
    for (int across = first; across <= out; across += 2) directions_.emplace_back(across, size, out);
  }
  if (split.cubemap()) return;
  // half the angle of m columns is m / face / 2 turns
  for (int m = -(split.face / 2); m <= split.face / 2; ++m) {
    const math::SineCosine value = math::sine_cosine_of_turns(0.5 * m / split.face);
    column_table_.push_back(static_cast<float>(value.sine));
    column_table_.push_back(static_cast<float>(value.cosine));
  }
}

// Counts, of n texels along half an edge, the middle one of an odd size among them, the n (n + 1) / 2 of an eighth of
// +y, and of a lat-long the n^2 of half a side face as well.
std::size_t NearWeights::directions_of(const NearSplit& split) noexcept {
  const auto half = static_cast<std::size_t>((split.size + 1) / 2);
  return half * (half + 1) / 2 + (split.cubemap() ? 0 : half * half);
}

std::size_t NearWeights::tiles() const noexcept { return (directions_.size() + first_of(1) - 1) / first_of(1); }
std::size_t NearWeights::first_of(std::size_t tile) noexcept { return tile * kGroupsPerTile * kLanes; }

namespace {

/// Returns where the planes lie that touch the cone of all directions within a reach, all with an edge of the face: x /
/// z from its axis' coordinates across and outwards.
///
/// The plane x = m z is as far as the reach from the axis (x, z) where |x - m z| / sqrt(1 + m^2) = S, S the sine of the
/// reach; the coordinate along the edge plays no part. That is
///   m^2 (z^2 - S^2) - 2 m x z + x^2 - S^2 = 0,  m = (x z -+ S sqrt(x^2 + z^2 - S^2)) / (z^2 - S^2),
/// as the discriminant x^2 z^2 - (z^2 - S^2) (x^2 - S^2) is S^2 (x^2 + z^2 - S^2). If that is not positive, the edge's
/// own direction lies within the cone, and all planes through it meet the cone. Where |z| <= S the cone meets z = 0, so
/// the range is open on one side. As (x z - root) (x z + root) = (z^2 - S^2) (x^2 - S^2), its end (x z -+ root) / (z^2
/// - S^2) is taken as (x^2 - S^2) / (x z +- root): z^2 - S^2 may be 0. Where |x| <= S too it is open on both sides.
Interval across_cone(double x, double z, const math::SineCosine& reach) {
  const double square = x * x + z * z - reach.sine * reach.sine;
  if (z <= -reach.sine) return {};
  if (square <= 0.0) return {-kInfinity, kInfinity};
  const double root = reach.sine * std::sqrt(square);
  const double wide = z * z - reach.sine * reach.sine;
  const double product = x * x - reach.sine * reach.sine;
  if (z > reach.sine) return {(x * z - root) / wide, (x * z + root) / wide};
  if (product <= 0.0) return {-kInfinity, kInfinity};
  if (x > 0.0) return {product / (x * z + root), kInfinity};
  return {-kInfinity, product / (x * z - root)};
}

/// Returns the union of a range that is counted from `offset` on, as the result is, and of another that is not.
ColumnRange with(const ColumnRange& range, const ColumnRange& other, int offset) {
  return {std::min(range.first, other.first - offset), std::max(range.end, other.end - offset)};
}

}  // namespace

void NearWeights::add_face(const Directions& directions, int part, Scratch& scratch) const {
  const image::Frame& frame = image::face_frame(kNearFaces[static_cast<std::size_t>(part)]);
  const int size = split_.face;
  const math::SineCosine reach = math::sine_cosine_of_turns(split_.reach / (2.0 * kPi));
  Window& window = scratch.windows[scratch.count];
  window.part = part;
  CubeGroup& group = window.face;
  group = {};
  group.size = static_cast<float>(size);
  ColumnRange rows{std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  ColumnRange columns = rows;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double x = glm::dot(directions[k], frame.u);
    const double y = glm::dot(directions[k], frame.v);
    const double z = glm::dot(directions[k], frame.normal);
    group.column[k] = group.row[k] = static_cast<float>(kNowhere);
    window.row[k] = window.column[k] = kNowhere;
    const ColumnRange own_rows = texels_of(across_cone(y, z, reach), size);
    const ColumnRange own_columns = texels_of(across_cone(x, z, reach), size);
    if (empty(own_rows) || empty(own_columns)) continue;
    const double column = clear_of_lines(0.5 * (x / z + 1.0) * size);
    const double row = clear_of_lines(0.5 * (y / z + 1.0) * size);
    window.column[k] = whole_below(column);
    window.row[k] = whole_below(row);
    group.u[k] = static_cast<float>(x / z);
    group.v[k] = static_cast<float>(y / z);
    group.column[k] = static_cast<float>(window.column[k]);
    group.row[k] = static_cast<float>(window.row[k]);
    group.part[k] = static_cast<float>(column - window.column[k]);
    group.part_row[k] = static_cast<float>(row - window.row[k]);
    rows = with(rows, own_rows, window.row[k]);
    columns = with(columns, own_columns, window.column[k]);
  }
  if (empty(rows)) return;
  ++scratch.count;
  window.first_row = rows.first;
  window.rows.clear();
  const auto beside = [](int row, int texels) -> ColumnRange {
    return std::abs(row) <= texels ? ColumnRange{-texels, texels + 1} : ColumnRange{0, 0};
  };
  for (int row = rows.first; row < rows.end; ++row)
    window.rows.push_back({.range = nested(columns, beside(row, closed_ ? kFine : kClose),
                                           closed_ ? beside(row, kClose) : ColumnRange{})});
}

void NearWeights::add_lat_long(const Directions& directions, Scratch& scratch) const {
  const int columns = split_.face;
  const int rows = split_.rows;
  Window& window = scratch.windows[scratch.count++];
  LatLongGroup& group = window.lat_long;
  group = {};
  group.rows = static_cast<float>(rows);
  group.down = static_cast<float>(kPi / rows);
  group.across = static_cast<float>(2.0 * kPi / columns);
  // the pair of 0 columns, from which indices go both ways
  group.columns = column_table_.data() + columns / 2 * 2;
  Interval latitude;  // turns
  Interval part_rows;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const glm::dvec3& d = directions[k];
    const double flat = std::sqrt(d.x * d.x + d.z * d.z);
    const double elevation = math::turns_of(d.y, flat);
    // Column 0 begins at longitude 180 degrees (0.5 turns), row 0 at the pole (0.25 turns).
    const double column = clear_of_lines((0.5 - math::turns_of(d.x, d.z)) * columns);
    const double row = clear_of_lines((0.25 - elevation) * 2.0 * rows);
    latitude.take(elevation);
    part_rows.take(row - whole_below(row));
    window.column[k] = whole_below(column);
    window.row[k] = std::min(whole_below(row), rows - 1);
    const math::SineCosine part = math::sine_cosine_of_turns(0.5 * (column - window.column[k]) / columns);
    const math::SineCosine middle = math::sine_cosine_of_turns(0.5 * (column - window.column[k] - 0.5) / columns);
    group.sine[k] = static_cast<float>(d.y);
    group.cosine[k] = static_cast<float>(flat);
    group.sine_of_part[k] = static_cast<float>(part.sine);
    group.cosine_of_part[k] = static_cast<float>(part.cosine);
    group.sine_of_middle[k] = static_cast<float>(middle.sine);
    group.cosine_of_middle[k] = static_cast<float>(middle.cosine);
    group.row[k] = static_cast<float>(window.row[k]);
    group.part_row[k] = static_cast<float>(row - window.row[k]);
  }
  const int highest_row = *std::max_element(window.row.begin(), window.row.end());
  const double own_cosine = math::sine_cosine_of_turns(latitude.end).cosine;
  // sin^2 of half the way is sin^2(rows / 2) + cos cos sin^2(columns / 2) (the haversine formula). With `left` of it
  // for the columns, half their angle is asin(sqrt(left / cosines)), which is half_angle columns / pi columns. Column
  // k > 0 has its middle k - 1/2 or more from a direction in column 0, -k as much, and counts if that less kInset is
  // within. `cosines` is that of the northernmost direction and the row's northern edge: no other has a wider range.
  const auto range_of = [&](double cosines, double left) -> ColumnRange {
    if (left <= 0.0) return {0, 0};
    // near 1 the arc sine is steep, and the row is all but whole
    int side = columns / 2;
    if (left < 0.99 * cosines) {
      const double half_angle = math::arc_sine(std::sqrt(left / cosines));
      side = std::min(side, whole_above(half_angle * columns / kPi + kInset - 0.5));
    }
    return side == columns / 2 ? ColumnRange{-side, side} : ColumnRange{-side, side + 1};
  };
  // ranges that count in texels are wide enough for the lowest of the directions, where columns are the widest
  const double texel = std::max(kPi / rows, 2.0 * kPi / columns * math::sine_cosine_of_turns(latitude.first).cosine);
  const double all = sine_squared_of_half(split_.reach);
  const double fine = sine_squared_of_half((closed_ ? kFine : kClose) * texel);
  const double close = closed_ ? sine_squared_of_half(kClose * texel) : 0.0;
  const auto side = static_cast<int>(std::ceil(split_.reach * rows / kPi));
  window.first_row = -side;
  window.rows.clear();
  for (int row = -side; row <= side; ++row) {
    // its middle, from the highest and the lowest of the directions; rows beyond the pole that none of them has see
    // nothing, which a `nearest` above any reach says
    const double high = row + 0.5 - part_rows.first;
    const double low = row + 0.5 - part_rows.end;
    const double nearest =
        row + highest_row < 0 ? 10.0 : sine_squared_of_half(std::max({0.0, low - kInset, -high - kInset}) * kPi / rows);
    const double other = latitude.end + 0.5 * (0.5 - low) / rows;  // the northernmost
    const double cosines = other >= 0.25 ? 0.0 : own_cosine * math::sine_cosine_of_turns(other).cosine;
    window.rows.push_back({.range = nested(range_of(cosines, all - nearest), range_of(cosines, fine - nearest),
                                           range_of(cosines, close - nearest))});
  }
}

namespace {

void grow(platform::AlignedBuffer<float>& buffer, std::size_t count) {
  if (buffer.size() >= count) return;
  buffer = {};  // not both at the same time
  buffer = platform::AlignedBuffer<float>(count + count / 2);
}

}  // namespace

void NearWeights::make(std::size_t tile, NearTile& to, Scratch& scratch) const {
  scratch.made.runs.clear();
  scratch.made.runs_ends.clear();
  scratch.made.weights.clear();
  const std::size_t groups = (directions_.size() + kLanes - 1) / kLanes;
  for (std::size_t group = tile * kGroupsPerTile; group < std::min(groups, (tile + 1) * kGroupsPerTile); ++group) {
    weigh_group(group, scratch);
    for (std::size_t lane = 0; lane < std::min(kLanes, directions_.size() - group * kLanes); ++lane)
      take_runs(lane, scratch);
  }
  to.runs.assign(scratch.made.runs.begin(), scratch.made.runs.end());
  to.runs_ends.assign(scratch.made.runs_ends.begin(), scratch.made.runs_ends.end());
  to.weights.assign(scratch.made.weights.begin(), scratch.made.weights.end());
}

void NearWeights::weigh_group(std::size_t group, Scratch& scratch) const {
  Directions directions;
  float sums[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    const glm::ivec3& direction = directions_[std::min(group * kLanes + k, directions_.size() - 1)];
    directions[k] = glm::normalize(glm::dvec3(direction));
    // Scaled to the near part's exact share, 1 - far_0, weights leave uniform light uniform whatever they err by.
    sums[k] = static_cast<float>(share_ / times_itself(direction));
  }
  scratch.count = 0;
  if (split_.cubemap()) {
    for (int part = 0; part < static_cast<int>(kNearFaces.size()); ++part) add_face(directions, part, scratch);
  } else {
    add_lat_long(directions, scratch);
  }
  std::size_t texels = 0;
  for (std::size_t k = 0; k < scratch.count; ++k) {
    for (Window::Row& row : scratch.windows[k].rows) {
      row.weights = texels * kLanes;
      texels += static_cast<std::size_t>(row.range.columns.end - row.range.columns.first);
    }
  }
  grow(scratch.weights, texels * kLanes);
  for (std::size_t k = 0; k < scratch.count; ++k) {
    if (split_.cubemap())
      weigh(near_kernels().cube, scratch.windows[k].face, scratch.windows[k], scratch);
    else
      weigh(near_kernels().lat_long, scratch.windows[k].lat_long, scratch.windows[k], scratch);
  }
  near_kernels().scale(scratch.weights.data(), static_cast<int>(texels), sums);
}

/// Takes a direction's weights, without the ends of rows that the near part does not reach.
void NearWeights::take_runs(std::size_t lane, Scratch& scratch) const {
  const int part_rows = split_.cubemap() ? split_.face : split_.rows;
  for (std::size_t k = 0; k < scratch.count; ++k) {
    const Window& window = scratch.windows[k];
    if (window.column[lane] == kNowhere) continue;
    int row = window.part * part_rows + window.row[lane] + window.first_row;
    for (const Window::Row& line : window.rows) {
      const float* const weights = scratch.weights.data() + line.weights + lane;
      const auto weight = [&](int i) { return weights[static_cast<std::ptrdiff_t>(i) * simd::kLanes]; };
      const int count = line.range.columns.end - line.range.columns.first;
      int first = 0;
      int end = count;
      while (first < end && weight(first) == 0.0F) ++first;
      while (first < end && weight(end - 1) == 0.0F) --end;
      if (first < end) {
        scratch.made.runs.push_back({row, window.column[lane] + line.range.columns.first + first, end - first});
        const std::size_t before = scratch.made.weights.size();
        scratch.made.weights.resize(before + static_cast<std::size_t>(end - first));
        float* const made = scratch.made.weights.data() + before;
        for (int i = first; i < end; ++i) made[i - first] = weight(i);
      }
      ++row;
    }
  }
  scratch.made.runs_ends.push_back(scratch.made.runs.size());
}

template <class Group>
void NearWeights::weigh(const GroupKernels<Group>& kernels, const Group& group, const Window& window,
                        Scratch& scratch) const {
  const int cut = split_.cubemap() ? 0 : 1;  // a lat-long's own column is two: see `MeasureLine`
  const auto count = static_cast<int>(window.rows.size());
  const auto range = [&](int row) -> const RowRange& { return window.rows[static_cast<std::size_t>(row)].range; };
  ColumnRange all{0, 0};  // that are close
  for (int row = 0; row < count; ++row) {
    const ColumnRange& close = range(row).close;
    if (!empty(close)) all = {std::min(all.first, close.first), std::max(all.end, close.end)};
  }
  const auto width = static_cast<std::ptrdiff_t>(all.end + 1 + cut - all.first) * simd::kLanes;
  grow(scratch.corners, static_cast<std::size_t>(6 * width));
  float* const corners = scratch.corners.data() - std::ptrdiff_t{all.first} * simd::kLanes;
  // A line is the lower one of a row and the upper one of the next: two are kept in turn.
  const auto line = [&](int row) -> CornerLine {
    float* const first = corners + (row & 1) * 3 * width;
    return {first, first + width, first + 2 * width, cut == 0 ? nullptr : scratch.bends[row & 1]};
  };
  // the texels that are close above a line and below it
  const auto close_to_line = [&](int row) -> ColumnRange {
    const ColumnRange above = row > 0 ? range(row - 1).close : ColumnRange{};
    const ColumnRange below = row < count ? range(row).close : ColumnRange{};
    if (empty(above)) return below;
    if (empty(below)) return above;
    return {std::min(above.first, below.first), std::max(above.end, below.end)};
  };
  for (int row = 0; row <= count; ++row) {
    const ColumnRange close = close_to_line(row);
    if (!empty(close))
      kernels.measure(lobe_, group, window.first_row + row, {close.first, close.end + 1 + cut}, line(row));
    if (row == 0 || empty(range(row - 1).columns)) continue;
    float* const weights = scratch.weights.data() + window.rows[static_cast<std::size_t>(row - 1)].weights -
                           std::ptrdiff_t{range(row - 1).columns.first} * simd::kLanes;
    kernels.weigh(lobe_, group, window.first_row + row - 1, range(row - 1), line(row - 1), line(row), weights);
  }
}

}  // namespace welkin::reflections
