// Light with a direction: what in an environment is best given to a directional light.
#pragma once

#include <cstdint>
#include <optional>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// The one directional light that comes closest to an environment of two bands or more.
struct DominantLight {
  dvec3 direction{};   ///< unit, towards the light
  dvec3 irradiance{};  ///< on a surface that faces it
};

/// Direction: that of the linear band's luminance (0.2126, 0.7152, 0.0722), the mean direction of the light. Colour, by
/// channel: the least-squares fit of a directional light's coefficients from there to bands 1 and 2 (band 0 has the
/// ambient light in it; bands above the third are left out, so that it does not matter how many there are), not below
/// zero (after Sloan 2008, "Stupid Spherical Harmonics Tricks", section "Extracting a directional light"). A constant
/// and a directional light come back exactly. None if the linear band has no direction: if its luminance is below
/// 1e-6 of band 0's (a projection's rounding leaves 1e-7), not finite, or there is one band only.
[[nodiscard]] std::optional<DominantLight> dominant_light(const SphericalHarmonics& radiance);

/// What counts as a sun: a spot that is far brighter than the map, small, and a good part of the map's light. All
/// three are needed; the defaults are chosen on photographs (docs/notes/measurements.md), where suns are 0.3 to 1.8
/// degrees in radius and 2 to 77 % of the light, and lamps, windows and clouds fail by size or by share. A spotlight
/// that is as small and strong as a sun is taken for one: nothing in a map tells them apart.
struct SunOptions {
  /// Texels of at least this share of the brightest one's luminance that are joined to it are the spot; above 0 to 1.
  /// What is fainter, the glow, stays in the map. A clipped sun before bright clouds wants more, 0.5 perhaps.
  double relative_threshold = 0.02;

  /// If one of them lies farther than this from the centre of the spot's light, 0 to 90 degrees, the spot is too large
  /// for a light without extent, and there is no sun. Neighbours of the brightest texel count as near, however coarse
  /// the map is.
  double maximum_radius_degrees = 3.0;

  /// There is no sun if the brightest luminance is less than this times the map's mean; at least 1. It matters in
  /// coarse maps, where a neighbourhood is no longer small: below some 20 texels no map has a sun.
  double minimum_contrast = 20.0;

  /// There is no sun if the spot has less than this share of the map's luminance, 0 to 1: taking it out would help
  /// nobody. (Unlike contrast the share does not depend on the map's resolution.)
  double minimum_share = 0.01;
};

/// A sun that was taken out of an environment.
struct Sun {
  dvec3 direction{};         ///< unit, towards the centre of its light: mean over its texels' areas, by luminance
  dvec3 irradiance{};        ///< of the directional light: what was taken out, integral of (L - what was left) dw
  dvec3 radiance{};          ///< its mean: irradiance / solid angle
  double solid_angle = 0.0;  ///< of the texels of the spot, steradians
  double angular_radius_degrees = 0.0;  ///< of a disc with that solid angle
  std::uint64_t texels = 0;             ///< that were changed: of the spot and of its rim
  dvec3 total_radiance_before{};        ///< of the map, integral over the sphere
  dvec3 total_radiance_after{};         ///< of the map without its sun; before = after + irradiance, to 1e-6
};

/// Finds the sun and takes it out, in place: the spot's texels and those that touch it, which its edge covers in part,
/// become the radiance around them, the median channel by channel of the next two rings of texels, unless
/// they were darker. None, and nothing changed, if there is no sun by the options. Of several the brightest is taken;
/// another call takes the next. `pixels` are RGB floats in Welkin's axes.
///
/// An engine adds the sun back as a directional light that makes `irradiance` on a surface which faces it; so the total
/// radiance is the map's again. The sun itself, a disc of angular radius a, makes (1 + cos a) / 2 of that, as not all
/// of it is straight ahead: 2e-5 less for half a degree, 7e-4 for three. In bands: band l of a spot with mean squared
/// radius r^2 (radians) is smaller than the light's by the factor 1 - l(l+1) r^2 / 4, which for a disc of half a degree
/// takes 6e-5 from band 2.
///
/// A texel with a channel that is NaN or infinite is left alone, is nobody's neighbour, and is in no sum: replace a
/// sun that overflowed (65504 is the largest half) before. Negatives are kept; they are never made brighter.
///
/// Cost: reads the map once, in the arena, and once more its part with the spot; takes a bit of memory a texel.
/// The same bits for any number of threads and on every machine.
/// Throws `Error` (invalid_argument) for options out of range and for pixels that do not fit the size.
[[nodiscard]] std::optional<Sun> take_out_sun(LatLongImage& image, const SunOptions& options = {});
[[nodiscard]] std::optional<Sun> take_out_sun(CubemapImage& image, const SunOptions& options = {});

/// The coefficients of a sun's light, to be added to those of its map: a uniform disc of its solid angle that holds its
/// irradiance (radiance times solid angle), in closed form; with solid angle 0 a light from one direction. `radiance`,
/// `angular_radius_degrees` and the total radiances are not read. Relative error below 1e-13 from a point to the whole
/// sphere. Throws `Error` (invalid_argument) for a direction without length, a solid angle outside 0 to 4 pi, or a
/// wrong number of bands.
[[nodiscard]] SphericalHarmonics sun_harmonics(const Sun& sun, int bands);

}  // namespace welkin
