#include "reflections/lobe_table.h"

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "reflections/lobe_weights.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{128} << 20U;
constexpr int kLeastFace = 8;
constexpr int kLargestFace = 64;
constexpr std::size_t kMostTaps = 2000;  ///< of a texel
constexpr std::size_t kLookedAt = 2 * LobeErrors::kTexels;

/// Texels of a mip within the sixteenth.
std::size_t texels_of_sixteenth(int size) noexcept {
  const auto half = static_cast<std::size_t>(size + 1) / 2;
  return half * half + half * (half + 1) / 2;
}

/// A face's axes in whole numbers.
glm::ivec3 whole(const glm::dvec3& axis) noexcept {
  return {static_cast<int>(axis.x), static_cast<int>(axis.y), static_cast<int>(axis.z)};
}

int dot(const glm::ivec3& a, const glm::ivec3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// A point of a level, which may lie in the margin.
struct LevelPoint {
  int face;
  int row;
  int column;
};

/// Where an image has it.
LevelPoint moved_point(const image::CubeImage& image, const CubeLevel& level, const LevelPoint& point) noexcept {
  const image::Frame& frame = image::face_frame(point.face);
  const glm::ivec3 normal = moved(image, whole(frame.normal));
  const int u = 2 * (point.column - level.margin) + 1 - level.size;
  const int v = 2 * (point.row - level.margin) + 1 - level.size;
  const glm::ivec3 aside = moved(image, whole(frame.u) * u + whole(frame.v) * v);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& other = image::face_frame(face);
    if (whole(other.normal) != normal) continue;
    return {face, (dot(aside, whole(other.v)) + level.size - 1) / 2 + level.margin,
            (dot(aside, whole(other.u)) + level.size - 1) / 2 + level.margin};
  }
  return point;
}

}  // namespace

/// Goes over the texels of a sixteenth of all mips, some rows of a mip in each tile.
class LobeTable::Builder {
 public:
  Builder(LobeTable& table, const LobeTableKey& key) : table_(table), key_(key) {
    for (const CubeLevel& level : table.levels_) records_.emplace_back(level.points(), 0U);
  }

  void run(const Control& control) {
    for (const LobeMip& mip : key_.mips) add_mip(mip, control);
    number_records();
    std::size_t k = 0;
    for (GroupTap& tap : table_.taps_) {
      const auto& [level, point] = places_[k++];
      tap.record = records_[level][point] - 1;
    }
  }

 private:
  struct Place {
    std::uint32_t level;
    std::uint32_t point;

    friend bool operator==(const Place&, const Place&) = default;
  };

  /// A weight of one of a group's texels.
  struct Part {
    Place place;
    std::size_t texel;
    float value;
  };

  /// What comes of two rows of a face, and which of the sixteenth's texels is their first.
  struct Rows {
    int face;
    int row;
    std::size_t first_texel;
    std::vector<Group> groups{};  ///< their taps are counted from the first one of these rows
    std::vector<GroupTap> taps{};
    std::vector<Place> places{};                ///< of each tap
    std::vector<std::vector<double>> looked{};  ///< at: errors of the weights
  };

  void add_mip(const LobeMip& mip, const Control& control) {
    std::vector<Rows> pieces = rows_of(mip.size);
    constexpr auto arena = jobs::Placement::arena;
    std::vector<std::unique_ptr<LobeWeights>> weights(jobs::worker_count(arena));
    jobs::run_tiles(pieces.size(), arena, weights.size(), {control.stop}, [&](std::size_t tile, std::size_t worker) {
      if (!weights[worker]) weights[worker] = std::make_unique<LobeWeights>(table_.levels_, mip.alpha);
      weigh(mip.size, pieces[tile], *weights[worker]);
    });
    Mip made{mip.size, LobeErrors(key_.face_size), {}, {}};
    std::vector<std::vector<double>> looked;
    for (Rows& rows : pieces) {
      append(rows, made);
      std::move(rows.looked.begin(), rows.looked.end(), std::back_inserter(looked));
      rows = {};
    }
    keep(looked, made.errors);
    table_.mips_.push_back(std::move(made));
  }

  static bool has_texel(int size, int face, int row, int column) noexcept {
    return row < size && column < size && image::in_sixteenth(face, image::point_of(size, {face, column, row}));
  }

  /// Still without groups.
  static std::vector<Rows> rows_of(int size) {
    std::vector<Rows> pieces;
    std::size_t texel = 0;
    for (const int face : {5, 2}) {
      for (int row = 0; row < size; row += 2) {
        pieces.push_back({face, row, texel});
        for (int column = 0; column < size; ++column) {
          for (const int own_row : {row, row + 1}) texel += has_texel(size, face, own_row, column) ? 1 : 0;
        }
      }
    }
    return pieces;
  }

  static void weigh(int size, Rows& rows, LobeWeights& weights) {
    std::size_t texel = rows.first_texel;
    std::size_t looked = 0;
    while (looked_at(size, looked) < texel) ++looked;
    std::vector<Part> parts;
    for (int column = 0; column < size; column += 2) {
      Group group{rows.face, rows.row, column, 0, rows.taps.size(), 0};
      parts.clear();
      for (std::size_t k = 0; k < kTexelsOfGroup; ++k) {
        const int own_row = rows.row + static_cast<int>(k / 2);
        const int own_column = column + static_cast<int>(k % 2);
        if (!has_texel(size, rows.face, own_row, own_column)) continue;
        group.texels |= 1U << k;
        const glm::dvec3 direction = image::face_direction(size, rows.face, own_column + 0.5, own_row + 0.5);
        for (const LobeWeights::Weight& weight : weights.about(direction))
          parts.push_back({{weight.level, weight.point}, k, static_cast<float>(weight.value)});
        for (; looked_at(size, looked) == texel; ++looked) rows.looked.push_back(weights.errors());
        ++texel;
      }
      if (group.texels == 0) continue;
      add_taps(parts, rows);
      group.end = rows.taps.size();
      rows.groups.push_back(group);
    }
  }

  /// Which of the sixteenth's texels is the k-th that is looked at; one of few texels more than once.
  static std::size_t looked_at(int size, std::size_t k) noexcept {
    return k < kLookedAt ? (2 * k + 1) * texels_of_sixteenth(size) / (2 * kLookedAt) : ~std::size_t{0};
  }

  /// Coarse levels first, whose weights are small.
  static void add_taps(std::vector<Part>& parts, Rows& rows) {
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
      if (a.place.level != b.place.level) return a.place.level > b.place.level;
      return a.place.point != b.place.point ? a.place.point < b.place.point : a.texel < b.texel;
    });
    const std::size_t first = rows.taps.size();
    for (const Part& part : parts) {
      if (rows.taps.size() == first || rows.places.back() != part.place) {
        rows.places.push_back(part.place);
        rows.taps.push_back({0, {}});
      }
      rows.taps.back().weights[part.texel] = part.value;
    }
  }

  void append(const Rows& rows, Mip& mip) {
    const std::size_t first = table_.taps_.size();
    for (Group group : rows.groups) {
      group.first += first;
      group.end += first;
      group.place = mip.places.size();
      for (std::size_t k = 0; k < kTexelsOfGroup; ++k) {
        if ((group.texels >> k & 1U) != 0) add_places(group, k, mip);
      }
      mip.groups.push_back(group);
    }
    table_.taps_.insert(table_.taps_.end(), rows.taps.begin(), rows.taps.end());
    places_.insert(places_.end(), rows.places.begin(), rows.places.end());
    for (const Place& place : rows.places) records_[place.level][place.point] = 1;
  }

  static void add_places(const Group& group, std::size_t texel, Mip& mip) {
    const glm::ivec3 point = image::point_of(
        mip.size, {group.face, group.column + static_cast<int>(texel % 2), group.row + static_cast<int>(texel / 2)});
    for (int k = 0; k < kRingImages; ++k) {
      const image::CubeTexel at = image::texel_at(mip.size, moved(image::cube_image_of(k), point));
      mip.places.push_back(
          {static_cast<std::uint16_t>(at.face), static_cast<std::uint16_t>(at.row * mip.size + at.column)});
    }
  }

  /// Keeps each second, from the worst down: where one place of a face is far worse than others, it counts.
  static void keep(std::vector<std::vector<double>>& looked, LobeErrors& errors) {
    const auto square = [](const std::vector<double>& off) { return math::dot(off, off); };
    std::stable_sort(looked.begin(), looked.end(), [&](const auto& a, const auto& b) { return square(a) > square(b); });
    for (int k = 0; k < LobeErrors::kTexels; ++k) errors.add(k, looked[std::size_t{2} * static_cast<std::size_t>(k)]);
  }

  [[nodiscard]] Run run_from(std::size_t level, const LevelPoint& first, std::uint32_t record) const {
    const CubeLevel& shape = table_.levels_[level];
    Run run{};
    run.record = record;
    LevelPoint second = first;
    ++second.column;
    for (std::size_t k = 0; k < kRingImages; ++k) {
      const auto place = [&](const LevelPoint& point) {
        const LevelPoint at = moved_point(image::cube_image_of(static_cast<int>(k)), shape, point);
        return 3 * ((at.face * shape.edge() + at.row) * shape.edge() + at.column);
      };
      run.from[k] = static_cast<std::uint32_t>(table_.level_starts_[level]) + static_cast<std::uint32_t>(place(first));
      run.step[k] = place(second) - place(first);
    }
    return run;
  }

  void number_records() {
    std::uint32_t next = 0;
    for (std::size_t level = 0; level < table_.levels_.size(); ++level) {
      const int edge = table_.levels_[level].edge();
      std::size_t point = 0;
      for (int line = 0; line < 6 * edge; ++line) {
        for (int column = 0; column < edge; ++column, ++point) {
          std::uint32_t& record = records_[level][point];
          if (record == 0) continue;
          const bool follows = column > 0 && records_[level][point - 1] != 0;
          if (!follows) table_.runs_.push_back(run_from(level, {line / edge, line % edge, column}, next));
          ++table_.runs_.back().count;
          record = ++next;  // one more than its number
        }
      }
    }
    table_.room_floats_ = table_.records_start_ + std::size_t{next} * kRecordFloats + 6 * table_.scratch_floats();
  }

  LobeTable& table_;
  const LobeTableKey& key_;
  std::vector<std::vector<std::uint32_t>> records_;
  std::vector<Place> places_;
};

LobeTable::LobeTable(const LobeTableKey& key, const Control& control)
    : face_size_(key.face_size), levels_(cube_levels(key.face_size)) {
  std::size_t floats = 0;
  for (const CubeLevel& level : levels_) {
    level_starts_.push_back(floats);
    floats += 3 * level.points();
  }
  records_start_ = (floats + 1 + 15) / 16 * 16;  // a float more than the last point's can be read
  std::vector<double> row(static_cast<std::size_t>(face_size_));
  for (int k = 0; k < face_size_; ++k) {
    image::cubemap_row_solid_angles(k, row);
    for (const double value : row) steradians_.push_back(static_cast<float>(value));
  }
  Builder(*this, key).run(control);
  taps_.shrink_to_fit();
}

bool LobeTable::serves(int face_size, const LobeMip& mip) noexcept {
  return face_size % 2 == 0 && face_size >= kLeastFace && face_size <= kLargestFace && 2 * mip.size <= face_size;
}

std::shared_ptr<const LobeTable> LobeTable::get(const LobeTableKey& key, const Control& control) {
  static auto& cache = *new math::TableCache<LobeTableKey, LobeTable>(kCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const LobeTable>(key, control); });
}

std::size_t LobeTable::scratch_floats() const noexcept {
  return levels_.size() > 1 ? coarsening_floats(levels_[0], levels_[1]) : 0;
}

std::size_t LobeTable::bytes() const noexcept {
  std::size_t bytes =
      sizeof(*this) + runs_.size() * sizeof(Run) + taps_.size() * sizeof(GroupTap) + steradians_.size() * sizeof(float);
  for (const Mip& mip : mips_) {
    bytes +=
        mip.groups.size() * sizeof(Group) + mip.places.size() * sizeof(TexelPlace) + LobeErrors::bytes_for(face_size_);
  }
  return bytes;
}

std::size_t LobeTable::working_bytes(int face_size) noexcept {
  // a record for each point of the coarser levels, and of the finest for a sixteenth and what lies beside it
  std::size_t floats = 16;
  for (const CubeLevel& level : cube_levels(face_size)) floats += level.points() * (3 + kRecordFloats);
  return floats * sizeof(float);
}

std::size_t LobeTable::making_bytes(const LobeTableKey& key) noexcept {
  std::size_t texels = 0;
  for (const LobeMip& mip : key.mips) texels += texels_of_sixteenth(mip.size);
  std::size_t points = 0;
  for (const CubeLevel& level : cube_levels(key.face_size)) points += level.points();
  // the mip's at hand that are looked at, and all mips' that are kept
  const std::size_t face_texels = std::size_t{6} * static_cast<std::size_t>(key.face_size * key.face_size);
  const std::size_t errors =
      kLookedAt * face_texels * sizeof(double) + key.mips.size() * LobeErrors::bytes_for(key.face_size);
  const std::size_t weights = points * 64 * jobs::worker_count(jobs::Placement::arena);
  // twice: lists grow by doubling
  return 2 * texels * kMostTaps * (sizeof(GroupTap) + 2 * sizeof(std::uint32_t)) + weights + errors;
}

/// One call of `fill`.
class LobeTable::Filling {
 public:
  Filling(const LobeTable& table, const CubemapView& source, float* room)
      : table_(table), source_(source), room_(room) {}

  /// A face's light on all levels.
  void spread_face(int face, float* scratch) const {
    float* light = level(0, face);
    const float* steradians = table_.steradians_.data();
    for (int row = 0; row < table_.face_size_; ++row) {
      const auto* from = static_cast<const float*>(image::row_of(source_, face, row));
      for (int k = 0; k < table_.face_size_; ++k, ++steradians, from += 3, light += 3) {
        for (int c = 0; c < 3; ++c) light[c] = *steradians * from[c];
      }
    }
    for (std::size_t k = 1; k < table_.levels_.size(); ++k)
      coarsen(table_.levels_[k - 1], level(k - 1, face), table_.levels_[k], level(k, face), scratch);
  }

  void gather(const Run& run) const {
    ImageRows rows{};
    for (std::size_t k = 0; k < kRingImages; ++k) {
      rows.from[k] = room_ + run.from[k];
      rows.step[k] = run.step[k];
    }
    rows.count = run.count;
    ring_kernels().gather_images(rows, records() + static_cast<std::size_t>(run.record) * kRecordFloats);
  }

  void sum(const Mip& mip, const Group& group, const std::array<float*, 6>& faces) const {
    alignas(64) float sums[kTexelsOfGroup][kRecordFloats];
    ring_kernels().sum_group_taps({records(), table_.taps_.data() + group.first, table_.taps_.data() + group.end},
                                  sums);
    const TexelPlace* place = mip.places.data() + group.place;
    for (std::size_t texel = 0; texel < kTexelsOfGroup; ++texel) {
      if ((group.texels >> texel & 1U) == 0) continue;
      const float* from = sums[texel];
      for (int k = 0; k < kRingImages; ++k, ++place, from += 3)
        std::copy_n(from, 3, faces[place->face] + std::size_t{3} * place->texel);
    }
  }

 private:
  [[nodiscard]] float* level(std::size_t which, int face) const noexcept {
    return room_ + table_.level_starts_[which] + table_.levels_[which].points() / 2 * static_cast<std::size_t>(face);
  }
  [[nodiscard]] float* records() const noexcept { return room_ + table_.records_start_; }

  const LobeTable& table_;
  const CubemapView& source_;
  float* room_;
};

void LobeTable::fill(const CubemapView& source, float* room, const std::vector<std::array<float*, 6>>& mips,
                     bool not_negative, const Control& control) const {
  constexpr std::size_t kTileRuns = 64;
  constexpr std::size_t kTileGroups = 4;
  const Filling filling(*this, source, room);
  const auto placement = jobs::placement_for(std::int64_t{100} * face_size_ * face_size_);
  const std::size_t workers = jobs::worker_count(placement);
  float* const scratch = room + room_floats_ - 6 * scratch_floats();
  jobs::run_tiles(6, placement, workers, {control.stop}, [&](std::size_t face, std::size_t) {
    filling.spread_face(static_cast<int>(face), scratch + face * scratch_floats());
  });
  jobs::run_tiles((runs_.size() + kTileRuns - 1) / kTileRuns, placement, workers, {control.stop},
                  [&](std::size_t tile, std::size_t) {
                    for (std::size_t k = tile * kTileRuns; k < std::min(runs_.size(), (tile + 1) * kTileRuns); ++k)
                      filling.gather(runs_[k]);
                  });
  for (std::size_t k = 0; k < mips_.size(); ++k) {
    const std::vector<Group>& groups = mips_[k].groups;
    jobs::run_tiles((groups.size() + kTileGroups - 1) / kTileGroups, placement, workers, {control.stop},
                    [&](std::size_t tile, std::size_t) {
                      for (std::size_t i = tile * kTileGroups; i < std::min(groups.size(), (tile + 1) * kTileGroups);
                           ++i)
                        filling.sum(mips_[k], groups[i], mips[k]);
                    });
  }
  if (control.progress) control.progress(1.0);
  if (!not_negative) return;
  for (std::size_t k = 0; k < mips_.size(); ++k) {
    const std::ptrdiff_t count = std::ptrdiff_t{3} * mips_[k].size * mips_[k].size;
    for (float* const values : mips[k]) {
      std::transform(values, values + count, values, [](float value) { return std::max(value, 0.0F); });
    }
  }
}

}  // namespace welkin::reflections
