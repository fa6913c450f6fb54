// Constants of the Legendre recurrences in hundreds of bands.
//
// P(l, m) is orthonormal on the sphere with e^(i m phi), without Condon-Shortley phase. With x = cos(theta) and
//   e(l, m) = sqrt((l^2 - m^2) / (4 l^2 - 1)):
//   x P(l) = e(l + 1) P(l + 1) + e(l) P(l - 1).
// Scaled, P(l) = gamma(l) Q(l) with gamma(m) = gamma(m + 1) = 1 and gamma(l) = e(l - 1) / e(l) gamma(l - 2), the
// recurrence has one factor:
//   Q(l) = a(l) x Q(l - 1) - Q(l - 2),   a(l) = gamma(l - 1) / (e(l) gamma(l)).
// gamma falls slowly, like (l - m)^(-1/4): Q is as tame as P.
//
// Integrals: (1 - x^2) P'(l) = (l + 1) e(l) P(l - 1) - l e(l + 1) P(l + 1) gives for any interval
//   Int P(l) dx = ((l - 2) e(l - 1) Int P(l - 2) dx - [(1 - x^2) P(l - 1)]) / ((l + 1) e(l))
//               = alpha(l) Int P(l - 2) dx - beta(l) [(1 - x^2) Q(l - 1)],
// (cf. M. K. Paul, "Recurrence relations for integrals of associated Legendre functions", Bulletin Geodesique 52,
// 1978), with alpha(m + 1) = 0. |alpha| < 1: errors fade.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "platform/memory.h"
#include "transform/transform_kernels.h"

namespace welkin::transforms {

class LegendreFactors {
 public:
  /// From a bounded cache. `bands` >= 1.
  static std::shared_ptr<const LegendreFactors> get(int bands);

  explicit LegendreFactors(int bands);

  /// Entries of order m < bands, entry i for l = m + i, i < bands - m + 9.
  [[nodiscard]] const double* a(int m) const noexcept { return values_.data() + start(m); }
  /// a in float.
  [[nodiscard]] const float* a_single(int m) const noexcept { return single_.data() + start(m); }
  [[nodiscard]] const double* gamma(int m) const noexcept { return a(m) + length_; }
  [[nodiscard]] const double* alpha(int m) const noexcept { return a(m) + 2 * length_; }
  [[nodiscard]] const double* beta(int m) const noexcept { return a(m) + 3 * length_; }

  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(*this) + values_.bytes() + single_.bytes() + starts_.size() * sizeof(std::size_t);
  }

 private:
  [[nodiscard]] std::size_t start(int m) const noexcept { return starts_[static_cast<std::size_t>(m)]; }
  void fill_order(int m, int count);

  std::size_t length_ = 0;  ///< of all orders' entries of one kind
  std::vector<std::size_t> starts_;
  platform::AlignedBuffer<double> values_;
  platform::AlignedBuffer<float> single_;
};

// Where the Legendre functions of each order begin to matter on each group of ring pairs, and their values there.

/// Which colatitudes, `rings` rows on the sphere. Lane q is a pair of equal distance from the equator.
enum class RingSet {
  centres,  ///< theta = pi (q + 1/2) / rings, q < ceil(rings / 2), and its mirror image
  edges,    ///< theta = pi (q + 1) / rings, the last one the equator; the functions times sin^2(theta)
};

struct LegendreRingsKey {
  int rings;
  int bands;
  RingSet places;

  bool operator==(const LegendreRingsKey&) const = default;
};

class LegendreRings {
 public:
  static std::shared_ptr<const LegendreRings> get(const LegendreRingsKey& key);

  explicit LegendreRings(const LegendreRingsKey& key);

  [[nodiscard]] static int pairs_of(int rings, RingSet places) noexcept {
    return places == RingSet::centres ? (rings + 1) / 2 : (rings - 1) / 2 + 1;
  }
  [[nodiscard]] static int groups_of(int rings, RingSet places) noexcept {
    return (pairs_of(rings, places) + kRingLanes - 1) / kRingLanes;
  }

  [[nodiscard]] int groups() const noexcept { return groups_; }

  /// Orders m that do not vanish everywhere on a group for all l < bands: those below this.
  [[nodiscard]] int orders(int group) const noexcept { return orders_[static_cast<std::size_t>(group)]; }
  /// The first group on which order m does not vanish; `groups()` if there is none.
  [[nodiscard]] int first_group(int m) const noexcept { return first_groups_[static_cast<std::size_t>(m)]; }

  /// The functions of order m on `groups` groups from `first` on, for all l < bands.
  [[nodiscard]] LegendreRun run(int m, int first, int groups, const LegendreFactors& factors) const noexcept;

  /// Edges only, [groups][kRingLanes] of order m: with P(m, m)'s integrals over rows, sum over rows of
  /// f Int P(m, m) sin(theta) d theta is the sum of these over lanes, times the sum (or difference) of f across the
  /// lane's edge and its mirror image's; in the last lane times f's sum over the two rows next to the equator.
  [[nodiscard]] const double* row_weights(int m) const noexcept {
    return row_weights_.data() + static_cast<std::size_t>(m) * lanes();
  }

  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  [[nodiscard]] std::size_t lanes() const noexcept {
    return static_cast<std::size_t>(groups_) * static_cast<std::size_t>(kRingLanes);
  }
  void place_rings(const LegendreRingsKey& key);
  void find_starts(const LegendreRingsKey& key);
  void fill_row_weights(const LegendreRingsKey& key);

  int bands_;
  int groups_;
  std::vector<double> sines_;                ///< [lane]; 0 where there is no ring
  platform::AlignedBuffer<double> x_;        ///< [lane], cosines
  platform::AlignedBuffer<float> x_single_;  ///< [group][2][kRingLanes]
  int first_single_ = 0;
  platform::AlignedBuffer<double> states_;  ///< [m][group][2][kRingLanes]
  std::vector<int> starts_;                 ///< [m][group], in fours of degrees
  std::vector<int> orders_;
  std::vector<int> first_groups_;
  platform::AlignedBuffer<double> row_weights_;
};

/// Legendre functions of few bands, on the rings of a grid, as the coefficients of cubic B-splines down the meridians:
/// sums of them need neither the recurrence nor the spline's, which take most of the time where there are few rings.
class SplineFunctions {
 public:
  /// Whether they are few: at most 1 MiB.
  [[nodiscard]] static bool serve(int rings, int bands) noexcept;
  /// From a bounded cache, of those that serve.
  static std::shared_ptr<const SplineFunctions> get(int rings, int bands);

  SplineFunctions(int rings, int bands);

  /// Degrees of order m: bands - m, or one more that is 0 to make them even.
  [[nodiscard]] int degrees(int m) const noexcept { return (bands_ - m + 1) / 2 * 2; }
  /// Returns the functions of order m on a group: [degrees(m)][kRingLanes].
  [[nodiscard]] const float* of(int m, int group) const noexcept { return values_.data() + start(m, group); }
  [[nodiscard]] std::size_t bytes() const noexcept { return sizeof(*this) + values_.bytes(); }

 private:
  [[nodiscard]] std::size_t start(int m, int group) const noexcept {
    const std::size_t before = starts_[static_cast<std::size_t>(m)] * static_cast<std::size_t>(groups_);
    return (before + static_cast<std::size_t>(group) * static_cast<std::size_t>(degrees(m))) * kRingLanes;
  }

  int bands_;
  int groups_;
  std::vector<std::size_t> starts_;  ///< degrees of the orders before
  platform::AlignedBuffer<float> values_;
};

}  // namespace welkin::transforms
