// Directions and weights over a sky.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "platform/memory.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"
#include "sky/sky_kernels.h"
#include "sky/sky_slice.h"
#include "welkin/sky.h"

namespace welkin::sky {

/// Rings of one side of the horizon. Weights: of the integral over the zenith's cosine.
struct RingRule {
  std::vector<double> cosines;
  std::vector<double> sines;
  std::vector<double> weights;
};

/// Azimuths in half the circle, each standing for its mirror image too: weights add up to 2 pi.
struct AzimuthRule {
  std::vector<double> cosines;
  std::vector<double> from_sun;       ///< 1 - cosine, with its digits
  std::vector<double> from_opposite;  ///< 1 + cosine
  std::vector<double> weights;
};

/// How a quadrature cuts the sphere.
struct SkyRule {
  RingRule above;  ///< the horizon
  RingRule below;
  AzimuthRule azimuths;
};

/// `horizon`: cosine of its zenith angle. `top`: that of the highest ring that has any light: 1 inside the air, from
/// space its upper edge. `asymmetry`: the aerosol's g, the sharpest of several. Throws `Error` (invalid_argument) for
/// options out of range.
[[nodiscard]] SkyRule sky_rule(const SkyHarmonicsOptions& options, double horizon, double top, double asymmetry);

// A quadrature over a sky, ready for any sun.

/// Distance and transmittance of a ring's rays to the ground.
struct GroundRay {
  double distance = 0.0;
  double transmittance[3]{};
};

/// Sixteen rings of one side of the horizon; the last is repeated, without weight.
struct RingGroup {
  double cosines[16]{};
  double sines[16]{};
  std::vector<double> basis;  ///< [even_count(bands)][16]: weight times Y(l, m) at azimuth 0
  bool any_ground = false;
  bool any_night = false;
  glm::dvec3 night[16]{};  ///< radiance
  GroundRay ground[16];
  platform::AlignedBuffer<float> values;  ///< [azimuth nodes][suns][6][16]; none from outside the air
};

class SkyProjection {
 public:
  /// Throws `Error`: invalid_argument, limit_exceeded.
  SkyProjection(SkyView view, const SkyHarmonicsOptions& options);

  /// Coefficients of the sky with the sun at azimuth 0: even_count(bands) triples. Allocates nothing.
  void project(const SunAngles& sun, std::span<glm::dvec3> even) const;

  /// Computes the coefficients by the view's own calls, in double: the reference for the kernel.
  void project_plainly(const SunAngles& sun, std::span<glm::dvec3> even) const;

  [[nodiscard]] const SkyView& view() const noexcept { return view_; }
  [[nodiscard]] const SkyHarmonicsOptions& options() const noexcept { return options_; }
  [[nodiscard]] int directions() const noexcept { return directions_; }

 private:
  using Lobe = std::array<double, 3>;  ///< by channel

  /// Distances of sixteen rings from the sun (SkyRings).
  struct SunDistances {
    alignas(64) float nearness[16];
    alignas(64) float breadth[16];
  };

  void add_rings(const RingRule& rings);
  void fill_values(RingGroup& group) const;
  void check_size(std::size_t rings) const;

  [[nodiscard]] Lobe lobe_at(const SunAngles& sun, const SunLookup& point) const noexcept;
  void add_lobe(const SunAngles& sun, const Lobe& lobe, std::span<glm::dvec3> even) const;
  /// Returns the aureole's factors under a sun, [kAureoleAngles][4], or null where there are none.
  [[nodiscard]] const float* aureole_under(const SunAngles& sun, float* scratch) const noexcept;
  void fill_ground(const RingGroup& group, const SunAngles& sun, int first, int count, float* ground) const noexcept;
  [[nodiscard]] SkyRings rings_of(const RingGroup& group, const SunAngles& sun, SunDistances& distances) const noexcept;
  [[nodiscard]] double lobe_integral(const SunAngles& sun, std::size_t channel) const noexcept;
  [[nodiscard]] Lobe aerosol_factors(const SunAngles& sun) const noexcept;
  void add_group(const RingGroup& group, const SunAngles& sun, const SunLookup& point, const CubicTaps* azimuth_taps,
                 const Lobe& lobe, const Lobe& aerosol, const float* aureole, std::span<glm::dvec3> even) const;

  SkyView view_;
  SkyHarmonicsOptions options_;
  const SkySlice& slice_;
  std::array<double, 3> asymmetries_;
  bool one_lobe_;                               ///< of all channels
  bool backwards_;                              ///< the lobes' axis is the point opposite to the sun
  std::array<AerosolLobe, 3> aerosol_;          ///< by channel
  std::array<std::vector<double>, 3> spectra_;  ///< by channel
  AzimuthRule azimuths_;
  std::vector<float> gaps_;     ///< of the azimuths, from the lobe's axis
  std::vector<float> factors_;  ///< [azimuths][bands]
  std::vector<RingGroup> groups_;
  double bottom_ = 0.0;
  double radius_ = 0.0;  ///< the viewer's over the ground's
  double horizon_ = 0.0;
  int directions_ = 0;
};

/// Returns the bytes that a projection needs at most, without its view; `options` as `sky_rule` accepts them.
[[nodiscard]] std::uint64_t projection_bytes(const SkyTableOptions& tables,
                                             const SkyHarmonicsOptions& options) noexcept;

/// Throws `Error` (invalid_argument) if fewer than bands^2 coefficients fit.
void check_room(std::size_t size, int bands);

}  // namespace welkin::sky

namespace welkin {

// The implementation behind a projector.

struct WELKIN_HIDDEN SkyProjectorAccess {
  [[nodiscard]] static const sky::SkyProjection& projection(const SkyProjector& projector) noexcept;
};
}  // namespace welkin
