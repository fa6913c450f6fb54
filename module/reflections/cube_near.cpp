// The near part over a cubemap: the texels about each direction, in closed form close by.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "platform/memory.h"
#include "reflections/narrow_kernels.h"
#include "reflections/near_parts.h"

namespace welkin::reflections {
namespace {

constexpr int kLanes = simd::kLanes;
constexpr int kGroupsPerTile = 8;
constexpr int kClose = 2;  ///< texels to either side that are integrated in closed form

using Faces = std::array<float*, 6>;

/// A place clear of lines between texels, whose corners it would see under no angle: some 1e-7 of a texel away, much
/// less than the narrowest lobe is wide.
double clear_of_lines(double place) {
  const double line = std::round(place);
  return std::abs(place - line) < 0x1p-23 ? line + 0x1p-23 : place;
}

/// A worker's room for one group.
class Room {
 public:
  explicit Room(int corners) {
    const auto floats = static_cast<std::size_t>(corners) * kLanes;
    for (Line& line : lines_) {
      for (auto* list : {&line.x, &line.y, &line.far, &line.edge}) *list = platform::AlignedBuffer<float>(floats);
    }
    weights_ = platform::AlignedBuffer<float>(floats);
  }

  [[nodiscard]] CornerLine line(int which) {
    Line& line = lines_[static_cast<std::size_t>(which)];
    return {line.x.data(), line.y.data(), line.far.data(), line.edge.data()};
  }
  [[nodiscard]] float* weights() { return weights_.data(); }

  alignas(64) float sums[4 * kLanes] = {};  ///< RGB and what does not count, for each lane
  alignas(64) float shares[kLanes] = {};    ///< the near part in all

 private:
  struct Line {
    platform::AlignedBuffer<float> x, y, far, edge;
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

struct Work {
  const projection::SanitizedSource& source;
  NarrowSplit split;
  SplitLobe lobe;
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
void weigh(const Work& work, Room& room, const Window& window, int row) {
  const CornerLine above = room.line(row & 1);
  const CornerLine below = room.line((row + 1) & 1);
  const ColumnRange close = window.close_columns(row);
  if (close.first < close.end) {
    const int first = std::max(-kClose, -window.rows);  // later rows' upper line was the lower one of the row before
    if (row == first) work.kernels.measure_line(work.lobe, close, above);
    work.kernels.measure_line(work.lobe, close, below);
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

/// Each group is added once for each face that it can reach.
class CubeNear {
 public:
  CubeNear(const Work& work, const Outputs& outputs) : work_(work), outputs_(outputs), size_(work.split.columns) {}

  /// The most corners of a line: at a face's corner, sqrt(1 + u^2 + v^2) sqrt(1 + u^2) is below 3.8 within `reach`.
  [[nodiscard]] int most_corners() const {
    return static_cast<int>(3.8 * size_ * work_.split.reach * (1.0 + work_.split.reach)) + 4;
  }

  void add(std::int64_t group, Room& room) const {
    Directions directions;
    for (int k = 0; k < kLanes; ++k)
      directions[static_cast<std::size_t>(k)] = outputs_.direction(outputs_.texel(group, k));
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
      weigh(work_, room, window, row - 1);
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
  const Outputs& outputs_;
  int size_;
};

}  // namespace

// The near part's share is made exact: what even light gives must not depend on how a window ends.
void add_cubemap_near(const NearPart& part, const SplitLobe& lobe, const Control& control) {
  const Work work{part.source, part.split, lobe, narrow_kernels()};
  const Outputs outputs(part.size);
  const CubeNear near(work, outputs);
  const std::int64_t groups = outputs.groups();
  const auto placement = jobs::placement_for(groups * kLanes * 100);
  std::vector<Room> rooms;
  for (std::size_t k = 0; k < jobs::worker_count(placement); ++k) rooms.emplace_back(near.most_corners());
  jobs::run_tiles(static_cast<std::size_t>((groups + kGroupsPerTile - 1) / kGroupsPerTile), placement, rooms.size(),
                  control, [&](std::size_t tile, std::size_t worker) {
                    Room& room = rooms[worker];
                    const auto first = static_cast<std::int64_t>(tile) * kGroupsPerTile;
                    for (std::int64_t group = first; group < std::min(groups, first + kGroupsPerTile); ++group) {
                      std::fill(std::begin(room.sums), std::end(room.sums), 0.0F);
                      std::fill(std::begin(room.shares), std::end(room.shares), 0.0F);
                      near.add(group, room);
                      for (int k = 0; k < outputs.lanes(group); ++k) {
                        float* const rgb = outputs.pixel(part.faces, outputs.texel(group, k));
                        const float scale = static_cast<float>(part.energy) / room.shares[k];
                        for (int c = 0; c < 3; ++c) rgb[c] += scale * room.sums[4 * k + c];
                      }
                    }
                  });
}

}  // namespace welkin::reflections
