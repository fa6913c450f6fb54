// The references' model of an atmosphere: how much of each matter lies along a ray, and how much sunlight reaches a
// point. Everything is in double, by quadrature, without tables.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "welkin/sky.h"

namespace welkin::sky {

/// The part of a ray that is in the air. With r the distance from the planet's centre at its start and mu the cosine of
/// the zenith angle, square = r^2 - R^2 and slope = r mu; then r(s)^2 - R^2 = square + s (2 slope + s). No term is a
/// difference of two squared radii.
struct AirRay {
  double square = 0.0;  ///< m2
  double slope = 0.0;   ///< m
  double length = 0.0;  ///< m; 0: the ray meets no air
  bool ground = false;  ///< whether it ends on the ground
};

class ReferenceAir {
 public:
  static constexpr std::size_t kMaxConstituents = 6;
  using Columns = std::array<double, kMaxConstituents>;  ///< metres at density 1, of each matter

  struct Matter {
    std::vector<DensityLayer> density;
    std::vector<double> scattering;  ///< 1/m, one per wavelength
    std::vector<double> extinction;
    bool rayleigh = false;  ///< whether its phase function is Rayleigh's, else the aerosol's
  };

  /// Checks the atmosphere.
  explicit ReferenceAir(const Atmosphere& atmosphere);

  [[nodiscard]] const Atmosphere& atmosphere() const noexcept { return atmosphere_; }
  [[nodiscard]] std::span<const Matter> matter() const noexcept { return matter_; }
  [[nodiscard]] std::size_t wavelengths() const noexcept { return atmosphere_.wavelengths_nm.size(); }
  [[nodiscard]] double radius() const noexcept { return atmosphere_.bottom_radius_m; }
  [[nodiscard]] double thickness() const noexcept { return thickness_; }

  /// Converts an altitude to r^2 - R^2, and back.
  [[nodiscard]] double square_of(double altitude) const noexcept { return altitude * (2.0 * radius() + altitude); }
  [[nodiscard]] double altitude_of(double square) const noexcept;
  [[nodiscard]] double altitude_at(const AirRay& ray, double s) const noexcept {
    return altitude_of(ray.square + s * (2.0 * ray.slope + s));
  }

  /// Returns a ray by cosine and sine of its zenith angle. From space it begins at the air, `skipped` metres away.
  [[nodiscard]] AirRay ray(double altitude, double cosine, double sine, double* skipped = nullptr) const noexcept;
  /// Returns a ray from a point in the air to the top, with no ground in the way.
  [[nodiscard]] AirRay ray_to_top(double square, double slope) const noexcept;

  /// Returns the rising distances along a ray of its two ends, its lowest point, and `altitudes_`.
  [[nodiscard]] std::vector<double> ends(const AirRay& ray) const;

  /// Returns the matter along [from, to] of a ray, which its `ends` cut into smooth pieces.
  [[nodiscard]] Columns columns(const AirRay& ray, std::span<const double> ends, double from, double to,
                                double relative_error) const;
  [[nodiscard]] Columns columns(const AirRay& ray, double relative_error) const;

  [[nodiscard]] double optical_depth(const Columns& columns, std::size_t wavelength) const noexcept;
  [[nodiscard]] double phase(const Matter& matter, std::size_t wavelength, double cosine) const noexcept;
  /// Returns the phase function to draw directions by: for an aerosol whose g differs by wavelength, that of the mean.
  [[nodiscard]] double drawn_phase(const Matter& matter, double cosine) const noexcept;
  [[nodiscard]] double drawn_asymmetry() const noexcept { return drawn_asymmetry_; }

  /// Returns the elevation of the sun's centre above a point's local horizon, nearly in radians: (mu_s - mu_h) r / R.
  /// `sun_slope` is r mu_s.
  [[nodiscard]] double sun_elevation(double square, double sun_slope) const noexcept;
  /// Returns the share of the sun's disc above the horizon.
  [[nodiscard]] double visible_share(double elevation) const noexcept;
  /// Returns the ray from a point in the air towards the sun's centre, or the horizon if the centre is below it.
  [[nodiscard]] AirRay sun_ray(double square, double sun_slope) const noexcept;
  /// Returns where along a ray the disc's rims or centre meet the local horizon. `sun_slope` is that of its start.
  [[nodiscard]] std::vector<double> shadow_ends(const AirRay& ray, double sun_slope, double sun_cosine) const;

 private:
  void add_matter(const Constituent& constituent, bool rayleigh);
  void add_altitudes(std::span<const DensityLayer> layers);

  Atmosphere atmosphere_;
  double thickness_;
  double sun_radius_;  ///< radians
  double drawn_asymmetry_;
  std::vector<Matter> matter_;
  /// Rising altitudes between which all densities are smooth and change by no more than a few powers of e^10.
  std::vector<double> altitudes_;
};

/// Air in shells of nearly constant extinction, to find how much of it lies along the many rays of paths.
class PathShells {
 public:
  using Columns = ReferenceAir::Columns;

  explicit PathShells(const ReferenceAir& air);

  [[nodiscard]] std::size_t count() const noexcept { return densest_.size(); }
  /// Returns r^2 - R^2 of the lower bound of shell `i`, or of the top for i = count().
  [[nodiscard]] double square(std::size_t i) const noexcept { return squares_[i]; }
  /// Returns the shell that contains r^2 - R^2.
  [[nodiscard]] std::size_t find(double square) const noexcept;
  /// Computes the densities of all matter at a point of shell `i`.
  void densities(std::size_t i, double square, Columns& values) const noexcept;

  /// Returns metres at density 1 of each matter along a part of a ray within shell `i`, by Gauss's rule of five points.
  /// The extinction changes by a factor of two at most, so that an optical depth's relative error is below 1e-6.
  [[nodiscard]] Columns columns(const AirRay& ray, std::size_t i, double from, double to) const noexcept;
  /// Returns metres at density 1 of each matter along a whole ray.
  [[nodiscard]] Columns columns(const AirRay& ray) const noexcept;

 private:
  void add_shells(double low, double high, int depth);
  void add_shell(double low, double high);
  [[nodiscard]] double densest(double low, double high, bool thinnest) const;
  [[nodiscard]] bool steep(double low, double high, double most) const;

  const ReferenceAir& air_;
  std::vector<double> bounds_;
  std::vector<double> squares_;
  std::vector<double> densest_;  ///< upper bound of each shell's extinction, 1/m
  std::vector<std::array<const DensityLayer*, ReferenceAir::kMaxConstituents>> layers_;
};

/// Walks a ray shell by shell.
class ShellWalk {
 public:
  ShellWalk(const PathShells& shells, const AirRay& ray) noexcept
      : shells_(shells), ray_(ray), shell_(shells.find(ray.square)), falling_(ray.slope < 0.0) {
    if (!falling_ && shell_ + 1 < shells.count() && ray.square >= shells.square(shell_ + 1)) ++shell_;
    set_end();
  }

  [[nodiscard]] std::size_t shell() const noexcept { return shell_; }
  [[nodiscard]] double end() const noexcept { return end_; }
  /// Returns whether this is the ray's last shell.
  [[nodiscard]] bool last() const noexcept { return falling_ ? shell_ == 0 : shell_ + 1 == shells_.count(); }

  void next() noexcept {
    shell_ = falling_ ? shell_ - 1 : shell_ + 1;
    set_end();
  }

 private:
  void set_end() noexcept {
    const double start = end_;
    const double nearest = ray_.slope * ray_.slope - ray_.square;  // -(r^2 - R^2) at the lowest point
    if (falling_) {
      const double below = nearest + shells_.square(shell_);
      if (below > 0.0 && (shell_ > 0 || ray_.ground)) {
        end_ = -ray_.slope - std::sqrt(below);
        if (end_ < start) end_ = start;
        return;
      }
      falling_ = false;
    }
    if (last()) {
      end_ = ray_.length;
    } else {
      const double above = nearest + shells_.square(shell_ + 1);
      end_ = -ray_.slope + std::sqrt(above > 0.0 ? above : 0.0);
    }
    if (end_ > ray_.length) end_ = ray_.length;
    if (end_ < start) end_ = start;
  }

  const PathShells& shells_;
  AirRay ray_;
  std::size_t shell_;
  bool falling_;
  double end_ = 0.0;
};

}  // namespace welkin::sky
