// Lobes of mips that bring linear lookups between them nearest to the reference.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "reflections/lookups.h"

namespace welkin::reflections {
namespace {

constexpr int kDegrees = 512;    ///< of the image, however few texels the chain has: they alias what is finer
constexpr int kFitSamples = 8;   ///< roughnesses between two mips
constexpr int kSteps = 10;       ///< of Gauss-Newton; the last ones change a roughness by less than 1e-6
constexpr double kSlope = 0.01;  ///< of a roughness, by which its spectrum's slope is found

using Spectrum = std::vector<double>;

/// Returns a typical image's energy per degree: a power law between that of landscapes, l^-3 per harmonic, and that of
/// images with lamps, l^-2.
Spectrum typical_energies(int degrees) {
  Spectrum energies{9.0};
  for (int l = 1; l < degrees; ++l)
    energies.push_back((2.0 * l + 1.0) / (static_cast<double>(l) * l * std::sqrt(static_cast<double>(l))));
  return energies;
}

/// Sum of the degrees of a times b, weighted by energies.
double product(const Spectrum& energies, const Spectrum& a, const Spectrum& b) {
  double sum = 0.0;
  for (std::size_t l = energies.size(); l-- > 0;) sum += energies[l] * a[l] * b[l];
  return sum;
}

/// A lookup between a mip and the next.
struct Wanted {
  std::size_t mip;
  double share;  ///< of the next mip
  Spectrum truth;
  double weight;  ///< how many materials have such a roughness, over the mean square of the reference
};

/// The squared error of all lookups as a function of the mips' lobes: Gauss-Newton, whose equations are tridiagonal, as
/// a lookup reads two mips.
///
/// With g_k(l) what mip k shows of degree l, e_l = t_l - (1 - f) g_k - f g_(k+1) is what a lookup misses. Texels that
/// are wide for a lobe also show a_k(l) of it in other degrees, so the squared error is
///   Sum_l S_l (e_l^2 + ((1 - f) a_k)^2 + (f a_(k+1))^2).
/// To first order in steps d of the lobes' roughness, with slopes g' and a', it is least where for each mip
///   Sum over its lookups of weight share Sum_l S_l (g' (e - share g' d - other share other g' other d)
///                                                   - share a' (a + a' d)) = 0:
/// a row has the mip's own product of slopes (`diagonal`) and those with its two neighbours (`beside`).
class Fit {
 public:
  Fit(const std::vector<double>& roughness, const LookupFormula& formula, int degrees)
      : energies_(typical_energies(degrees)), lobes_(roughness) {
    for (std::size_t mip = 0; mip < lobes_.size(); ++mip)
      filters_.emplace_back(std::max(1, formula.size >> mip), roughness[mip], degrees);
    for (std::size_t mip = 0; mip + 1 < lobes_.size(); ++mip) {
      const MipPair pair{static_cast<int>(mip), {roughness[mip], roughness[mip + 1]}};
      const double width = (roughness[mip + 1] - roughness[mip]) / kFitSamples;
      for (const Lookup& lookup : lookups_between(pair, formula, kFitSamples)) {
        Spectrum truth = spectrum_of(lookup.roughness, degrees);
        const double weight = width / product(energies_, truth, truth);
        wanted_.push_back({mip, lookup.share, std::move(truth), weight});
      }
    }
  }

  std::vector<double> run() {
    for (int step = 0; step < kSteps; ++step) improve();
    // Lobes of one or two texels may come out narrower than the mip before has them.
    for (std::size_t mip = 1; mip < lobes_.size(); ++mip) lobes_[mip] = std::max(lobes_[mip], lobes_[mip - 1]);
    return lobes_;
  }

 private:
  /// Factors by which a shader that reads one mip shows each degree.
  struct Shown {
    Spectrum here;
    Spectrum slope;
    double squares = 0.0;  ///< of slopes, both what is shown of the degree and in others
    double aliases = 0.0;  ///< what is shown in others times its slope
  };

  [[nodiscard]] Shown shown(std::size_t mip) const {
    const auto degrees = static_cast<int>(energies_.size());
    const double step = lobes_[mip] * kSlope;
    const Spectrum lobe = spectrum_of(lobes_[mip], degrees);
    const Spectrum narrower = spectrum_of(lobes_[mip] - step, degrees);
    Shown shown;
    for (std::size_t l = 0; l < lobe.size(); ++l) {
      const double gain = filters_[mip].gain[l];
      const double noise = filters_[mip].noise[l];
      const double slope = mip > 0 ? (lobe[l] - narrower[l]) / step : 0.0;
      shown.here.push_back(lobe[l] * gain);
      shown.slope.push_back(slope * gain);
      shown.squares += energies_[l] * (gain * gain + noise) * slope * slope;
      shown.aliases += energies_[l] * noise * lobe[l] * slope;
    }
    return shown;
  }

  void improve() {
    const std::size_t count = lobes_.size();
    std::vector<Shown> mips;
    for (std::size_t k = 0; k < count; ++k) mips.push_back(shown(k));
    std::vector<double> diagonal(count, 0.0);
    std::vector<double> beside(count, 0.0);  // between a mip and the next
    std::vector<double> right(count, 0.0);
    for (const Wanted& lookup : wanted_) {
      const std::size_t k = lookup.mip;
      const double first = 1.0 - lookup.share;
      Spectrum missing = lookup.truth;
      for (std::size_t l = 0; l < missing.size(); ++l)
        missing[l] -= first * mips[k].here[l] + lookup.share * mips[k + 1].here[l];
      for (const auto& [mip, share] : {std::pair{k, first}, std::pair{k + 1, lookup.share}}) {
        diagonal[mip] += lookup.weight * share * share * mips[mip].squares;
        right[mip] +=
            lookup.weight * share * (product(energies_, missing, mips[mip].slope) - share * mips[mip].aliases);
      }
      beside[k] += lookup.weight * first * lookup.share * product(energies_, mips[k].slope, mips[k + 1].slope);
    }
    move(diagonal, beside, right);
  }

  /// Solves the equations and moves the lobes. Mip 0, mips that no lookup reads, lobes that would exceed roughness 1,
  /// and those too narrow for the degrees that are looked at (the last one keeps e^-1 of its light) stay. A lobe that
  /// stays has the equation d = 0 and no neighbours; the others by elimination downwards and substitution upwards,
  /// without pivots, as the matrix is positive definite (Gram's of the slopes).
  void move(std::vector<double>& diagonal, std::vector<double>& beside, std::vector<double>& right) {
    const std::size_t count = lobes_.size();
    const double narrowest =
        std::sqrt(0.5 / static_cast<double>(energies_.size()));  // 2 alpha l = 1 at the last degree
    const auto stays = [&](std::size_t k) {
      return k == 0 || !(diagonal[k] > 0.0) || (lobes_[k] >= 1.0 && right[k] >= 0.0) || lobes_[k] < narrowest;
    };
    for (std::size_t k = 0; k < count; ++k) {
      if (!stays(k)) continue;
      diagonal[k] = 1.0;
      right[k] = 0.0;
      beside[k] = 0.0;
      if (k > 0) beside[k - 1] = 0.0;
    }
    for (std::size_t k = 1; k < count; ++k) {
      const double share = beside[k - 1] / diagonal[k - 1];
      diagonal[k] -= share * beside[k - 1];
      right[k] -= share * right[k - 1];
    }
    double after = 0.0;
    for (std::size_t k = count; k-- > 1;) {
      after = (right[k] - (k + 1 < count ? beside[k] * after : 0.0)) / diagonal[k];
      constexpr double kFarthest = 0.2;  // a step, of the roughness
      const double most = kFarthest * lobes_[k];
      lobes_[k] = std::min(1.0, lobes_[k] + std::clamp(after, -most, most));
    }
  }

  Spectrum energies_;
  std::vector<double> lobes_;
  std::vector<TexelFilter> filters_;  ///< of each mip
  std::vector<Wanted> wanted_;
};

struct FitKey {
  RoughnessSchedule schedule;
  int mips;
  int size;
  bool operator==(const FitKey&) const = default;
};

}  // namespace
}  // namespace welkin::reflections

namespace welkin {

std::vector<double> fitted_mip_roughness(RoughnessSchedule schedule, int mips, int size) {
  const platform::FloatingPointScope floating_point;
  const auto fit = [&] {
    const std::vector<double> nominal = mip_roughness(schedule, mips, size);
    reflections::Fit lobes(nominal, {schedule, mips, size}, reflections::kDegrees);
    return math::number_table(lobes.run());
  };
  static auto& fits = *new math::TableCache<reflections::FitKey, math::NumberTable>(1U << 14U);  // never destroyed
  return fits.get({schedule, mips, size}, fit)->values;
}

}  // namespace welkin
