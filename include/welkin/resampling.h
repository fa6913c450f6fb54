// One environment in memory to another of a different shape, size or orientation.
#pragma once

#include <glm/mat3x3.hpp>

#include "welkin/control.h"
#include "welkin/image.h"

namespace welkin {

/// Turning, mirroring and resampling.
///
/// `turn` is an orthogonal matrix (a rotation, or a rotation and a mirror): what lies in direction d of the source
/// lies in direction turn * d of the result. Where shape and size stay and the turn takes texels to texels (any of a
/// cube's 48 symmetries; for a lat-long a mirror in x or y, in z if the width is even, or a turn about y by whole
/// texels), every texel is moved as it is, bit for bit.
///
/// Else each texel of the result is the mean, by solid angle, of the source's bilinear interpolation over the texel's
/// area, at evenly spaced samples. Along either edge these are the source's texels a radian where they lie closest
/// (cube: size; lat-long: width / 2 pi or height / pi, the larger) over the result's where they lie widest apart (cube:
/// size / 2; lat-long: width / 2 pi across, height / pi down), rounded up, and at least 2. So no texel of the source is
/// passed over, and flux is kept to the error of the interpolation; but not close to the poles of a lat-long source.
/// Its texels there are narrower than samples lie apart, and one that differs much from its row may count many times or
/// not at all (from 256 x 128 to 16 x 16 x 6 in the first row 0 to 26 times, in the fifth 0.2 to 4 times).
///
/// Faces are interpolated across their edges, a lat-long across its poles and its seam; NaN and infinities spread to
/// the texels that they touch. Cost: some 20 ns a sample and thread from a cubemap, 60 ns from a lat-long. The same
/// bits on any number of threads. Throws `Error`: invalid_argument (views, sizes, a matrix that is off orthogonal by
/// more than 1e-6), cancelled.
[[nodiscard]] CubemapImage to_cubemap(const CubemapView& source, int size, const glm::dmat3& turn = glm::dmat3(1.0),
                                      const Control& control = {});
[[nodiscard]] CubemapImage to_cubemap(const LatLongView& source, int size, const glm::dmat3& turn = glm::dmat3(1.0),
                                      const Control& control = {});
[[nodiscard]] LatLongImage to_lat_long(const CubemapView& source, int width, int height,
                                       const glm::dmat3& turn = glm::dmat3(1.0), const Control& control = {});
[[nodiscard]] LatLongImage to_lat_long(const LatLongView& source, int width, int height,
                                       const glm::dmat3& turn = glm::dmat3(1.0), const Control& control = {});

/// A turn about y, from +z towards +x: what lies in the middle of a lat-long moves to the left. The same bits
/// everywhere, exact at multiples of 90 degrees. Throws `Error` (invalid_argument) unless |degrees| <= 1e6.
[[nodiscard]] glm::dmat3 turn_about_y(double degrees);

}  // namespace welkin
