// A zonal kernel as the prefilter reads it: polynomials by the distance from its axis, their harmonics, and a table.
#pragma once

#include <functional>
#include <vector>

namespace welkin::reflections {

/// A kernel by even steps of s = sin(theta / 2), theta the angle to the axis: cubic polynomials through the kernel's
/// values. A step is a hundred-and-twenty-eighth of the kernel's scale, so the cubics err by some 1e-8 of its largest
/// value.
class KernelTable {
 public:
  /// The kernel at s from 0 to 1.
  [[nodiscard]] double at(double s) const noexcept {
    const Run* run = runs_.data();
    while (s >= run->end && run->next) ++run;
    double place = (s - run->begin) * run->cells_of_s;
    if (!(place > 0.0)) place = 0.0;
    auto cell = static_cast<int>(place);
    if (cell >= run->cells) cell = run->cells - 1;
    const double t = place - cell;
    const double* const k = cubics_.data() + 4 * static_cast<std::ptrdiff_t>(run->first + cell);
    return k[0] + t * (k[1] + t * (k[2] + t * k[3]));
  }

 private:
  friend class ZonalShape;

  /// Cells between two breaks.
  struct Run {
    double begin;
    double end;
    double cells_of_s;
    int first;
    int cells;
    bool next;  ///< whether another run follows
  };

  std::vector<Run> runs_;
  std::vector<double> cubics_;  ///< four coefficients a cell
};

/// A kernel whose integral over the sphere is 1. The caller's function is followed by polynomials of degree 19 in s, on
/// panels that are halved until they follow it to 1e-12 of its largest value.
class ZonalShape {
 public:
  /// `breaks`: in s, without 0 and 1. Throws `Error` (invalid_argument), see `ZonalKernel::from_function`.
  ZonalShape(const std::function<double(double cosine)>& value, std::vector<double> breaks);
  /// Of a finite spectrum, whose first number is 1.
  explicit ZonalShape(std::vector<double> factors);

  [[nodiscard]] double value(double cosine) const noexcept;
  [[nodiscard]] std::vector<double> spectrum(int bands) const;

  /// Int k^2 over the sphere: Sum (2 l + 1) k_l^2 / (4 pi).
  [[nodiscard]] double square() const noexcept { return square_; }
  [[nodiscard]] double peak() const noexcept { return peak_; }  ///< the largest magnitude
  /// Radians: the largest magnitude over the steepest slope, at most pi.
  [[nodiscard]] double scale() const noexcept { return scale_; }
  /// Where it is seen at all, in s: nearer the axis and farther from it all is below 1e-9 of the largest magnitude.
  [[nodiscard]] double nearest() const noexcept { return nearest_; }
  [[nodiscard]] double farthest() const noexcept { return farthest_; }
  [[nodiscard]] bool negative() const noexcept { return negative_; }      ///< in places
  [[nodiscard]] bool hemisphere() const noexcept { return hemisphere_; }  ///< 0 wherever the cosine is below 0
  /// As well as that, next to it all but the cosine times a steady function.
  [[nodiscard]] bool steady_horizon() const noexcept { return steady_horizon_; }
  [[nodiscard]] const std::vector<double>& breaks() const noexcept { return breaks_; }
  [[nodiscard]] const KernelTable& table() const noexcept { return table_; }
  /// Bands beyond which there is nothing; 0: it has no end.
  [[nodiscard]] int last_band() const noexcept { return static_cast<int>(factors_.size()); }

 private:
  static constexpr int kOrder = 20;

  /// A polynomial in Legendre's form over s in [begin, end].
  struct Panel {
    double begin;
    double end;
    double coefficients[kOrder];
  };

  [[nodiscard]] static double evaluate(const Panel& panel, double s) noexcept;
  [[nodiscard]] double value_at(double s) const noexcept;
  void follow(const std::function<double(double)>& value);
  void normalise();
  void measure();
  void make_table();
  void find_ends();

  std::vector<double> factors_;
  std::vector<double> breaks_;  ///< in s
  std::vector<Panel> panels_;
  double square_ = 0.0;
  double peak_ = 0.0;
  double scale_ = 0.0;
  double nearest_ = 0.0;
  double farthest_ = 1.0;
  bool negative_ = false;
  bool hemisphere_ = false;
  bool steady_horizon_ = false;
  KernelTable table_;
};

}  // namespace welkin::reflections
