// How much sunlight reaches any point of the air: transmittance to the sun over altitude and elevation.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/sky_kernels.h"
#include "sky/table_mapping.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin::sky {

/// Density-weighted path lengths to the top for rays above the horizon: of no wavelength, and so computed once.
///
/// Heights are those of the tables (x = rho / H). Over zenith cosines, y = mu - mu_h above each height's own horizon:
/// x = share (Y + b) / Y y / (y + b) + (1 - share) y / Y, Y = 1 - mu_h: half of the nodes lie where the air is deepest,
/// the bend b being a few times the width over which an exponential air darkens, sqrt(2 scale height / R).
class SunPaths {
 public:
  /// At least 4 heights; zeniths a multiple of 4.
  struct Size {
    int heights = 128;
    int zeniths = 256;
  };

  SunPaths(const AirModel& air, const TableMapping& mapping, const Size& size, const Control& control);

  /// The two coefficients of a height's axis, per node.
  struct Axis {
    double horizon, rational, bend, linear;
  };
  [[nodiscard]] Axis axis(double altitude) const noexcept;
  [[nodiscard]] const PerConstituent& lengths(int height, int zenith) const noexcept {
    return lengths_->amounts[static_cast<std::size_t>(height * size_.zeniths + zenith)];
  }
  [[nodiscard]] const TableMapping& mapping() const noexcept { return mapping_; }
  [[nodiscard]] const Size& size() const noexcept { return size_; }

 private:
  [[nodiscard]] double zenith_cosine(double altitude, int node) const noexcept;

  TableMapping mapping_;
  Size size_;
  double bend_;
  std::shared_ptr<const RayLengths> lengths_;
};

/// The light of the sun at three wavelengths, of one at unit irradiance.
class Sunlight {
 public:
  Sunlight(const AirModel& air, const SunPaths& paths, const Extinctions& extinctions);

  /// Nodes of a row of a sample.
  [[nodiscard]] int nodes() const noexcept { return paths_->size().zeniths; }

  /// Fills in what of a sample depends on its altitude.
  void at(double altitude, SunlitSample& sample) const noexcept;

  /// In double, for a single point: transmittance times the visible share of the disc.
  [[nodiscard]] std::array<double, 3> at(double altitude, double sun_zenith_cosine) const noexcept;

 private:
  const SunPaths* paths_;
  double bottom_radius_;
  std::size_t row_;          ///< floats of a height
  double disc_slope_;        ///< 1 / (2 a)
  std::vector<float> rows_;  ///< [heights][zeniths][4]
};

// The direct sun at a position, by the tables.

/// Steradians: a disc of less is a point, whose radiance would overflow.
inline constexpr double kPoint = 1e-60;

/// Sine of the lowest sun's elevation.
[[nodiscard]] double lowest_sun_sine(const SkyTables& tables) noexcept;

/// The mapping of an atmosphere's tables.
[[nodiscard]] TableMapping mapping_of(const SkyTables& tables) noexcept;

/// Transmittance from an altitude within the air along a ray to the top; of one below the horizon that of the
/// horizon's.
[[nodiscard]] glm::dvec3 transmittance_to_top(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                              double zenith_cosine) noexcept;

/// The sun's disc over a horizon (welkin/sky.h states the model), at any altitude.
struct SettingSun {
  double horizon = 0.0;  ///< cosine of its zenith angle
  double stretch = 1.0;  ///< of elevations at the altitude relative to those on the ground
  double radius = 0.0;   ///< of the disc, radians

  SettingSun(const Atmosphere& atmosphere, double altitude_m) noexcept;

  [[nodiscard]] double visible_share(double sun_zenith_cosine) const noexcept;
};

/// Returns what the air transmits of a sun at that elevation, at any altitude; below the horizon as on it.
[[nodiscard]] glm::dvec3 sun_transmittance(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                           double sun_zenith_cosine) noexcept;

/// Returns the fraction of the sun's light above the air that arrives: through the air, past the horizon. Any altitude.
[[nodiscard]] glm::dvec3 sun_share(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                   double sun_zenith_cosine) noexcept;

/// Irradiance of the sky on the ground or above it (tables' irradiance), facing up.
[[nodiscard]] glm::dvec3 sky_irradiance(const SkyTables& tables, const TableMapping& mapping, double altitude,
                                        double sun_zenith_cosine) noexcept;

/// 1 down to the tables' lowest sun, 0 at the nadir, smooth between: how much of the last sky is left.
[[nodiscard]] double sun_fade(const SkyTables& tables, double sun_zenith_cosine) noexcept;

}  // namespace welkin::sky
