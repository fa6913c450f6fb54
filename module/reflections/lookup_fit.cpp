// Lobes of mips that linear lookups between them bring nearest to the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "reflections/lookups.h"

namespace welkin::reflections {
namespace {

constexpr int kDegrees = 512;    ///< of the image at most
constexpr int kFitSamples = 8;   ///< roughnesses between two mips
constexpr int kSteps = 10;       ///< of Gauss-Newton; the last ones change a roughness by less than 1e-6
constexpr double kSlope = 0.01;  ///< of a roughness, by which its spectrum's slope is found

using Spectrum = std::vector<double>;

/// What a typical image has of each degree: a power law between that of landscapes, l^-3 per harmonic, and that of
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
  double weight;  ///< how many materials have such a roughness, over the mean square of the truth
};

/// The squared error of all lookups as a function of the mips' lobes: Gauss-Newton, whose equations are tridiagonal, as
/// a lookup reads two mips.
///
/// With g_k(l) what mip k shows of degree l, e_l = t_l - (1 - f) g_k - f g_(k+1) is what a lookup misses, and its
/// squared error Sum_l S_l e_l^2. To first order in steps d of the lobes' roughness, with slopes g', it is least where
/// for each mip
///   Sum over its lookups of weight share (Sum_l S_l g' (e - share g' d - other share other g' other d)) = 0:
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
  /// Returns what a shader shows of each degree where it reads one mip.
  [[nodiscard]] Spectrum shown(std::size_t mip, double roughness, int degrees) const {
    Spectrum spectrum = spectrum_of(roughness, degrees);
    for (std::size_t l = 0; l < spectrum.size(); ++l) spectrum[l] *= filters_[mip].gain[l];
    return spectrum;
  }

  void improve() {
    const std::size_t count = lobes_.size();
    const auto degrees = static_cast<int>(energies_.size());
    std::vector<Spectrum> here;
    std::vector<Spectrum> slopes;
    for (std::size_t k = 0; k < count; ++k) {
      here.push_back(shown(k, lobes_[k], degrees));
      slopes.push_back(shown(k, lobes_[k] * (1.0 - kSlope), degrees));
      for (std::size_t l = 0; l < slopes.back().size() && k > 0; ++l)
        slopes.back()[l] = (here.back()[l] - slopes.back()[l]) / (lobes_[k] * kSlope);
    }
    std::vector<double> diagonal(count, 0.0);
    std::vector<double> beside(count, 0.0);  // between a mip and the next
    std::vector<double> right(count, 0.0);
    for (const Wanted& lookup : wanted_) {
      const std::size_t k = lookup.mip;
      const double first = 1.0 - lookup.share;
      Spectrum missing = lookup.truth;
      for (std::size_t l = 0; l < missing.size(); ++l) missing[l] -= first * here[k][l] + lookup.share * here[k + 1][l];
      diagonal[k] += lookup.weight * first * first * product(energies_, slopes[k], slopes[k]);
      diagonal[k + 1] += lookup.weight * lookup.share * lookup.share * product(energies_, slopes[k + 1], slopes[k + 1]);
      beside[k] += lookup.weight * first * lookup.share * product(energies_, slopes[k], slopes[k + 1]);
      right[k] += lookup.weight * first * product(energies_, missing, slopes[k]);
      right[k + 1] += lookup.weight * lookup.share * product(energies_, missing, slopes[k + 1]);
    }
    move(diagonal, beside, right);
  }

  /// Solves the equations and moves the lobes. Mip 0, mips that no lookup reads, and lobes that would exceed roughness
  /// 1 stay. A lobe that stays has the equation d = 0 and no neighbours; the others by elimination downwards and
  /// substitution upwards, without pivots, as the matrix is positive definite (Gram's of the slopes).
  void move(std::vector<double>& diagonal, std::vector<double>& beside, std::vector<double>& right) {
    const std::size_t count = lobes_.size();
    const auto stays = [&](std::size_t k) {
      return k == 0 || !(diagonal[k] > 0.0) || (lobes_[k] >= 1.0 && right[k] >= 0.0);
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
    reflections::Fit lobes(nominal, {schedule, mips, size}, std::min(reflections::kDegrees, 2 * size));
    return math::number_table(lobes.run());
  };
  static auto& fits = *new math::TableCache<reflections::FitKey, math::NumberTable>(1U << 14U);  // never destroyed
  return fits.get({schedule, mips, size}, fit)->values;
}

}  // namespace welkin
