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
#pragma once

#include <array>
#include <vector>

#include "sky/sky_kernels.h"
#include "welkin/atmosphere.h"

namespace welkin::sky {

class Aureole {
 public:
  /// Of three channels whose aerosol has the asymmetries g. Next to no share that goes straight on: `any()` is false.
  Aureole(const Atmosphere& atmosphere, const std::array<double, 3>& asymmetries, int orders);

  [[nodiscard]] bool any() const noexcept;

  /// (P + D) / P at the angles of `kAureoleAngles`, for the depths x of three channels: [kAureoleAngles][4].
  void factors(const std::array<double, 3>& depths, float* values) const noexcept;

  /// -D_l of all bands that are kept.
  [[nodiscard]] double loss(std::size_t channel, double depth) const noexcept;

 private:
  /// One of all channels, or each one's own.
  struct Lobe {
    double forward = 0.0;       ///< f
    std::vector<double> table;  ///< [angles][depths]; none: nothing to correct
  };

  [[nodiscard]] const Lobe& lobe(std::size_t channel) const noexcept { return lobes_[lobes_.size() > 1 ? channel : 0]; }

  std::vector<Lobe> lobes_;
};

}  // namespace welkin::sky
