// An environment that was turned or scaled: what stays, and what is turned and scaled with it.
#include <cmath>
#include <string>
#include <utility>

#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/plan.h"

namespace welkin {
namespace {

bool turns(const EnvironmentChange& change) { return change.turn != glm::dmat3(1.0); }
bool scales(const EnvironmentChange& change) { return change.scale != glm::dvec3(1.0); }

void check(const EnvironmentChange& change) {
  for (glm::length_t c = 0; c < 3; ++c) {
    if (change.scale[c] >= 0.0 && std::isfinite(change.scale[c])) continue;
    throw Error(ErrorCode::invalid_argument, "an environment cannot be scaled by " + std::to_string(change.scale[c]) +
                                                 "; pass a finite factor that is not negative");
  }
  // Refuses what is no turn, whether or not there is light to turn.
  if (turns(change)) static_cast<void>(transform(SphericalHarmonics(1), change.turn));
}

std::string how(const EnvironmentChange& change) {
  if (turns(change)) return scales(change) ? "turned and scaled" : "turned";
  return scales(change) ? "scaled" : "as it was";
}

bool evaluates_irradiance(const BakeOptions& baked) {
  return baked.irradiance_size > 0 && baked.bands > 0 && baked.irradiance_method == IrradianceMethod::harmonics;
}

PlannedPass kept(std::string name, bool is_there, const EnvironmentChange& change) {
  if (!is_there) return {std::move(name), PassAction::skip, "there is none", 0.0, 0};
  return {std::move(name), PassAction::reuse, "lookups are " + how(change) + " by the shader", 0.0, 0};
}

}  // namespace

Plan plan_change(const BakeOptions& baked, const EnvironmentChange& change, const CostModel& costs) {
  check(change);
  constexpr double kNanoseconds = 1e6;  // in a millisecond
  constexpr std::uint64_t kTexelBytes = 3 * sizeof(float);
  Plan plan;
  plan.source = "an environment that was baked before, " + how(change);
  plan.options = baked;
  plan.passes = {{"clean", PassAction::skip, "no pixel is read", 0.0, 0},
                 kept("specular", baked.specular.has_value(), change),
                 kept("background", baked.background, change),
                 kept("background mips", baked.background && baked.background_mips, change)};
  if (baked.bands > 0) {
    plan.passes.push_back({"project", PassAction::reuse, "coefficients, " + how(change), 0.0, 0});
  } else {
    plan.passes.push_back({"project", PassAction::skip, "there are no coefficients", 0.0, 0});
  }
  const double texels = 6.0 * baked.irradiance_size * baked.irradiance_size;
  if (evaluates_irradiance(baked)) {
    const double cost = costs.irradiance_term * texels * baked.bands * baked.bands / kNanoseconds;
    plan.result_bytes = kTexelBytes * static_cast<std::uint64_t>(texels);
    plan.passes.push_back(
        {"irradiance", PassAction::run, "from the coefficients, " + how(change), cost, plan.result_bytes});
  } else {
    plan.passes.push_back(kept("irradiance", baked.irradiance_size > 0, change));
  }
  if (baked.brdf) {
    plan.passes.push_back({"brdf", PassAction::reuse, "it depends on no scene", 0.0, 0});
  } else {
    plan.passes.push_back({"brdf", PassAction::skip, "there is none", 0.0, 0});
  }
  return plan;
}

void apply_change(BakeResult& result, const BakeOptions& baked, const EnvironmentChange& change,
                  const Control& control) {
  check(change);
  result.diagnostics.flux *= change.scale;
  result.diagnostics.flux_before_clamp *= change.scale;
  if (!result.radiance) return;
  SphericalHarmonics radiance = *result.radiance;
  if (turns(change)) radiance = transform(radiance, change.turn);
  if (scales(change)) radiance = scale(radiance, change.scale);
  if (evaluates_irradiance(baked)) {
    result.irradiance = irradiance_cubemap(irradiance_from_radiance(radiance), baked.irradiance_size, control);
  }
  result.radiance = std::move(radiance);
}

}  // namespace welkin
