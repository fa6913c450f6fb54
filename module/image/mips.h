// A face of odd size to one of half the size: texels are cut.
#pragma once

#include <array>
#include <vector>

#include "welkin/resampling.h"

namespace welkin::image {

/// Which texels of a face of `size` = 2 m + 1 texels along an edge lie under a row of the m x m below, and with which
/// part of that texel: a texel below covers size / m = 2 + 1 / m texels either way, so part of at most 3 x 3.
class OddMipRow {
 public:
  /// size >= 3.
  OddMipRow(int size, MipFilter filter);

  /// Goes to row `row` of the smaller face.
  void place(int row) noexcept;

  /// The row's texels: rgb[3 m] from a packed face.
  void reduce(const float* face, float* rgb) const noexcept;

 private:
  int size_;
  int row_ = 0;
  MipFilter filter_;
  std::vector<std::array<double, 9>> parts_;  ///< [m]: by rows; they add up to 1
};

}  // namespace welkin::image
