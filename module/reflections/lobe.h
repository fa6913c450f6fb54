// Lobes: GGX of the split sum in closed form, and any other function of the angle from an axis.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

namespace welkin::reflections {

/// k(c) = c D(sqrt((1 + c) / 2)), 0 for c <= 0; `alpha` = perceptual roughness squared, in (0, 1]. DESIGN:
/// reflections.h.
[[nodiscard]] double lobe(double cosine, double alpha) noexcept;

/// Int k over the sphere, in closed form.
[[nodiscard]] double lobe_integral(double alpha) noexcept;

/// k_l / k_0 for l < bands, k_l = 2 pi Int k(c) P_l(c) dc: what the prefilter does to band l. In double to 1e-10.
[[nodiscard]] std::vector<double> lobe_spectrum(double alpha, int bands);

/// The far part of a lobe's spectrum (see `kFarPart`), over k_0 of the whole lobe; `end` is q + s where the near part
/// ends, q = alpha^2 / (1 - alpha^2). In double to 1e-9; not kept.
[[nodiscard]] std::vector<double> far_spectrum(double alpha, double end, int bands);

/// Sum_i weights[i] P_l(1 - distances[i]) for l < bands: what a quadrature of a zonal lobe gives.
[[nodiscard]] std::vector<double> zonal_moments(std::vector<double> distances, std::vector<double> weights, int bands);

/// A kernel by even steps of s = sin(theta / 2), theta the angle to the axis: a line in each cell. The horizon lies
/// between two of them. A cell is a 512th of the kernel's scale, so a line errs by 5e-7 of the peak, and by
/// nothing in the mean.
struct KernelTable {
  std::vector<float>
      lines;           ///< of each cell where the kernel is seen: the value at its beginning, and what it rises by
  int first_cell = 0;  ///< counted from s = 0
  double cells_of_s = 0.0;

  /// Int_0^c (c - x) k(x) dx of a kernel that is 0 below the horizon, by even steps of the cosine c: of each cell from
  /// c = 0 on a cubic's four coefficients, lowest first. The last cell is a line, which goes on for ever.
  std::vector<float> twice_integrated;
  double cells_of_c = 0.0;

  /// Radians: `Lobe::scale` of the bell whose fourth derivative is as large relative to its peak as the kernel's is
  /// where it has no break.
  double smooth_scale = 0.0;

  [[nodiscard]] int cells() const noexcept { return static_cast<int>(lines.size() / 2); }
  [[nodiscard]] int cosine_cells() const noexcept { return static_cast<int>(twice_integrated.size() / 4); }
};

/// How much light counts, by its angle from an axis; the integral over the sphere is 1. GGX has closed forms. Any other
/// function is followed by polynomials of degree 19 in s, on panels that are halved until they follow it to 1e-12 of
/// its largest value.
class Lobe {
 public:
  /// GGX of the split sum (`lobe`); alpha in (0, 1].
  explicit Lobe(double alpha);
  /// `breaks`: in s, without 0 and 1. Throws `Error` (invalid_argument), see `ZonalLobe::from_function`.
  Lobe(const std::function<double(double cosine)>& value, std::vector<double> breaks);
  /// A finite spectrum, whose first number is 1.
  explicit Lobe(std::vector<double> factors);

  /// Returns the bytes of a lobe other than GGX whose spectrum and table were made, unless it is narrower than most.
  [[nodiscard]] static constexpr std::size_t bytes() noexcept { return std::size_t{1} << 19U; }

  /// Returns GGX's alpha; 0 for any other lobe.
  [[nodiscard]] double alpha() const noexcept { return alpha_; }
  /// Returns the density per steradian.
  [[nodiscard]] double value(double cosine) const noexcept;
  /// Returns k_l for l < bands, k_0 = 1; fewer of a lobe other than GGX if `bands` is above `kMaximumSpectrumBands`.
  [[nodiscard]] std::vector<double> spectrum(int bands) const;

  /// Returns Int k^2 over the sphere: Sum (2 l + 1) k_l^2 / (4 pi). For GGX a bound.
  [[nodiscard]] double square() const noexcept { return square_; }
  [[nodiscard]] double peak() const noexcept { return peak_; }  ///< the largest magnitude
  /// Radians: the largest magnitude over the steepest slope, at most pi.
  [[nodiscard]] double scale() const noexcept { return scale_; }
  /// Returns alpha of the GGX lobe that is as narrow as the finest detail.
  [[nodiscard]] double width_alpha() const noexcept;
  /// Returns alpha of the GGX lobe through which a light is as bright; at most 0.1 unless the lobe is GGX: every texel
  /// above 25 times the mean is then a light, however wide the lobe.
  [[nodiscard]] double light_alpha() const noexcept;
  /// Where it is seen at all, in s: nearer the axis and farther from it all is below 1e-9 of the largest magnitude.
  [[nodiscard]] double nearest() const noexcept { return nearest_; }
  [[nodiscard]] double farthest() const noexcept { return farthest_; }
  /// Returns the width in s over which a polynomial of degree 19 follows the lobe to 1e-12 of its peak, of the places
  /// between these where it is least. Not for GGX.
  [[nodiscard]] double smooth_over(double from, double to) const noexcept;
  [[nodiscard]] bool negative() const noexcept { return negative_; }      ///< in places
  [[nodiscard]] bool hemisphere() const noexcept { return hemisphere_; }  ///< 0 wherever the cosine is below 0
  /// Returns the steepest slope per radian within 0.1 above the horizon, of a lobe other than GGX.
  [[nodiscard]] double horizon_slope() const noexcept { return horizon_slope_; }
  /// Returns whether it has breaks but for a hemisphere's horizon.
  [[nodiscard]] bool bends() const noexcept { return breaks_.size() > (hemisphere_ ? 1U : 0U); }
  /// Returns whether all of it lies in a ring about the axis, above the horizon: a small light sees it as a function of
  /// a cosine that changes evenly.
  [[nodiscard]] bool annular() const noexcept;
  [[nodiscard]] const std::vector<double>& breaks() const noexcept { return breaks_; }
  [[nodiscard]] const KernelTable& table() const;  ///< made on first use; empty for GGX
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
  void find_where_seen();
  void make_table() const;
  void integrate_twice() const;
  [[nodiscard]] double find_smooth_scale() const;
  [[nodiscard]] std::vector<double> find_spectrum(int bands) const;

  double alpha_ = 0.0;
  std::vector<double> factors_;
  std::vector<double> breaks_;  ///< in s
  std::vector<Panel> panels_;
  double square_ = 0.0;
  double peak_ = 0.0;
  double scale_ = 0.0;
  double nearest_ = 0.0;
  double farthest_ = 1.0;
  double horizon_slope_ = 0.0;
  bool negative_ = false;
  bool hemisphere_ = false;
  mutable std::once_flag table_made_;
  mutable KernelTable table_;
  mutable std::mutex mutex_;
  mutable std::vector<double> spectrum_;  ///< made on demand
};

/// Returns what decides at such bounds how finely lights are merged, and which lobes are too narrow for harmonics: 9.25
/// for rms 1e-3 and maximum 1e-2, more for smaller ones.
[[nodiscard]] double reach_for(double rms, double maximum) noexcept;

}  // namespace welkin::reflections
