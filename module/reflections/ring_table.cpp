#include "reflections/ring_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <glm/geometric.hpp>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "platform/memory.h"
#include "platform/standard_library.h"

namespace welkin::reflections {
namespace {

constexpr int kSpread = RingTable::kSpread;
constexpr int kMiddle = kSpread / 2;
constexpr std::size_t kCacheBytes = std::size_t{128} << 20U;
constexpr std::size_t kLargestTable = std::size_t{64} << 20U;
constexpr int kLeastRows = 16;
constexpr double kNothing = 1e-9;  ///< of a ring's texel: weights below are left out

constexpr int kCells = kSpread - 1;  ///< that take a point's light, of two groups of neighbours

using Shares = std::array<double, kCells>;

/// Shares of a point at `place` from the middle edge of some neighbouring cells, in cells.
class Spreading {
 public:
  /// `moments`[j][k]: the mean of x^j over cell k.
  explicit Spreading(std::array<Shares, kCells> moments) {
    std::array<Shares, kCells> inverse{};
    for (std::size_t k = 0; k < kCells; ++k) inverse[k][k] = 1.0;
    for (std::size_t pivot = 0; pivot < kCells; ++pivot) {  // Gauss and Jordan
      std::size_t best = pivot;
      for (std::size_t row = pivot + 1; row < kCells; ++row) {
        if (std::abs(moments[row][pivot]) > std::abs(moments[best][pivot])) best = row;
      }
      std::swap(moments[pivot], moments[best]);
      std::swap(inverse[pivot], inverse[best]);
      const double scale = 1.0 / moments[pivot][pivot];
      for (std::size_t k = 0; k < kCells; ++k) {
        moments[pivot][k] *= scale;
        inverse[pivot][k] *= scale;
      }
      for (std::size_t row = 0; row < kCells; ++row) {
        const double factor = moments[row][pivot];
        if (row == pivot || factor == 0.0) continue;
        for (std::size_t k = 0; k < kCells; ++k) {
          moments[row][k] -= factor * moments[pivot][k];
          inverse[row][k] -= factor * inverse[pivot][k];
        }
      }
    }
    powers_ = inverse;
  }

  [[nodiscard]] Shares at(double place) const noexcept {
    Shares shares{};
    for (std::size_t k = 0; k < kCells; ++k) {
      for (std::size_t j = kCells; j-- > 0;) shares[k] = shares[k] * place + powers_[k][j];
    }
    return shares;
  }

 private:
  std::array<Shares, kCells> powers_{};  ///< [cell][power of the place]
};

/// Of columns, all alike.
Spreading spreading_of_columns() {
  std::array<Shares, kCells> moments{};
  for (std::size_t k = 0; k < kCells; ++k) {
    const double middle = static_cast<double>(k) + 0.5 - kMiddle;
    double above = 1.0;
    double below = 1.0;
    for (std::size_t j = 0; j < kCells; ++j) {
      above *= middle + 0.5;
      below *= middle - 0.5;
      moments[j][k] = (above - below) / static_cast<double>(j + 1);
    }
  }
  return Spreading(moments);
}

/// Of the rings about the upper edge of ring `row`, which go on beyond the pole.
Spreading spreading_of_rings(int row, int rows) {
  const math::GaussRule rule = math::gauss_legendre(8);
  std::array<Shares, kCells> moments{};
  for (std::size_t k = 0; k < kCells; ++k) {
    const double middle = static_cast<double>(k) + 0.5 - kMiddle;
    Shares sums{};
    for (int point = 0; point < rule.order; ++point) {
      const double place = middle + 0.5 * rule.nodes[point];
      double term = rule.weights[point] * std::abs(math::sine_cosine_of_turns((row + place) / (2.0 * rows)).sine);
      for (std::size_t j = 0; j < kCells; ++j, term *= place) sums[j] += term;
    }
    for (std::size_t j = 0; j < kCells; ++j) moments[j][k] = sums[j] / sums[0];
  }
  return Spreading(moments);
}

/// From one group's shares to the next one's where a point is half way through a cell, so that all shares are smooth.
/// `place`: from the middle of the cell in the middle.
std::array<double, kSpread> blended(const Spreading& before, const Spreading& after, double place) {
  const double s = place + 0.5;
  const double share = s * s * s * (s * (6.0 * s - 15.0) + 10.0);
  const Shares first = before.at(place + 0.5);
  const Shares second = after.at(place - 0.5);
  std::array<double, kSpread> shares{};
  for (std::size_t k = 0; k < kCells; ++k) {
    shares[k] += (1.0 - share) * first[k];
    shares[k + 1] += share * second[k];
  }
  return shares;
}

/// About a table's weights: each texel of a sixteenth reaches the rings that it covers and those beside them.
double about_taps(const RingTableKey& key) noexcept {
  const double rings = 0.5 * key.rows / key.face_size;
  return 6.0 / kRingImages * key.face_size * key.face_size * (kSpread + rings) * (kSpread + rings);
}

/// A point's shares, from a row and a column on.
struct Landing {
  int row;
  int column;
  std::array<double, kSpread> down;  ///< times steradians
  std::array<double, kSpread> across;
};

struct Entry {
  std::uint32_t column;
  std::uint32_t texel;
  double weight;
};

}  // namespace

/// Goes over the texels of a sixteenth, from -Z's middle towards +x and up to +Y. What a texel gives to a ring's texel
/// elsewhere, one of its images gives to the one in the sixteenth.
class RingTable::Builder {
 public:
  explicit Builder(const RingTableKey& key)
      : size_(key.face_size),
        rows_(key.rows),
        columns_(2 * key.rows),
        across_(spreading_of_columns()),
        entries_(static_cast<std::size_t>(rows_ / 2)) {
    for (int row = 0; row <= rows_; ++row) down_.push_back(spreading_of_rings(row, rows_));
    // Two points hold what a ring or less has; three, two of them. Twice as many, for a uniform cube to be even: rings
    // are only as even as points are dense.
    const double rings = 0.5 * rows_ / size_;
    parts_ = 2 * std::max(1, static_cast<int>(std::ceil(0.5 * rings)));
    rule_ = math::gauss_legendre(rings <= 1.0 ? 2 : 3);
  }

  void run(RingTable& table, const Control& control) {
    for (int face : {5, 2}) {
      for (int row = 0; row < size_; ++row) {
        jobs::throw_if_cancelled(control);
        for (int column = 0; column < size_; ++column) {
          const glm::ivec3 point = image::point_of(size_, {face, column, row});
          if (!image::in_sixteenth(face, point)) continue;
          add_texel({face, column, row}, point);
        }
      }
    }
    finish(table);
  }

 private:
  void add_texel(const image::CubeTexel& texel, const glm::ivec3& point);
  void spread(double distance, double ring, double steradians);
  void land(int row, int column, double weight);
  void finish(RingTable& table);

  int size_;
  int rows_;
  int columns_;
  int parts_ = 1;
  math::GaussRule rule_{};
  Spreading across_;
  std::vector<Spreading> down_;
  std::vector<Landing> landings_;  ///< of a texel
  std::vector<double> sums_;
  std::array<std::uint32_t, kRingImages> images_{};  ///< the texel that image k moves to this one
  std::vector<std::deque<Entry>> entries_;           ///< no list has room to spare
};

void RingTable::Builder::spread(double distance, double ring, double steradians) {
  const int row = std::clamp(static_cast<int>(std::floor(ring)), 0, rows_ - 1);
  const int column = static_cast<int>(std::floor(distance));
  const auto across = blended(across_, across_, distance - column - 0.5);
  const auto down =
      blended(down_[static_cast<std::size_t>(row)], down_[static_cast<std::size_t>(row + 1)], ring - row - 0.5);
  landings_.push_back({row - kMiddle, column - kMiddle, down, across});
  for (double& share : landings_.back().down) share *= steradians;
}

void RingTable::Builder::add_texel(const image::CubeTexel& texel, const glm::ivec3& point) {
  int alike = 0;  // symmetries that leave it where it is: each of them would count it once
  for (int k = 0; k < kRingImages; ++k) {
    alike += moved(image::cube_image_of(k), point) == point ? 1 : 0;
    const image::CubeTexel from = image::texel_at(size_, moved_back(image::cube_image_of(k), point));
    images_[static_cast<std::size_t>(k)] =
        static_cast<std::uint32_t>((from.face * size_ + from.row) * size_ + from.column);
  }
  const image::Frame& frame = image::face_frame(texel.face);
  const double step = 2.0 / size_ / parts_;
  landings_.clear();
  landings_.reserve(static_cast<std::size_t>(parts_ * parts_) * static_cast<std::size_t>(rule_.order * rule_.order));
  for (int part = 0; part < parts_ * parts_; ++part) {
    const int across = part % parts_;
    const int down = part / parts_;
    const double u_part = (2.0 * texel.column - size_) / size_ + (across + 0.5) * step;
    const double v_part = (2.0 * texel.row - size_) / size_ + (down + 0.5) * step;
    for (int i = 0; i < rule_.order; ++i) {
      for (int j = 0; j < rule_.order; ++j) {
        const double u = u_part + 0.5 * step * rule_.nodes[i];
        const double v = v_part + 0.5 * step * rule_.nodes[j];
        const glm::dvec3 to = frame.normal + frame.u * u + frame.v * v;
        const double square = 1.0 + u * u + v * v;
        const double area = 0.25 * step * step * rule_.weights[i] * rule_.weights[j] / (square * std::sqrt(square));
        const double horizontal = std::sqrt(to.x * to.x + to.z * to.z);
        spread(math::turns_of(to.x, -to.z) * columns_, math::turns_of(horizontal, to.y) * columns_, area / alike);
      }
    }
  }
  Landing least = landings_.front();
  Landing most = least;
  for (const Landing& landing : landings_) {
    least.row = std::min(least.row, landing.row);
    least.column = std::min(least.column, landing.column);
    most.row = std::max(most.row, landing.row);
    most.column = std::max(most.column, landing.column);
  }
  const int height = most.row - least.row + kSpread;
  const int width = most.column - least.column + kSpread;
  sums_.assign(static_cast<std::size_t>(height) * static_cast<std::size_t>(width), 0.0);
  for (const Landing& landing : landings_) {
    double* sums = sums_.data() + std::ptrdiff_t{width} * (landing.row - least.row) + (landing.column - least.column);
    for (const double down : landing.down) {
      for (std::size_t j = 0; j < kSpread; ++j) sums[j] += down * landing.across[j];
      sums += width;
    }
  }
  const double* sum = sums_.data();
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column, ++sum) {
      if (*sum != 0.0) land(least.row + row, least.column + column, *sum);
    }
  }
}

void RingTable::Builder::land(int row, int column, double weight) {
  if (row < 0) {
    row = -1 - row;
    column += columns_ / 2;
  }
  const bool below = row >= rows_ / 2;
  if (below) row = rows_ - 1 - row;
  column = (column + columns_) % columns_;
  int quarter = column / (columns_ / 4);
  column %= columns_ / 4;
  const bool mirrored = column >= columns_ / 8;
  if (mirrored) {
    quarter = (quarter + 1) % 4;
    column = columns_ / 4 - 1 - column;
  }
  const std::uint32_t texel = images_[static_cast<std::size_t>(image::index_of({quarter, mirrored, below}))];
  entries_[static_cast<std::size_t>(row)].push_back({static_cast<std::uint32_t>(column), texel, weight});
}

void RingTable::Builder::finish(RingTable& table) {
  std::vector<std::uint32_t> records(std::size_t{6} * static_cast<std::size_t>(size_) *
                                     static_cast<std::size_t>(size_));
  for (const auto& row : entries_) {
    for (const Entry& entry : row) records[entry.texel] = 1;
  }
  std::uint32_t next = 0;
  for (int line = 0; line < 6 * size_; ++line) {
    for (int column = 0; column < size_; ++column) {
      const auto texel =
          static_cast<std::size_t>(line) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(column);
      if (records[texel] == 0) continue;
      const bool follows = column > 0 && records[texel - 1] != 0 && !table.runs_.empty();
      if (!follows) table.runs_.push_back({line / size_, line % size_, column, 0, next});
      ++table.runs_.back().count;
      records[texel] = ++next;  // one more than its number
    }
  }
  table.record_count_ = next;
  std::size_t count = 0;
  for (const auto& row : entries_) count += row.size();
  table.taps_.reserve(count);
  const auto width = static_cast<std::uint32_t>(columns_ / 8);
  for (int row = 0; row < rows_ / 2; ++row) {
    auto& list = entries_[static_cast<std::size_t>(row)];
    std::vector<Entry> entries(list.begin(), list.end());
    list = {};
    platform::ranges::sort(entries, [](const Entry& a, const Entry& b) {
      return a.column != b.column ? a.column < b.column : a.texel < b.texel;
    });
    const double scale = 1.0 / image::lat_long_texel_solid_angle(columns_, rows_, row);
    std::size_t k = 0;
    table.ends_.push_back(static_cast<std::uint32_t>(table.taps_.size()));
    for (std::uint32_t column = 0; column < width; ++column) {
      while (k < entries.size() && entries[k].column == column) {
        const std::uint32_t texel = entries[k].texel;
        double weight = 0.0;
        for (; k < entries.size() && entries[k].column == column && entries[k].texel == texel; ++k)
          weight += entries[k].weight;
        weight *= scale;
        if (std::abs(weight) > kNothing) table.taps_.push_back({records[texel] - 1, static_cast<float>(weight)});
      }
      table.ends_.push_back(static_cast<std::uint32_t>(table.taps_.size()));
    }
  }
  table.taps_.shrink_to_fit();
}

RingTable::RingTable(const RingTableKey& key, const Control& control) : key_(key) { Builder(key).run(*this, control); }

bool RingTable::serves(const RingTableKey& key) noexcept {
  // Of odd faces the middle texels lie on the meridians of symmetry, and an even cube of 257 was uneven by 6e-5.
  if (key.rows < kLeastRows || key.rows % 4 != 0 || key.face_size % 2 != 0) return false;
  return about_taps(key) * sizeof(RingTap) <= static_cast<double>(kLargestTable);
}

std::shared_ptr<const RingTable> RingTable::get(const RingTableKey& key, const Control& control) {
  static auto& cache = *new math::TableCache<RingTableKey, RingTable>(kCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const RingTable>(key, control); });
}

std::size_t RingTable::bytes() const noexcept {
  return sizeof(*this) + runs_.size() * sizeof(Run) + ends_.size() * sizeof(std::uint32_t) +
         taps_.size() * sizeof(RingTap);
}

std::size_t RingTable::working_bytes(const RingTableKey& key) noexcept {
  // A margin of some texels all around the sixteenth is read too.
  const auto half = static_cast<std::size_t>(key.face_size) / 2 + 2 * kSpread;
  return 2 * half * half * kRecordFloats * sizeof(float);
}

std::size_t RingTable::making_bytes(const RingTableKey& key) noexcept {
  // Columns crowd at the poles: there a texel reaches more of them than elsewhere.
  const double rings = 0.5 * key.rows / key.face_size;
  const double entries = 1.05 * (1.0 + rings / (kSpread + rings)) * about_taps(key);
  const double points = 9.0 * (rings + 2.0) * (rings + 2.0);
  const double texels = 6.0 * key.face_size * key.face_size;
  constexpr std::size_t blocks = 1024;  // of a ring's list, and what its shares take
  return static_cast<std::size_t>(entries * (sizeof(RingTap) + sizeof(Entry)) + points * sizeof(Landing) +
                                  texels * sizeof(std::uint32_t)) +
         static_cast<std::size_t>(key.rows) * blocks;
}

void RingTable::gather(const CubemapView& source, const Run& run, float* records) const {
  const int size = key_.face_size;
  for (int k = 0; k < kRingImages; ++k) {
    const image::CubeImage image = image::cube_image_of(k);
    const auto place = [&](int column) {
      const image::CubeTexel from =
          image::texel_at(size, moved(image, image::point_of(size, {run.face, column, run.row})));
      return static_cast<const float*>(image::row_of(source, from.face, from.row)) + std::ptrdiff_t{3} * from.column;
    };
    const float* from = place(run.first);
    const std::ptrdiff_t step = run.count > 1 ? place(run.first + 1) - from : 0;
    float* to = records + static_cast<std::size_t>(run.record) * kRecordFloats + 3 * k;
    for (int texel = 0; texel < run.count; ++texel, from += step, to += kRecordFloats) {
      to[0] = from[0];
      to[1] = from[1];
      to[2] = from[2];
    }
  }
}

void RingTable::fill(const CubemapView& source, float* rgb, const Control& control) const {
  constexpr std::size_t kTileRuns = 4;
  constexpr int kTileTexels = 2048;
  platform::AlignedBuffer<float> records(record_count_ * kRecordFloats);
  const int columns = 2 * key_.rows;
  const auto placement = jobs::placement_for(std::int64_t{columns} * key_.rows);
  const std::size_t workers = jobs::worker_count(placement);
  const std::size_t gathers = (runs_.size() + kTileRuns - 1) / kTileRuns;
  jobs::run_tiles(gathers, placement, workers, jobs::part_of(control, 0.0, 0.2), [&](std::size_t tile, std::size_t) {
    for (std::size_t k = tile * kTileRuns; k < std::min(runs_.size(), (tile + 1) * kTileRuns); ++k)
      gather(source, runs_[k], records.data());
  });
  const int width = columns / 8;
  const int tile_rows = std::max(1, kTileTexels / width);
  const int half = key_.rows / 2;
  const RingKernels& kernels = ring_kernels();
  jobs::run_tiles(static_cast<std::size_t>((half + tile_rows - 1) / tile_rows), placement, workers,
                  jobs::part_of(control, 0.2, 1.0), [&](std::size_t tile, std::size_t) {
                    const int first = static_cast<int>(tile) * tile_rows;
                    for (int row = first; row < std::min(half, first + tile_rows); ++row) {
                      RingPlacesInMemory places{};
                      for (int k = 0; k < kRingImages; ++k) {
                        const image::CubeImage image = image::cube_image_of(k);
                        const std::ptrdiff_t line = image.below ? key_.rows - 1 - row : row;
                        const int column =
                            (image.quarter * (columns / 4) + (image.mirrored ? columns - 1 : 0)) % columns;
                        places.to[k] = rgb + 3 * (line * columns + column);
                        places.step[k] = image.mirrored ? -3 : 3;
                      }
                      const std::uint32_t* const ends =
                          ends_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width + 1);
                      kernels.sum_ring_taps({records.data(), taps_.data(), ends, width}, places);
                    }
                  });
}

}  // namespace welkin::reflections
