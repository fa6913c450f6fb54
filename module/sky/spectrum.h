// Checks of lists of wavelengths, and the weights of wavelengths in a sky's three channels.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/sky.h"

namespace welkin::sky {

inline constexpr std::size_t kMaxWavelengths = 96;  ///< of an atmosphere

/// Throws `Error` (invalid_argument) unless there are 3 to 96, from 1 to 1e6 nm, all rising or all falling.
void check_wavelengths(const std::vector<double>& wavelengths_nm);

/// Returns weights that convert radiances (W/m2/sr/nm) at an atmosphere's wavelengths to linear sRGB luminance (cd/m2):
/// the sum of weights[i] times radiance i. The spectrum is linear between wavelengths and constant outside. Throws
/// `Error` (invalid_argument) for wavelengths that `check_wavelengths` refuses.
[[nodiscard]] std::vector<glm::dvec3> srgb_weights(const std::vector<double>& wavelengths_nm);

// The three channels of a computed sky: three wavelengths' own, or a spectrum folded to linear sRGB.

/// Returns weights of the wavelengths in the channels: `srgb_weights`, or, of `spectral` skies, 1 in each one's own.
[[nodiscard]] std::vector<glm::dvec3> channel_weights(const Atmosphere& atmosphere, SkyColour colour);

/// Weights of the wavelengths in the three channels.
class ColourFold {
 public:
  ColourFold(const Atmosphere& atmosphere, SkyColour colour);

  /// Sunlight above the air: W/m2/nm, or lux in linear sRGB. Not negative.
  [[nodiscard]] const glm::dvec3& sunlight() const noexcept { return sunlight_; }

  /// By channel the mean of something that each wavelength has (a transmittance, an albedo), as sunlight weighs it:
  /// sunlight() times it is what is left. Not below 0.
  [[nodiscard]] glm::dvec3 share(std::span<const double> values) const noexcept;

  /// g of the aerosol's lobe in each channel: that of its wavelength, or the mean of those folded to it, weighted by
  /// how much they scatter.
  [[nodiscard]] const std::array<double, 3>& asymmetries() const noexcept { return asymmetries_; }

 private:
  void set_asymmetries(const Atmosphere& atmosphere, SkyColour colour);

  std::vector<glm::dvec3> weights_;  ///< sunlight of each wavelength
  glm::dvec3 sunlight_{};
  std::array<double, 3> asymmetries_{};
};

}  // namespace welkin::sky
