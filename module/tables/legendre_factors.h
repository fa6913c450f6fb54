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

#include "tables/aligned_buffer.h"

namespace welkin::tables {

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
  AlignedBuffer<double> values_;
  AlignedBuffer<float> single_;
};

}  // namespace welkin::tables
