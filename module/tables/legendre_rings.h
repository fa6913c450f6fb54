// Where the Legendre functions of each order begin to matter on each group of ring pairs, and their values there.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "simd/transform_kernels.h"
#include "tables/aligned_buffer.h"
#include "tables/legendre_factors.h"

namespace welkin::tables {

/// Which colatitudes, `rings` rows on the sphere. Lane q is a pair of equal distance from the equator.
enum class RingPlaces {
  centres,  ///< theta = pi (q + 1/2) / rings, q < ceil(rings / 2), and its mirror image
  edges,    ///< theta = pi (q + 1) / rings, the last one the equator; the functions times sin^2(theta)
};

struct LegendreRingsKey {
  int rings;
  int bands;
  RingPlaces places;

  bool operator==(const LegendreRingsKey&) const = default;
};

class LegendreRings {
 public:
  static std::shared_ptr<const LegendreRings> get(const LegendreRingsKey& key);

  explicit LegendreRings(const LegendreRingsKey& key);

  [[nodiscard]] static int pairs_of(int rings, RingPlaces places) noexcept {
    return places == RingPlaces::centres ? (rings + 1) / 2 : (rings - 1) / 2 + 1;
  }
  [[nodiscard]] static int groups_of(int rings, RingPlaces places) noexcept {
    return (pairs_of(rings, places) + simd::kRingLanes - 1) / simd::kRingLanes;
  }

  [[nodiscard]] int groups() const noexcept { return groups_; }

  /// Orders m that do not vanish everywhere on a group for all l < bands: those below this.
  [[nodiscard]] int orders(int group) const noexcept { return orders_[static_cast<std::size_t>(group)]; }
  /// The first group on which order m does not vanish; `groups()` if there is none.
  [[nodiscard]] int first_group(int m) const noexcept { return first_groups_[static_cast<std::size_t>(m)]; }

  /// The functions of order m on `groups` groups from `first` on, for all l < bands.
  [[nodiscard]] simd::LegendreRun run(int m, int first, int groups, const LegendreFactors& factors) const noexcept;

  /// Edges only, [groups][kRingLanes] of order m: with P(m, m)'s integrals over rows, sum over rows of
  /// f Int P(m, m) sin(theta) d theta is the sum of these over lanes, times the sum (or difference) of f across the
  /// lane's edge and its mirror image's; in the last lane times f's sum over the two rows next to the equator.
  [[nodiscard]] const double* row_weights(int m) const noexcept {
    return row_weights_.data() + static_cast<std::size_t>(m) * lanes();
  }

  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  [[nodiscard]] std::size_t lanes() const noexcept {
    return static_cast<std::size_t>(groups_) * static_cast<std::size_t>(simd::kRingLanes);
  }
  void place_rings(const LegendreRingsKey& key);
  void find_starts(const LegendreRingsKey& key);
  void fill_row_weights(const LegendreRingsKey& key);

  int bands_;
  int groups_;
  std::vector<double> sines_;      ///< [lane]; 0 where there is no ring
  AlignedBuffer<double> x_;        ///< [lane], cosines
  AlignedBuffer<float> x_single_;  ///< [group][2][kRingLanes]
  int first_single_ = 0;
  AlignedBuffer<double> states_;  ///< [m][group][2][kRingLanes]
  std::vector<int> starts_;       ///< [m][group], in fours of degrees
  std::vector<int> orders_;
  std::vector<int> first_groups_;
  AlignedBuffer<double> row_weights_;
};

}  // namespace welkin::tables
