#include "report/log_axis.h"

#include <algorithm>
#include <cmath>

namespace welkin::report {
namespace {

constexpr double kLeastDecades = 1.5;
constexpr double kMargin = 0.12;  // decades

}  // namespace

LogAxis::LogAxis(const std::vector<double>& values, double floor, double from, double to)
    : floor_(floor), from_(from), to_(to) {
  double least = HUGE_VAL;
  double largest = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value) || value < 0.0) continue;
    least = std::min(least, std::max(value, floor));
    largest = std::max(largest, std::max(value, floor));
  }
  if (largest <= 0.0) return;
  low_ = std::log10(least) - kMargin;
  high_ = std::log10(largest) + kMargin;
  const double missing = std::max(0.0, kLeastDecades - (high_ - low_));
  low_ -= 0.5 * missing;
  high_ += 0.5 * missing;
}

double LogAxis::place(double value) const noexcept {
  const double at = std::log10(std::max(value, floor_));
  return from_ + (to_ - from_) * (at - low_) / (high_ - low_);
}

bool LogAxis::shows(double value) const noexcept {
  const double at = std::log10(value);
  return at >= low_ && at <= high_;
}

std::vector<double> LogAxis::decades() const {
  std::vector<double> found;
  for (int power = static_cast<int>(std::ceil(low_)); power <= high_; ++power) found.push_back(std::pow(10.0, power));
  return found;
}

std::vector<double> LogAxis::minor() const {
  std::vector<double> found;
  for (int power = static_cast<int>(std::floor(low_)); power <= high_; ++power) {
    for (int factor = 2; factor <= 9; ++factor) {
      const double value = factor * std::pow(10.0, power);
      if (shows(value)) found.push_back(value);
    }
  }
  return found;
}

}  // namespace welkin::report
