// A row of a lat-long that is moved along itself by a share of a texel.
#pragma once

#include <cstddef>
#include <vector>

namespace welkin::image {

/// One channel of a row. Linear interpolation keeps the row's sum and every range, and blurs. What cubic convolution
/// (Catmull-Rom) adds to it is a flux between neighbours, p (a - b) + q (b - c) from texel b's place to a's, which
/// keeps the sum as well. Of each flux as much is taken as leaves every result between the least and the largest of the
/// four texels around its place (S. T. Zalesak, "Fully multidimensional flux-corrected transport algorithms for
/// fluids", 1979). Where a texel is NaN or infinite the interpolation stays linear.
class MovedRow {
 public:
  /// Every result lies by `share`, from 0 to 1, of a texel after the texel of its own number.
  MovedRow(int width, double share);

  double& texel(int column) noexcept { return texels_[static_cast<std::size_t>(column + kBorder)]; }

  /// Writes the results, `step` floats apart, once all texels are set.
  void write(float* results, int step) noexcept;

 private:
  static constexpr int kBorder = 2;  ///< texels before the first one; as many and one more follow the last

  void wrap() noexcept;
  void interpolate() noexcept;
  void limit() noexcept;

  int width_;
  double share_;
  std::vector<double> texels_;
  // Of place i at i + kBorder, from -kBorder to the width.
  std::vector<double> linear_;
  std::vector<double> flux_;  ///< into each place from the next one
  std::vector<double> rise_;  ///< the shares of what flows in
  std::vector<double> fall_;  ///< and out that keep the result within its range
};

}  // namespace welkin::image
