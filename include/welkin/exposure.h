// The exposure at which a light suits a screen: the factor that radiance is multiplied by before a tone curve.
//
//   const double exposure = welkin::exposure_of(projection.radiance);
//   colour = tone_map(exposure * radiance);
//
// Environments come in whatever unit their file has: W/(m2 sr nm) of a computed sky, "1 is white" of a photograph.
#pragma once

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Returns the exposure that takes the mean radiance to middle grey: 0.18 over its luminance (Rec. 709). Reads band 0
/// of radiance coefficients alone. Returns 1 if the mean is not above 0, or so small or large that no double holds the
/// result.
[[nodiscard]] double exposure_of(const SphericalHarmonics& radiance);

/// Returns the exposure of `welkin bake`'s previews. It takes the 75th percentile of the lit texels' luminance, by
/// solid angle, to 0.36, a stop above middle grey. Lit texels are those of at least 1/32 of the mean, for which
/// luminance above its 99th percentile counts as that percentile: neither the black around a studio's lamps nor a sun
/// changes the result. NaN and values below 0 count as black. Returns 1 if there is no light. Sorts the texels, with 16
/// bytes of memory per texel; a mip of 32 texels per edge gives nearly the same. Throws `Error` (invalid_argument) for
/// a view that is not valid.
[[nodiscard]] double exposure_of(const CubemapView& picture);
/// Returns the same for a lat-long.
[[nodiscard]] double exposure_of(const LatLongView& picture);

}  // namespace welkin
