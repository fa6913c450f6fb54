// Directions of a sky's harmonics: one quadrature against finer ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "budget/budget.h"
#include "jobs/tiles.h"
#include "math/direction.h"
#include "platform/float_environment.h"
#include "welkin/core.h"

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
  const platform::FloatingPointScope floating_point;
  budget::check_budget(budget);
  budget::check_suns(suns);
  BudgetChoice<SkyHarmonicsOptions> choice;
  choice.relative_to = "norm of the sky's radiance coefficients, of the worst sun";
  Quadratures quadratures(view, suns, options);
  const auto look_at = [&](int zeniths, int azimuths, double error) {
    choice.tried.push_back({quadratures.setting(zeniths, azimuths), error + kRounding,
                            kDirectionNanoseconds * quadratures.directions(zeniths, azimuths)});
    return choice.tried.back().error_estimate <= budget.relative;
  };
  std::size_t step = 0;
  for (bool met = false; step < kNodes.size(); ++step) {
    const int nodes = kNodes[step];
    const Lights& fine = quadratures.lights(2 * nodes, 2 * nodes);
    const Lights& between = quadratures.lights(nodes * 3 / 2, nodes * 3 / 2);
    const Lights& coarse = quadratures.lights(nodes, nodes);
    const double error = std::max(budget::worst_difference(coarse, fine), budget::worst_difference(coarse, between));
    met = look_at(nodes, nodes, kSafety * error);
    if (met) break;
  }
  // Fewer azimuths may do with these zeniths.
  for (std::size_t fewer = step; step < kNodes.size() && fewer-- > 0;) {
    const Lights& fine = quadratures.lights(2 * kNodes[step], 2 * kNodes[step]);
    const Lights& coarse = quadratures.lights(kNodes[step], kNodes[fewer]);
    if (!look_at(kNodes[step], kNodes[fewer], kSafety * budget::worst_difference(coarse, fine))) break;
  }
  budget::settle(choice, budget);
  return choice;
}

}  // namespace welkin

namespace welkin::budget {

void check_suns(std::span<const glm::dvec3> suns) {
  if (suns.empty()) throw Error(ErrorCode::invalid_argument, "no sun is named; an estimate needs at least one");
  for (const glm::dvec3& sun : suns) {
    static_cast<void>(math::moderate_direction(sun, "a direction towards the sun"));
  }
}

double worst_difference(std::span<const SphericalHarmonics> a, std::span<const SphericalHarmonics> b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, relative_difference(a[k], b[k]));
  return worst;
}

std::vector<SphericalHarmonics> light_of(const SkyTables& tables, const SkyProbe& probe) {
  // The view wants to share its tables; it does not outlive this call, nor does the pointer own them.
  const std::shared_ptr<const SkyTables> borrowed(std::shared_ptr<const void>(), &tables);
  const SkyProjector projector(SkyView(borrowed, probe.altitude_m));
  std::vector<SphericalHarmonics> lights;
  for (const glm::dvec3& sun : probe.suns) lights.push_back(projector.project(sun));
  return lights;
}

}  // namespace welkin::budget

namespace welkin {
namespace {

// Sizes of a sky's tables, and orders of scattering: what the next better ones changed.

using budget::light_of;
using budget::worst_difference;
using Lights = std::vector<SphericalHarmonics>;

constexpr std::array<double, 4> kScales{0.125, 0.25, 0.5, 1.0};
constexpr double kSizeSafety = 2.0;
constexpr double kOrderSafety = 2.0;
constexpr double kMostRatio = 0.98;  ///< of an order's light to the one before it: above, no sum is worth a guess
constexpr double kTexelNanoseconds =
    600.0;  ///< a texel of the scattering table and order, docs/sky.md: 2 s for 4 orders

SkyTableOptions scaled(const SkyTableOptions& most, double scale) {
  const auto size = [scale](int whole, int least) {
    return std::min(whole, std::max(least, static_cast<int>(std::lround(scale * whole))));
  };
  SkyTableOptions options = most;
  options.heights = size(most.heights, 2);
  options.view_zeniths = std::min(most.view_zeniths, 2 * size((most.view_zeniths + 1) / 2, 4));
  options.sun_zeniths = size(most.sun_zeniths, 4);
  options.sun_angles = size(most.sun_angles, 2);
  options.transmittance_heights = size(most.transmittance_heights, 4);
  options.transmittance_zeniths = size(most.transmittance_zeniths, 8);
  options.irradiance_heights = size(most.irradiance_heights, 2);
  options.irradiance_sun_zeniths = size(most.irradiance_sun_zeniths, 4);
  return options;
}

double predicted(const SkyTableOptions& options) {
  return kTexelNanoseconds * options.orders * options.heights * options.view_zeniths * options.sun_zeniths *
         (options.layout == ScatteringLayout::full ? options.sun_angles : 1);
}

void check_probe(const SkyProbe& probe, const ErrorBudget& budget) {
  budget::check_budget(budget);
  budget::check_suns(probe.suns);
}

/// What all larger tables still change, if differences go on falling as the last two did: by an eighth from size to
/// size at best (interpolation of the third order), by half where that is not known or not so.
double still_to_change(double last, double before) {
  const double ratio = before > 0.0 ? std::clamp(last / before, 0.125, 0.5) : 0.5;
  return std::max(last, ratio * before) * ratio / (1.0 - ratio);
}

/// What the sum of all further orders adds to that of the last one. The ratio of one order to the one before it rises
/// to a limit where much aerosol scatters forwards (0.41, 0.50, 0.53, 0.54 for haze): it is taken to rise once more as
/// much as it last did, or by a third of the way to 1 where that is not known yet.
double further(double last, double before, double before_that) {
  const double ratio = before > 0.0 ? last / before : 0.0;
  const double earlier = before_that > 0.0 ? before / before_that : 0.0;
  const double rise = before_that > 0.0 ? std::max(0.0, ratio - earlier) : (1.0 - ratio) / 3.0;
  const double limit = std::max(ratio, earlier) + rise;
  if (limit >= kMostRatio) return std::numeric_limits<double>::infinity();
  return last * limit / (1.0 - limit);
}

}  // namespace

BudgetChoice<SkyTableOptions> choose_sky_tables(const Atmosphere& atmosphere, const SkyProbe& probe,
                                                const SkyTableOptions& most, const ErrorBudget& budget,
                                                const Control& control) {
  const platform::FloatingPointScope floating_point;
  check_probe(probe, budget);
  BudgetChoice<SkyTableOptions> choice;
  choice.relative_to = "norm of the sky's three bands at the probe's height, of its worst sun";
  double difference_before = 0.0;
  Lights before;
  for (std::size_t step = 0; step < kScales.size(); ++step) {
    const SkyTableOptions setting = scaled(most, kScales[step]);
    const double share = std::pow(0.125, static_cast<double>(kScales.size() - step));
    Lights lights = light_of(precompute_sky(atmosphere, setting, jobs::part_of(control, share, 8.0 * share)), probe);
    if (step > 0) {
      const double difference = worst_difference(before, lights);
      const double error = kSizeSafety * still_to_change(difference, difference_before) + kRounding;
      choice.tried.push_back({setting, error, predicted(setting)});
      difference_before = difference;
      if (error <= budget.relative) break;
    }
    before = std::move(lights);
  }
  if (control.progress) control.progress(1.0);
  budget::settle(choice, budget);
  return choice;
}

BudgetChoice<SkyTableOptions> choose_sky_orders(const Atmosphere& atmosphere, const SkyProbe& probe,
                                                const SkyTableOptions& most, const ErrorBudget& budget,
                                                const Control& control) {
  const platform::FloatingPointScope floating_point;
  check_probe(probe, budget);
  BudgetChoice<SkyTableOptions> choice;
  choice.relative_to = "norm of the sky's three bands of all orders at the probe's height, of its worst sun";
  SkyTableOptions small = scaled(most, 0.25);
  small.until_change = 0.0;
  double before = 0.0;
  double before_that = 0.0;
  Lights lights;
  // The change that order n brings says what n - 1 orders lack.
  for (int orders = 1; orders <= std::min(64, most.orders + 1); ++orders) {
    small.orders = orders;
    Lights next = light_of(precompute_sky(atmosphere, small, {control.stop, {}}), probe);
    if (orders > 1) {
      const double last = worst_difference(lights, next);
      SkyTableOptions setting = most;
      setting.orders = orders - 1;
      const double error =
          orders == 2 ? std::numeric_limits<double>::infinity() : last + further(last, before, before_that);
      choice.tried.push_back({setting, kOrderSafety * error + kRounding, predicted(setting)});
      before_that = before;
      before = last;
      if (choice.tried.back().error_estimate <= budget.relative) break;
    }
    lights = std::move(next);
    if (control.progress) control.progress(static_cast<double>(orders) / (most.orders + 2));
  }
  if (control.progress) control.progress(1.0);
  budget::settle(choice, budget);
  return choice;
}

}  // namespace welkin
