#include "reflections/irradiance.h"

#include <algorithm>
#include <memory>
#include <numbers>

#include "platform/text.h"
#include "reflections/band_choice.h"
#include "reflections/lobe.h"
#include "transform/spectrum.h"
#include "welkin/projection.h"

namespace welkin::reflections {
namespace {

constexpr double kLambertAlpha = 1.0;  ///< the GGX lobe of roughness 1 is the clipped cosine

constexpr double kMinHarmonicsError = 1e-5;  ///< below, float sums leave too little of a bound
constexpr double kLargestOverRms = 10.0;     ///< largest error of a texel over the rms error, of bounds
constexpr double kIntegralError = 2e-7;      ///< of a sum in double that is rounded to floats

void add_irradiance(PrefilterPlan& plan, int size, const ErrorBounds& bounds) {
  MipPlan& mip = plan.irradiance.emplace();
  mip.size = size;
  mip.roughness = 1.0;
  mip.alpha = kLambertAlpha;
  mip.lobe = std::make_shared<const Lobe>(kLambertAlpha);
  mip.method = MipMethod::spectral;
  mip.bands = tapered_lobe(kLambertAlpha, first_bands_within(kLambertAlpha, bounds));
  plan.irradiance_bounds = bounds;
}

ErrorBounds bounds_of(double rms_error) { return {rms_error, kLargestOverRms * rms_error}; }

}  // namespace

void check_irradiance_error(double rms_error) {
  if (rms_error >= 1e-6 && rms_error <= 1.0) return;
  throw Error(ErrorCode::invalid_argument,
              "irradiance.rms_error is " + platform::number_text(rms_error) + "; it must be from 1e-6 to 1");
}

PrefilterPlan plan_irradiance(int size, double rms_error) {
  PrefilterPlan plan;
  plan.bounds = bounds_of(rms_error);
  add_irradiance(plan, size, plan.bounds);
  if (rms_error < kMinHarmonicsError) return plan;
  plan.bands = std::max(plan.irradiance->bands.bands(), first_bands_for_dark(plan.bounds));
  plan.reach = reach_for(plan.bounds.rms, plan.bounds.maximum);
  plan.light_alpha = kMatteLightAlpha;
  plan.may_integrate = true;
  return plan;
}

bool share_harmonics(PrefilterPlan& chain, int size, double rms_error) {
  const ErrorBounds bounds = bounds_of(rms_error);
  const bool fine = chain.lights.of == LightsOf::ggx && chain.bands >= first_bands_for_dark(bounds) &&
                    chain.bounds.rms <= bounds.rms && chain.reach >= reach_for(bounds.rms, bounds.maximum);
  if (!fine || rms_error < kMinHarmonicsError) return false;
  add_irradiance(chain, size, bounds);
  return true;
}

IrradianceMap irradiance_cubemap(const projection::SanitizedSource& source, PrefilterPlan plan,
                                 const Control& control) {
  if (plan.bands == 0) return integrated_irradiance(source, plan.irradiance->size, control);
  plan.mips.clear();
  IrradianceMap made;
  static_cast<void>(prefilter(source, plan, {}, control, &made));
  return made;
}

IrradianceMap integrated_irradiance(const projection::SanitizedSource& source, int size, const Control& control) {
  IrradianceMap made;
  made.cubemap = source.cubemap() ? direct_irradiance_cubemap(source.cube(), size, control)
                                  : direct_irradiance_cubemap(source.lat_long(), size, control);
  made.record.size = size;
  made.record.roughness = 1.0;
  made.record.method = MipMethod::reference;
  made.record.error_estimate = kIntegralError;
  made.record.mean = mean_radiance(project(made.cubemap.view(), {.bands = 1}, {control.stop, {}}).radiance);
  return made;
}

}  // namespace welkin::reflections
