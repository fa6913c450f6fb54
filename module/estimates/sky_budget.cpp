// Directions of a sky's harmonics: one quadrature against finer ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "estimates/budget.h"
#include "estimates/sky_probe.h"

namespace welkin {
namespace {

/// Nodes along zenith and azimuth: each is half and two thirds of later ones.
constexpr std::array<int, 10> kNodes{4, 6, 8, 12, 16, 24, 32, 48, 64, 96};
constexpr int kMost = 128;
/// A quadrature differs from one of twice the nodes by its own error, less the other's: see docs/error_budget.md.
constexpr double kSafety = 3.0;
constexpr double kRounding = 1e-6;
constexpr double kDirectionNanoseconds = 10.0;  ///< docs/sky.md: 4 to 6 us for 512 directions

using Lights = std::vector<SphericalHarmonics>;

/// Results of quadratures, each computed once.
class Quadratures {
 public:
  Quadratures(SkyView view, std::span<const glm::dvec3> suns, const SkyHarmonicsOptions& options)
      : view_(std::move(view)), suns_(suns.begin(), suns.end()), options_(options) {}

  [[nodiscard]] SkyHarmonicsOptions setting(int zeniths, int azimuths) const {
    SkyHarmonicsOptions setting = options_;
    setting.zeniths = std::min(zeniths, kMost);
    setting.azimuths = std::min(azimuths, 2 * kMost);
    return setting;
  }

  const Lights& lights(int zeniths, int azimuths) { return entry(zeniths, azimuths).lights; }
  int directions(int zeniths, int azimuths) { return entry(zeniths, azimuths).directions; }

 private:
  struct Entry {
    Lights lights;
    int directions = 0;
  };

  const Entry& entry(int zeniths, int azimuths) {
    const auto [found, fresh] = entries_.try_emplace({zeniths, azimuths});
    if (!fresh) return found->second;
    const SkyProjector projector(view_, setting(zeniths, azimuths));
    for (const glm::dvec3& sun : suns_) found->second.lights.push_back(projector.project(sun));
    found->second.directions = projector.directions();
    return found->second;
  }

  SkyView view_;
  std::vector<glm::dvec3> suns_;
  SkyHarmonicsOptions options_;
  std::map<std::pair<int, int>, Entry> entries_;
};

}  // namespace

BudgetChoice<SkyHarmonicsOptions> choose_sky_harmonics(const SkyView& view, std::span<const glm::dvec3> suns,
                                                       const SkyHarmonicsOptions& options, const ErrorBudget& budget) {
  estimates::check_budget(budget);
  estimates::check_suns(suns);
  BudgetChoice<SkyHarmonicsOptions> choice;
  choice.relative_to = "norm of the sky's radiance coefficients, of the worst sun";
  Quadratures quadratures(view, suns, options);
  const auto look_at = [&](int zeniths, int azimuths, double error) {
    choice.tried.push_back({quadratures.setting(zeniths, azimuths), error + kRounding,
                            kDirectionNanoseconds * quadratures.directions(zeniths, azimuths)});
    return choice.tried.back().estimated_error <= budget.relative;
  };
  std::size_t step = 0;
  for (bool met = false; step < kNodes.size(); ++step) {
    const int nodes = kNodes[step];
    const Lights& fine = quadratures.lights(2 * nodes, 2 * nodes);
    const Lights& between = quadratures.lights(nodes * 3 / 2, nodes * 3 / 2);
    const Lights& coarse = quadratures.lights(nodes, nodes);
    const double error =
        std::max(estimates::worst_difference(coarse, fine), estimates::worst_difference(coarse, between));
    met = look_at(nodes, nodes, kSafety * error);
    if (met) break;
  }
  // Fewer azimuths may do with these zeniths.
  for (std::size_t fewer = step; step < kNodes.size() && fewer-- > 0;) {
    const Lights& fine = quadratures.lights(2 * kNodes[step], 2 * kNodes[step]);
    const Lights& coarse = quadratures.lights(kNodes[step], kNodes[fewer]);
    if (!look_at(kNodes[step], kNodes[fewer], kSafety * estimates::worst_difference(coarse, fine))) break;
  }
  estimates::settle(choice, budget);
  return choice;
}

}  // namespace welkin
