// An atmosphere as the references see it: how much of each matter lies along a ray, and how much sun reaches a point.
// All in double, by quadrature, without a table.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/sky.h"

namespace welkin::sky {

/// The part of a ray that is in the air. With r the distance from the planet's centre at its start, mu the cosine of
/// the zenith angle: square = r^2 - R^2 and slope = r mu; then r(s)^2 - R^2 = square + s (2 slope + s). Nothing in it
/// is a difference of two squared radii.
struct AirRay {
  double square = 0.0;  ///< m2
  double slope = 0.0;   ///< m
  double length = 0.0;  ///< m; 0: the ray meets no air
  bool ground = false;  ///< its end
};

class ReferenceAir {
 public:
  static constexpr std::size_t kMaxConstituents = 6;
  using Columns = std::array<double, kMaxConstituents>;  ///< metres at density 1, of each matter

  struct Matter {
    std::vector<DensityLayer> density;
    std::vector<double> scattering;  ///< 1/m, one each wavelength
    std::vector<double> extinction;
    bool rayleigh = false;  ///< its phase function; else the aerosol's
  };

  /// Checks the atmosphere.
  explicit ReferenceAir(const Atmosphere& atmosphere);

  [[nodiscard]] const Atmosphere& atmosphere() const noexcept { return atmosphere_; }
  [[nodiscard]] std::span<const Matter> matter() const noexcept { return matter_; }
  [[nodiscard]] std::size_t wavelengths() const noexcept { return atmosphere_.wavelengths_nm.size(); }
  [[nodiscard]] double radius() const noexcept { return atmosphere_.bottom_radius_m; }
  [[nodiscard]] double thickness() const noexcept { return thickness_; }

  /// r^2 - R^2 and back.
  [[nodiscard]] double square_of(double altitude) const noexcept { return altitude * (2.0 * radius() + altitude); }
  [[nodiscard]] double altitude_of(double square) const noexcept;
  [[nodiscard]] double altitude_at(const AirRay& ray, double s) const noexcept {
    return altitude_of(ray.square + s * (2.0 * ray.slope + s));
  }

  /// Cosine and sine of the zenith angle. In space it begins where the ray enters; `skipped` is how far that is.
  [[nodiscard]] AirRay ray(double altitude, double cosine, double sine, double* skipped = nullptr) const noexcept;
  /// From a point in the air to the top; no ground is in the way.
  [[nodiscard]] AirRay ray_to_top(double square, double slope) const noexcept;

  /// Places along a ray where it passes `altitudes_` or its own lowest point, and its two ends, rising.
  [[nodiscard]] std::vector<double> ends(const AirRay& ray) const;

  /// Matter along [from, to] of a ray, which `ends` (its own) cut into smooth pieces.
  [[nodiscard]] Columns columns(const AirRay& ray, std::span<const double> ends, double from, double to,
                                double relative_error) const;
  [[nodiscard]] Columns columns(const AirRay& ray, double relative_error) const;

  [[nodiscard]] double optical_depth(const Columns& columns, std::size_t wavelength) const noexcept;
  [[nodiscard]] double phase(const Matter& matter, std::size_t wavelength, double cosine) const noexcept;
  /// The phase function that directions are drawn by: of an aerosol whose g differs by wavelength, that of the mean.
  [[nodiscard]] double drawn_phase(const Matter& matter, double cosine) const noexcept;
  [[nodiscard]] double drawn_asymmetry() const noexcept { return drawn_asymmetry_; }

  /// Elevation of the sun's centre over a point's own horizon, radians nearly: (mu_s - mu_h) r / R.
  /// `sun_slope` is r mu_s.
  [[nodiscard]] double sun_elevation(double square, double sun_slope) const noexcept;
  /// The share of the sun's disc that is up.
  [[nodiscard]] double visible_share(double elevation) const noexcept;
  /// Where sunlight at a point in the air comes through: towards the centre, or the horizon if that is below it.
  [[nodiscard]] AirRay sun_ray(double square, double sun_slope) const noexcept;
  /// Places along a ray where the disc's rims or centre meet the local horizon. `sun_slope` is that of its start.
  [[nodiscard]] std::vector<double> shadow_ends(const AirRay& ray, double sun_slope, double sun_cosine) const;

 private:
  void add_matter(const Constituent& constituent, bool rayleigh);
  void add_altitudes(std::span<const DensityLayer> layers);

  Atmosphere atmosphere_;
  double thickness_;
  double sun_radius_;  ///< radians
  double drawn_asymmetry_;
  std::vector<Matter> matter_;
  /// Between them all densities are smooth and change by no more than some powers of e^10; rising.
  std::vector<double> altitudes_;
};

/// Throws `Error` (invalid_argument), by the argument's name, for a direction that is not of length 1.
void check_direction(const char* what, const glm::dvec3& direction);

}  // namespace welkin::sky
