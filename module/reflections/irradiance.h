// Irradiance as a cubemap: a picture blurred by the Lambert lobe, to a bound.
#pragma once

#include <cstddef>

#include "projection/sanitized_pixels.h"
#include "reflections/bright_lights.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// Of the GGX lobe that texels are compared through: from 25 times the mean on they are lights.
inline constexpr double kIrradianceLightAlpha = 0.1;

/// What a bound asks for.
struct IrradiancePlan {
  int bands = 0;  ///< of the harmonics; 0: more would be needed than is worth while, so the integral itself is taken
  int face_size = 0;  ///< of a cubemap: texels along an edge of the faces, its own or reduced, that they are found from
  double reach = 0.0;  ///< of lights, see `reach_for`
  int rings = 0;       ///< of a cubemap: rows of the lat-long that it goes through
};
[[nodiscard]] IrradiancePlan plan_irradiance(const PictureShape& source, double rms_error);

/// Throws `Error` (invalid_argument) unless `rms_error` is from 1e-6 to 1.
void check_irradiance_error(double rms_error);

/// Returns irradiance (W/m2 where radiance is W/m2/sr) at each texel's centre within `rms_error` rms and ten times that
/// at any texel: bright texels each by the clipped cosine, the rest by harmonics. Not negative where the source is not.
/// Values beyond the floats become the largest float. The same bits on any number of threads and instruction set. Cost:
/// one reading of the source, and below 10 ns per texel of the result; 5 ns per texel of the source and of the result
/// where bounds are so narrow that the integral itself is taken. Throws `Error` (cancelled).
[[nodiscard]] CubemapImage irradiance_cubemap(const projection::SanitizedSource& source, int size, double rms_error,
                                              const Control& control);

}  // namespace welkin::reflections
