// Irradiance as a cubemap, for renderers that look it up instead of evaluating harmonics.
#pragma once

#include "welkin/control.h"
#include "welkin/export.h"
#include "welkin/image.h"
#include "welkin/image_view.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Irradiance (W/m2 where radiance is W/m2/sr; pi times it in a uniform environment) at each texel's centre, by the
/// sum of irradiance coefficients (of `irradiance_from_radiance`): `irradiance_cubemap(e, 64)`. SIMD; the same bits
/// everywhere. Throws `Error`: invalid_argument (size not in 1 to 4096), cancelled.
[[nodiscard]] CubemapImage irradiance_cubemap(const SphericalHarmonics& irradiance, int size,
                                              const Control& control = {});

/// The reference: direct cosine integration in double, as `direct_irradiance`, at each texel's centre. Cost: some 5 ns
/// a source texel, result texel and thread.
[[nodiscard]] CubemapImage direct_irradiance_cubemap(const CubemapView& source, int size, const Control& control = {});
[[nodiscard]] CubemapImage direct_irradiance_cubemap(const LatLongView& source, int size, const Control& control = {});

}  // namespace welkin
