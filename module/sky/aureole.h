// The glow about the sun, where light is deflected little more than once (Nakajima and Tanaka 1988, "Algorithms for
// radiative intensity calculations in moderately thick atmospheres using a truncation approximation").
//
// Delta-M scaling counts a fraction f of what the aerosol scatters as light that goes straight on: a lobe P_f whose
// moments are 1 below the bands that are kept and chi_l / f beyond. A table's single scattering has the whole lobe P
// and scaled transmittance T' (their TMS correction), and so f P_f once, as if P_f deflected no light a second time.
// With x = f times the aerosol's scattering depth towards the sun, light that P_f deflects any number of times is
//   T' (exp(-x (1 - chi_f,l)) - exp(-x)) in band l, and not T' x chi_f,l.
// The difference belongs to the first order's light: instead of P it is seen with P + D, D's moments being
//   D_l = f ((exp(-x (1 - chi_f,l)) - exp(-x)) / x - chi_f,l).
// (Their IMS correction is the first two terms in x.)
//
// Where that fraction is large, light of all orders that the aerosol scatters last is a glow about the sun, too narrow
// for a table's nodes: under an aerosol of depth tau with small deflections, light deflected at least once has
//   S_l = (exp(tau chi_l) - 1) / (exp(tau) - 1), tau = x / f,
// of which tau chi_l / (exp(tau) - 1) was deflected once. Tables of such a narrow lobe hold the aerosol's light of all
// orders relative to the glow S, which is as sharp as its formula wherever it is looked up. The tables' values are as
// smooth as light of other geometry makes them.
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
  /// For three channels whose aerosol has the asymmetries g. If next to no light goes straight on, `any()` is false.
  Aureole(const Atmosphere& atmosphere, const std::array<double, 3>& asymmetries, const SkyTableOptions& options);

  [[nodiscard]] bool any() const noexcept;
  /// Returns whether tables hold the aerosol's light relative to a glow. Compact tables never do.
  [[nodiscard]] bool glows() const noexcept;

  /// Writes the factors on P for table lookups, (P + D) / P or S / P, at the angles of `kAureoleAngles`, for the depths
  /// x of three channels: [kAureoleAngles][4].
  void factors(const std::array<double, 3>& depths, float* values) const noexcept;

  /// Factors of one channel at a cosine between view and sun and a depth: `once`, (P + D) / P, for light that was
  /// scattered once, and `glow`, S / P, for all light that tables hold relative to a glow.
  struct Factors {
    double once;
    double glow;
  };
  [[nodiscard]] Factors factors(std::size_t channel, double cosine, double depth) const noexcept;

  /// Returns how much `factors` takes away from the lobe's band of moment chi.
  [[nodiscard]] double loss(std::size_t channel, double chi, double depth) const noexcept;

 private:
  /// One lobe for all channels, or one per channel.
  struct Lobe {
    double asymmetry = 0.0;    ///< g
    double forward = 0.0;      ///< f
    std::vector<double> once;  ///< (P + D) / P: [angles][depths]; none: nothing to correct
    std::vector<double> glow;  ///< S / P: [angles][depths]; none: no glow
    [[nodiscard]] const std::vector<double>& seen() const noexcept { return glow.empty() ? once : glow; }
  };

  [[nodiscard]] const Lobe& lobe(std::size_t channel) const noexcept { return lobes_[lobes_.size() > 1 ? channel : 0]; }

  std::vector<Lobe> lobes_;
};

/// Returns depths x of three channels at an altitude within the air, under each of the tables' `suns` suns; a sun
/// below the horizon counts as on it.
[[nodiscard]] std::vector<std::array<double, 3>> aureole_depths(const Atmosphere& atmosphere,
                                                                const SkyTableOptions& options, const ColourFold& fold,
                                                                const TableMapping& mapping, double altitude, int suns);

}  // namespace welkin::sky
