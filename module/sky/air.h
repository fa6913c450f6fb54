// An atmosphere made ready for integrals: densities of all its constituents, and where they change.
#pragma once

#include <array>
#include <cstddef>
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

}  // namespace welkin::sky
