// An atmosphere made ready for integrals: densities of all its constituents, and where they change.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "welkin/atmosphere.h"

namespace welkin::sky {

/// Molecules, aerosol and up to four absorbers.
inline constexpr std::size_t kMostConstituents = 6;
inline constexpr std::size_t kRayleigh = 0;
inline constexpr std::size_t kAerosol = 1;

/// A number for each constituent; those that an atmosphere has not are 0.
using Amounts = std::array<double, kMostConstituents>;

class Air {
 public:
  /// Of an atmosphere that `check` accepts, which must outlive it.
  explicit Air(const Atmosphere& atmosphere);

  [[nodiscard]] const Atmosphere& atmosphere() const noexcept { return *atmosphere_; }
  [[nodiscard]] double bottom_radius() const noexcept { return atmosphere_->bottom_radius_m; }
  [[nodiscard]] double thickness() const noexcept { return thickness_; }
  [[nodiscard]] std::size_t constituents() const noexcept { return matter_.size(); }

  /// Densities from 0 to 1 at an altitude, all entries written.
  void densities(double altitude, Amounts& amounts) const noexcept;

  /// Rising altitudes from 0 to the thickness: between two of them every density is smooth, and an exponential one that
  /// matters changes by no more than e^2.5.
  [[nodiscard]] const std::vector<double>& shells() const noexcept { return shells_; }

  /// The smallest scale height of what there is, at most the thickness.
  [[nodiscard]] double scale_height() const noexcept { return scale_height_; }

  /// Scattering and absorption of a constituent at a wavelength, 1/m where its density is 1.
  [[nodiscard]] double extinction(std::size_t constituent, std::size_t wavelength) const noexcept;
  [[nodiscard]] double scattering(std::size_t constituent, std::size_t wavelength) const noexcept;
  [[nodiscard]] double albedo(std::size_t wavelength) const noexcept;

 private:
  void divide(double low, double high);
  /// Whether it has any effect: what has none must not cut the air into shells.
  [[nodiscard]] static bool matters(const Constituent& constituent) noexcept;
  [[nodiscard]] double steepness(double low, double high) const noexcept;

  const Atmosphere* atmosphere_;
  double thickness_;
  double scale_height_;
  std::vector<const Constituent*> matter_;
  std::vector<double> shells_;
};

// How dense one kind of matter is at an altitude: the twin, in double, of what tables evaluate in lanes.

/// A layer covers altitudes from its bottom up to, not including, its top; the last one all above. No layers: 0.
/// Altitudes below 0 are taken as 0. From 0 to 1 for every profile that `check` accepts.
[[nodiscard]] double density(std::span<const DensityLayer> layers, double altitude_m) noexcept;

/// What one layer's formula gives at an altitude, its own or not, clamped to [0, 1].
[[nodiscard]] double density_of(const DensityLayer& layer, double altitude_m) noexcept;

/// Altitudes strictly between 0 and `thickness_m`, rising, at which the density or its slope jumps: tops of layers, and
/// places where a layer's formula meets 0 or 1. Between two of them the density is analytic. At most 7 + 8 * 4.
[[nodiscard]] std::vector<double> density_breaks(std::span<const DensityLayer> layers, double thickness_m);

/// Altitudes strictly between 0 and `thickness_m`, rising, at which the density may turn from rising to falling or back
/// inside of a layer. Between two of these or of the breaks it is monotone. At most 8.
[[nodiscard]] std::vector<double> density_turns(std::span<const DensityLayer> layers, double thickness_m);

}  // namespace welkin::sky
