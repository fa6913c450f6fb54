// A computed sky as spherical harmonics: by quadrature, or along a curve over the sun's elevation that is baked once.
//
//   welkin::SkyCurve curve(view);                                          // milliseconds, once a height
//   welkin::SphericalHarmonics light = curve.at(welkin::sun_direction(20.0, 145.0));  // each frame
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>

#include "welkin/control.h"
#include "welkin/export.h"
#include "welkin/sky_view.h"
#include "welkin/spherical_harmonics.h"

namespace WELKIN_EXPORT welkin {

/// Directions and weights. A sky is mirror-symmetric about the sun's vertical plane, so all of them look at half the
/// azimuths only, and no coefficient that is odd in the azimuth from the sun is computed.
enum class SkyQuadrature {
  /// Uniform in angles, weighted by solid angle: 16 zenith angles x 32 azimuths (16 looked at) are the article's
  uniform,
  /// Gauss-Legendre in t, cosine = horizon +- t^2, on either side of the horizon, times a trapezoid in azimuth
  gauss,
  /// The same zenith angles, azimuths closer together about the sun (tan(azimuth / 2) = A tan(t / 2), trapezoid in t),
  /// and the aerosol's forward lobe, times what it has to scatter at the sun, taken out of the sky and given back by
  /// its own spectrum in closed form
  gauss_split,
};

/// "uniform", "gauss", "gauss-split"
[[nodiscard]] const char* name(SkyQuadrature quadrature) noexcept;

/// How a sky is projected.
struct SkyHarmonicsOptions {
  int bands = 3;                                          ///< 1 to kMaximumBands
  SkyQuadrature quadrature = SkyQuadrature::gauss_split;  ///< where directions are taken
  int zeniths = 16;   ///< Gauss nodes on either side of the horizon; uniform: over both. 2 to 128
  int azimuths = 16;  ///< over half the circle, mirrored: 2 to 256

  friend bool operator==(const SkyHarmonicsOptions&, const SkyHarmonicsOptions&) = default;
};

/// A quadrature made ready for a view: what does not depend on the sun is computed here. Immutable: any number of
/// threads may ask at once.
///
/// Error of the nine coefficients of Bruneton's Earth at the default setting, against the converged integral of the
/// same view, on the ground: 2.1e-4 from 90 to -6 degrees, 3e-3 at -10; the article's directions: 2e-2 to 1.3e-1. At
/// 10 km 2.2e-3, at 50 km 6.4e-3 (both at -6). Sharper lobes: 5e-3 at g = 0.95; at 0.99 up to 7e-2 while the sun
/// crosses the horizon. Outside of the atmosphere the lobe is not taken out, and an update costs some 50 times more.
class SkyProjector {
 public:
  /// Throws `Error`: invalid_argument, limit_exceeded (more than 1 GiB for what is made ready).
  explicit SkyProjector(SkyView view, const SkyHarmonicsOptions& options = {});

  /// Radiance coefficients of the sky with the sun towards a direction, without its disc. Writes bands^2 triples;
  /// allocates nothing. The same bits on every instruction set. Throws `Error` (invalid_argument) for too short a span,
  /// a direction that is not finite or has no length.
  void project(const glm::dvec3& sun, std::span<glm::dvec3> coefficients) const;
  /// Harmonics of radiance for one direction to the sun, without the sun's disc.
  [[nodiscard]] SphericalHarmonics project(const glm::dvec3& sun) const;

  [[nodiscard]] int directions() const noexcept;  ///< radiance evaluations an update
  /// The view that is projected.
  [[nodiscard]] const SkyView& view() const noexcept;
  /// Those that it was made with.
  [[nodiscard]] const SkyHarmonicsOptions& options() const noexcept;

 private:
  struct WELKIN_HIDDEN Prepared;
  friend struct SkyProjectorAccess;  ///< module/sky: coefficients before they are turned
  std::shared_ptr<const Prepared> prepared_;
};

/// How many nodes a curve has, and how each is made.
struct SkyCurveOptions {
  int bands = 3;    ///< 1 to kMaximumBands; `projection.bands` is not read
  int nodes = 256;  ///< sun elevations, closer together about the horizon: 8 to 4096
  /// How each node is projected.
  SkyHarmonicsOptions projection{.bands = 3, .quadrature = SkyQuadrature::gauss_split, .zeniths = 32, .azimuths = 32};

  friend bool operator==(const SkyCurveOptions&, const SkyCurveOptions&) = default;
};

/// Coefficients over the sun's elevation at one height, baked once: a moved sun is an interpolation and a rotation
/// about the vertical. Band 0 and the sun's irradiance are never negative. Immutable; copies share it.
///
/// Against the projection it is made of, at the default 256 nodes on the ground: 4e-4 from 90 to -6 degrees, 6e-3 to
/// -9, 2e-2 to -12, 1e-1 to -18, where the tables' own interpolation between suns is no smoother than that.
class SkyCurve {
 public:
  /// Parallel over elevations; the same bits on any number of threads and instruction set.
  /// Throws `Error`: invalid_argument, limit_exceeded, cancelled.
  explicit SkyCurve(const SkyView& view, const SkyCurveOptions& options = {}, const Control& control = {});

  /// Bands of the harmonics.
  [[nodiscard]] int bands() const noexcept;
  /// Writes bands^2 triples; allocates nothing; under a microsecond for 3 bands. Throws `Error` (invalid_argument) for
  /// too short a span, a direction that is not finite or has no length.
  void at(const glm::dvec3& sun, std::span<glm::dvec3> coefficients) const;
  /// Harmonics of radiance for a direction to the sun. Cost: microseconds.
  [[nodiscard]] SphericalHarmonics at(const glm::dvec3& sun) const;
  /// The direct sun's irradiance on a surface that faces it, from the same curve.
  [[nodiscard]] glm::dvec3 sun_irradiance(const glm::dvec3& sun) const;

  /// Memory of the curve.
  [[nodiscard]] std::uint64_t bytes() const noexcept;

 private:
  struct WELKIN_HIDDEN Nodes;
  std::shared_ptr<const Nodes> nodes_;
};

}  // namespace welkin
