// Windows against ringing: light that a few bands make negative.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "welkin/export.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// By what band l is multiplied. `width` is in bands.
enum class Window {
  none,
  hanning,        ///< (1 + cos(pi l / width)) / 2, 0 from l = width on
  lanczos,        ///< sin(x) / x with x = pi l / width, 0 from l = width on
  min_laplacian,  ///< 1 / (1 + lambda l^2 (l + 1)^2), with the smallest lambda that leaves no irradiance negative
};

/// "none", "hanning", "lanczos", "min-laplacian"
[[nodiscard]] const char* name(Window window) noexcept;

/// The smallest value of a function over the sphere, by channel, and where it is.
struct HarmonicMinimum {
  glm::dvec3 value{};         ///< irradiance there, each channel at its own direction
  glm::dvec3 direction[3]{};  ///< unit, by channel; one of them where several are equal
};

/// On a grid finer than the highest band (8 points to each half wave of it) and refined by Newton steps. Error of a
/// value: below 1e-12 of the largest coefficient. The same bits everywhere. A channel with a coefficient that is not
/// finite has the minimum NaN. Cost: some 50 microseconds for three bands, some milliseconds for 16; ten times as much
/// where the lowest places are a ring, as around a lone light.
[[nodiscard]] HarmonicMinimum minimum(const SphericalHarmonics& harmonics);

/// Windowed coefficients, and what the window did.
struct Windowed {
  SphericalHarmonics radiance;  ///< the windowed coefficients
  double parameter = 0.0;  ///< hanning, lanczos: the width in bands; min_laplacian: lambda (0 if nothing was needed)
  glm::dvec3 minimum_before{};  ///< of the irradiance over all normals
  glm::dvec3 minimum_after{};   ///< the least irradiance after it, each channel
  std::vector<double> factors;  ///< by band
};

/// Multiplies each band of radiance by the window's factor. `width`: of Hanning and Lanczos in bands, 0: the number of
/// bands; the others take no notice of it. Band 0 and so the mean radiance never change.
///
/// `min_laplacian` (Sloan 2008, "Stupid Spherical Harmonics Tricks", and 2017, "Deringing Spherical Harmonics"; the
/// window of least squared Laplacian): no channel's irradiance is below -1e-9 of its mean anywhere, and with any
/// smaller lambda some channel's would be (but for that tolerance). One lambda for all channels, so that colours keep
/// their balance. It is 0 if nothing is negative. It does not depend on how the light is turned.
///
/// Throws `Error` (invalid_argument) for a width that is negative or not finite; for `min_laplacian`, if a coefficient
/// is not finite, or if a channel's band 0 is not positive although some of the channel's irradiance is negative: no
/// window helps there.
[[nodiscard]] Windowed apply_window(const SphericalHarmonics& radiance, Window window, double width = 0.0);

}  // namespace welkin
