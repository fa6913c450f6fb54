// The optical model of an atmosphere: densities of its constituents, shells for integrals, and phase functions.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "welkin/sky.h"

namespace welkin::sky {

/// Molecules, aerosol and up to four absorbers.
inline constexpr std::size_t kMaxConstituents = 6;
inline constexpr std::size_t kRayleigh = 0;
inline constexpr std::size_t kAerosol = 1;

/// Returns whether any of the constituent is present and scatters light.
[[nodiscard]] bool scatters(const Constituent& constituent) noexcept;
/// Returns whether any of it is present and scatters or absorbs; others must not cut the air into shells.
[[nodiscard]] bool matters(const Constituent& constituent) noexcept;

/// A number for each constituent; 0 for those that an atmosphere lacks.
using PerConstituent = std::array<double, kMaxConstituents>;

class AirModel {
 public:
  /// Prepares an atmosphere that `check` accepts and that must outlive the model.
  explicit AirModel(const Atmosphere& atmosphere);

  [[nodiscard]] const Atmosphere& atmosphere() const noexcept { return *atmosphere_; }
  [[nodiscard]] double bottom_radius() const noexcept { return atmosphere_->bottom_radius_m; }
  [[nodiscard]] double thickness() const noexcept { return thickness_; }
  [[nodiscard]] std::size_t constituents() const noexcept { return matter_.size(); }

  /// Writes densities from 0 to 1 at four altitudes; every entry is written.
  void densities(const std::array<double, 4>& altitudes, std::array<PerConstituent, 4>& amounts) const noexcept;

  /// Returns the density layers of each constituent that matters.
  [[nodiscard]] std::vector<std::vector<DensityLayer>> profiles() const;

  /// Returns rising altitudes from 0 to the thickness. Between two of them every density is smooth, and an exponential
  /// one that matters changes by no more than e^2.5.
  [[nodiscard]] const std::vector<double>& shells() const noexcept { return shells_; }

  /// Returns such altitudes for lengths alone: four Gauss nodes per shell are right to 1e-6, and constituents that take
  /// less than a millionth of the light that all others take are ignored.
  [[nodiscard]] const std::vector<double>& length_shells() const noexcept { return length_shells_; }

  /// Returns the smallest scale height of all constituents, at most the thickness.
  [[nodiscard]] double scale_height() const noexcept { return scale_height_; }

  /// Returns scattering plus absorption of a constituent at a wavelength, 1/m where its density is 1.
  [[nodiscard]] double extinction(std::size_t constituent, std::size_t wavelength) const noexcept;
  /// Returns the extinction of each constituent.
  [[nodiscard]] PerConstituent extinctions(std::size_t wavelength) const noexcept;
  [[nodiscard]] double scattering(std::size_t constituent, std::size_t wavelength) const noexcept;
  [[nodiscard]] double albedo(std::size_t wavelength) const noexcept;

 private:
  /// Returns shells within which no density is too steep. `faint`: the fraction of the light taken by all other matter
  /// below which a constituent does not count.
  [[nodiscard]] std::vector<double> cut_at(const std::vector<double>& breaks, double faint) const;
  [[nodiscard]] bool fainter(double share, std::size_t constituent, double altitude) const noexcept;
  [[nodiscard]] double steepness(double low, double high, double faint) const noexcept;

  const Atmosphere* atmosphere_;
  double thickness_;
  double scale_height_;
  std::vector<const Constituent*> matter_;
  std::vector<double> shells_;
  std::vector<double> length_shells_;
};

// Density of one kind of matter at an altitude: the counterpart, in double, of what tables evaluate in lanes.

/// Returns the density, from 0 to 1 for every profile that `check` accepts; 0 without layers. A layer covers altitudes
/// from its bottom up to, not including, its top; the last one everything above. Altitudes below 0 count as 0.
[[nodiscard]] double density(std::span<const DensityLayer> layers, double altitude_m) noexcept;

/// Returns one layer's formula at any altitude, clamped to [0, 1].
[[nodiscard]] double density_of(const DensityLayer& layer, double altitude_m) noexcept;

/// Returns altitudes strictly between 0 and `thickness_m`, rising, at which the density or its slope jumps: tops of
/// layers, and altitudes where a layer's formula meets 0 or 1. Between two of them the density is analytic. At most
/// 7 + 8 * 4.
[[nodiscard]] std::vector<double> density_breaks(std::span<const DensityLayer> layers, double thickness_m);

// Phase functions: the fraction of scattered light per direction and steradian; their integral over the sphere is 1.
//
// `cosine` is that of the deflection: 1 straight on. Only + - * / and square roots: the same bits everywhere.

/// Returns the phase function of molecules, without their small anisotropy.
[[nodiscard]] inline double rayleigh_phase(double cosine) noexcept {
  return 3.0 / (16.0 * std::numbers::pi) * (1.0 + cosine * cosine);
}

/// (1 + g^2 - 2 g cosine)^(3/2) without the cancellation at g cosine = 1: the square of a difference and a product,
/// neither negative.
[[nodiscard]] inline double henyey_greenstein_denominator(double g, double cosine) noexcept {
  const double ahead = g < 0.0 ? 1.0 + cosine : 1.0 - cosine;
  const double size = g < 0.0 ? -g : g;
  const double square = (1.0 - size) * (1.0 - size) + 2.0 * size * (ahead > 0.0 ? ahead : 0.0);
  return square * std::sqrt(square);
}

/// Returns the phase function of Henyey and Greenstein 1941. The mean cosine is g.
[[nodiscard]] inline double henyey_greenstein_phase(double g, double cosine) noexcept {
  return (1.0 - g * g) / (4.0 * std::numbers::pi * henyey_greenstein_denominator(g, cosine));
}

/// Returns that of Cornette and Shanks 1992, equation 8: Rayleigh's at g = 0, mean cosine
/// 3 g (4 + g^2) / (5 (2 + g^2)).
[[nodiscard]] inline double cornette_shanks_phase(double g, double cosine) noexcept {
  return 3.0 / (8.0 * std::numbers::pi) * (1.0 - g * g) / (2.0 + g * g) * (1.0 + cosine * cosine) /
         henyey_greenstein_denominator(g, cosine);
}

[[nodiscard]] inline double aerosol_phase(AerosolPhase phase, double g, double cosine) noexcept {
  return phase == AerosolPhase::cornette_shanks ? cornette_shanks_phase(g, cosine) : henyey_greenstein_phase(g, cosine);
}

// Phase functions as sums of Legendre polynomials.

inline constexpr int kMaxSourceBands = 20;
inline constexpr int kNarrowBands = 28;  ///< of a narrow lobe

/// Moments chi_l of phase functions, p(cosine) = sum over l of (2 l + 1) / (4 pi) chi_l P_l(cosine), chi_0 = 1.
struct PhaseSpectrum {
  std::vector<double> aerosol;  ///< as many as bands
  int bands = 3;
  bool narrow = false;
  double forward = 0.0;  ///< fraction of what the aerosol scatters that is treated as not scattered at all
};

/// Moment of band 20 above which a lobe is narrow: light scattered twice is a glow about the sun that no nodes of
/// tables resolve. Henyey-Greenstein of g = 0.86.
inline constexpr double kNarrowForward = 0.05;
/// The g below which a backward lobe is narrow.
inline constexpr double kNarrowBackward = -0.6;

/// Returns chi_0 to chi_(bands - 1) of an air's aerosol with asymmetry g: g^l for Henyey-Greenstein. Cornette-Shanks'
/// are those of 3/2 (1 + cosine^2) / (2 + g^2) times it, by applying
/// cosine P_l = ((l + 1) P_(l + 1) + l P_(l - 1)) / (2 l + 1) twice.
[[nodiscard]] std::vector<double> aerosol_moments(const Atmosphere& atmosphere, double g, int bands);

/// Returns as many bands as an air's aerosol needs for a remainder below 1 %, up to 20, or 28 for a narrow lobe.
/// A forward lobe is cut by delta-M scaling (Wiscombe 1977, "The Delta-M Method", equations 9 and 10): the fraction
/// f = chi_bands counts as light that goes straight on, and the moments of the rest are (chi_l - f) / (1 - f). A
/// backward lobe narrower than that (g below -0.79) loses detail: its moments fade towards the end to hide the cut.
[[nodiscard]] PhaseSpectrum phase_spectrum(const Atmosphere& atmosphere, double g);

/// Returns the spectra of wavelengths that are computed together: one if all have the same g, else one per wavelength,
/// the aerosol's padded with zeros to as many bands as the widest has.
[[nodiscard]] std::vector<PhaseSpectrum> phase_spectra(const Atmosphere& atmosphere,
                                                       const std::array<double, 3>& asymmetries);

/// Returns the asymmetry g of an air's aerosol at one of its wavelengths; all scattering code calls this.
[[nodiscard]] double aerosol_asymmetry(const Atmosphere& atmosphere, std::size_t wavelength) noexcept;

/// Returns `forward` of an air's spectrum with that g where tables follow light beyond its first scattering, else 0.
[[nodiscard]] double forward_share(const Atmosphere& atmosphere, double g, int orders);
/// Returns `forward_share` at each wavelength.
[[nodiscard]] std::vector<double> forward_shares(const Atmosphere& atmosphere, int orders);

/// Direction in which the narrow lobe of an air sends light: forward if any does at any wavelength.
enum class NarrowLobe { none, backward, forward };
[[nodiscard]] NarrowLobe narrow_lobe(const Atmosphere& atmosphere, int orders);

/// Returns whether all three are the same.
[[nodiscard]] constexpr bool all_equal(const std::array<double, 3>& values) noexcept {
  return values[0] == values[1] && values[0] == values[2];
}

/// Returns a phase function of these moments (`math::sum_of_degrees`), not below 0, as a truncated series may swing
/// there.
[[nodiscard]] double phase_of(const std::vector<double>& moments, double cosine) noexcept;

// The aerosol's phase function as quadratures need it.

/// factor (1 + even nu^2) / (gap + slope x)^1.5, x = 1 - nu or, if `backwards`, 1 + nu.
struct AerosolLobe {
  double factor;
  double gap;    ///< (1 - g)^2; if `backwards`, (1 + g)^2
  double slope;  ///< 2 g; if `backwards`, -2 g
  double even;   ///< 1: Cornette-Shanks; 0: Henyey-Greenstein
};

[[nodiscard]] AerosolLobe aerosol_lobe(const Atmosphere& atmosphere, double g, bool backwards) noexcept;

}  // namespace welkin::sky
