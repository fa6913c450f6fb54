// Irradiance at surfaces: by direct integration, which is the truth that a few bands are measured against, and as a
// cubemap.
//
//   welkin::dvec3 ground = welkin::direct_irradiance(cubemap, {0.0, 1.0, 0.0});
//   welkin::CubemapImage lookup = welkin::irradiance_cubemap(welkin::irradiance_from_radiance(light.radiance), 64);
#pragma once

#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

// ---- Direct integration

/// Irradiance by direct cosine integration, in double: the sum over all texels of radiance times the texel's integral
/// of max(0, normal . direction). W/m2 where radiance is W/m2/sr.
///
/// Texels are areas. One that lies wholly on one side of the horizon is integrated in closed form; of one that the
/// horizon cuts, what lies above it is integrated by Gauss rules. Relative error: below 1e-8 at every size.
///
/// `pixels` acts as in `project`; pixels that are not valid RGB floats already are copied. Cost per texel, normal and
/// thread: 6 ns for maps of 1024 x 512, 12 ns for 256 x 128, where the horizon cuts a larger share of the texels, and
/// 60 ns for 64 x 32. The same bits on any number of threads.
/// Throws `Error`: invalid_argument (view, policy, normals, none or more than 100 000 of them), rejected_pixel,
/// cancelled.
[[nodiscard]] std::vector<dvec3> direct_irradiance(const CubemapView& cubemap, std::span<const dvec3> normals,
                                                   const PixelPolicy& pixels = {}, const Control& control = {});
[[nodiscard]] std::vector<dvec3> direct_irradiance(const LatLongView& lat_long, std::span<const dvec3> normals,
                                                   const PixelPolicy& pixels = {}, const Control& control = {});

/// The same for one normal, with the default policy for pixels.
[[nodiscard]] dvec3 direct_irradiance(const CubemapView& cubemap, const dvec3& normal);
[[nodiscard]] dvec3 direct_irradiance(const LatLongView& lat_long, const dvec3& normal);

/// How far the irradiance of the first `bands` bands is from the direct one, over normals that cover the sphere evenly.
/// Differences are lengths |E_sh - E| over the three channels.
struct IrradianceError {
  int bands = 0;          ///< how many bands the irradiance was taken from
  double rms = 0.0;       ///< root mean square of the difference over that of |E|: 0.01 is 1 %
  double maximum = 0.0;   ///< largest difference over the root mean square of |E|
  double relative = 0.0;  ///< largest difference over |E| at the same normal: on the dark side, as a rule
  dvec3 worst_normal{};   ///< where the largest difference is
};

/// One entry for each number of bands from 1 to radiance.bands(). `radiance`: coefficients of the same environment,
/// from `project` as a rule; windowed ones show what the window costs. `normals`: how many, 1 to 100 000, on a
/// Fibonacci spiral. Where an environment has no light at all, the errors are 0 if the coefficients have none either,
/// else infinite. Cost, bits and errors as of `direct_irradiance`.
[[nodiscard]] std::vector<IrradianceError> irradiance_errors(const CubemapView& cubemap,
                                                             const SphericalHarmonics& radiance, int normals = 500,
                                                             const PixelPolicy& pixels = {},
                                                             const Control& control = {});
[[nodiscard]] std::vector<IrradianceError> irradiance_errors(const LatLongView& lat_long,
                                                             const SphericalHarmonics& radiance, int normals = 500,
                                                             const PixelPolicy& pixels = {},
                                                             const Control& control = {});

// ---- Irradiance as a cubemap, for renderers that look it up instead of evaluating harmonics

/// Irradiance (W/m2 where radiance is W/m2/sr; pi times it in a uniform environment) at each texel's centre, by the
/// sum of irradiance coefficients (of `irradiance_from_radiance`): `irradiance_cubemap(e, 64)`. Values beyond the
/// floats (pi times a radiance of 3e38) become the largest float. SIMD; the same bits everywhere. Throws `Error`:
/// invalid_argument (size not in 1 to 4096), cancelled.
[[nodiscard]] CubemapImage irradiance_cubemap(const SphericalHarmonics& irradiance, int size,
                                              const Control& control = {});

/// The reference: direct cosine integration in double, as `direct_irradiance`, at each texel's centre. Cost: some 6 ns
/// a source texel, result texel and thread.
[[nodiscard]] CubemapImage direct_irradiance_cubemap(const CubemapView& source, int size, const Control& control = {});
[[nodiscard]] CubemapImage direct_irradiance_cubemap(const LatLongView& source, int size, const Control& control = {});

}  // namespace welkin
