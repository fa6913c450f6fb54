#include "reflections/near_sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "reflections/lobe.h"
#include "reflections/narrow_kernels.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::size_t kCacheBytes = std::size_t{64} << 20U;
constexpr int kFineRadius = 2;  ///< texels from a direction within which weights have 4 x 4 points, not 2 x 2

constexpr double kPoints2[2] = {-0.577350269189625765, 0.577350269189625765};
constexpr double kPoints4[4] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                                0.861136311594052575};
constexpr double kWeights4[4] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                 0.347854845137453857};

}  // namespace

double NearSplit::end() const noexcept {
  const double sine = math::sine_cosine_of_turns(reach / (4.0 * kPi)).sine;
  return alpha * alpha / ((1.0 - alpha) * (1.0 + alpha)) + sine * sine;
}

/// Finds the taps of one target after the other.
class NearSums::Weigher {
 public:
  explicit Weigher(const NearSplit& split)
      : size_(split.face),
        reach_(split.reach),
        end_(split.end()),
        offset_(split.alpha * split.alpha / ((1.0 - split.alpha) * (1.0 + split.alpha))),
        whole_(lobe_integral(split.alpha)),
        alpha_(split.alpha),
        sine_(math::sine_cosine_of_turns(reach_ / (2.0 * kPi)).sine),
        record_of_(std::size_t{6} * static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {
    constexpr int kCells = 4096;
    for (int k = 0; k <= kCells + 1; ++k) density_.push_back(density((end_ - offset_) * k / kCells));
    cells_ = kCells / (end_ - offset_);
  }

  [[nodiscard]] std::size_t texel(int face, int row, int column) const {
    return (static_cast<std::size_t>(face) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(row)) *
               static_cast<std::size_t>(size_) +
           static_cast<std::size_t>(column);
  }
  /// Adds the taps, whose records are texels for now.
  void weigh(const glm::dvec3& direction, std::vector<RingTap>& taps) {
    for (int face = 0; face < 6; ++face) {
      const glm::dvec3 middle = image::face_direction(2, face, 1.0, 1.0);
      const glm::dvec3 across = image::face_direction(2, face, 2.0, 1.0) * std::numbers::sqrt2 - middle;
      const glm::dvec3 down = image::face_direction(2, face, 1.0, 2.0) * std::numbers::sqrt2 - middle;
      weigh_face(face, {glm::dot(direction, across), glm::dot(direction, down), glm::dot(direction, middle)}, taps);
    }
  }
  std::vector<std::uint32_t>& records() { return record_of_; }

 private:
  /// Per steradian, of a lobe whose integral is 1. `s`: sin^2 of half the angle.
  [[nodiscard]] double density(double s) const {
    const double x = (offset_ + s) / end_;
    if (x >= 1.0) return 0.0;
    return lobe(1.0 - 2.0 * s, alpha_) * (1.0 - x * x * far_polynomial(x)) / whole_;
  }
  [[nodiscard]] double tabled(double s) const {
    const double at = std::max(0.0, s) * cells_;
    const auto cell = static_cast<std::size_t>(at);
    if (cell + 1 >= density_.size()) return 0.0;
    return density_[cell] + (at - static_cast<double>(cell)) * (density_[cell + 1] - density_[cell]);
  }
  /// Texels of a row or column that a circle may reach, by the axis across them: first and one beyond the last.
  [[nodiscard]] std::array<int, 2> range(double component, double along) const {
    const double length = std::sqrt(component * component + along * along);
    if (sine_ >= length) return {0, size_};
    const double middle = math::turns_of(component, along);
    const double half = math::arc_sine(sine_ / length) / (2.0 * kPi);
    const auto place = [&](double turns) {
      if (turns <= -0.125) return 0.0;
      if (turns >= 0.125) return 1.0 * size_;
      const math::SineCosine angle = math::sine_cosine_of_turns(turns);
      return 0.5 * size_ * (1.0 + angle.sine / angle.cosine);
    };
    if (middle - half >= 0.125 || middle + half <= -0.125) return {0, 0};
    return {std::max(0, static_cast<int>(place(middle - half))),
            std::min(size_, static_cast<int>(place(middle + half)) + 1)};
  }
  void weigh_face(int face, const glm::dvec3& direction, std::vector<RingTap>& taps) {
    const std::array<int, 2> columns = range(direction.x, direction.z);
    const std::array<int, 2> rows = range(direction.y, direction.z);
    const double u = direction.z > 0.0 ? direction.x / direction.z : 9.0;
    const double v = direction.z > 0.0 ? direction.y / direction.z : 9.0;
    const double middle_column = 0.5 * size_ * (1.0 + u);
    const double middle_row = 0.5 * size_ * (1.0 + v);
    for (int row = rows[0]; row < rows[1]; ++row) {
      for (int column = columns[0]; column < columns[1]; ++column) {
        const bool fine =
            std::abs(column + 0.5 - middle_column) < kFineRadius && std::abs(row + 0.5 - middle_row) < kFineRadius;
        const double weight =
            fine ? integral<4>(direction, row, column, kPoints4) : integral<2>(direction, row, column, kPoints2);
        if (weight > 0.0) {
          taps.push_back({static_cast<std::uint32_t>(texel(face, row, column)), static_cast<float>(weight)});
          record_of_[taps.back().record] = 1;
        }
      }
    }
  }
  template <int count>
  [[nodiscard]] double integral(const glm::dvec3& direction, int row, int column, const double* points) const {
    const double half = 1.0 / size_;
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      const double v = (2 * row + 1 + points[i]) * half - 1.0;
      for (int j = 0; j < count; ++j) {
        const double u = (2 * column + 1 + points[j]) * half - 1.0;
        const double inverse = 1.0 / (1.0 + u * u + v * v);
        const double root = std::sqrt(inverse);
        const double cosine = (direction.x * u + direction.y * v + direction.z) * root;
        const double weight = count == 4 ? kWeights4[i] * kWeights4[j] : 1.0;
        sum += weight * inverse * root * tabled(0.5 - 0.5 * cosine);
      }
    }
    return sum * half * half;
  }

  int size_;
  double reach_;
  double end_;
  double offset_;
  double whole_;
  double alpha_;
  double sine_;
  double cells_ = 0.0;
  std::vector<double> density_;
  std::vector<std::uint32_t> record_of_;  ///< [texel]: 1 where it is needed; then its record
};

namespace {

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

NearSums::NearSums(const NearSplit& split) : split_(split), ends_{0} {
  const int half = split.size / 2;
  std::uint32_t target = 0;
  Weigher weigher(split);
  far_ = far_spectrum(split.alpha, split.end(), split.bands + split.bands / 2);
  const double even = 1.0 - far_.front();
  const auto weigh_row = [&](const glm::ivec3& first, int count) {
    const image::CubeTexel at = image::texel_at(split.size, first);
    targets_.push_back({places_of(split.size, at.face, at.row, at.column), count, target});
    target += static_cast<std::uint32_t>(count);
    for (int k = 0; k < count; ++k) {
      const std::size_t begin = taps_.size();
      const glm::ivec3 point = image::point_of(split.size, {at.face, at.column + k, at.row});
      weigher.weigh(glm::normalize(glm::dvec3(point)), taps_);
      double sum = 0.0;
      for (std::size_t tap = begin; tap < taps_.size(); ++tap) sum += static_cast<double>(taps_[tap].weight);
      for (std::size_t tap = begin; tap < taps_.size(); ++tap)
        taps_[tap].weight = static_cast<float>(static_cast<double>(taps_[tap].weight) * even / sum);
      ends_.push_back(static_cast<std::uint32_t>(taps_.size()));
    }
  };
  // a forty-eighth of the mip: an eighth of +Y
  for (int row = 0; row < half; ++row) weigh_row({1, split.size, -(2 * row + 1)}, row + 1);
  std::vector<std::uint32_t>& record = weigher.records();
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < split.face; ++row) {
      bool follows = false;
      for (int column = 0; column < split.face; ++column) {
        std::uint32_t& own = record[weigher.texel(face, row, column)];
        if (own == 0) {
          follows = false;
          continue;
        }
        if (!follows) sources_.push_back({places_of(split.face, face, row, column), 0, records_});
        follows = true;
        ++sources_.back().count;
        own = records_++;
      }
    }
  }
  for (RingTap& tap : taps_) tap.record = record[tap.record];
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
  const double bytes = 3.0 * taps * sizeof(RingTap) + records * kCubeImages * 3.0 * sizeof(float) +
                       (all + 6.0 * split.face * 2.0) * sizeof(std::uint32_t) + 8.0 * edge * sizeof(Texels) +
                       18.0 * split.size * split.size * sizeof(float);
  return static_cast<std::size_t>(bytes) + (std::size_t{1} << 16U);
}

std::size_t NearSums::bytes() const noexcept {
  return sizeof(*this) + (sources_.size() + targets_.size()) * sizeof(Texels) + ends_.size() * sizeof(std::uint32_t) +
         taps_.size() * sizeof(RingTap) + far_.size() * sizeof(double);
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
  constexpr double kLeastTexels = 2.5;  // of reach
  constexpr double kLeastWidths = 2.0;  // alpha: the far part of less is hardly wider than the lobe
  constexpr double kMostTexel = 2.5;    // over alpha: the points of the weights' quadrature see no narrower lobe
  constexpr int kStep = 8;
  NearSplit best{face, size, alpha, 0.0, 0};
  if (2.0 / face > kMostTexel * alpha) return best;
  for (int bands = kStep; bands <= 1024; bands += bands < 128 ? kStep : 2 * kStep) {
    const double reach = bands_of_reach / bands;
    if (reach > kMostReach) continue;
    if (0.5 * reach * face < kLeastTexels || reach < kLeastWidths * alpha) break;
    const NearSplit split{face, size, alpha, reach, bands};
    if (best.bands == 0 || milliseconds_of(split) < milliseconds_of(best)) best = split;
  }
  return best;
}

void NearSums::gather(const float* faces, const Texels& texels, float* records) const {
  const std::ptrdiff_t last = std::ptrdiff_t{18} * split_.face * split_.face - 3;
  for (std::size_t k = 0; k < kCubeImages; ++k) {
    const Place place = texels.places[k];
    const float* from = faces + place.first;
    const std::size_t image = k % kRingImages;
    float* to = records + (k / kRingImages * records_ + texels.record) * kRecordFloats + 3 * image;
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

void NearSums::write(const float* faces, float* to, const Control& control) const {
  constexpr std::size_t kTileRows = 4;
  platform::AlignedBuffer<float> records(static_cast<std::size_t>(records_) * kCubeImages * 3);
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(taps_.size()));
  const std::size_t workers = jobs::worker_count(placement);
  jobs::run_tiles((sources_.size() + kTileRows - 1) / kTileRows, placement, workers, jobs::part_of(control, 0.0, 0.2),
                  [&](std::size_t tile, std::size_t) {
                    for (std::size_t k = tile * kTileRows; k < std::min(sources_.size(), (tile + 1) * kTileRows); ++k)
                      gather(faces, sources_[k], records.data());
                  });
  jobs::run_tiles(kTurns * targets_.size(), placement, workers, jobs::part_of(control, 0.2, 1.0),
                  [&](std::size_t tile, std::size_t) {
                    const Texels& targets = targets_[tile % targets_.size()];
                    const std::size_t turn = tile / targets_.size();
                    RingPlacesInMemory places{};
                    for (int k = 0; k < kRingImages; ++k) {
                      const Place place = targets.places[turn * kRingImages + static_cast<std::size_t>(k)];
                      places.to[k] = to + place.first;
                      places.step[k] = place.step;
                    }
                    ring_kernels().sum_ring_taps({records.data() + turn * records_ * kRecordFloats, taps_.data(),
                                                  ends_.data() + targets.record, targets.count},
                                                 places);
                  });
}

}  // namespace welkin::reflections
