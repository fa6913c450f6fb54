// How many harmonic bands a lobe takes, how its spectrum ends, and on how many rings a cubemap is read for it.
#pragma once

#include <vector>

namespace welkin::reflections {

/// Bounds on a mip's error.
struct ErrorBounds {
  double rms = 1e-3;      ///< root mean square error over the mip's root mean square
  double maximum = 1e-2;  ///< error at any texel over the value there

  /// Returns both bounds divided by 3^steps.
  [[nodiscard]] ErrorBounds tightened(int steps) const noexcept;
};

/// Fraction of a bound that bands may use. The rest is for lights, and texels that see less light than the sphere has.
inline constexpr double kOfBound = 0.8;

/// That fraction for lobes other than GGX, whose kinks leave more than ten times the root mean square at single texels.
inline constexpr double kOfLobeBound = 0.3;

inline constexpr int kBandStep = 8;       ///< bands are a multiple of it
inline constexpr int kMinLobeBands = 64;  ///< of lobes other than GGX

/// How often the bounds are tightened where an image's own energies exceed what most images have.
inline constexpr int kMaxTightenings = 2;

/// Returns 2 alpha bands, which decides the error of a lobe of any alpha, because its spectrum falls like exp(-2 alpha
/// l). The bounds hold for photographs, edges of any contrast, noise and stripes (docs/maths/reflections.md) whose
/// bright texels are extracted.
[[nodiscard]] double reach_within(const ErrorBounds& bounds) noexcept;

/// Returns bands, a multiple of 8: by reach, or more where the lobe is so wide that its kink at the horizon decides.
/// alpha in (0, 1].
[[nodiscard]] int bands_within(double alpha, const ErrorBounds& bounds) noexcept;

/// Returns the bands to begin with: by the kink no more than at the default bounds, which do for most images.
[[nodiscard]] int first_bands_within(double alpha, const ErrorBounds& bounds) noexcept;

/// Returns the minimum number of rings of latitude to read a cubemap on where `alpha` is that of the narrowest lobe.
[[nodiscard]] double rings_within(double alpha, const ErrorBounds& bounds) noexcept;

/// Returns the minimum number of texels along an edge of the faces that a cubemap's are halved to (`halved_faces`)
/// where `alpha` is that of the narrowest lobe and lobes with kinks take `bands`.
[[nodiscard]] double face_texels_within(double alpha, int bands, const ErrorBounds& bounds) noexcept;

/// The factors by which one mip's synthesis multiplies bands.
struct BandChoice {
  std::vector<double> zonal;  ///< one factor per band: the lobe's spectrum, tapered to nothing at the end

  [[nodiscard]] int bands() const noexcept { return static_cast<int>(zonal.size()); }
};

/// Returns the lobe's factors for `bands` bands.
[[nodiscard]] BandChoice tapered_lobe(double alpha, int bands);

/// Returns the bands that wide lobes take for an image with dark parts.
[[nodiscard]] int bands_for_dark(const ErrorBounds& bounds) noexcept;

/// Returns those of them to begin with, which most images with dark parts do with.
[[nodiscard]] int first_bands_for_dark(const ErrorBounds& bounds) noexcept;

/// Returns 1 up to the last fifth of the bands, then half a cosine down to 0. Without it every light would ring over
/// the whole sphere.
[[nodiscard]] double taper(int l, int bands) noexcept;

}  // namespace welkin::reflections
