// Tools of the cases: small environments, errors of results against their references, and skies at hard directions.
#pragma once

#include "standard_headers.h"
#include "support/coefficients.h"
#include "support/sun_maps.h"
#include "support/values_of.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test::stability {

/// Returns a pseudo-random integer by seed and index (a finalizer like that of murmur3).
[[nodiscard]] std::uint32_t hashed(std::uint32_t seed, std::uint32_t index) noexcept;
/// Returns a pseudo-random number in [0, 1), exact in float.
[[nodiscard]] float noise(std::uint32_t seed, std::uint32_t index) noexcept;

[[nodiscard]] Cubemap noise_cube(int size, std::uint32_t seed);
[[nodiscard]] LatLongImage noise_lat_long(int width, int height, std::uint32_t seed);

/// Returns the image with all channels of one texel (counted from the first face's first) set.
template <class Image>
[[nodiscard]] Image with_texel(Image image, std::size_t texel, float value) {
  for (std::size_t c = 0; c < 3; ++c) test::values_of(image)[3 * texel + c] = value;
  return image;
}

/// Returns an image of +amplitude and -amplitude in alternation along rows and columns.
[[nodiscard]] Cubemap checkerboard_cube(int size, float amplitude);
[[nodiscard]] LatLongImage checkerboard_lat_long(int width, int height, float amplitude);

/// Returns an image that is 1 above the horizon and 0 below. `size` is even.
[[nodiscard]] Cubemap upper_half_cube(int size);
[[nodiscard]] LatLongImage upper_half_lat_long(int width, int height);

using test::relative_error;  // of coefficients

/// Returns `|found - truth| / |truth|`: 0 if equal, infinity where only `truth` is 0 or where `found` is NaN.
[[nodiscard]] double relative_error(double found, double truth);
[[nodiscard]] double relative_error(const glm::dvec3& found, const glm::dvec3& truth);

/// Returns the error in units in the last place of the float nearest to `truth` (the largest float, if beyond them).
[[nodiscard]] double float_ulps(double found, double truth);

/// Returns the root of the sum of squared differences over that of the squared references.
[[nodiscard]] double rms_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth);

/// Returns the larger one, or infinity if either is NaN.
[[nodiscard]] double worse(double a, double b) noexcept;

/// Returns 1 if `wrong`, else 0.
[[nodiscard]] inline double wrong_if(bool wrong) noexcept { return wrong ? 1.0 : 0.0; }

/// Returns how many values are negative or not finite.
[[nodiscard]] double unsound(std::span<const float> values) noexcept;

/// Returns 0 if `call` throws an `Error` of that code, else 1.
[[nodiscard]] double wrong_unless_thrown(ErrorCode code, const std::function<void()>& call);

/// Returns directions evenly over the sphere: a Fibonacci spiral.
[[nodiscard]] std::vector<glm::dvec3> spread_directions(int count);

/// Returns the texels of a mip in memory order.
[[nodiscard]] std::vector<glm::dvec3> texels(const Cubemap& chain, int level);

/// Returns the largest relative error of any channel (infinity where only the reference is 0).
[[nodiscard]] double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth);

/// Returns the Earth with all scattering and absorption times a factor.
[[nodiscard]] Atmosphere dense_earth(double factor);

/// Returns a planet with Rayleigh scattering only: optical depth 0.1 from the ground up at the middle wavelength.
[[nodiscard]] Atmosphere plain_planet(double radius_m, double thickness_m, double scale_height_m);

/// Returns options of one order and few heights, else of the default sizes.
[[nodiscard]] SkyTableOptions single_order();

/// Returns the Earth's tables by these options, computed once per program.
[[nodiscard]] const std::shared_ptr<const SkyTables>& earth_tables();

/// Returns directions from the zenith to the nadir, close to the horizon on both sides, at three azimuths; from space,
/// across the planet and through its limb.
[[nodiscard]] std::vector<glm::dvec3> hard_directions(const Atmosphere& atmosphere, double altitude_m);

/// Returns the root mean square of the view's error over directions, divided by that of the reference's single
/// scattering. The view must have one order and no ground.
[[nodiscard]] double radiance_error(const SkyView& view, const std::vector<glm::dvec3>& directions,
                                    double sun_elevation_degrees);

/// Returns that error of an atmosphere's view at `hard_directions`.
[[nodiscard]] double sky_error(const Atmosphere& atmosphere, double altitude_m, double sun_elevation_degrees,
                               const SkyTableOptions& options = single_order());

/// Returns how many values of all tables are negative or not finite.
[[nodiscard]] double unsound_values(const SkyTables& tables);

}  // namespace welkin::test::stability
