#include "reflections/lobe_table.h"

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "reflections/cube_images.h"
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
LevelPoint moved_point(const CubeImage& image, const CubeLevel& level, const LevelPoint& point) noexcept {
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

/// Goes over the texels of a sixteenth of all mips.
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
  };

  /// A weight of one of a group's texels.
  struct Part {
    std::uint32_t level;
    std::uint32_t point;
    std::size_t texel;
    float value;
  };

  void add_mip(const LobeMip& mip, const Control& control) {
    LobeWeights weights(table_.levels_, mip.alpha);
    Mip made{mip.size, LobeErrors(key_.face_size), {}};
    std::size_t texel = 0;
    std::vector<std::vector<double>> looked;
    for (int face : {5, 2}) {
      for (int row = 0; row < mip.size; row += 2) {
        jobs::throw_if_cancelled(control);
        for (int column = 0; column < mip.size; column += 2) {
          Group group{face, row, column, 0, table_.taps_.size(), 0};
          parts_.clear();
          for (std::size_t k = 0; k < kTexelsOfGroup; ++k) {
            const int own_row = row + static_cast<int>(k / 2);
            const int own_column = column + static_cast<int>(k % 2);
            if (own_row >= mip.size || own_column >= mip.size) continue;
            if (!in_sixteenth(face, image::point_of(mip.size, {face, own_column, own_row}))) continue;
            group.texels |= 1U << k;
            const glm::dvec3 direction = image::face_direction(mip.size, face, own_column + 0.5, own_row + 0.5);
            for (const LobeWeights::Weight& weight : weights.about(direction))
              parts_.push_back({weight.level, weight.point, k, static_cast<float>(weight.value)});
            for (; texel == looked_at(mip.size, looked.size()); looked.push_back(weights.errors())) {
            }
            ++texel;
          }
          if (group.texels == 0) continue;
          add_taps();
          group.end = table_.taps_.size();
          made.groups.push_back(group);
        }
      }
    }
    keep(looked, made.errors);
    table_.mips_.push_back(std::move(made));
  }

  /// Which of the sixteenth's texels is the k-th that is looked at; one of few texels more than once.
  static std::size_t looked_at(int size, std::size_t k) noexcept {
    return k < kLookedAt ? (2 * k + 1) * texels_of_sixteenth(size) / (2 * kLookedAt) : ~std::size_t{0};
  }

  /// Keeps each second, from the worst down: where one place of a face is far worse than others, it counts.
  static void keep(std::vector<std::vector<double>>& looked, LobeErrors& errors) {
    const auto square = [](const std::vector<double>& off) { return math::dot(off, off); };
    std::stable_sort(looked.begin(), looked.end(), [&](const auto& a, const auto& b) { return square(a) > square(b); });
    for (int k = 0; k < LobeErrors::kTexels; ++k) errors.add(k, looked[std::size_t{2} * static_cast<std::size_t>(k)]);
  }

  /// Coarse levels first, whose weights are small.
  void add_taps() {
    std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) {
      if (a.level != b.level) return a.level > b.level;
      return a.point != b.point ? a.point < b.point : a.texel < b.texel;
    });
    for (const Part& part : parts_) {
      const bool begins = table_.taps_.size() == places_.size() &&
                          (places_.empty() || places_.back().level != part.level || places_.back().point != part.point);
      if (begins || table_.taps_.size() == first_of_group_) {
        records_[part.level][part.point] = 1;
        places_.push_back({part.level, part.point});
        table_.taps_.push_back({0, {}});
      }
      table_.taps_.back().weights[part.texel] = part.value;
    }
    first_of_group_ = table_.taps_.size();
  }

  [[nodiscard]] Run run_from(std::size_t level, const LevelPoint& first, std::uint32_t record) const {
    const CubeLevel& shape = table_.levels_[level];
    Run run{};
    run.record = record;
    LevelPoint second = first;
    ++second.column;
    for (std::size_t k = 0; k < kRingImages; ++k) {
      const auto place = [&](const LevelPoint& point) {
        const LevelPoint at = moved_point(cube_image_of(static_cast<int>(k)), shape, point);
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
  std::vector<Part> parts_;
  std::size_t first_of_group_ = 0;
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
  for (const Mip& mip : mips_) bytes += mip.groups.size() * sizeof(Group) + LobeErrors::bytes_for(face_size_);
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
  // twice: lists grow by doubling
  return 2 * texels * kMostTaps * (sizeof(GroupTap) + 2 * sizeof(std::uint32_t)) + points * 64 + errors;
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

  void sum(const Group& group, int size, const std::array<float*, 6>& faces) const {
    alignas(64) float sums[kTexelsOfGroup][kRecordFloats];
    ring_kernels().sum_group_taps({records(), table_.taps_.data() + group.first, table_.taps_.data() + group.end},
                                  sums);
    for (std::size_t texel = 0; texel < kTexelsOfGroup; ++texel) {
      if ((group.texels >> texel & 1U) == 0) continue;
      const glm::ivec3 point = image::point_of(
          size, {group.face, group.column + static_cast<int>(texel % 2), group.row + static_cast<int>(texel / 2)});
      for (int k = 0; k < kRingImages; ++k) {
        const image::CubeTexel at = image::texel_at(size, moved(cube_image_of(k), point));
        float* const to =
            faces[static_cast<std::size_t>(at.face)] + std::ptrdiff_t{3} * (std::ptrdiff_t{at.row} * size + at.column);
        for (int c = 0; c < 3; ++c) to[c] = sums[texel][3 * k + c];
      }
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
                        filling.sum(groups[i], mips_[k].size, mips[k]);
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
