#include "reflections/zonal_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include "math/quadrature.h"
#include "platform/text.h"
#include "reflections/lobe.h"
#include "welkin/core.h"

namespace welkin::reflections {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kFollowed = 1e-12;    ///< what the last coefficients of a panel may be, over the largest value
constexpr std::size_t kPanels = 2000;  ///< at most
constexpr double kCellsOfScale = 128.0;
constexpr int kMostCells = 1 << 16;

double cosine_of(double s) noexcept { return 1.0 - 2.0 * s * s; }

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, what); }

/// Sum (2 l + 1) / (4 pi) k_l P_l(c).
double sum_of_degrees(const std::vector<double>& factors, double cosine) noexcept {
  double before = 0.0;
  double legendre = 1.0;
  double sum = 0.0;
  for (std::size_t l = 0; l < factors.size(); ++l) {
    const auto degree = static_cast<double>(l);
    sum += (2.0 * degree + 1.0) * factors[l] * legendre;
    const double next = ((2.0 * degree + 1.0) * cosine * legendre - degree * before) / (degree + 1.0);
    before = std::exchange(legendre, next);
  }
  return sum / (4.0 * kPi);
}

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

double ZonalShape::evaluate(const Panel& panel, double s) noexcept {
  const double x = (2.0 * s - panel.begin - panel.end) / (panel.end - panel.begin);
  static constexpr Recurrence<kOrder + 1> recurrence;
  double next = 0.0;  // Clenshaw's sum
  double after = 0.0;
  for (int j = kOrder - 1; j > 0; --j) {
    const double own = panel.coefficients[j] + recurrence.up[j] * x * next - recurrence.down[j + 1] * after;
    after = std::exchange(next, own);
  }
  return panel.coefficients[0] + x * next - 0.5 * after;
}

double ZonalShape::value_at(double s) const noexcept {
  const auto at = std::upper_bound(panels_.begin(), panels_.end() - 1, s,
                                   [](double place, const Panel& panel) { return place < panel.end; });
  return evaluate(*at, s);
}

double ZonalShape::value(double cosine) const noexcept {
  return value_at(std::sqrt(std::clamp(0.5 * (1.0 - cosine), 0.0, 1.0)));
}

/// From the axis on, so that panels come out in order. Each is halved until its last coefficients are small.
void ZonalShape::follow(const std::function<double(double)>& value) {
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
      double before = 0.0;
      double legendre = 1.0;
      for (int j = 0; j < kOrder; ++j) {
        panel.coefficients[j] += (j + 0.5) * rule.weights[i] * values[i] * legendre;
        const double next = ((2.0 * j + 1.0) * rule.nodes[i] * legendre - j * before) / (j + 1.0);
        before = std::exchange(legendre, next);
      }
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
    // a panel may be off where it is so narrow that nothing of it is seen: beside the root of a power
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

void ZonalShape::normalise() {
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

void ZonalShape::measure() {
  constexpr int kSteps = 32;  // of a panel
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  double steepest = 0.0;
  double least = 0.0;
  double below = 0.0;  // the horizon
  for (const Panel& panel : panels_) {
    const double width = panel.end - panel.begin;
    for (int i = 0; i < kOrder; ++i) {
      const double s = 0.5 * (panel.begin + panel.end) + 0.5 * width * rule.nodes[i];
      const double own = evaluate(panel, s);
      square_ += 4.0 * kPi * width * rule.weights[i] * s * own * own;
    }
    double before = evaluate(panel, panel.begin);
    for (int k = 0; k <= kSteps; ++k) {
      const double s = panel.begin + width * k / kSteps;
      const double own = evaluate(panel, s);
      peak_ = std::max(peak_, std::abs(own));
      least = std::min(least, own);
      if (panel.begin >= std::sqrt(0.5) - 1e-12) below = std::max(below, std::abs(own));
      // ds = cos(theta / 2) dtheta / 2
      const double slope = std::abs(own - before) * kSteps / width * 0.5 * std::sqrt(std::max(0.0, 1.0 - s * s));
      if (width > 1e-6) steepest = std::max(steepest, slope);
      before = own;
    }
  }
  scale_ = peak_ < kPi * steepest ? peak_ / steepest : kPi;
  negative_ = least < -1e-9 * peak_;
  const bool broken =
      std::any_of(breaks_.begin(), breaks_.end(), [](double s) { return std::abs(s - std::sqrt(0.5)) < 1e-12; });
  hemisphere_ = broken && below == 0.0;
  steady_horizon_ = hemisphere_ && std::abs(value(1e-6)) < 1e-4 * peak_;
}

/// By the cells of the table: one that is dark at its ends and in between is.
void ZonalShape::find_ends() {
  constexpr double kSeen = 1e-9;
  double first = 1.0;
  double last = 0.0;
  for (const KernelTable::Run& run : table_.runs_) {
    for (int cell = 0; cell < run.cells; ++cell) {
      const double from = run.begin + cell / run.cells_of_s;
      const double width = 1.0 / run.cells_of_s;
      double largest = 0.0;
      for (const double share : {0.001, 0.5, 0.999})
        largest = std::max(largest, std::abs(table_.at(from + share * width)));
      if (largest < kSeen * peak_) continue;
      first = std::min(first, from);
      last = std::max(last, from + width);
    }
  }
  nearest_ = first;
  farthest_ = last;
}

void ZonalShape::make_table() {
  std::vector<double> ends = breaks_;
  ends.push_back(1.0);
  double begin = 0.0;
  const auto panel_of = [this](double s) -> const Panel& {
    return *std::upper_bound(panels_.begin(), panels_.end() - 1, s,
                             [](double place, const Panel& panel) { return place < panel.end; });
  };
  for (const double end : ends) {
    const double wanted = (end - begin) * kCellsOfScale / (0.5 * scale_);
    const int cells = std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e9))), 64, kMostCells);
    table_.runs_.push_back(
        {begin, end, cells / (end - begin), static_cast<int>(table_.cubics_.size() / 4), cells, end < 1.0});
    const double width = (end - begin) / cells;
    for (int cell = 0; cell < cells; ++cell) {
      double at[4];
      for (int k = 0; k < 4; ++k) {
        // within the run: beyond a break the kernel is another function
        const double s = begin + width * (cell + std::clamp(k / 3.0, 1e-9, 1.0 - 1e-9));
        at[k] = evaluate(panel_of(s), s);
      }
      // Newton's form of the cubic through t = 0, 1/3, 2/3, 1, multiplied out
      const double first = at[1] - at[0];
      const double second = 0.5 * (at[2] - 2.0 * at[1] + at[0]);
      const double third = (at[3] - 3.0 * at[2] + 3.0 * at[1] - at[0]) / 6.0;
      table_.cubics_.insert(table_.cubics_.end(),
                            {at[0], 3.0 * (first - second + 2.0 * third), 9.0 * (second - 3.0 * third), 27.0 * third});
    }
    begin = end;
  }
}

ZonalShape::ZonalShape(const std::function<double(double)>& value, std::vector<double> breaks)
    : breaks_(std::move(breaks)) {
  std::sort(breaks_.begin(), breaks_.end());
  breaks_.erase(std::unique(breaks_.begin(), breaks_.end()), breaks_.end());
  follow(value);
  normalise();
  measure();
  make_table();
  find_ends();
}

ZonalShape::ZonalShape(std::vector<double> factors) : factors_(std::move(factors)) {
  follow([this](double cosine) { return sum_of_degrees(factors_, cosine); });
  normalise();
  measure();
  make_table();
  find_ends();
}

std::vector<double> ZonalShape::spectrum(int bands) const {
  if (!factors_.empty()) {
    std::vector<double> values = factors_;
    values.resize(static_cast<std::size_t>(bands), 0.0);
    return values;
  }
  // Legendre's polynomials of the last band move at most 2.83 l a unit of s: see `lobe_spectrum`
  const math::GaussRule rule = math::gauss_legendre(kOrder);
  const double widest = 28.0 / (2.83 * std::max(bands, 8));
  std::vector<double> distances;
  std::vector<double> weights;
  for (const Panel& panel : panels_) {
    const int parts = static_cast<int>(std::ceil((panel.end - panel.begin) / widest));
    const double half = 0.5 * (panel.end - panel.begin) / parts;
    for (int part = 0; part < parts; ++part) {
      for (int i = 0; i < kOrder; ++i) {
        const double s = panel.begin + half * (2.0 * part + 1.0 + rule.nodes[i]);
        distances.push_back(2.0 * s * s);
        weights.push_back(8.0 * kPi * half * rule.weights[i] * s * evaluate(panel, s));
      }
    }
  }
  std::vector<double> values = zonal_moments(std::move(distances), std::move(weights), bands);
  const double whole = values.front();
  for (double& value : values) value /= whole;
  return values;
}

}  // namespace welkin::reflections
