// Adaptive integrals of several functions at once, refined until all of them meet a relative error.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace welkin::sky {

/// Up to `Most` integrals that share their nodes: Gauss-Kronrod of 7 and 15 points. The worst piece is halved first
/// (QUADPACK; Piessens et al. 1983).
template <std::size_t Most>
class ReferenceQuadrature {
 public:
  using Values = std::array<double, Most>;

  ReferenceQuadrature(std::size_t functions, double relative_error) : n_(functions), tolerance_(relative_error) {}

  /// Integrates over [ends.front(), ends.back()], at first in the pieces between `ends`, which rise and should lie
  /// where the functions bend, so that each piece is smooth. `function(position, values)` sets the first values.
  template <class Function>
  Values operator()(std::span<const double> ends, const Function& function) {
    pieces_.clear();
    for (std::size_t i = 1; i < ends.size(); ++i) pieces_.push_back(piece(ends[i - 1], ends[i], function));
    for (int halvings = 0; halvings < kMaxHalvings; ++halvings) {
      const std::size_t worst = worst_piece();
      if (worst == pieces_.size()) break;
      const Piece old = pieces_[worst];
      const double middle = old.low + 0.5 * (old.high - old.low);
      if (!(middle > old.low && middle < old.high)) {
        pieces_[worst].error.fill(0.0);  // nothing is left to halve
        continue;
      }
      pieces_[worst] = piece(old.low, middle, function);
      pieces_.push_back(piece(middle, old.high, function));
    }
    Values sum{};
    for (const Piece& p : pieces_) add(p.value, sum);
    return sum;
  }

 private:
  static constexpr int kMaxHalvings = 4000;

  struct Piece {
    double low = 0.0;
    double high = 0.0;
    Values value;
    Values error;
  };

  void add(const Values& part, Values& sum) const {
    for (std::size_t k = 0; k < n_; ++k) sum[k] += part[k];
  }

  /// Returns the piece with the largest share of an error, or the number of pieces if all integrals are exact enough.
  std::size_t worst_piece() const {
    Values total{};
    Values error{};
    for (const Piece& p : pieces_) {
      add(p.value, total);
      add(p.error, error);
    }
    double worst_share = 0.0;
    std::size_t worst = pieces_.size();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (std::size_t k = 0; k < n_; ++k) {
        const double allowed = tolerance_ * std::abs(total[k]);
        if (!(error[k] > allowed) || error[k] < kNothing) continue;
        const double share = pieces_[i].error[k] / error[k];
        if (share > worst_share) {
          worst_share = share;
          worst = i;
        }
      }
    }
    return worst;
  }

  template <class Function>
  Piece piece(double low, double high, const Function& function) const {
    constexpr std::array<double, 8> nodes{
        0.991455371120812639207, 0.949107912342758524526, 0.864864423359769072790, 0.741531185599394439864,
        0.586087235467691130294, 0.405845151377397166907, 0.207784955007898467601, 0.0};
    constexpr std::array<double, 8> kronrod{0.022935322010529224964, 0.063092092629978553291, 0.104790010322250183840,
                                            0.140653259715525918745, 0.169004726639267902827, 0.190350578064785409913,
                                            0.204432940075298892414, 0.209482141084727828013};
    constexpr std::array<double, 4> gauss{0.129484966168869693271, 0.279705391489276667901, 0.381830050505118944950,
                                          0.417959183673469387755};
    const double half = 0.5 * (high - low);
    const double centre = low + half;
    std::array<Values, 15> values;
    Values fine{};
    Values coarse{};
    for (std::size_t i = 0; i < 15; ++i) {
      const std::size_t j = i < 8 ? i : 14 - i;
      function(centre + (i < 8 ? -nodes[j] : nodes[j]) * half, values[i]);
      for (std::size_t k = 0; k < n_; ++k) {
        fine[k] += kronrod[j] * values[i][k];
        if (j % 2 == 1) coarse[k] += gauss[j / 2] * values[i][k];
      }
    }
    Piece result;
    result.low = low;
    result.high = high;
    for (std::size_t k = 0; k < n_; ++k) {
      result.value[k] = half * fine[k];
      double spread = 0.0;
      for (std::size_t i = 0; i < 15; ++i) {
        spread += kronrod[i < 8 ? i : 14 - i] * std::abs(values[i][k] - 0.5 * fine[k]);
      }
      result.error[k] = half * likely_error(std::abs(fine[k] - coarse[k]), spread);
    }
    return result;
  }

  /// QUADPACK's estimate: the rules' difference is the coarse one's error; the fine one's is about its power 3/2.
  static double likely_error(double difference, double spread) {
    if (!(spread > 0.0) || difference == 0.0) return difference;
    const double ratio = 200.0 * difference / spread;
    return ratio < 1.0 ? spread * ratio * std::sqrt(ratio) : spread;
  }

  static constexpr double kNothing = 1e-290;

  std::size_t n_;
  double tolerance_;
  std::vector<Piece> pieces_;
};

}  // namespace welkin::sky
