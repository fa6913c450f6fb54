// The glow about the sun, where light is turned by little more than once (Nakajima and Tanaka 1988, "Algorithms for
// radiative intensity calculations in moderately thick atmospheres using a truncation approximation").
//
// Delta-M scaling takes a share f of what the aerosol scatters for light that goes straight on: a lobe P_f whose
// moments are 1 below the bands that are kept and chi_l / f beyond. A table's single scattering has the whole lobe P
// and scaled transmittance T' (their TMS correction), and so f P_f once, as if what it turned were not turned again.
// With x = f times the aerosol's scattering depth towards the sun, light that P_f turns any number of times is
//   T' (exp(-x (1 - chi_f,l)) - exp(-x)) in band l, and not T' x chi_f,l.
// The difference belongs to the first order's light: instead of P it is seen with P + D, D's moments being
//   D_l = f ((exp(-x (1 - chi_f,l)) - exp(-x)) / x - chi_f,l).
// (Their IMS correction is the first two terms in x.)
//
// Where that share is large, light of all orders that the aerosol scatters last is a glow about the sun, too narrow for
// a table's nodes: under an aerosol of depth tau that turns light by little, light turned at least once has
//   S_l = (exp(tau chi_l) - 1) / (exp(tau) - 1), tau = x / f,
// of which tau chi_l / (exp(tau) - 1) was turned once. Tables of such a narrow lobe hold the aerosol's light of all
// orders relative to the glow S, which is as sharp as its formula wherever it is looked up; what they hold is as smooth
// as light of other geometry makes it.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sky/sky_kernels.h"
#include "sky/spectrum.h"
#include "sky/table_mapping.h"
#include "welkin/sky.h"

namespace welkin::sky {

class Aureole {
 public:
  /// Of three channels whose aerosol has the asymmetries g. Next to no share that goes straight on: `any()` is false.
  Aureole(const Atmosphere& atmosphere, const std::array<double, 3>& asymmetries, const SkyTableOptions& options);

  [[nodiscard]] bool any() const noexcept;
  /// Whether tables hold the aerosol's light relative to a glow. Compact ones never do.
  [[nodiscard]] bool glows() const noexcept;

  /// What P is multiplied by where tables are looked up, (P + D) / P or S / P, at the angles of `kAureoleAngles`, for
  /// the depths x of three channels: [kAureoleAngles][4].
  void factors(const std::array<double, 3>& depths, float* values) const noexcept;

  /// Of one channel, at a cosine between view and sun and a depth, of light that was scattered once: (P + D) / P; and
  /// of all that tables hold relative to a glow: S / P.
  struct Factors {
    double once;
    double glow;
  };
  [[nodiscard]] Factors factors(std::size_t channel, double cosine, double depth) const noexcept;

  /// How much `factors` takes away from a band of the lobe whose moment is chi.
  [[nodiscard]] double loss(std::size_t channel, double chi, double depth) const noexcept;

 private:
  /// One of all channels, or each one's own.
  struct Lobe {
    double asymmetry = 0.0;    ///< g
    double forward = 0.0;      ///< f
    std::vector<double> once;  ///< (P + D) / P: [angles][depths]; none: nothing to correct
    std::vector<double> glow;  ///< S / P: likewise; none: no glow
    [[nodiscard]] const std::vector<double>& seen() const noexcept { return glow.empty() ? once : glow; }
  };

  [[nodiscard]] const Lobe& lobe(std::size_t channel) const noexcept { return lobes_[lobes_.size() > 1 ? channel : 0]; }

  std::vector<Lobe> lobes_;
};

/// Depths x of three channels at an altitude within the air, under each of `suns` suns of tables; one that is down
/// counts as on the horizon.
[[nodiscard]] std::vector<std::array<double, 3>> aureole_depths(const Atmosphere& atmosphere,
                                                                const SkyTableOptions& options, const ColourFold& fold,
                                                                const TableMapping& mapping, double altitude, int suns);

}  // namespace welkin::sky
