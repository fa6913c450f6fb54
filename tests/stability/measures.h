// What the cases share: small environments, how far a result is from its truth, skies where they are hard.
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

/// Whole numbers that look random: the same for the same seed and index (a finaliser in the manner of murmur3).
[[nodiscard]] std::uint32_t hashed(std::uint32_t seed, std::uint32_t index) noexcept;
/// In [0, 1), exact in float.
[[nodiscard]] float noise(std::uint32_t seed, std::uint32_t index) noexcept;

[[nodiscard]] Cubemap noise_cube(int size, std::uint32_t seed);
[[nodiscard]] LatLongImage noise_lat_long(int width, int height, std::uint32_t seed);

/// The same with all channels of one texel (counted from the first face's first) set.
template <class Image>
[[nodiscard]] Image with_texel(Image image, std::size_t texel, float value) {
  for (std::size_t c = 0; c < 3; ++c) test::values_of(image)[3 * texel + c] = value;
  return image;
}

/// +size and -size by turns along rows and columns.
[[nodiscard]] Cubemap checkerboard_cube(int size, float amplitude);
[[nodiscard]] LatLongImage checkerboard_lat_long(int width, int height, float amplitude);

/// 1 above the horizon, 0 below. `size` even.
[[nodiscard]] Cubemap upper_half_cube(int size);
[[nodiscard]] LatLongImage upper_half_lat_long(int width, int height);

using test::relative_error;  // of coefficients

/// |found - truth| / |truth|; 0 if equal, infinity where the truth alone is 0 or the found value no number.
[[nodiscard]] double relative_error(double found, double truth);
[[nodiscard]] double relative_error(const glm::dvec3& found, const glm::dvec3& truth);

/// Error in units of the last place of the float nearest to the truth (of the largest one, where that is beyond them).
[[nodiscard]] double float_ulps(double found, double truth);

/// Root of the sum of squared differences over that of the squared truths.
[[nodiscard]] double rms_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth);

/// The larger one; infinity as soon as one of them is no number.
[[nodiscard]] double worse(double a, double b) noexcept;

/// 1 where something is wrong.
[[nodiscard]] inline double wrong_if(bool wrong) noexcept { return wrong ? 1.0 : 0.0; }

/// How many of these are negative or not finite.
[[nodiscard]] double unsound(std::span<const float> values) noexcept;

/// 0 if `call` throws an `Error` of that code, else 1.
[[nodiscard]] double wrong_unless_thrown(ErrorCode code, const std::function<void()>& call);

/// Evenly over the sphere: a Fibonacci spiral.
[[nodiscard]] std::vector<glm::dvec3> spread_directions(int count);

/// The texels of a level in the order of its memory.
[[nodiscard]] std::vector<glm::dvec3> texels(const Cubemap& chain, int level);

/// Where the truth is above 0: the largest relative error of any channel.
[[nodiscard]] double worst_relative_error(std::span<const glm::dvec3> found, std::span<const glm::dvec3> truth);

/// Earth with all scattering and absorption times a factor.
[[nodiscard]] Atmosphere dense_earth(double factor);

/// A planet with nothing but Rayleigh's air: optical depth 0.1 from the ground up at the middle wavelength.
[[nodiscard]] Atmosphere plain_planet(double radius_m, double thickness_m, double scale_height_m);

/// One order, few heights, else the default sizes.
[[nodiscard]] SkyTableOptions single_order();

/// Earth by these, made once a program.
[[nodiscard]] const std::shared_ptr<const SkyTables>& earth_tables();

/// From the zenith to the nadir, close to the horizon from both sides, at three azimuths; from space across the planet
/// and through its limb.
[[nodiscard]] std::vector<glm::dvec3> hard_directions(const Atmosphere& atmosphere, double altitude_m);

/// Root mean square of the view's error over that of the reference's single scattering, over directions. The view must
/// be of one order and without ground.
[[nodiscard]] double radiance_error(const SkyView& view, const std::vector<glm::dvec3>& directions,
                                    double sun_elevation_degrees);

/// The same for an atmosphere's own view at `hard_directions`.
[[nodiscard]] double sky_error(const Atmosphere& atmosphere, double altitude_m, double sun_elevation_degrees,
                               const SkyTableOptions& options = single_order());

/// How many values of all tables are negative or not finite.
[[nodiscard]] double unsound_values(const SkyTables& tables);

}  // namespace welkin::test::stability
