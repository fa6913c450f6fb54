// Lobes of any function: polynomials by the distance from the axis, their harmonics, and a table.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <numbers>
#include <string>
#include <utility>

#include "math/basis.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "platform/text.h"
#include "reflections/lobe.h"
#include "transform/spectrum.h"
#include "welkin/core.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFollowed = 1e-12;    ///< what the last coefficients of a panel may be, over the largest value
constexpr std::size_t kPanels = 2000;  ///< at most
constexpr double kCellsOfScale = 512.0;
constexpr int kMaxCells = 1 << 17;
constexpr double kSeen = 1e-9;  ///< of the largest magnitude: what is less is dark

constexpr double kMaxLightAlpha = 0.1;
// With t = theta / (2 alpha) the slope 4 t / (1 + t^2)^3 is the steepest at t^2 = 1/5, 1.035 per unit of t, so that
// `Lobe::scale`, the peak over it, is 2 alpha / 1.035 = 1.93 alpha.
constexpr double kScaleOfAlpha = 1.93;  ///< of narrow GGX lobes, 1 / (1 + (theta / 2 alpha)^2)^2

// In s = sin(theta / 2) the cosine is 1 - 2 s^2, its distance from 1 has all its digits near the axis, and the solid
// angle is 2 pi dc = 8 pi s ds.
double cosine_of(double s) noexcept { return 1.0 - 2.0 * s * s; }

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, what); }

/// Legendre's recurrence, P_(j+1) = up[j] x P_j - down[j] P_(j-1).
template <int order>
struct Recurrence {
  constexpr Recurrence() {
    for (int j = 0; j < order; ++j) {
      up[j] = (2.0 * j + 1.0) / (j + 1.0);
      down[j] = j / (j + 1.0);
    }
  }
  double up[order]{};
  double down[order]{};
};

}  // namespace

double Lobe::evaluate(const Panel& panel, double s) noexcept {
  const double x = (2.0 * s - panel.begin - panel.end) / (panel.end - panel.begin);
  static constexpr Recurrence<kOrder + 1> recurrence;
  // Sum c_j P_j: b_j = c_j + up_j x b_(j+1) - down_(j+1) b_(j+2), and P_0 (c_0 - down_1 b_2) + P_1 b_1
  // with P_0 = 1, P_1 = x and down_1 = 1/2 is the value.
  double next = 0.0;  // Clenshaw's sum
  double after = 0.0;
  for (int j = kOrder - 1; j > 0; --j) {
    const double term = panel.coefficients[j] + recurrence.up[j] * x * next - recurrence.down[j + 1] * after;
    after = std::exchange(next, term);
  }
  return panel.coefficients[0] + x * next - 0.5 * after;
}

double Lobe::value_at(double s) const noexcept {
  const auto at = std::upper_bound(panels_.begin(), panels_.end() - 1, s,
                                   [](double position, const Panel& panel) { return position < panel.end; });
  return evaluate(*at, s);
}

double Lobe::smooth_over(double from, double to) const noexcept {
  auto at = std::upper_bound(panels_.begin(), panels_.end() - 1, from,
                             [](double position, const Panel& panel) { return position < panel.end; });
  double narrowest = 1.0;
  for (; at != panels_.end() && at->begin <= to; ++at) narrowest = std::min(narrowest, at->end - at->begin);
  return std::max(narrowest, 0.5 * scale_);  // panels about the axis are narrower than they need be
}

double Lobe::value(double cosine) const noexcept {
  if (alpha_ > 0.0) return lobe(cosine, alpha_) / lobe_integral(alpha_);
  return value_at(std::sqrt(std::clamp(0.5 * (1.0 - cosine), 0.0, 1.0)));
}

/// Makes panels from the axis on, so that they come out in order. Each is halved until its last coefficients are small.
///
/// On a panel, mapped to x from -1 to 1, the coefficient of P_j is (j + 1/2) Int k P_j dx. The rule of 20 points is
/// exact up to degree 39: for a polynomial of degree 19 these are the coefficients of the polynomial through its
/// points. Where a function is analytic the coefficients fall geometrically, so the last three bound what was left out.
void Lobe::follow(const std::function<double(double)>& value) {
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  std::vector<double> ends = breaks_;
  for (double end = 1.0; end > 5e-4; end *= 0.5) ends.push_back(end);  // the axis is looked at closely
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<std::pair<double, double>> open;
  double largest = 0.0;
  const auto fill = [&](Panel& panel) {
    double values[kOrder];
    for (int i = 0; i < kOrder; ++i) {
      const double s = 0.5 * (panel.begin + panel.end) + 0.5 * (panel.end - panel.begin) * rule.nodes[i];
      values[i] = value(cosine_of(s));
      if (!std::isfinite(values[i]))
        refuse("a kernel's value at the cosine " + platform::number_text(cosine_of(s)) + " is not finite");
      largest = std::max(largest, std::abs(values[i]));
    }
    std::fill_n(panel.coefficients, kOrder, 0.0);
    for (int i = 0; i < kOrder; ++i) {
      math::for_each_legendre(rule.nodes[i], kOrder, [&](std::size_t j, double legendre) {
        panel.coefficients[j] += (static_cast<double>(j) + 0.5) * rule.weights[i] * values[i] * legendre;
      });
    }
  };
  // A first look at all of them, for the largest value.
  double begin = 0.0;
  for (const double end : ends) {
    Panel panel{std::exchange(begin, end), end, {}};
    fill(panel);
    open.emplace_back(panel.begin, panel.end);
  }
  std::reverse(open.begin(), open.end());
  while (!open.empty()) {
    Panel panel{open.back().first, open.back().second, {}};
    open.pop_back();
    fill(panel);
    double last = 0.0;
    for (int j = kOrder - 3; j < kOrder; ++j) last += std::abs(panel.coefficients[j]);
    const double width = panel.end - panel.begin;
    // A panel may be off where it is so narrow that nothing of it is seen: next to the root of a power. Below a width
    // of 1/16 its error counts by its width.
    if (last * std::min(1.0, 16.0 * width) <= kFollowed * largest || width < 1e-9) {
      panels_.push_back(panel);
      continue;
    }
    if (panels_.size() + open.size() >= kPanels)
      refuse("a kernel is not smooth between its breaks: " + std::to_string(kPanels) +
             " polynomials do not follow it; name the cosines at which it jumps or bends");
    const double middle = 0.5 * (panel.begin + panel.end);
    open.emplace_back(middle, panel.end);
    open.emplace_back(panel.begin, middle);
  }
}

// Int k dw = 2 pi Int k dc = 8 pi Int k s ds.
void Lobe::normalise() {
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  double whole = 0.0;
  for (const Panel& panel : panels_) {
    const double half = 0.5 * (panel.end - panel.begin);
    for (int i = 0; i < kOrder; ++i) {
      const double s = 0.5 * (panel.begin + panel.end) + half * rule.nodes[i];
      whole += 8.0 * kPi * half * rule.weights[i] * s * evaluate(panel, s);
    }
  }
  if (!(whole > 0.0) || !std::isfinite(whole))
    refuse("a kernel's integral is " + platform::number_text(whole) + "; it must be above 0");
  for (Panel& panel : panels_) {
    for (double& coefficient : panel.coefficients) coefficient /= whole;
  }
}

void Lobe::measure() {
  constexpr int kSteps = 32;             // of a panel
  constexpr double kNearHorizon = 0.45;  // s^2 at the cosine 0.1
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  double steepest = 0.0;
  double lowest = 0.0;
  double below = 0.0;  // the horizon
  for (const Panel& panel : panels_) {
    const double width = panel.end - panel.begin;
    for (int i = 0; i < kOrder; ++i) {
      const double s = 0.5 * (panel.begin + panel.end) + 0.5 * width * rule.nodes[i];
      const double value = evaluate(panel, s);
      square_ += 4.0 * kPi * width * rule.weights[i] * s * value * value;
    }
    double before = evaluate(panel, panel.begin);
    for (int k = 0; k <= kSteps; ++k) {
      const double s = panel.begin + width * k / kSteps;
      const double value = evaluate(panel, s);
      peak_ = std::max(peak_, std::abs(value));
      lowest = std::min(lowest, value);
      if (panel.begin >= std::sqrt(0.5) - 1e-12) below = std::max(below, std::abs(value));
      // dk / dtheta = dk / ds cos(theta / 2) / 2, and cos(theta / 2) = sqrt(1 - s^2)
      const double slope = std::abs(value - before) * kSteps / width * 0.5 * std::sqrt(std::max(0.0, 1.0 - s * s));
      if (width > 1e-6) steepest = std::max(steepest, slope);
      if (s * s >= kNearHorizon && panel.end <= std::sqrt(0.5) + 1e-12)
        horizon_slope_ = std::max(horizon_slope_, slope);
      before = value;
    }
  }
  find_where_seen();
  scale_ = peak_ < kPi * steepest ? peak_ / steepest : kPi;
  negative_ = lowest < -1e-9 * peak_;
  const bool broken =
      std::any_of(breaks_.begin(), breaks_.end(), [](double s) { return std::abs(s - std::sqrt(0.5)) < 1e-12; });
  hemisphere_ = broken && below == 0.0;
}

/// Takes in the steps next to those where the lobe is seen, so that nothing between steps is missed.
void Lobe::find_where_seen() {
  constexpr int kSteps = 32;  // of a panel
  nearest_ = 1.0;
  farthest_ = 0.0;
  for (const Panel& panel : panels_) {
    for (int k = 0; k <= kSteps; ++k) {
      const auto at = [&](int step) { return panel.begin + (panel.end - panel.begin) * step / kSteps; };
      if (std::abs(evaluate(panel, at(k))) < kSeen * peak_) continue;
      nearest_ = std::min(nearest_, at(std::max(0, k - 1)));
      farthest_ = std::max(farthest_, at(std::min(kSteps, k + 1)));
    }
  }
}

const KernelTable& Lobe::table() const {
  std::call_once(table_made_, [this] {
    if (alpha_ == 0.0) make_table();
  });
  return table_;
}

void Lobe::make_table() const {
  const double horizon = std::sqrt(0.5);
  // s is half of theta near the axis: 0.5 scale_ of it is the scale. A whole number of cells ends at the horizon, where
  // kernels jump or bend. A line over a cell of w errs by w^2 k'' / 8: with k'' as large as peak / scale^2 that is
  // 1 / (8 512^2) = 5e-7 of the peak.
  const double wanted = horizon * kCellsOfScale / (0.5 * scale_);
  const int above = std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e9))), 64, kMaxCells);
  table_.cells_of_s = above / horizon;
  table_.first_cell = static_cast<int>(nearest_ * table_.cells_of_s);
  const auto end = static_cast<int>(std::ceil(farthest_ * table_.cells_of_s));
  auto panel = panels_.begin();
  for (int cell = table_.first_cell; cell < end; ++cell) {
    const double width = std::min(1.0, table_.cells_of_s - cell);  // the last one ends at s = 1
    const auto at = [&](double share) {
      const double s = std::min(1.0, (cell + share * width) / table_.cells_of_s);
      while (panel->end <= s && panel + 1 != panels_.end()) ++panel;
      return evaluate(*panel, s);
    };
    const double first = at(1e-6);  // within the cell: at a break the kernel jumps
    const double middle = at(0.5);
    const double last = at(1.0 - 1e-6);
    // By that much the line has the cell's mean by Simpson's rule, (first + 4 middle + last) / 6 - (first + last) / 2;
    // but none is negative where the kernel is not.
    double higher = 2.0 / 3.0 * (middle - 0.5 * (first + last));
    if (std::min(first, last) >= 0.0 && std::min(first, last) + higher < 0.0) higher = 0.0;
    table_.lines.push_back(static_cast<float>(first + higher));
    table_.lines.push_back(static_cast<float>((last - first) / width));
  }
  if (hemisphere_) integrate_twice();
  table_.smooth_scale = find_smooth_scale();
}

// F(c) = Int_0^c (c - x) k(x) dx is the kernel integrated twice, as F'' = k and F(0) = F'(0) = 0 (Cauchy). Its second
// difference is the mean of k over a parallelogram of cosines (`mean_at_horizon`). In a cell k is the line begin +
// rise t, so that with t from 0 to 1 and cells of `width`
//   F' = once + width (begin t + rise t^2 / 2),
//   F = twice + width once t + width^2 (begin t^2 / 2 + rise t^3 / 6),
// whose coefficients are the table's. Beyond the kernel's end F goes on as a line.
void Lobe::integrate_twice() const {
  constexpr double kCosineCellsOfScale = 64.0;
  constexpr int kMaxCosineCells = 1 << 14;
  const double end = cosine_of(nearest_);  // beyond it all is dark
  const auto cells = static_cast<int>(std::ceil(std::min<double>(kMaxCosineCells, end * kCosineCellsOfScale / scale_)));
  table_.cells_of_c = cells / end;
  const double width = 1.0 / table_.cells_of_c;
  double once = 0.0;
  double twice = 0.0;
  const auto add = [this, width](double a, double b, double c, double d) {
    for (const double value : {a, width * b, width * width * c, width * width * d})
      table_.twice_integrated.push_back(static_cast<float>(value));
  };
  for (int cell = 0; cell < cells; ++cell) {
    const double begin = value((cell + 1e-6) * width);
    const double rise = value((cell + 1.0 - 1e-6) * width) - begin;
    add(twice, once, begin / 2.0, rise / 6.0);
    twice += width * (once + width * (begin / 2.0 + rise / 6.0));
    once += width * (begin + rise / 2.0);
  }
  add(twice, once, 0.0, 0.0);
}

bool Lobe::annular() const noexcept {
  constexpr double kNearest = 0.1;  // in s
  return hemisphere_ && alpha_ == 0.0 && nearest_ > kNearest && !bends();
}

double Lobe::find_smooth_scale() const {
  // A bell exp(-x^2 / 2 d^2) is the steepest at x = d, by 1 / (sqrt(e) d) of its peak, so its scale is sqrt(e) d. Its
  // fourth derivative at 0 is 3 / d^4, whose fourth root over the peak's is 3^(1/4) / d: sqrt(e) 3^(1/4) = 2.17. The
  // derivative is found as the fourth difference (1, -4, 6, -4, 1) / step^4.
  constexpr double kOfBell =
      2.17;  // its scale, sqrt(e) deviations, over the fourth root of its peak over the derivative
  const double step = 0.25 * scale_;
  const auto angle_of = [](double s) { return 2.0 * math::arc_sine(s); };
  double largest = 0.0;
  for (double angle = angle_of(nearest_); angle <= angle_of(farthest_); angle += step) {
    const auto crossed = [&](double s) { return std::abs(angle_of(s) - angle) < 2.0 * step; };
    if (std::any_of(breaks_.begin(), breaks_.end(), crossed)) continue;
    const auto at = [&](double steps) {
      return value_at(std::abs(math::sine_cosine_of_turns((angle + steps * step) / (4.0 * kPi)).sine));
    };
    largest = std::max(largest, std::abs(at(-2.0) + at(2.0) - 4.0 * (at(-1.0) + at(1.0)) + 6.0 * at(0.0)));
  }
  return std::max(scale_, kOfBell * step * std::sqrt(std::sqrt(peak_ / std::max(largest, 1e-9 * peak_))));
}

Lobe::Lobe(double alpha)
    : alpha_(alpha),
      breaks_{std::sqrt(0.5)},
      peak_(lobe(1.0, alpha) / lobe_integral(alpha)),
      scale_(std::min(1.0, kScaleOfAlpha * alpha)),
      farthest_(std::sqrt(0.5)),
      hemisphere_(true) {
  // Int k^2 is at most its peak times Int k, and less for a narrow lobe: with x = 1 - c and h = (1 - alpha^2) / 2 the
  // lobe is at most alpha^2 / (pi (alpha^2 + h x)^2), and 2 pi Int_0^inf alpha^4 / (pi^2 (alpha^2 + h x)^4) dx is
  // 2 / (3 pi h alpha^2) = 4 / (3 pi alpha^2 (1 - alpha^2)).
  const double square = alpha * alpha;
  const double integral = lobe_integral(alpha);
  square_ = std::min(peak_, 4.0 / (3.0 * kPi * square * std::max(1e-9, 1.0 - square)) / (integral * integral));
}

Lobe::Lobe(const std::function<double(double)>& value, std::vector<double> breaks) : breaks_(std::move(breaks)) {
  std::sort(breaks_.begin(), breaks_.end());
  breaks_.erase(std::unique(breaks_.begin(), breaks_.end()), breaks_.end());
  follow(value);
  normalise();
  measure();
}

Lobe::Lobe(std::vector<double> factors) : factors_(std::move(factors)) {
  follow([this](double cosine) { return math::sum_of_degrees(factors_, cosine); });
  normalise();
  measure();
}

double Lobe::width_alpha() const noexcept { return alpha_ > 0.0 ? alpha_ : std::clamp(4.0 / 3.0 * scale_, 1e-4, 1.0); }

double Lobe::light_alpha() const noexcept {
  if (alpha_ > 0.0) return alpha_;
  // GGX's peak is 1 / alpha^2 + 3 times the mean: 4 for alpha 1, a cosine's, and within a tenth for all others
  return std::min(kMaxLightAlpha, std::sqrt(1.0 / std::max(1.0, 4.0 * kPi * peak_ - 3.0)));
}

std::vector<double> Lobe::spectrum(int bands) const {
  if (alpha_ > 0.0) return lobe_spectrum(alpha_, bands);
  const auto count = static_cast<std::size_t>(bands);
  if (!factors_.empty()) {
    std::vector<double> values = factors_;
    values.resize(count, 0.0);
    return values;
  }
  const std::scoped_lock lock(mutex_);
  if (spectrum_.empty()) spectrum_ = find_spectrum(transforms::kMaximumSpectrumBands);
  return {spectrum_.begin(), spectrum_.begin() + static_cast<std::ptrdiff_t>(std::min(count, spectrum_.size()))};
}

std::vector<double> Lobe::find_spectrum(int bands) const {
  // P_l turns by l radians per radian of the angle theta, s = sin(theta / 2), and a rule of `kOrder` points integrates
  // products with it over 28. dtheta / ds = 2 / sqrt(1 - s^2) is at most 2.83 as far as the horizon, and without a
  // bound towards the cosine -1, where parts are therefore even in theta: by s alone a uniform lobe of 1536 bands had
  // factors of 6e-4 where they are 0.
  constexpr double kTurn = 28.0;
  const double degree = std::max(bands, 8);
  const double horizon = std::sqrt(0.5);
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  std::vector<double> distances;
  std::vector<double> weights;
  const auto add = [&](const Panel& panel, double from, double to, double widest, const auto& point_at) {
    if (!(from < to)) return;
    const int parts = static_cast<int>(std::ceil((to - from) / widest));
    const double half = 0.5 * (to - from) / parts;
    for (int part = 0; part < parts; ++part) {
      for (int i = 0; i < kOrder; ++i) {
        const auto [s, slope] = point_at(from + half * (2.0 * part + 1.0 + rule.nodes[i]));
        distances.push_back(2.0 * s * s);
        weights.push_back(8.0 * kPi * half * rule.weights[i] * s * evaluate(panel, s) * slope);
      }
    }
  };
  const auto angle_of = [](double s) { return 2.0 * math::arc_sine(s); };
  for (const Panel& panel : panels_) {
    add(panel, panel.begin, std::min(panel.end, horizon), kTurn / (2.83 * degree), [](double s) {
      return std::pair{s, 1.0};
    });
    add(panel, angle_of(std::max(panel.begin, horizon)), angle_of(std::max(panel.end, horizon)), kTurn / degree,
        [](double angle) {
          const auto half = math::sine_cosine_of_turns(angle / (4.0 * kPi));
          return std::pair{half.sine, 0.5 * half.cosine};
        });
  }
  std::vector<double> values = zonal_moments(std::move(distances), std::move(weights), bands);
  const double whole = values.front();
  for (double& value : values) value /= whole;
  return values;
}

}  // namespace welkin::reflections
