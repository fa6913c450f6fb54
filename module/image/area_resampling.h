// Light moved from a lat-long's texels to a cube's, and back, by the area that they have in common.
#pragma once

#include <array>
#include <cstddef>

#include "platform/memory.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

/// Writes six faces of `size` x `size` RGB floats, packed, in the frames of `CubemapView`: `to_cubemap` by
/// ResampleFilter::area, without a turn. The view and the size are checked already. The first call for sizes costs a
/// few times as much as those that follow, for which weights are kept (TileWeightTable). Throws `Error` (cancelled).
void fill_cubemap_by_area(const LatLongView& source, int size, const std::array<float*, 6>& faces,
                          const Control& control);

/// Writes width x height RGB floats, packed: each texel is the mean of the cube's texels, taken as areas of one value
/// each, over its own area (edges in steps as CubeTiling has them). Every texel of the cube keeps its total radiance to
/// rounding, and so does a uniform cube its value to 2e-7: what the prefilter's transform wants, and not smooth where
/// the lat-long is finer than the cube. Takes 24 bytes a texel of the result. The view and the sizes are checked
/// already. The same bits on any number of threads. Throws `Error` (cancelled).
void fill_lat_long_by_area(const CubemapView& source, int width, int height, float* rgb, const Control& control);

// A lat-long as texels of four floats, going on round the seam.

/// Red, green, blue and 0 for each texel, and `border` more texels at both ends of each row: those round the seam.
class PaddedPicture {
 public:
  PaddedPicture(const LatLongView& source, int border, const Control& control);

  [[nodiscard]] const float* texel(int column, int row) const noexcept {
    return values_.data() + row * stride() + std::ptrdiff_t{4} * (column + border_);
  }
  /// Floats from a row to the next.
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return std::ptrdiff_t{4} * (width_ + 2 * border_); }

 private:
  int width_;
  int border_;
  platform::AlignedBuffer<float> values_;
};

}  // namespace welkin::image
