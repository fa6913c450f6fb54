#include "reflections/ring_table.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/table_cache.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{192} << 20U;

/// About a table's weights: each texel of a sixteenth reaches the rings that it covers and those beside them.
double about_taps(const RingTableKey& key) noexcept {
  const double rings = 0.5 * key.rows / key.face_size;
  return 6.0 / kRingImages * key.face_size * key.face_size * (kSpread + rings) * (kSpread + rings);
}

/// [image][k]: the image by which a texel has there what its image `image` has at image k.
std::array<std::array<std::size_t, kRingImages>, kRingImages> composed_images() {
  const glm::ivec3 point{1, 2, 4};
  std::array<std::array<std::size_t, kRingImages>, kRingImages> composed{};
  for (int image = 0; image < kRingImages; ++image) {
    const glm::ivec3 there = moved_back(image::cube_image_of(image), point);
    for (int k = 0; k < kRingImages; ++k) {
      int found = 0;
      while (moved(image::cube_image_of(found), point) != moved(image::cube_image_of(k), there)) ++found;
      composed[static_cast<std::size_t>(image)][static_cast<std::size_t>(k)] = static_cast<std::size_t>(found);
    }
  }
  return composed;
}

/// Counts to where each texel's taps begin, and the end of the last one's.
void add_up(std::vector<std::uint32_t>& counts) {
  std::uint32_t sum = 0;
  for (std::uint32_t& count : counts) {
    const std::uint32_t start = sum;
    sum += count;
    count = start;
  }
}

}  // namespace

RingTable::RingTable(const RingTableKey& key, const Control& control, std::size_t largest) : key_(key) {
  RingWeights weights(key.face_size, key.rows);
  rows_ = weights.rows();
  images_ = weights.images();
  if (about_taps(key) * sizeof(RingTap) <= static_cast<double>(largest))
    make(weights, control);
  else
    weights_ = std::make_unique<const RingWeights>(std::move(weights));
}

void RingTable::make(const RingWeights& weights, const Control& control) {
  constexpr auto arena = jobs::Placement::arena;
  const auto bands = static_cast<std::size_t>(weights.bands());
  const auto width = static_cast<std::size_t>(key_.rows / 4);
  const auto first = [&](std::size_t band) {
    return width * static_cast<std::size_t>(weights.first_ring(static_cast<int>(band)));
  };
  ends_.resize(width * static_cast<std::size_t>(key_.rows / 2) + 1);
  jobs::run_tiles(bands, arena, jobs::worker_count(arena), {control.stop, {}}, [&](std::size_t band, std::size_t) {
    weights.count(static_cast<int>(band), ends_.data() + first(band));
  });
  add_up(ends_);
  taps_ = platform::AlignedBuffer<RingTap>(ends_.back());
  std::vector<std::uint32_t> next = ends_;
  jobs::run_tiles(bands, arena, jobs::worker_count(arena), {control.stop, {}}, [&](std::size_t band, std::size_t) {
    weights.weigh(static_cast<int>(band), next.data() + first(band), taps_.data());
  });
}

std::shared_ptr<const RingTable> RingTable::get(const RingTableKey& key, const Control& control) {
  static auto& cache = *new math::TableCache<RingTableKey, RingTable>(kCacheBytes);  // never destroyed
  return cache.get(key, [&] { return std::make_shared<const RingTable>(key, control); });
}

std::size_t RingTable::bytes() const noexcept {
  return sizeof(*this) + rows_.size() * sizeof(RingWeights::TexelRow) +
         images_.size() * sizeof(RingWeights::ImageRecord) + ends_.size() * sizeof(std::uint32_t) + taps_.bytes() +
         (weights_ ? weights_->bytes() : 0);
}

std::size_t RingTable::working_bytes(const RingTableKey& key) noexcept {
  // A margin of some texels all around the sixteenth is read too.
  const auto half = static_cast<std::size_t>(key.face_size) / 2 + 2 * kSpread;
  return 2 * half * half * kRecordFloats * sizeof(float);
}

std::size_t RingTable::making_bytes(const RingTableKey& key) {
  // Columns crowd at the poles: there a texel reaches more of them than elsewhere.
  const double rings = 0.5 * key.rows / key.face_size;
  const double taps = 1.06 * (1.0 + 0.7 * rings / (kSpread + rings)) * about_taps(key);
  const auto cells = static_cast<std::size_t>(key.rows / 2) * static_cast<std::size_t>(key.rows / 4);
  return static_cast<std::size_t>(taps * sizeof(RingTap)) + 2 * cells * sizeof(std::uint32_t) +
         RingWeights::making_bytes(key.face_size, key.rows, jobs::worker_count(jobs::Placement::arena));
}

void RingTable::gather(const CubemapView& source, const RingWeights::TexelRow& row, float* records) const {
  const int size = key_.face_size;
  for (int k = 0; k < kRingImages; ++k) {
    const image::CubeImage image = image::cube_image_of(k);
    const auto place = [&](int column) {
      const image::CubeTexel from = image::texel_at(size, moved(image, row.first + glm::ivec3(2 * column, 0, 0)));
      return static_cast<const float*>(image::row_of(source, from.face, from.row)) + std::ptrdiff_t{3} * from.column;
    };
    const float* from = place(0);
    const std::ptrdiff_t step = row.count > 1 ? place(1) - from : 0;
    float* to = records + static_cast<std::size_t>(row.record) * kRecordFloats + 3 * k;
    for (int texel = 0; texel < row.count; ++texel, from += step, to += kRecordFloats) {
      to[0] = from[0];
      to[1] = from[1];
      to[2] = from[2];
    }
  }
}

void RingTable::sum(const float* records, const RingTap* taps, const std::uint32_t* ends, int ring, float* rgb) const {
  const int columns = 2 * key_.rows;
  RingPlacesInMemory places{};
  for (int k = 0; k < kRingImages; ++k) {
    const image::CubeImage image = image::cube_image_of(k);
    const std::ptrdiff_t line = image.below ? key_.rows - 1 - ring : ring;
    const int column = (image.quarter * (columns / 4) + (image.mirrored ? columns - 1 : 0)) % columns;
    places.to[k] = rgb + 3 * (line * columns + column);
    places.step[k] = image.mirrored ? -3 : 3;
  }
  ring_kernels().sum_ring_taps({records, taps, ends, columns / 8}, places);
}

void RingTable::fill(const CubemapView& source, float* rgb, const Control& control) const {
  constexpr std::size_t kTileRows = 4;
  constexpr int kTileTexels = 2048;
  const std::size_t texels = rows_.back().record + static_cast<std::size_t>(rows_.back().count);
  platform::AlignedBuffer<float> records((texels + images_.size()) * kRecordFloats);
  const auto placement = jobs::placement_for(std::int64_t{2} * key_.rows * key_.rows);
  const std::size_t workers = jobs::worker_count(placement);
  const std::size_t gathers = (rows_.size() + kTileRows - 1) / kTileRows;
  jobs::run_tiles(gathers, placement, workers, jobs::part_of(control, 0.0, 0.2), [&](std::size_t tile, std::size_t) {
    for (std::size_t k = tile * kTileRows; k < std::min(rows_.size(), (tile + 1) * kTileRows); ++k)
      gather(source, rows_[k], records.data());
  });
  static const auto composed = composed_images();
  float* to = records.data() + texels * kRecordFloats;
  for (const RingWeights::ImageRecord& image : images_) {
    const float* const from = records.data() + std::size_t{image.record} * kRecordFloats;
    for (const std::size_t k : composed[static_cast<std::size_t>(image.image)]) to = std::copy_n(from + 3 * k, 3, to);
  }
  const int width = key_.rows / 4;
  if (weights_) {
    jobs::run_tiles(static_cast<std::size_t>(weights_->bands()), placement, workers, jobs::part_of(control, 0.2, 1.0),
                    [&](std::size_t tile, std::size_t) { sum_band(records.data(), static_cast<int>(tile), rgb); });
    return;
  }
  const int tile_rings = std::max(1, kTileTexels / width);
  const int half = key_.rows / 2;
  jobs::run_tiles(static_cast<std::size_t>((half + tile_rings - 1) / tile_rings), placement, workers,
                  jobs::part_of(control, 0.2, 1.0), [&](std::size_t tile, std::size_t) {
                    const int first = static_cast<int>(tile) * tile_rings;
                    for (int ring = first; ring < std::min(half, first + tile_rings); ++ring)
                      sum(records.data(), taps_.data(), ends_.data() + std::ptrdiff_t{width} * ring, ring, rgb);
                  });
}

void RingTable::sum_band(const float* records, int band, float* rgb) const {
  const int first = weights_->first_ring(band);
  const int end = weights_->first_ring(band + 1);
  const int width = key_.rows / 4;
  std::vector<std::uint32_t> ends(static_cast<std::size_t>(end - first) * static_cast<std::size_t>(width) + 1);
  weights_->count(band, ends.data());
  add_up(ends);
  platform::AlignedBuffer<RingTap> taps(ends.back());
  std::vector<std::uint32_t> next = ends;
  weights_->weigh(band, next.data(), taps.data());
  for (int ring = first; ring < end; ++ring)
    sum(records, taps.data(), ends.data() + std::ptrdiff_t{width} * (ring - first), ring, rgb);
}

}  // namespace welkin::reflections
