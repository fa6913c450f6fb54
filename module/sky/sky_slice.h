// The tables at one altitude, prepared for lookups by views and quadratures.
//
// Rows are `kSkyRow` floats: Rayleigh's and all higher orders' red, green, blue, 0; single Mie scattering's red, green,
// blue, 0; all without phase functions. Between nodes values are cubics along each axis: taps are four rows one after
// the other and their weights, the result is the plain weighted sum, not below 0. (Over suns light falls by decades:
// there the cubic is of rows relative to their sun's brightness, the mean of all views.) What is seen is
//   fade (max(row[0..2], 0) rayleigh_phase(nu) + max(row[4..6], 0) aerosol_phase(nu)),
// the aerosol's phase function being each channel's own, and on top of it the light of the night.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "sky/aureole.h"
#include "sky/night_light.h"
#include "sky/sky_kernels.h"
#include "sky/spectrum.h"
#include "sky/table_mapping.h"
#include "welkin/sky.h"

namespace welkin::sky {

/// Where a sun stands.
struct SunLookup {
  SunTaps taps;       ///< of sun rows
  float fade = 1.0F;  ///< below the tables' lowest sun
};

/// A view's zenith, and the end of its rays.
struct ViewLookup {
  CubicTaps taps{};  ///< of view nodes
  bool ground = false;
  double distance = 0.0;     ///< to the ground, metres, if there it ends
  float transmittance[3]{};  ///< up to the ground; 0 if the view does not show it
};

/// The slice; of the top for views from above, which look into it where their rays enter (`outside()`).
class SkySlice {
 public:
  SkySlice(std::shared_ptr<const SkyTables> tables, double altitude_m, const SkyViewOptions& options);

  [[nodiscard]] const std::shared_ptr<const SkyTables>& tables() const noexcept { return tables_; }
  [[nodiscard]] double altitude() const noexcept { return altitude_; }  ///< the viewer's
  [[nodiscard]] bool outside() const noexcept { return outside_; }

  /// Values are [views][azimuths][suns] rows; 4 azimuths and suns or more, and 8 views or more, of which the first half
  /// end on the ground. (Tables with less nodes are continued to as many.)
  [[nodiscard]] int views() const noexcept { return views_; }
  [[nodiscard]] int azimuths() const noexcept { return azimuths_; }
  [[nodiscard]] int suns() const noexcept { return suns_; }
  [[nodiscard]] const float* values() const noexcept { return values_.data(); }

  /// Returns the lookup of a view inside the air (or at the point of entry) whose cosine with the zenith is `mu`.
  [[nodiscard]] ViewLookup view_lookup(double mu) const noexcept;
  /// Returns taps by the cosine of the azimuth from sun to view, (nu - mu mu_s) / (sqrt(1 - mu^2) sqrt(1 - mu_s^2)).
  [[nodiscard]] CubicTaps azimuth_taps(double cosine, double mu_s) const noexcept;
  /// Writes the taps of several azimuths under one sun.
  void azimuth_taps(std::span<const double> cosines, double mu_s, CubicTaps* taps) const noexcept;
  /// Returns the lookup by the cosine between sun and zenith.
  [[nodiscard]] SunLookup sun_lookup(double mu_s) const noexcept;

  /// Returns the aerosol's phase function at a cosine between view and sun, 1/sr, in each channel.
  [[nodiscard]] glm::dvec3 aerosol_phase(double nu) const noexcept;

  /// Returns the radiance that leaves the ground where the sun's zenith cosine is `mu_s`: a ray of length d from radius
  /// r ends where that is (r mu_s + d nu) / R. The viewer sees it times the view's `transmittance`.
  [[nodiscard]] glm::dvec3 ground_radiance(double mu_s) const noexcept;

  /// Returns the slice's own altitude: the viewer's, or the top.
  [[nodiscard]] double inside() const noexcept { return inside_; }
  [[nodiscard]] const TableMapping& mapping() const noexcept { return mapping_; }
  [[nodiscard]] const ColourFold& fold() const noexcept { return fold_; }

  [[nodiscard]] const Aureole& aureole() const noexcept { return aureole_; }
  /// Returns depths for it, for a sun at that zenith cosine (below the horizon as on it); from above the air 0.
  [[nodiscard]] std::array<double, 3> aureole_depths(double mu_s) const noexcept;

  /// Returns the night at the slice's altitude, in addition to all light in the rows; not visible from above the air.
  [[nodiscard]] const NightLight& night() const noexcept { return night_; }

  /// Returns the kernels' input, with a sun towards a unit direction; `of_sun` is left null.
  [[nodiscard]] SkyRun run(const glm::dvec3& sun) const noexcept;

  /// Rows of one view: [azimuths][suns], interpolated between view nodes.
  void view_rows(const CubicTaps& view, float* rows) const noexcept;

 private:
  void set_brightness();

  std::shared_ptr<const SkyTables> tables_;
  double altitude_ = 0.0;
  bool outside_ = false;
  int views_ = 0, azimuths_ = 0, suns_ = 0;
  std::vector<float> values_;
  std::vector<float> brightness_;  ///< over suns, mean of all views and channels: resample_log_cubic

  TableMapping mapping_;
  double inside_ = 0.0;  ///< altitude of the slice
  std::vector<float> reach_;
  std::vector<float> ground_;
  ColourFold fold_;
  Aureole aureole_;
  NightLight night_;
  std::vector<std::array<double, 3>> aureole_depths_;  ///< of the nodes' suns; none: nothing to correct
};

// The scattering tables cut at one altitude.

/// Nodes along the axes of a slice: those of the tables, but at least four (of the views eight, four to the ground).
/// Shorter axes are extended by the curve through all their nodes.
struct SliceShape {
  int views = 0;
  int azimuths = 0;
  int suns = 0;
};

[[nodiscard]] SliceShape slice_shape(const SkyTableOptions& options) noexcept;

/// Returns the max bytes that a slice takes while it is made, without its tables.
[[nodiscard]] std::uint64_t slice_bytes(const SkyTableOptions& options) noexcept;

/// Rows of eight floats (sky_slice.h): [views][azimuths][suns].
[[nodiscard]] std::vector<float> slice_rows(const SkyTables& tables, const TableMapping& mapping,
                                            const ColourFold& fold, double altitude);

// The ground in a view: its radiance under any sun, and the transmittance to it.

/// Nodes over the square root of |mu_s| with mu_s' sign, from -1 to 1: dense about the horizon, where the disc sets.
/// A step is 1/256 of the root: next to the horizon nodes are 1.5e-5 apart, and the Earth's disc, which sets over
/// +-0.0047, has 17 on either side of it.
inline constexpr int kGroundNodes = 513;

/// Radiance that leaves the ground at each of them, lit by the sun and by the sky: [kGroundNodes][4], the last 0.
[[nodiscard]] std::vector<float> ground_radiances(const SkyTables& tables, const TableMapping& mapping,
                                                  const ColourFold& fold);

/// Share of the ground's light that arrives at an altitude within the air, along the rays of the `half` view nodes that
/// end on the ground (of 2 half, as the mapping has them), to 1e-6: [half][4], the last 0.
[[nodiscard]] std::vector<float> ground_reach(const SkyTables& tables, const TableMapping& mapping,
                                              const ColourFold& fold, double altitude, int half);

}  // namespace welkin::sky

namespace welkin {

/// A view's slice.
struct WELKIN_HIDDEN SkyViewAccess {
  [[nodiscard]] static const sky::SkySlice& slice(const SkyView& view) noexcept;
};

}  // namespace welkin
