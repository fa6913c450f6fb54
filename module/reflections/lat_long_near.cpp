// The near part over a lat-long. Weights depend on where a direction lies within its texel and on its latitude: they
// are found once for all texels of the mip that a mirror or a quarter turn brings to each other.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/memory.h"
#include "reflections/gaussian_kernels.h"
#include "reflections/mirrored_texels.h"
#include "reflections/near_parts.h"
#include "simd/dispatch.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kLanes = simd::kLanes;
constexpr int kGroupsPerTile = 4;
constexpr double kEndOfGaussian = 8.79;  ///< t s: a Gaussian is 0.9 % of the lobe there, three texels away
constexpr double kClearRows = 4.0;       ///< times a window's half height
constexpr int kDivided = 3;              ///< parts of a row beside a pole
constexpr double kPartsToPole = 8.0;     ///< parts of a row between a direction and the pole, at least
constexpr double kMostDivided = 32.0;    ///< the same: nearer directions are few
constexpr int kColumnsOfPole = 96;       ///< parts of columns beside a pole, at least

int texels(double count) { return static_cast<int>(std::ceil(count)); }

/// 16 directions on the grid.
struct Places {
  std::array<MirroredTexels::Original, kLanes> original{};
  std::array<int, kLanes> column{};
  std::array<int, kLanes> row{};
  std::array<double, kLanes> part_column{};
  std::array<double, kLanes> part_row{};
  std::array<double, kLanes> sine{};  ///< of the latitude
  std::array<double, kLanes> cosine{};
  double least_cosine = 1.0;

  /// The least distance of a place from the lines about its texel.
  [[nodiscard]] static double distance(const std::array<double, kLanes>& parts) {
    double least = 1.0;
    for (const double part : parts) least = std::min({least, part, 1.0 - part});
    return least;
  }
};

/// Texels about a direction: rows to either side, columns from the direction's own.
struct Window {
  int rows = 0;
  int first = 0;
  int columns = 0;
  const float* weights = nullptr;
  const int* sides = nullptr;  ///< near a pole: see `PolarWindow`

  [[nodiscard]] int eights() const noexcept { return (columns + 7) / 8; }
};

PolarWindow polar_of(const Window& window) { return {window.rows, window.first, window.columns, window.sides}; }

/// A worker's room.
class Room {
 public:
  /// A window's weights and what is needed to find them: see `WeighGaussians`.
  struct WindowRoom {
    float* lines;
    float* weights;
  };
  /// `parts`: of a column.
  [[nodiscard]] WindowRoom window(int rows, int columns, int parts = 1) {
    const auto lines = static_cast<std::size_t>(4 * kLanes) * static_cast<std::size_t>(rows + columns * parts + 2);
    const auto all = static_cast<std::size_t>(kLanes) * static_cast<std::size_t>((2 * rows + 1) * (2 * columns + 1));
    return {room_of(window_, lines + all), window_.data() + lines};
  }
  /// For spread weights, and what it takes to make them.
  [[nodiscard]] float* spread(std::ptrdiff_t floats) { return room_of(spread_, floats); }
  [[nodiscard]] int* sides(int rows) {
    sides_.resize(static_cast<std::size_t>(rows));
    return sides_.data();
  }
  [[nodiscard]] float* plain(std::ptrdiff_t floats) { return room_of(plain_, floats); }

  alignas(64) float shares[kLanes] = {};  ///< the near part in all

  // of the images of 16 directions that differ by their turns
  alignas(64) float sums[4 * kLanes + 1][kWindowFloats] = {};  // the last one is read only
  std::array<float, 4 * kLanes> scales{};
  std::array<float*, 4 * kLanes> pixels{};
  int images = 0;

 private:
  static float* room_of(platform::AlignedBuffer<float>& buffer, std::size_t floats) {
    if (buffer.size() < floats) {
      buffer = {};  // not both at the same time
      buffer = platform::AlignedBuffer<float>(floats);
    }
    return buffer.data();
  }
  static float* room_of(platform::AlignedBuffer<float>& buffer, std::ptrdiff_t floats) {
    return room_of(buffer, static_cast<std::size_t>(floats));
  }

  platform::AlignedBuffer<float> window_;
  platform::AlignedBuffer<float> plain_;
  platform::AlignedBuffer<float> spread_;
  std::vector<int> sides_;
};

/// Radians that a Gaussian reaches.
double reach_of(double t) { return 2.0 * std::sqrt(kEndOfGaussian / t); }

int column_parts_of(int columns) { return (kColumnsOfPole + columns - 1) / columns; }

class LatLongNear {
 public:
  LatLongNear(const NearPart& part, const GaussianLobe& gaussians)
      : part_(part),
        gaussians_(gaussians),
        texels_(part.size, part.source.columns()),
        columns_(part.source.columns()),
        rows_(part.source.rows()),
        across_(2.0 * kPi / columns_),
        down_(kPi / rows_),
        column_parts_(column_parts_of(columns_)) {
    for (int g = 0; g < gaussians_.count; ++g) {
      const double root = 2.0 * static_cast<double>(gaussians_.root[g]);
      reaches_[static_cast<std::size_t>(g)] = 2.0 * std::sqrt(kEndOfGaussian) / root;
      reach_.rows[g] = texels(reaches_[static_cast<std::size_t>(g)] / down_);
    }
    for (int m = -columns_ * column_parts_; m <= columns_ * column_parts_; ++m) {
      const math::SineCosine value = math::sine_cosine_of_turns(0.5 * m / (columns_ * column_parts_));
      column_table_.push_back(static_cast<float>(value.sine));
      column_table_.push_back(static_cast<float>(value.cosine));
    }
    for (int row = 0; row < rows_; ++row) row_table_.push_back(part.source.row(row));
    for (const MirroredTexels::Set& set : texels_.sets()) {
      turned_.push_back({turned_of(set, false, false), turned_of(set, false, true), turned_of(set, true, false),
                         turned_of(set, true, true)});
    }
  }

  [[nodiscard]] std::int64_t groups_of_set() const noexcept { return (texels_.count() + kLanes - 1) / kLanes; }
  [[nodiscard]] std::int64_t groups() const noexcept {
    return groups_of_set() * static_cast<std::int64_t>(texels_.sets().size());
  }

  void add(std::int64_t group, Room& room) const;

 private:
  /// Images that differ by their turns alone.
  struct Turned {
    struct One {
      image::CubeImage image;
      int columns;   ///< to its texels of the source from the others'
      float* first;  ///< of the mip, and the floats from there to an original's
      std::ptrdiff_t across;
      std::ptrdiff_t along;
    };
    bool mirrored;  ///< beside the originals
    bool below;
    std::vector<One> images;
  };
  /// 16 originals: the last group repeats its last one.
  struct Group {
    const MirroredTexels::Set& set;
    const std::array<Turned, 4>& turned;
    std::int64_t first;
    int count;
  };

  [[nodiscard]] Places places_of(const Group& group) const;
  [[nodiscard]] int side_of(int g, double cosine) const;
  [[nodiscard]] int side_near_pole(const Places& places, int row) const;
  /// Leaves the columns of the lines that the directions are next to.
  [[nodiscard]] Window weigh_flat(Places& places, Room& room) const;
  [[nodiscard]] Window weigh_polar(const Places& places, Room& room) const;
  void add_images(const Group& group, const Places& places, const Window& window, Room& room) const;
  [[nodiscard]] Turned turned_of(const MirroredTexels::Set& set, bool mirrored, bool below) const;
  void sum_turned(const Group& group, const Places& places, const Window& window, const Turned& turned, int lane,
                  const float* spread, Room& room) const;
  void add_wrapped(const WindowRows& rows, int column, int columns, const float* spread, float* sums) const;
  void add_polar(const WindowRows& rows, int skipped, int column, const Window& window, bool mirrored,
                 const float* spread, float* sums) const;
  void add_run(const float* texels, int column, int columns, const float* spread, float* sums) const;
  [[nodiscard]] float* pixel(const image::CubeTexel& texel) const {
    return part_.faces[static_cast<std::size_t>(texel.face)] +
           3 * (std::ptrdiff_t{texel.row} * part_.size + texel.column);
  }

  const NearPart& part_;
  const GaussianLobe& gaussians_;
  MirroredTexels texels_;
  const GaussianKernels& kernels_ = gaussian_kernels();
  int columns_;
  int rows_;
  double across_;
  double down_;
  int column_parts_;
  GaussianReach reach_{};  ///< its rows
  std::array<double, GaussianLobe::kMost> reaches_{};
  std::vector<float> column_table_;
  std::vector<const float*> row_table_;
  std::vector<std::array<Turned, 4>> turned_;  ///< of each set
};

Places LatLongNear::places_of(const Group& group) const {
  Places places;
  for (std::size_t k = 0; k < kLanes; ++k) {
    places.original[k] = texels_.original(group.first + std::min(static_cast<int>(k), group.count - 1));
    const SpherePlace place = texels_.place(group.set, places.original[k]);
    const double column = (0.5 - place.longitude) * columns_;
    const double row = (0.25 - place.latitude) * 2.0 * rows_;
    places.column[k] = std::clamp(static_cast<int>(column), 0, columns_ - 1);
    places.row[k] = std::clamp(static_cast<int>(row), 0, rows_ - 1);
    places.part_column[k] = column - places.column[k];
    places.part_row[k] = row - places.row[k];
    places.sine[k] = place.sine;
    places.cosine[k] = place.cosine;
    places.least_cosine = std::min(places.least_cosine, place.cosine);
  }
  return places;
}

void LatLongNear::add(std::int64_t group, Room& room) const {
  const auto set = static_cast<std::size_t>(group / groups_of_set());
  const std::int64_t first = group % groups_of_set() * kLanes;
  const Group own{texels_.sets()[set], turned_[set], first,
                  static_cast<int>(std::min<std::int64_t>(kLanes, texels_.count() - first))};
  Places places = places_of(own);
  const double clear = kClearRows * (reach_.rows[0] + 1) * down_;
  const bool flat =
      places.least_cosine > clear && down_ < reaches_[0] && 2 * side_of(0, places.least_cosine) < columns_;
  std::fill(std::begin(room.shares), std::end(room.shares), 0.0F);
  const Window window = flat ? weigh_flat(places, room) : weigh_polar(places, room);
  add_images(own, places, window, room);
}

/// Columns to either side of a line that a Gaussian beside it reaches where rows' lines do not bend.
int LatLongNear::side_of(int g, double cosine) const {
  return texels(0.5 + std::min(reaches_[static_cast<std::size_t>(g)] / (cosine * across_), 1.0 * columns_));
}

Window LatLongNear::weigh_flat(Places& places, Room& room) const {
  GaussianReach reach = reach_;
  const double clear_row = Places::distance(places.part_row) * down_;  // what no direction's neighbours get any of
  for (int g = 0; g < gaussians_.count; ++g) {
    reach.columns[g] = side_of(g, places.least_cosine);
    if (reaches_[static_cast<std::size_t>(g)] < clear_row) reach.rows[g] = 0;
  }
  reach.rows[0] = reach_.rows[0];
  GaussianGroup group;
  group.down = static_cast<float>(down_);
  for (std::size_t k = 0; k < kLanes; ++k) {
    const bool right = places.part_column[k] > 0.5;  // nearer to its texel's right line
    group.from_line[k] = static_cast<float>(places.part_column[k] - (right ? 1.0 : 0.0));
    places.column[k] += right ? 1 : 0;
    group.part_row[k] = static_cast<float>(places.part_row[k]);
    group.across[k] = static_cast<float>(places.cosine[k] * across_);
    group.tangent[k] = static_cast<float>(places.sine[k] / places.cosine[k]);
  }
  const Room::WindowRoom own = room.window(reach.rows[0], reach.columns[0]);
  kernels_.weigh(gaussians_, reach, group, reach.rows[0], reach.columns[0], own.lines, own.weights, room.shares);
  return {reach.rows[0], -reach.columns[0], 2 * reach.columns[0], own.weights};
}

/// No point within r of latitude phi is farther than asin(sin(r) / cos(phi)) in longitude.
Window LatLongNear::weigh_polar(const Places& places, Room& room) const {
  GaussianReach reach = reach_;
  Window window{reach.rows[0], -(columns_ / 2), columns_};
  for (int g = gaussians_.count - 1; g >= 0; --g) {
    reach.columns[g] = -1;
    const double width = reaches_[static_cast<std::size_t>(g)];
    if (width > 0.9 * places.least_cosine) continue;
    const int side = texels(math::arc_sine(width / places.least_cosine) / across_);
    if (2 * side + 1 < columns_) reach.columns[g] = side;
  }
  if (reach.columns[0] >= 0) window = {reach.rows[0], -reach.columns[0], 2 * reach.columns[0] + 1};
  int* const sides = room.sides(2 * window.rows + 1);
  for (int row = 0; row <= 2 * window.rows; ++row) sides[row] = side_near_pole(places, row - window.rows);
  window.sides = sides;
  PolarGroup group;
  group.down = static_cast<float>(down_);
  group.rows = static_cast<float>(rows_);
  group.column_parts = column_parts_;
  // columns narrow towards the pole: what falls on them is taken at one place of each part of a row, and parts as high
  // as the pole is far cost 2e-4 of what columns beside it differ by
  const double to_pole = std::min(kMostDivided, kPartsToPole * down_ / places.least_cosine);
  group.divided =
      std::max({reach.columns[0] < 0 ? kDivided : 1, texels(kDivided * down_ / reaches_[0]), texels(to_pole)});
  for (std::size_t k = 0; k < kLanes; ++k) {
    const math::SineCosine part = math::sine_cosine_of_turns(0.5 * places.part_column[k] / columns_);
    group.sine_of_part[k] = static_cast<float>(part.sine);
    group.cosine_of_part[k] = static_cast<float>(part.cosine);
    group.part_row[k] = static_cast<float>(places.part_row[k]);
    group.row[k] = static_cast<float>(places.row[k]);
    group.sine_latitude[k] = static_cast<float>(places.sine[k]);
    group.cosine_latitude[k] = static_cast<float>(places.cosine[k]);
  }
  const Room::WindowRoom own = room.window(window.rows, (window.columns + 1) / 2, column_parts_);
  kernels_.weigh_polar(gaussians_, reach, group, polar_of(window),
                       column_table_.data() + std::ptrdiff_t{2} * column_parts_ * (columns_ + window.first), own.lines,
                       own.weights, room.shares);
  window.weights = own.weights;
  return window;
}

LatLongNear::Turned LatLongNear::turned_of(const MirroredTexels::Set& set, bool mirrored, bool below) const {
  Turned turned{mirrored, below, {}};
  for (const image::CubeImage& image : set.images) {
    if (image.below != below || (image.mirrored != set.own.mirrored) != mirrored) continue;
    float* const first = pixel(texels_.texel(set, {0, 0}, image));
    // an original beside the first one is there if there is more than one
    const bool one = texels_.count() == 1;
    const std::ptrdiff_t across = one ? 0 : pixel(texels_.texel(set, {1, 0}, image)) - first;
    const std::ptrdiff_t along = one ? 0 : pixel(texels_.texel(set, {0, 1}, image)) - first;
    turned.images.push_back({image, (turns_of(set.own) - turns_of(image)) * (columns_ / 4), first, across, along});
  }
  return turned;
}

/// Columns to either side of the directions' own that any Gaussian reaches in a row, counted from theirs. The circle at
/// distance r about colatitude theta crosses colatitude c where sin^2(dlambda / 2) = (sin^2(r / 2) - sin^2((theta - c)
/// / 2)) / (sin theta sin c), and is widest at cos c = cos theta / cos r.
int LatLongNear::side_near_pole(const Places& places, int row) const {
  const auto square_of_half = [](double angle) {
    const double sine = math::sine_cosine_of_turns(angle / (4.0 * kPi)).sine;
    return sine * sine;
  };
  const double reached = square_of_half(reaches_[0]);
  double widest = 0.0;
  for (std::size_t k = 0; k < kLanes; ++k) {
    const double place = (places.row[k] + places.part_row[k]) * down_;
    const double top = std::max(0.0, (places.row[k] + row) * down_);
    const double bottom = top + down_;
    if (place - bottom > reaches_[0] || top - place > reaches_[0]) continue;
    if (top < reaches_[0] - place) return columns_;
    const double tangent = std::sqrt(std::max(0.0, (place - reaches_[0]) * (place + reaches_[0])));
    const double there = std::clamp(tangent, std::max(top, 1e-9), bottom);
    const double sine = math::sine_cosine_of_turns(there / (2.0 * kPi)).sine;
    const double square = (reached - square_of_half(place - there)) / (places.cosine[k] * sine);
    if (square >= 0.9) return columns_;
    if (square > 0.0) widest = std::max(widest, 2.0 * math::arc_sine(std::sqrt(square)));
  }
  return std::min(columns_, texels(widest / across_) + 1);
}

void LatLongNear::add_images(const Group& group, const Places& places, const Window& window, Room& room) const {
  const int rows = 2 * window.rows + 1;
  const std::ptrdiff_t floats = spread_floats(rows, window.columns);
  const bool all = window.sides == nullptr;
  const float least = part_.source.has_negatives() ? -std::numeric_limits<float>::max() : 0.0F;
  for (const Turned& turned : group.turned) {
    if (turned.images.empty()) continue;
    float* const spread = room.spread(all ? floats * kLanes : std::ptrdiff_t{3} * rows * window.columns);
    if (all && !turned.below) {  // what lies above comes first, and leaves its weights to what lies below
      float* const plain = room.plain(floats / 3 * kLanes);
      kernels_.spread(window.weights, rows, window.columns, turned.mirrored, plain, spread);
    }
    room.images = 0;
    for (int lane = 0; lane < group.count; ++lane) {
      float* const own = spread + (all ? floats * lane : 0);
      if (!all) kernels_.spread_lane(window.weights + lane, polar_of(window), turned.mirrored, own);
      sum_turned(group, places, window, turned, lane, own, room);
    }
    kernels_.fold(room.sums, room.images, room.scales.data(), least, room.pixels.data());
  }
}

void LatLongNear::sum_turned(const Group& group, const Places& places, const Window& window, const Turned& turned,
                             int lane, const float* spread, Room& room) const {
  const auto k = static_cast<std::size_t>(lane);
  const int column =
      turned.mirrored ? columns_ - places.column[k] - window.first - window.columns : places.column[k] + window.first;
  std::array<std::ptrdiff_t, 4> offsets{};
  std::size_t count = 0;
  bool whole = true;
  for (const Turned::One& one : turned.images) {
    if (!texels_.has(group.set, places.original[k], one.image)) continue;
    int first = column + one.columns;
    if (first < 0) first += columns_;
    if (first < 0) first += columns_;
    if (first >= columns_) first -= columns_;
    whole = whole && first + 8 * window.eights() <= columns_;  // eight columns are read of the last ones
    offsets[count] = std::ptrdiff_t{3} * first;
    const auto place = static_cast<std::size_t>(room.images) + count++;
    room.pixels[place] = one.first + places.original[k].across * one.across + places.original[k].along * one.along;
    room.scales[place] = static_cast<float>(part_.energy) / room.shares[lane];
  }
  float(*const sums)[kWindowFloats] = room.sums + room.images;
  room.images += static_cast<int>(count);
  const int above = places.row[k] - window.rows;
  // near a pole some of the window's rows are beyond it
  const int from = std::max(above, 0);
  const int to = std::min(above + 2 * window.rows + 1, rows_);
  const WindowRows rows{row_table_.data() + (turned.below ? rows_ - 1 - from : from), turned.below ? -1 : 1, to - from,
                        window.eights()};
  if (window.sides == nullptr && whole && count > 0) {
    kernels_.add_windows(rows, offsets.data(), static_cast<int>(count), spread, sums);
    return;
  }
  for (std::size_t image = 0; image < count; ++image) {
    const int first = static_cast<int>(offsets[image] / 3);
    std::fill_n(sums[image], kWindowFloats, 0.0F);
    window.sides == nullptr ? add_wrapped(rows, first, window.columns, spread, sums[image])
                            : add_polar(rows, from - above, first, window, turned.mirrored, spread, sums[image]);
  }
}

/// A window across the seam.
void LatLongNear::add_wrapped(const WindowRows& rows, int column, int columns, const float* spread, float* sums) const {
  for (int row = 0; row < rows.count; ++row)
    add_run(rows.first[row * rows.step], column, columns, spread + std::ptrdiff_t{kWindowFloats} * row * rows.eights,
            sums);
}

/// Near a pole, of each row what counts; `skipped`: the window's rows that are not there.
void LatLongNear::add_polar(const WindowRows& rows, int skipped, int column, const Window& window, bool mirrored,
                            const float* spread, float* sums) const {
  for (int row = 0; row < rows.count; ++row) {
    const ColumnsOfRow own = columns_of_row(polar_of(window), skipped + row);
    const int first = mirrored ? window.columns - own.end : own.first;
    add_run(rows.first[row * rows.step], (column + first) % columns_, own.end - own.first,
            spread + std::ptrdiff_t{3} * (std::ptrdiff_t{skipped + row} * window.columns + first), sums);
  }
}

void LatLongNear::add_run(const float* texels, int column, int columns, const float* spread, float* sums) const {
  const int run = std::min(columns, columns_ - column);
  kernels_.add_run(texels + std::ptrdiff_t{3} * column, spread, run, sums);
  if (run < columns) kernels_.add_run(texels, spread + std::ptrdiff_t{3} * run, columns - run, sums);
}

}  // namespace

std::size_t lat_long_room_bytes(const NarrowSplit& split) noexcept {
  const auto columns = static_cast<std::size_t>(split.columns);
  const auto reach = static_cast<std::size_t>(texels(reach_of(split.split) * split.rows / kPi));
  const std::size_t lines =
      4 * kLanes * ((columns / 2 + 1) * static_cast<std::size_t>(column_parts_of(split.columns)) + reach + 2);
  // Of 16 directions each, with what they are spread to for one; clear of the poles windows are an eighth of a row and
  // are spread for all 16.
  const std::size_t texel = kLanes + std::max<std::size_t>(3, 3 * kLanes / 8) + kLanes / 8;
  return sizeof(float) * (lines + texel * (2 * reach + 1) * (columns + 8));
}

// The near part's share is made exact: what even light gives must not depend on how a window ends.
void add_lat_long_near(const NearPart& part, const GaussianLobe& gaussians, const Control& control) {
  const LatLongNear near(part, gaussians);
  const std::int64_t groups = near.groups();
  const auto placement = jobs::placement_for(groups * kLanes * 200);
  std::vector<Room> rooms(jobs::worker_count(placement));
  jobs::run_tiles(static_cast<std::size_t>((groups + kGroupsPerTile - 1) / kGroupsPerTile), placement, rooms.size(),
                  control, [&](std::size_t tile, std::size_t worker) {
                    const auto first = static_cast<std::int64_t>(tile) * kGroupsPerTile;
                    for (std::int64_t group = first; group < std::min(groups, first + kGroupsPerTile); ++group)
                      near.add(group, rooms[worker]);
                  });
}

}  // namespace welkin::reflections
