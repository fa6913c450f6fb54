#include "reflections/near_sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr std::size_t kCacheBytes = std::size_t{64} << 20U;

/// Returns where all images have a run of texels of faces of `size`.
NearSums::Places places_of(int size, int face, int row, int column) {
  NearSums::Places places{};
  for (int k = 0; k < NearSums::kCubeImages; ++k) {
    const image::CubeImage image = image::cube_image_of(k % kRingImages);
    const auto place = [&](int at) {
      glm::ivec3 point = image::point_of(size, {face, at, row});
      for (int turn = 0; turn < k / kRingImages; ++turn) point = {point.y, point.z, point.x};
      const image::CubeTexel texel = image::texel_at(size, image::moved(image, point));
      return 3 * ((texel.face * size + texel.row) * size + texel.column);
    };
    const int first = place(column);
    places[static_cast<std::size_t>(k)] = {first,
                                           column + 1 < size ? place(column + 1) - first : first - place(column - 1)};
  }
  return places;
}

}  // namespace

/// A forty-eighth of the mip: an eighth of +Y.
void NearSums::add_targets(std::vector<glm::dvec3>& directions) {
  for (int row = 0; row < split_.size / 2; ++row) {
    const image::CubeTexel at = image::texel_at(split_.size, {1, split_.size, -(2 * row + 1)});
    targets_.push_back(
        {places_of(split_.size, at.face, at.row, at.column), row + 1, static_cast<std::uint32_t>(directions.size())});
    for (int k = 0; k <= row; ++k)
      directions.push_back(glm::normalize(glm::dvec3(image::point_of(split_.size, {at.face, at.column + k, at.row}))));
  }
}

void NearSums::add_sources(const std::vector<NearWeights::Row>& rows) {
  for (int k = 0; k < 6 * split_.face; ++k) {
    const NearWeights::Row& row = rows[static_cast<std::size_t>(k)];
    if (row.first < row.end) {
      sources_.push_back(
          {places_of(split_.face, k / split_.face, k % split_.face, row.first), row.end - row.first, row.record});
    }
  }
}

NearSums::NearSums(const NearSplit& split)
    : split_(split), far_(far_spectrum(split.alpha, split.end(), split.bands + split.bands / 2)) {
  std::vector<glm::dvec3> directions;
  add_targets(directions);
  const Places& corner = targets_.front().places;  // of one target, on the diagonal
  for (std::size_t image = 0; image < kCubeImages; ++image) {
    twins_[image] = image;
    for (std::size_t other = 0; other < kCubeImages; ++other) {
      if (other != image && corner[other].first == corner[image].first) twins_[image] = other;
    }
  }
  NearWeights weights(split, directions, 1.0 - far_.front());
  add_sources(weights.rows());
  records_ = weights.records();
  ends_ = std::move(weights.ends());
  taps_ = std::move(weights.taps());
}

std::shared_ptr<const NearSums> NearSums::get(const NearSplit& split) {
  static auto& cache = *new math::TableCache<NearSplit, NearSums>(kCacheBytes);  // never destroyed
  return cache.get(split, [&] { return std::make_shared<const NearSums>(split); });
}

std::size_t NearSums::most_bytes(const NearSplit& split) noexcept {
  const double texels = 0.5 * split.reach * split.face;  // of a face's middle
  const double targets = 0.125 * split.size * (split.size + 2.0);
  const double all = 6.0 * split.face * split.face;
  const double taps = targets * std::min(all, 9.0 * texels * texels + 40.0);  // six on average
  const double edge = 0.5 * split.face + 5.0 * texels + 6.0;
  const double records = std::min(all, edge * edge);
  const double runs = targets * (8.0 * texels + 16.0);  // rows of texels near a target
  const double bytes = taps * sizeof(RingTap) + 8.0 * runs + 36.0 * targets + 72.0 * split.size * kCubeImages +
                       records * kRecordFloats * sizeof(float) + 6.0 * split.face * sizeof(NearWeights::Row) +
                       8.0 * edge * sizeof(Texels) + 18.0 * split.size * split.size * sizeof(float);
  return static_cast<std::size_t>(bytes) + (std::size_t{1} << 16U);
}

std::size_t NearSums::bytes() const noexcept {
  return sizeof(*this) + (sources_.size() + targets_.size()) * sizeof(Texels) + ends_.size() * sizeof(std::uint32_t) +
         taps_.bytes() + far_.size() * sizeof(double);
}

namespace {

// Measured on one core of a Zen 5 with AVX-512. Records of large faces do not stay in its caches.
constexpr double kNearMilliseconds = 3e-6;       ///< times size^2 (reach / texel)^2
constexpr double kRecordMilliseconds = 0.2;      ///< of faces of 128, by the fourth power of their size
constexpr double kHarmonicsMilliseconds = 0.55;  ///< of 144 bands, from rings to a mip
constexpr double kHarmonicsPower = 2.7;

}  // namespace

double milliseconds_of_harmonics(int bands) noexcept {
  return kHarmonicsMilliseconds * math::exponential(kHarmonicsPower * math::logarithm(bands / 144.0));
}

double milliseconds_of(const NearSplit& split) noexcept {
  const double texels = 0.5 * split.size * split.face * split.reach;
  const double squared = split.face / 128.0 * split.face / 128.0;
  return kNearMilliseconds * texels * texels + kRecordMilliseconds * squared * squared +
         milliseconds_of_harmonics(split.bands);
}

NearSplit cheapest_split(int face, int size, double alpha, double bands_of_reach) noexcept {
  constexpr double kMostReach = 0.5;
  constexpr double kMostTexel = 2.5;  // over alpha: the points of the weights' quadrature see no narrower lobe
  constexpr int kStep = 8;
  NearSplit best{face, size, alpha, 0.0, 0};
  if (2.0 / face > kMostTexel * alpha) return best;
  for (int bands = kStep; bands <= 1024; bands += bands < 128 ? kStep : 2 * kStep) {
    const double reach = bands_of_reach / bands;
    if (reach > kMostReach) continue;
    const NearSplit split{face, size, alpha, reach, bands};
    if (!split.serves()) break;
    if (best.bands == 0 || milliseconds_of(split) < milliseconds_of(best)) best = split;
  }
  return best;
}

void NearSums::gather(const float* faces, const Texels& texels, int turn, float* records) const {
  const std::ptrdiff_t last = std::ptrdiff_t{18} * split_.face * split_.face - 3;
  for (int image = 0; image < kRingImages; ++image) {
    const Place place = texels.places[static_cast<std::size_t>(turn * kRingImages + image)];
    const float* from = faces + place.first;
    float* to = records + std::size_t{texels.record} * kRecordFloats + std::ptrdiff_t{3} * image;
    // a fourth float is overwritten by the next image
    const std::ptrdiff_t end = place.first + std::ptrdiff_t{place.step} * (texels.count - 1);
    if (image + 1 < kRingImages && std::max<std::ptrdiff_t>(place.first, end) < last) {
      for (int texel = 0; texel < texels.count; ++texel, from += place.step, to += kRecordFloats)
        std::memcpy(to, from, 4 * sizeof(float));
    } else {
      for (int texel = 0; texel < texels.count; ++texel, from += place.step, to += kRecordFloats)
        std::memcpy(to, from, 3 * sizeof(float));
    }
  }
}

void NearSums::sum(std::size_t row, int turn, const float* records, float* to, float* diagonal) const {
  const Texels& targets = targets_[row];
  const std::uint32_t* const ends = ends_.data() + targets.record;
  const int others = targets.count - 1;
  RingPlacesInMemory places{};
  RingPlacesInMemory last{};
  for (int k = 0; k < kRingImages; ++k) {
    const auto image = static_cast<std::size_t>(turn * kRingImages + k);
    places.to[k] = to + targets.places[image].first;
    places.step[k] = targets.places[image].step;
    last.to[k] = diagonal + 3 * (kCubeImages * row + image);
  }
  ring_kernels().sum_ring_taps({records, taps_.data(), ends, others}, places);
  ring_kernels().sum_ring_taps({records, taps_.data(), ends + others, 1}, last);
}

// The last of a row's targets lies on a diagonal of its face, and two images have it: it is the mean of what both sum,
// so that it does not matter which of a turned picture's comes first.
void NearSums::write_diagonals(const float* diagonal, float* to) const {
  for (const Texels& targets : targets_) {
    const auto place = [&](std::size_t image) {
      return targets.places[image].first + targets.places[image].step * (targets.count - 1);
    };
    for (std::size_t image = 0; image < kCubeImages; ++image) {
      const float* const own = diagonal + 3 * image;
      const float* const other = diagonal + 3 * twins_[image];
      for (int c = 0; c < 3; ++c) to[place(image) + c] = 0.5F * own[c] + 0.5F * other[c];
    }
    diagonal += 3 * kCubeImages;
  }
}

void NearSums::write(const float* faces, float* to, const Control& control) const {
  constexpr std::size_t kTileRows = 4;
  platform::AlignedBuffer<float> records(std::size_t{records_} * kRecordFloats);
  platform::AlignedBuffer<float> diagonal(targets_.size() * 3 * kCubeImages);
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(taps_.size()));
  const std::size_t workers = jobs::worker_count(placement);
  for (int turn = 0; turn < kTurns; ++turn) {
    jobs::run_tiles((sources_.size() + kTileRows - 1) / kTileRows, placement, workers, {control.stop, {}},
                    [&](std::size_t tile, std::size_t) {
                      const std::size_t end = std::min(sources_.size(), (tile + 1) * kTileRows);
                      for (std::size_t k = tile * kTileRows; k < end; ++k)
                        gather(faces, sources_[k], turn, records.data());
                    });
    jobs::run_tiles(targets_.size(), placement, workers,
                    jobs::part_of(control, 1.0 * turn / kTurns, (turn + 1.0) / kTurns),
                    [&](std::size_t row, std::size_t) { sum(row, turn, records.data(), to, diagonal.data()); });
  }
  write_diagonals(diagonal.data(), to);
}

}  // namespace welkin::reflections
