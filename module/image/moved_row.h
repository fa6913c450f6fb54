// A row of a lat-long that is moved along itself by a fraction of a texel.
#pragma once

#include <cstddef>
#include <vector>

namespace welkin::image {

/// One channel of a row. Linear interpolation keeps the row's sum and every range, but blurs. Cubic convolution
/// (Catmull-Rom) adds a flux between neighbours, p (a - b) + q (b - c) from texel b to a, which keeps the sum as well.
/// Each flux is limited so that every result stays between the minimum and the maximum of the four texels around its
/// position (S. T. Zalesak, "Fully multidimensional flux-corrected transport algorithms for fluids", 1979). Where a
/// texel is NaN or infinite the interpolation remains linear.
class MovedRow {
 public:
  /// Result i lies `share` of a texel, from 0 to 1, after texel i.
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
  // Texel i is at i + kBorder, from -kBorder to the width.
  std::vector<double> linear_;
  std::vector<double> flux_;  ///< into each texel from the next one
  std::vector<double> rise_;  ///< the shares of what flows in
  std::vector<double> fall_;  ///< and out that keep the result within its range
};

}  // namespace welkin::image
