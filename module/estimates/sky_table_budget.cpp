// Sizes of a sky's tables, and orders of scattering: what the next better ones changed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "estimates/budget.h"
#include "estimates/sky_probe.h"
#include "jobs/tiles.h"

namespace welkin {
namespace {

using estimates::light_of;
using estimates::worst_difference;
using Lights = std::vector<SphericalHarmonics>;

constexpr std::array<double, 4> kScales{0.125, 0.25, 0.5, 1.0};
constexpr double kSizeSafety = 2.0;
constexpr double kOrderSafety = 1.5;
constexpr double kRounding = 1e-6;
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
  estimates::check_budget(budget);
  estimates::check_suns(probe.suns);
}

/// What all larger tables still change, if differences go on falling as the last two did: by a quarter from size to
/// size at best (interpolation of the second order), by half where that is not known or not so.
double still_to_change(double last, double before) {
  const double ratio = before > 0.0 ? std::clamp(last / before, 0.25, 0.5) : 0.5;
  return std::max(last, ratio * before) * ratio / (1.0 - ratio);
}

/// What the sum of all further orders adds to that of the last one, if they go on falling as the last three did.
double further(double last, double before, double before_that) {
  const double ratio = std::max(before > 0.0 ? last / before : 0.0, before_that > 0.0 ? before / before_that : 0.0);
  if (ratio >= kMostRatio) return std::numeric_limits<double>::infinity();
  return last * ratio / (1.0 - ratio);
}

}  // namespace

BudgetChoice<SkyTableOptions> choose_sky_tables(const Atmosphere& atmosphere, const SkyProbe& probe,
                                                const SkyTableOptions& most, const ErrorBudget& budget,
                                                const Control& control) {
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
  estimates::settle(choice, budget);
  return choice;
}

BudgetChoice<SkyTableOptions> choose_sky_orders(const Atmosphere& atmosphere, const SkyProbe& probe,
                                                const SkyTableOptions& most, const ErrorBudget& budget,
                                                const Control& control) {
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
      if (choice.tried.back().estimated_error <= budget.relative) break;
    }
    lights = std::move(next);
    if (control.progress) control.progress(static_cast<double>(orders) / (most.orders + 2));
  }
  if (control.progress) control.progress(1.0);
  estimates::settle(choice, budget);
  return choice;
}

}  // namespace welkin
