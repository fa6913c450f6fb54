// From rings of latitude to the faces of a cube.
#pragma once

#include <array>

#include "image/sphere_grid.h"
#include "welkin/control.h"

namespace welkin::image {

struct GridSampling {
  bool not_negative = false;  ///< values below 0 become 0
};

/// Writes the grid's function at the centre of every texel of six faces of `size` x `size` RGB floats, packed, in the
/// frames of `CubemapView`: by the cubic B-spline if the grid holds coefficients, else by bilinear interpolation of its
/// samples (which reads the same 4 x 4 texels). The border must be filled; 1 <= size <= 16384.
///
/// Places are exact to 1e-9 texels of the grid, results to 4e-7 of the sum of |weight x texel|; if all texels are
/// equal, each result is off by at most 3e-7 of them. A quarter turn of a grid whose columns divide by four permutes
/// the faces bit for bit (but for a texel whose centre is the pole, which is given the longitude 0). The same bits on
/// any number of threads and instruction set. Throws `Error` (cancelled).
void sample_faces(const SphereGrid& grid, int size, const std::array<float*, 6>& faces, const GridSampling& sampling,
                  const Control& control);

}  // namespace welkin::image
