#include "reflections/prefilter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sanitized_pixels.h"
#include "reflections/band_choice.h"
#include "reflections/cube_rings.h"
#include "reflections/lobe.h"
#include "reflections/lobe_chain.h"
#include "reflections/near_sums.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"

namespace welkin::reflections {

void fill_level(const projection::SanitizedSource& source, Cubemap& chain, int level, const Control& control) {
  const int size = chain.level_size(level);
  const CubemapView& cube = source.cube();
  if (!source.cubemap()) {
    image::fill_cubemap(source.lat_long(), chain, level, ResampleFilter::area, control);
  } else if (cube.size == size) {
    const std::size_t row_values = 3 * static_cast<std::size_t>(size);
    float* to = chain.face(level, 0);
    for (int row = 0; row < source.rows(); ++row, to += row_values) {
      jobs::throw_if_cancelled(control);
      std::memcpy(to, source.row(row), row_values * sizeof(float));
    }
    if (control.progress) control.progress(1.0);
  } else {
    const Cubemap image = to_cubemap(cube, size, glm::dmat3(1.0), ResampleFilter::area, control);
    std::copy(image.pixels().begin(), image.pixels().end(), chain.face(level, 0));
  }
}

void describe_pixels(const ProjectionDiagnostics& sanitized, const glm::dvec3& clamped_radiance,
                     PrefilteredSpecular& specular) {
  std::vector<PassRecord> passes = std::move(specular.pixels.passes);
  specular.pixels = sanitized;
  specular.pixels.passes = std::move(passes);
  specular.pixels.total_radiance = 4.0 * std::numbers::pi * specular.mips.front().mean;
  specular.pixels.total_radiance_before_clamp = specular.pixels.total_radiance + clamped_radiance;
}

void make_tables(const PrefilterPlan& plan, int face_size, const Control& control) {
  if (plan.bands == 0) return;
  const PrefilterPlan step = plan.at_step(0, {true, face_size, face_size});
  for (const MipPlan& mip : step.mips) {
    if (mip.near.face > 0) static_cast<void>(NearTable::get(mip.near));
  }
  RingTable::get({step.face_for_cubemap(face_size), step.rows_for_cubemap()}, {control.stop});
}

float safe_scale(const projection::SanitizedSource& source) noexcept {
  constexpr float kHuge = 1e18F;      // sums of squares of what is larger may exceed the range of floats
  constexpr float kDown = 0x1p-100F;  // makes of the largest float 2.7e8
  constexpr float kDark = 1e-25F;
  constexpr float kUp = 0x1p100F;
  float largest = 0.0F;
  for (int row = 0; row < source.rows(); ++row)
    largest = std::max({largest, source.range(row).largest, -source.range(row).least});
  if (largest > kHuge) return kDown;
  return largest > 0.0F && largest < kDark ? kUp : 1.0F;
}

namespace {

/// Exact, but for what is 1e50 times darker than the brightest.
std::vector<float> scaled_pixels(const projection::SanitizedSource& source, float scale) {
  const auto row_values = std::size_t{3} * static_cast<std::size_t>(source.columns());
  std::vector<float> pixels;
  pixels.reserve(row_values * static_cast<std::size_t>(source.rows()));
  for (int row = 0; row < source.rows(); ++row) {
    const float* const values = source.row(row);
    for (std::size_t k = 0; k < row_values; ++k) pixels.push_back(values[k] * scale);
  }
  return pixels;
}

/// Takes what was made of such an image over the same scale. No value rounds beyond the floats.
void undo_scale(PrefilteredSpecular& result, float scale) {
  static constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  const double back = 1.0 / static_cast<double>(scale);
  Cubemap& chain = result.cubemap;
  for (int level = 0; level < chain.levels(); ++level) {
    const auto edge = static_cast<std::size_t>(chain.level_size(level));
    float* const values = chain.face(level, 0);
    std::transform(values, values + 18 * edge * edge, values, [back](float value) {
      return static_cast<float>(std::clamp(back * static_cast<double>(value), -most, most));
    });
  }
  for (MipRecord& mip : result.mips) mip.mean *= back;
}

}  // namespace

PrefilteredSpecular prefilter(const projection::SanitizedSource& source, const PrefilterPlan& plan, Cubemap into,
                              const Control& control, IrradianceMap* irradiance) {
  const float scale = safe_scale(source);
  if (scale == 1.0F) return LobeChain(source, plan, std::move(into), control.memory).run(control, scale, irradiance);
  LatLongImage lat_long;
  Cubemap cube;
  if (source.cubemap())
    cube = {source.columns(), scaled_pixels(source, scale)};
  else
    lat_long = {source.columns(), source.rows(), scaled_pixels(source, scale)};
  const projection::SanitizedSource scaled(
      source.cubemap() ? EnvironmentView(cube.view()) : EnvironmentView(lat_long.view()), {}, {control.stop, {}});
  PrefilteredSpecular result = LobeChain(scaled, plan, std::move(into), control.memory).run(control, scale, irradiance);
  undo_scale(result, scale);
  return result;
}

PrefilteredSpecular prefilter(const EnvironmentView& view, const PrefilterPlan& plan, const PixelPolicy& pixels,
                              Cubemap into, const Control& control) {
  const projection::SanitizedSource source(view, pixels, jobs::part_of(control, 0.0, 0.05));
  PrefilteredSpecular result = prefilter(source, plan, std::move(into), jobs::part_of(control, 0.05, 1.0));
  result.peak_bytes += source.bytes();
  describe_pixels(source.diagnostics(), source.clamped_radiance(), result);
  return result;
}

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

namespace welkin {

const char* name(PrefilterMethod method) noexcept {
  static constexpr std::array kNames{"automatic", "spectral", "reference"};
  return platform::name_in<PrefilterMethod::reference>(kNames, method, "automatic");
}

const char* name(MipMethod method) noexcept {
  static constexpr std::array kNames{"copy", "spectral", "reference", "stored", "near_far"};
  return platform::name_in<MipMethod::near_far>(kNames, method, "copy");
}

PrefilteredSpecular prefilter_specular(const EnvironmentView& source, const PrefilterOptions& options,
                                       const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  return reflections::prefilter(source, reflections::plan_prefilter(options), options.pixels, {}, control);
}

}  // namespace welkin
