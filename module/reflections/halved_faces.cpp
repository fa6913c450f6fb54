#include "reflections/halved_faces.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/table_cache.h"
#include "reflections/ring_kernels.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{16} << 20U;

/// Rows, or columns, of a face that give to a row of the result, beginning with `first`.
struct Shares {
  int first = 0;
  int count = 0;
  float of[HalvedRow::kMaxRows] = {};
};

// Row i of the result gets shares of the rows from 2 i - 3 to 2 i + 4 (`kHalvedShares`). The first and last kFolded
// rows also get those of the rows -1, -2, half and half + 1, times kFirstBeyond and kSecondBeyond. A texel at an edge
// thus gives light to kFolded = 3 rows, with its moments up to the second. Along an axis a wave loses 0.0234 times the
// fourth power of its radians per texel. Texels shrink from h = 2 / size at the middle of a face outwards; over the
// sphere and all directions of waves the loss of degree l has the mean 0.0073 (l h)^4 and the root mean square
// 0.0089 (l h)^4. `kHalvedOrder`, a fit, is 0.0085.
Shares shares_of(int row, int size) {
  constexpr int kTaps = 8;
  const int half = size / 2;
  const int last = half - 1 - row;
  const auto first_of = [](int to) { return 2 * to - 3; };
  Shares shares;
  shares.first = row < kFolded ? 0 : first_of(row);
  const int end = last < kFolded ? size : first_of(row) + kTaps;
  for (int from = shares.first; from < end; ++from) {
    double share = 0.0;
    const auto add = [&](int to, double times) {
      const int tap = from - first_of(to);
      if (tap >= 0 && tap < kTaps) share += times * static_cast<double>(kHalvedShares[std::min(tap, kTaps - 1 - tap)]);
    };
    add(row, 1.0);
    if (row < kFolded) {
      add(-1, static_cast<double>(kFirstBeyond[row]));
      add(-2, static_cast<double>(kSecondBeyond[row]));
    }
    if (last < kFolded) {
      add(half, static_cast<double>(kFirstBeyond[last]));
      add(half + 1, static_cast<double>(kSecondBeyond[last]));
    }
    shares.of[shares.count++] = static_cast<float>(share);
  }
  return shares;
}

/// Holds what depends on the faces' size alone.
class HalvingTable {
 public:
  [[nodiscard]] static std::shared_ptr<const HalvingTable> get(int size) {
    static auto& cache = *new math::TableCache<int, HalvingTable>(kCacheBytes);  // never destroyed
    return cache.get(size, [size] { return std::make_shared<const HalvingTable>(size); });
  }

  explicit HalvingTable(int size) : size_(size) {
    const auto angles = image::FaceSolidAngles::get(size);
    for (int row = 0; row < size / 2; ++row) {
      for (int column = 0; column < size; ++column)
        angles_.insert(angles_.end(), 3, static_cast<float>(angles->at(row, column)));
    }
    for (int row = 0; row < size / 2; ++row) shares_.push_back(shares_of(row, size));
    find_scale();
  }

  [[nodiscard]] const Shares& shares(int row) const { return shares_[static_cast<std::size_t>(row)]; }
  [[nodiscard]] const float* angles(int row) const {
    return angles_.data() + std::ptrdiff_t{3} * size_ * std::min(row, size_ - 1 - row);
  }
  [[nodiscard]] const float* scale(int row) const {
    return scale_.data() + std::ptrdiff_t{size_ / 2} * std::min(row, size_ / 2 - 1 - row);
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + (angles_.size() + scale_.size()) * sizeof(float) + shares_.size() * sizeof(Shares);
  }

 private:
  /// Finds by what uniform light is uniform: 1 over the light, in steradians, that a texel of the result gets from
  /// radiance 1. That is its area as the shares see it, and it turns light back into radiance.
  void find_scale() {
    const int half = size_ / 2;
    std::vector<double> sums(static_cast<std::size_t>(size_));
    for (int row = 0; row < (half + 1) / 2; ++row) {
      const Shares& down = shares(row);
      std::fill(sums.begin(), sums.end(), 0.0);
      for (int k = 0; k < down.count; ++k) {
        const float* const from = angles(down.first + k);
        for (int column = 0; column < size_; ++column)
          sums[static_cast<std::size_t>(column)] +=
              static_cast<double>(down.of[k]) * static_cast<double>(from[std::ptrdiff_t{3} * column]);
      }
      for (int column = 0; column < half; ++column) {
        const Shares& across = shares(column);
        double sum = 0.0;
        for (int k = 0; k < across.count; ++k)
          sum += static_cast<double>(across.of[k]) * sums[static_cast<std::size_t>(across.first + k)];
        scale_.push_back(static_cast<float>(1.0 / sum));
      }
    }
  }

  int size_;
  std::vector<float> angles_;  ///< [upper rows][columns][3], steradians
  std::vector<float> scale_;   ///< [upper rows of the result][columns]
  std::vector<Shares> shares_;
};

constexpr int kTileRows = 16;  ///< of the result

/// Floats of a worker's scratch: the light of the rows that give to a tile, and `HalvedRow::scratch`.
std::size_t room_floats(int size) noexcept {
  constexpr int kRows = 2 * kTileRows + HalvedRow::kMaxRows;
  return static_cast<std::size_t>(3 * size) * (kRows + 1) + 6 * HalvedRow::kMargin + HalvedRow::kBeyond;
}

/// Makes rows of a face that follow each other. `from`: all rows of the face that is halved.
void halve_rows(const HalvingTable& table, int size, const float* const* from, int first, int end, float* scratch,
                float* to) {
  const int floats = 3 * size;
  const int begin = table.shares(first).first;
  float* const own = scratch + std::ptrdiff_t{floats} * (2 * kTileRows + HalvedRow::kMaxRows);
  int weighed = begin;
  for (int row = first; row < end; ++row, to += floats / 2) {
    const Shares& shares = table.shares(row);
    HalvedRow run{
        .light = {}, .shares = {}, .count = shares.count, .size = size, .scale = table.scale(row), .scratch = own};
    for (; weighed < shares.first + shares.count; ++weighed) {
      ring_kernels().weigh_light(from[weighed], table.angles(weighed), floats,
                                 scratch + std::ptrdiff_t{floats} * (weighed - begin));
    }
    for (int k = 0; k < shares.count; ++k) {
      run.light[k] = scratch + std::ptrdiff_t{floats} * (shares.first + k - begin);
      run.shares[k] = shares.of[k];
    }
    ring_kernels().halve_row(run, to);
  }
}

SourceRows halved_once(const std::vector<const float*>& rows, const Control& control) {
  const auto size = static_cast<int>(rows.size() / 6);
  const auto table = HalvingTable::get(size);
  const int half = size / 2;
  SourceRows faces{{}, platform::AlignedBuffer<float>(std::size_t{18} * static_cast<std::size_t>(half * half))};
  float* const first_row = faces.owned.data();
  for (int row = 0; row < 6 * half; ++row) faces.rows.push_back(first_row + std::ptrdiff_t{3} * half * row);
  const auto placement = jobs::placement_for(std::int64_t{6} * size * size);
  const std::size_t workers = jobs::worker_count(placement);
  platform::AlignedBuffer<float> scratches(workers * room_floats(size));
  const int tiles = (half + kTileRows - 1) / kTileRows;
  jobs::run_tiles(static_cast<std::size_t>(6 * tiles), placement, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    const int face = static_cast<int>(tile) / tiles;
                    const int first = static_cast<int>(tile) % tiles * kTileRows;
                    halve_rows(*table, size, rows.data() + std::ptrdiff_t{size} * face, first,
                               std::min(half, first + kTileRows), scratches.data() + worker * room_floats(size),
                               first_row + std::ptrdiff_t{3} * half * (half * face + first));
                  });
  return faces;
}

}  // namespace

SourceRows halved_faces(SourceRows faces, int size, const Control& control) {
  while (faces.face() > size) faces = halved_once(faces.rows, control);
  return faces;
}

std::size_t halved_faces_bytes(int from, int size) noexcept {
  if (from == size) return 0;
  const auto texels = static_cast<std::size_t>(from) * static_cast<std::size_t>(from);
  const std::size_t faces = 18 * (texels / 4 + (size < from / 2 ? texels / 16 : 0));
  const std::size_t tables = 2 * (3 * texels / 2 + texels / 8);  // one for each size
  const std::size_t scratches = jobs::worker_count(jobs::Placement::arena) * room_floats(from);
  return sizeof(float) * (faces + tables + scratches) + sizeof(Shares) * static_cast<std::size_t>(from);
}

}  // namespace welkin::reflections
