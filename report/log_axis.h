// A logarithmic axis.
#pragma once

#include <vector>

namespace welkin::report {

/// Values to places along a picture's edge.
class LogAxis {
 public:
  /// Shows `values` that are above 0 and finite, with a margin; `floor`: what is smaller is drawn there. `from`, `to`:
  /// the places of its ends (`to` may lie before `from`). At least one and a half decades, so that noise does not fill
  /// it.
  LogAxis(const std::vector<double>& values, double floor, double from, double to);

  [[nodiscard]] double place(double value) const noexcept;
  /// Powers of ten within it.
  [[nodiscard]] std::vector<double> decades() const;
  /// Their multiples by 2 to 9 within it.
  [[nodiscard]] std::vector<double> minor() const;
  [[nodiscard]] bool shows(double value) const noexcept;

 private:
  double floor_, from_, to_;
  double low_ = -1.0, high_ = 1.0;  ///< decimal logarithms of its ends
};

}  // namespace welkin::report
