#include "reflections/narrow.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/memory.h"
#include "reflections/lobe.h"
#include "reflections/narrow_kernels.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kLanes = simd::kLanes;
constexpr int kMostBands = 1536;
constexpr int kLeastBands = 144;
constexpr double kBandsPerColumn = 0.75;  ///< of a whole turn's columns
constexpr double kEnd = 11.0;             ///< bands^2 / split: what lies beyond the last band is e^-11
constexpr double kCut = 8.0;              ///< u at the near part's end: (1 + u) e^-u = 3.0e-3
constexpr int kGroupsPerTile = 8;
constexpr int kClose = 2;  ///< texels to either side that are integrated in closed form

using Faces = std::array<float*, 6>;

/// A place clear of lines between texels, whose corners it would see under no angle: some 1e-7 of a texel away, much
/// less than the narrowest lobe is wide.
double clear_of_lines(double place) {
  const double line = std::round(place);
  return std::abs(place - line) < 0x1p-23 ? line + 0x1p-23 : place;
}

int parts_of(int count, double wanted) { return std::max(1, static_cast<int>(std::ceil(wanted / count - 0.01))); }

}  // namespace

NarrowSplit split_for(bool cubemap, int columns, int rows) noexcept {
  NarrowSplit split;
  // texels that would fit a turn, along the axis on which they are small
  const double fine = cubemap ? kPi * columns : std::max<double>(columns, 2.0 * rows);
  split.bands = std::clamp(8 * static_cast<int>(std::ceil(fine * kBandsPerColumn / 8.0)), kLeastBands, kMostBands);
  const double least = kLeastBands / kBandsPerColumn;
  const double whole = std::max(fine, least);
  split.columns = columns * parts_of(columns, cubemap ? whole / kPi : whole);
  split.rows = rows * parts_of(rows, cubemap ? whole / kPi : 0.5 * whole);
  split.split = static_cast<double>(split.bands) * split.bands / kEnd;
  split.reach = 2.0 * std::sqrt(kCut / split.split);
  return split;
}

// The means over the texels of rings blur: band l loses (l pi / rows)^2 / 24, 1 % of the middle one at three rows a
// band, which a narrow lobe has little of.
int rows_for_far_part(int face_size, const NarrowSplit& split) noexcept {
  const double wanted = std::min(3.0 * split.bands, 2048.0);
  return 2 * face_size * std::max(1, static_cast<int>(std::ceil(wanted / (2.0 * face_size))));
}

double narrow_error(const projection::SanitizedSource& source, const NarrowSplit& split, double alpha) noexcept {
  constexpr double rounding = 5e-5;
  constexpr double of_tail = 6e-3;
  constexpr double darkest = 1e-6;  // of the mean, as errors are measured
  double largest = 0.0;
  double least = std::numeric_limits<double>::max();
  double mean = 0.0;
  for (int row = 0; row < source.rows(); ++row) {
    const auto& range = source.range(row);
    largest = std::max({largest, static_cast<double>(range.largest), -static_cast<double>(range.least)});
    least = std::min(least, static_cast<double>(range.least));
    mean += std::abs(range.mean) / source.rows();
  }
  // places are rounded to some 1e-7 of a texel, of which the narrowest lobes are not much wider
  const double texel = source.cubemap() ? 2.0 / split.columns : 2.0 * kPi / split.columns;
  const double floor = rounding + 0x1p-22 * texel / (2.0 * alpha);
  if (!(largest > least)) return rounding;
  const double contrast = largest / std::max({least, darkest * mean, std::numeric_limits<double>::min()});
  const double tail = 0.125 * alpha * alpha * split.split;  // of the lobe's energy, beyond some texels
  return floor + of_tail * std::min(1.0, 10.0 * tail * contrast);
}

namespace {

/// A worker's room for one group.
class Room {
 public:
  explicit Room(int corners) {
    const auto floats = static_cast<std::size_t>(corners) * kLanes;
    for (Line& line : lines_) {
      for (auto* list : {&line.x, &line.y, &line.far, &line.edge}) *list = platform::AlignedBuffer<float>(floats);
      line.foot = platform::AlignedBuffer<float>(kLanes);
    }
    weights_ = platform::AlignedBuffer<float>(floats);
  }

  [[nodiscard]] CornerLine line(int which) {
    Line& line = lines_[static_cast<std::size_t>(which)];
    return {line.x.data(), line.y.data(), line.far.data(), line.edge.data(), line.foot.data()};
  }
  [[nodiscard]] float* weights() { return weights_.data(); }

  alignas(64) float sums[4 * kLanes] = {};  ///< RGB and what does not count, for each lane
  alignas(64) float shares[kLanes] = {};    ///< the near part in all

 private:
  struct Line {
    platform::AlignedBuffer<float> x, y, far, edge, foot;
  };
  std::array<Line, 2> lines_;
  platform::AlignedBuffer<float> weights_;
};

/// Texels of one mip in groups of 16, in the order of memory; the last group repeats the last texel.
class Outputs {
 public:
  explicit Outputs(int size) : size_(size), count_(std::int64_t{6} * size * size) {}

  [[nodiscard]] std::int64_t groups() const noexcept { return (count_ + kLanes - 1) / kLanes; }
  [[nodiscard]] std::int64_t texel(std::int64_t group, int lane) const noexcept {
    return std::min(group * kLanes + lane, count_ - 1);
  }
  [[nodiscard]] int lanes(std::int64_t group) const noexcept {
    return static_cast<int>(std::min<std::int64_t>(kLanes, count_ - group * kLanes));
  }
  [[nodiscard]] glm::dvec3 direction(std::int64_t texel) const noexcept {
    const auto place = static_cast<int>(texel % (std::int64_t{size_} * size_));
    const int row = place / size_;
    return image::face_direction(size_, face(texel), place % size_ + 0.5, row + 0.5);
  }
  [[nodiscard]] int face(std::int64_t texel) const noexcept {
    return static_cast<int>(texel / (std::int64_t{size_} * size_));
  }
  [[nodiscard]] float* pixel(const Faces& faces, std::int64_t texel) const noexcept {
    return faces[static_cast<std::size_t>(face(texel))] + 3 * (texel % (std::int64_t{size_} * size_));
  }

 private:
  int size_;
  std::int64_t count_;
};

using Directions = std::array<glm::dvec3, kLanes>;

/// What all groups of a mip share.
struct Work {
  const projection::SanitizedSource& source;
  NarrowSplit split;
  SplitLobe lobe{};
  const NarrowKernels& kernels;
};

/// A window of texels about each of 16 directions: rows and columns from the direction's own.
struct Window {
  int rows = 0;     ///< to either side
  int first = 0;    ///< column
  int columns = 0;  ///< from there on
  int close = 0;    ///< columns to either side that are close by, in rows that are

  [[nodiscard]] ColumnRange close_columns(int row) const {
    if (std::abs(row) > kClose) return {0, 0};
    return {std::max(0, -close - first), std::min(columns, close + 1 - first)};
  }
};

/// Weighs the row whose corners are known: exactly close by.
void weigh(const Work& work, Room& room, const Window& window, int row, bool has_foot) {
  const CornerLine above = room.line(row & 1);
  const CornerLine below = room.line((row + 1) & 1);
  const ColumnRange close = window.close_columns(row);
  if (close.first < close.end) {
    const int first = std::max(-kClose, -window.rows);  // later rows' upper line was the lower one of the row before
    if (row == first) work.kernels.measure_line(work.lobe, has_foot, close, above);
    work.kernels.measure_line(work.lobe, has_foot, close, below);
    work.kernels.weigh_close(work.lobe, above, below, close, room.weights(), room.shares);
  }
  work.kernels.weigh_far(work.lobe, above, below, {0, close.first}, room.weights(), room.shares);
  work.kernels.weigh_far(work.lobe, above, below, {close.end, window.columns}, room.weights(), room.shares);
}

/// Adds up a row of the source for one lane; the columns are those of small texels.
void add_run(const Work& work, const float* rgb, int first, int count, int parts, const float* weights, float* sum) {
  if (parts == 1) {
    work.kernels.add_texels(rgb + std::ptrdiff_t{3} * first, weights, count, sum);
    return;
  }
  for (int i = 0; i < count; ++i)
    work.kernels.add_texels(rgb + std::ptrdiff_t{3} * ((first + i) / parts), weights + std::ptrdiff_t{i} * kLanes, 1,
                            sum);
}

/// The source as a lat-long.
class LatLongNear {
 public:
  explicit LatLongNear(const Work& work)
      : work_(work), columns_(work.split.columns), rows_(work.split.rows), half_(work.split.columns / 2) {
    for (int m = -half_; m <= columns_ - half_; ++m) add(column_table_, 0.5 * m / columns_);
    for (int m = -rows_; m <= rows_; ++m) add(row_table_, 0.25 * m / rows_);
  }

  /// The most corners of a line: at the poles all columns.
  [[nodiscard]] int most_corners() const { return columns_ + 1; }

  void add(const Directions& directions, Room& room) const {
    LatLongGroup group;
    std::array<int, kLanes> columns{};
    std::array<int, kLanes> rows{};
    double least_cosine = 1.0;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const glm::dvec3& d = directions[k];
      const double cosine = std::sqrt(d.x * d.x + d.z * d.z);
      const double column = clear_of_lines((0.5 - math::turns_of(d.x, d.z)) * columns_);
      const double row = clear_of_lines((0.25 - math::turns_of(d.y, cosine)) * 2.0 * rows_);
      columns[k] = std::clamp(static_cast<int>(column), 0, columns_ - 1);
      rows[k] = std::clamp(static_cast<int>(row), 0, rows_ - 1);
      const math::SineCosine part = math::sine_cosine_of_turns(0.5 * (column - columns[k]) / columns_);
      const math::SineCosine part_row = math::sine_cosine_of_turns(0.25 * (row - rows[k]) / rows_);
      group.sine_of_part[k] = static_cast<float>(part.sine);
      group.cosine_of_part[k] = static_cast<float>(part.cosine);
      group.sine_of_part_row[k] = static_cast<float>(part_row.sine);
      group.cosine_of_part_row[k] = static_cast<float>(part_row.cosine);
      group.sine_latitude[k] = static_cast<float>(d.y);
      group.cosine_latitude[k] = static_cast<float>(cosine);
      least_cosine = std::min(least_cosine, cosine);
    }
    const Window window = window_for(least_cosine);
    for (int row = -window.rows; row <= window.rows + 1; ++row) {
      const CornerLine line = room.line(row & 1);
      place(group, rows, row, window, line);
      if (row == -window.rows) continue;
      weigh(work_, room, window, row - 1, true);
      for (int k = 0; k < kLanes; ++k) add_row(columns, rows, k, row - 1, window, room);
    }
  }

 private:
  static void add(std::vector<float>& table, double turns) {
    const math::SineCosine value = math::sine_cosine_of_turns(turns);
    table.push_back(static_cast<float>(value.sine));
    table.push_back(static_cast<float>(value.cosine));
  }

  /// No point within `reach` of latitude lambda is farther than asin(sin(reach) / cos(lambda)) in longitude.
  [[nodiscard]] Window window_for(double cosine) const {
    Window window;
    window.rows = static_cast<int>(std::ceil(work_.split.reach * rows_ / kPi - 0.5));
    window.first = -half_;
    window.columns = columns_;
    const double close = kClose * (0.5 * columns_ / rows_) / cosine;  // as long as rows are high
    window.close = static_cast<int>(std::ceil(std::min(close, 1.0 * columns_)));
    if (work_.split.reach < 0.9 * cosine) {
      const double half = math::arc_sine(work_.split.reach / cosine) * columns_ / (2.0 * kPi);
      const int side = static_cast<int>(std::ceil(half - 0.5));
      if (2 * side + 1 < columns_) window = {window.rows, -side, 2 * side + 1, window.close};
    }
    return window;
  }

  void place(const LatLongGroup& group, const std::array<int, kLanes>& rows, int row, const Window& window,
             const CornerLine& line) const {
    alignas(64) float angles[2 * kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) {
      const int offset = std::clamp(rows[k] + row, 0, rows_) - rows[k];
      const float* const entry = row_table_.data() + 2 * (offset + rows_);
      angles[k] = entry[0];
      angles[kLanes + k] = entry[1];
    }
    const float* const columns = column_table_.data() + 2 * (window.first + half_);
    work_.kernels.place_lat_long(group, columns, angles, window.columns + 1, line);
  }

  void add_row(const std::array<int, kLanes>& columns, const std::array<int, kLanes>& rows, int lane, int offset,
               const Window& window, Room& room) const {
    const auto k = static_cast<std::size_t>(lane);
    const int row = rows[k] + offset;
    if (row < 0 || row >= rows_) return;
    const float* const rgb = work_.source.row(row / (rows_ / work_.source.rows()));
    const int parts = columns_ / work_.source.columns();
    const int first = (columns[k] + window.first + columns_) % columns_;
    const int run = std::min(window.columns, columns_ - first);
    const float* const weights = room.weights() + lane;
    float* const sum = room.sums + 4 * lane;
    add_run(work_, rgb, first, run, parts, weights, sum);
    if (run < window.columns)
      add_run(work_, rgb, 0, window.columns - run, parts, weights + std::ptrdiff_t{run} * kLanes, sum);
  }

  const Work& work_;
  int columns_;
  int rows_;
  int half_;
  std::vector<float> column_table_;
  std::vector<float> row_table_;
};

/// The source as a cubemap: each group is added once for each face that it can reach.
class CubeNear {
 public:
  explicit CubeNear(const Work& work) : work_(work), size_(work.split.columns) {}

  /// The most corners of a line: at a face's corner, sqrt(1 + u^2 + v^2) sqrt(1 + u^2) is below 3.8 within `reach`.
  [[nodiscard]] int most_corners() const {
    return static_cast<int>(3.8 * size_ * work_.split.reach * (1.0 + work_.split.reach)) + 4;
  }

  void add(const Directions& directions, Room& room) const {
    for (int face = 0; face < 6; ++face) add_face(directions, face, room);
  }

 private:
  void add_face(const Directions& directions, int face, Room& room) const {
    const image::Frame& frame = image::face_frame(face);
    CubeGroup group{};
    group.size = static_cast<float>(size_);
    std::array<int, kLanes> columns{};
    std::array<int, kLanes> rows{};
    double half = 0.0;  // of the widest disc, in texels
    double half_rows = 0.0;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const glm::dvec3& d = directions[k];
      const double normal = glm::dot(d, frame.normal);
      columns[k] = rows[k] = kNowhere;
      const double along_u = glm::dot(d, frame.u);
      const double along_v = glm::dot(d, frame.v);
      // the sine of the angle to the plane through the face's edge
      const double beyond = std::max(std::abs(along_u), std::abs(along_v)) - normal;
      if (beyond < std::numbers::sqrt2 * work_.split.reach) {
        const double u = along_u / normal;
        const double v = along_v / normal;
        // a step of one radian moves u by so much at most, and the disc's rim by somewhat more
        const double wide = work_.split.reach * (1.0 + work_.split.reach) * std::sqrt(1.0 + u * u + v * v);
        half = std::max(half, 0.5 * size_ * wide * std::sqrt(1.0 + u * u));
        half_rows = std::max(half_rows, 0.5 * size_ * wide * std::sqrt(1.0 + v * v));
        set(group, k, u, v, columns, rows);
        continue;
      }
      group.column[k] = group.row[k] = kNowhere;
    }
    if (half == 0.0) return;
    const int side = static_cast<int>(std::ceil(half - 0.5));
    const int side_rows = static_cast<int>(std::ceil(half_rows - 0.5));
    add_window(group, columns, rows, face, {side_rows, -side, 2 * side + 1, kClose}, room);
  }

  void set(CubeGroup& group, std::size_t k, double u, double v, std::array<int, kLanes>& columns,
           std::array<int, kLanes>& rows) const {
    const double column = clear_of_lines(0.5 * (u + 1.0) * size_);
    const double row = clear_of_lines(0.5 * (v + 1.0) * size_);
    columns[k] = static_cast<int>(std::floor(column));
    rows[k] = static_cast<int>(std::floor(row));
    group.u[k] = static_cast<float>(u);
    group.v[k] = static_cast<float>(v);
    group.column[k] = static_cast<float>(columns[k]);
    group.row[k] = static_cast<float>(rows[k]);
    group.part[k] = static_cast<float>(column - columns[k]);
    group.part_row[k] = static_cast<float>(row - rows[k]);
  }

  void add_window(const CubeGroup& group, const std::array<int, kLanes>& columns, const std::array<int, kLanes>& rows,
                  int face, const Window& window, Room& room) const {
    for (int row = -window.rows; row <= window.rows + 1; ++row) {
      const CornerLine line = room.line(row & 1);
      work_.kernels.place_cube(group, window.first, row, window.columns + 1, line);
      if (row == -window.rows) continue;
      weigh(work_, room, window, row - 1, false);
      for (int k = 0; k < kLanes; ++k) {
        const auto lane = static_cast<std::size_t>(k);
        add_row(face, rows[lane] + row - 1, columns[lane] + window.first, window.columns, k, room);
      }
    }
  }

  void add_row(int face, int row, int first, int count, int lane, Room& room) const {
    if (row < 0 || row >= size_) return;
    const int from = std::max(first, 0);
    const int to = std::min(first + count, size_);
    if (from >= to) return;
    const int parts = size_ / work_.source.columns();
    add_run(work_, work_.source.row(face * work_.source.columns() + row / parts), from, to - from, parts,
            room.weights() + std::ptrdiff_t{from - first} * kLanes + lane, room.sums + 4 * lane);
  }

  static constexpr int kNowhere = -100'000;  ///< no window reaches a face from there

  const Work& work_;
  int size_;
};

/// All groups. The near part's share is made exact: what even light gives must not depend on how a window ends.
template <class Near>
void add_all(const Work& work, double near_energy, int size, const Faces& faces, const Control& control) {
  const Near near(work);
  const Outputs outputs(size);
  const std::int64_t groups = outputs.groups();
  const auto placement = jobs::placement_for(groups * kLanes * 100);
  std::vector<Room> rooms;
  for (std::size_t k = 0; k < jobs::worker_count(placement); ++k) rooms.emplace_back(near.most_corners());
  jobs::run_tiles(static_cast<std::size_t>((groups + kGroupsPerTile - 1) / kGroupsPerTile), placement, rooms.size(),
                  control, [&](std::size_t tile, std::size_t worker) {
                    Room& room = rooms[worker];
                    const auto first = static_cast<std::int64_t>(tile) * kGroupsPerTile;
                    for (std::int64_t group = first; group < std::min(groups, first + kGroupsPerTile); ++group) {
                      Directions directions;
                      for (int k = 0; k < kLanes; ++k)
                        directions[static_cast<std::size_t>(k)] = outputs.direction(outputs.texel(group, k));
                      std::fill(std::begin(room.sums), std::end(room.sums), 0.0F);
                      std::fill(std::begin(room.shares), std::end(room.shares), 0.0F);
                      near.add(directions, room);
                      for (int k = 0; k < outputs.lanes(group); ++k) {
                        float* const rgb = outputs.pixel(faces, outputs.texel(group, k));
                        const float scale = static_cast<float>(near_energy) / room.shares[k];
                        for (int c = 0; c < 3; ++c) rgb[c] += scale * room.sums[4 * k + c];
                      }
                    }
                  });
}

}  // namespace

void add_near_parts(const projection::SanitizedSource& source, const NarrowSplit& split, double alpha, int size,
                    const std::array<float*, 6>& faces, const Control& control) {
  const double square = alpha * alpha;
  const double rest = 1.0 - square;
  SplitLobe lobe{};
  lobe.width_squared = static_cast<float>(4.0 * square);
  lobe.split = static_cast<float>(split.split);
  lobe.offset = static_cast<float>(split.split * square / rest);
  lobe.far_scale = static_cast<float>(square * split.split * split.split / (4.0 * kPi * rest * rest));
  const Work work{source, split, lobe, narrow_kernels()};
  const double near_energy = 1.0 - far_spectrum(alpha, split.split, 1).front();
  if (source.cubemap()) {
    add_all<CubeNear>(work, near_energy, size, faces, control);
  } else {
    add_all<LatLongNear>(work, near_energy, size, faces, control);
  }
}

}  // namespace welkin::reflections
