// The sky as it is seen from one height: any direction, any sun.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "welkin/control.h"
#include "welkin/directional_light.h"
#include "welkin/export.h"
#include "welkin/image.h"
#include "welkin/sky_tables.h"

namespace WELKIN_EXPORT welkin {

/// What a view is prepared for.
struct SkyViewOptions {
  bool ground = true;  ///< rays that end on the ground see it, lit by sun and sky; else only the air before it
};

/// What pictures show.
struct SkyPictureOptions {
  /// The sun's disc, as texels that it covers by area: their total radiance is the directional light's irradiance. Off:
  /// the disc is left out.
  bool sun_disc = false;
};

/// The tables' slice at one height: 1 MiB at the default sizes, made in some 2 ms. Immutable: any number of threads may
/// ask at once. A sun that is not finite or has no length is an `Error` (invalid_argument) in every call that takes
/// one.
///
/// Between the tables' nodes radiance is a cubic along each of height, view zenith, azimuth and sun zenith, which
/// leaves the range of the two nodes nearest to it by no more than a tenth. Measured against the truth of single
/// scattering (Earth, default sizes): nine harmonics within 0.2 % from 90 to -8 degrees on the ground, 0.3 % at 20 km,
/// 0.7 % at the top; radiance rms 1e-5 by day, 0.5 % at sunset and after; at the edges of the planet's shadow percents.
class SkyView {
 public:
  /// Altitude 0 (on the ground) to 1e9 m: above the top it is space, and rays are looked up where they enter the air.
  /// Throws `Error` (invalid_argument), also for tables that do not hold what their options say.
  SkyView(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options = {});
  ~SkyView();
  /// Copies share the tables.
  SkyView(const SkyView&);
  /// The source can only be assigned to or destroyed afterwards.
  SkyView(SkyView&&) noexcept;
  /// As the constructors.
  SkyView& operator=(const SkyView&);
  /// As the constructors.
  SkyView& operator=(SkyView&&) noexcept;

  /// The tables that the view is a slice of.
  [[nodiscard]] const std::shared_ptr<const SkyTables>& tables() const noexcept;
  /// The observer's, above the ground.
  [[nodiscard]] double altitude_m() const noexcept;

  /// Radiance that arrives from a unit direction, sun towards the unit direction `sun`, without its disc. Not
  /// negative, finite. Allocates nothing. Directions of any length are taken, one without is the zenith. Below the
  /// lowest sun of the tables it is that one's sky, faded to nothing at the nadir. Cost: some 0.3 us.
  [[nodiscard]] glm::dvec3 radiance(const glm::dvec3& direction, const glm::dvec3& sun) const;

  /// The same for many directions, in lanes: packed x y z, packed rgb. The bits of the call above for the same floats.
  /// Allocates nothing; some 50 ns a direction. Throws `Error` (invalid_argument) if `rgb` is shorter than
  /// `directions`.
  void radiance(std::span<const glm::vec3> directions, const glm::dvec3& sun, std::span<glm::vec3> rgb) const;

  /// The sun as a directional light at this height: direction, irradiance through the air (0 below the horizon, in part
  /// while it sets), mean radiance, solid angle of its disc. `texels` and total radiances are not set.
  [[nodiscard]] Sun sun(const glm::dvec3& sun) const;

  /// Irradiance of the sky (no direct sun) on a horizontal surface facing up, from the table; 0 from above the air.
  [[nodiscard]] glm::dvec3 irradiance(const glm::dvec3& sun) const;

 private:
  struct WELKIN_HIDDEN Slice;
  friend struct SkyViewAccess;  ///< module/sky: the slice for quadratures
  std::shared_ptr<const Slice> slice_;
};

/// The radiance at texels' centres (the sun's disc, if asked for, by area: its total radiance is the irradiance of
/// `SkyView::sun` at any size; of a disc that the horizon cuts the part above). Parallel over rows, the same bits on
/// any number of threads; some 50 ns and 12 bytes a texel. Throws `Error`: invalid_argument (size or height 1 to
/// 16384), cancelled.
[[nodiscard]] CubemapImage sky_cubemap(const SkyView& view, const glm::dvec3& sun, int size,
                                       const SkyPictureOptions& options = {}, const Control& control = {});
[[nodiscard]] LatLongImage sky_lat_long(const SkyView& view, const glm::dvec3& sun, int height,
                                        const SkyPictureOptions& options = {}, const Control& control = {});

}  // namespace welkin
