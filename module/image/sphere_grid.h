// A function on the sphere, held on rings of equal latitude: what the transform gives and faces are sampled from.
#pragma once

#include <array>
#include <cstddef>

#include "platform/memory.h"
#include "welkin/core.h"

namespace welkin::image {

/// The meaning of a grid's numbers.
enum class GridContent {
  samples,              ///< the function at the texels' centres
  spline_coefficients,  ///< of the cubic B-spline, in both directions, that takes the function's values there
};

/// `rings` x `columns` texels of four floats (red, green, blue, unused) laid out as `LatLongView` has them: texel
/// (i, j)'s centre is at colatitude pi (j + 1/2) / rings and longitude pi - 2 pi (i + 1/2) / columns. Beyond every edge
/// lie kBorder more texels, copies of what lies there on the sphere: across the seam, and across a pole (the ring of
/// the same distance on its other side, 180 degrees on; where `columns` is odd that lies between two texels, and their
/// mean is taken).
class SphereGrid {
 public:
  static constexpr int kBorder = 4;

  SphereGrid() = default;
  SphereGrid(int rings, int columns, GridContent content)
      : rings_(rings),
        columns_(columns),
        content_(content),
        values_(static_cast<std::size_t>(rings + 2 * kBorder) * static_cast<std::size_t>(columns + 2 * kBorder) * 4) {}

  [[nodiscard]] int rings() const noexcept { return rings_; }
  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] GridContent content() const noexcept { return content_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return values_.bytes(); }

  /// Floats from a ring to the next.
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return std::ptrdiff_t{4} * (columns_ + 2 * kBorder); }

  /// Texel (column, ring), each from -kBorder to its number + kBorder - 1.
  [[nodiscard]] float* texel(int column, int ring) noexcept {
    return values_.data() + (ring + kBorder) * stride() + std::ptrdiff_t{4} * (column + kBorder);
  }
  [[nodiscard]] const float* texel(int column, int ring) const noexcept {
    return values_.data() + (ring + kBorder) * stride() + std::ptrdiff_t{4} * (column + kBorder);
  }

  /// Copies the border of `count` rings from `first` on to the left and right.
  void fill_sides(int first, int count) noexcept;
  /// Copies the rings beyond both poles; the sides of the rings must be filled.
  void fill_poles() noexcept;

 private:
  int rings_ = 0;
  int columns_ = 0;
  GridContent content_ = GridContent::samples;
  platform::AlignedBuffer<float> values_;
};

// From rings of latitude to the faces of a cube.

struct GridSampling {
  bool not_negative = false;  ///< values below 0 become 0
};

/// Writes the grid's function at the centre of every texel of six faces of `size` x `size` RGB floats, packed, in the
/// frames of `CubemapView`: by the cubic B-spline if the grid holds coefficients, else by bilinear interpolation of its
/// samples (which reads the same 4 x 4 texels). The border must be filled; 1 <= size <= 16384.
///
/// Positions are exact to 1e-9 texels of the grid, results to 4e-7 of the sum of |weight x texel|; if all texels are
/// equal, each result is off by at most 3e-7 of them. A quarter turn of a grid whose columns divide by four permutes
/// the faces bit for bit (but for a texel whose centre is the pole, which is given the longitude 0). The same bits on
/// any number of threads and instruction set. Throws `Error` (cancelled).
void sample_faces(const SphereGrid& grid, int size, const std::array<float*, 6>& faces, const GridSampling& sampling,
                  const Control& control);

}  // namespace welkin::image
