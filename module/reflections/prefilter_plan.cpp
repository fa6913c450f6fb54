#include "reflections/prefilter_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "image/pixels.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "transform/ring_fft.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

constexpr int kLargestSize = 8192;
constexpr double kLeastAlpha = 1e-6;       ///< below, a lobe is narrower than any texel by far: a copy
constexpr double kKinkOversampling = 2.0;  ///< of the synthesis' rings: a kink's last bands are not as small as GGX's
constexpr double kLeastRmsError = 1e-6;    ///< what float arithmetic leaves
constexpr double kLeastMaximumError = 1e-5;

[[noreturn]] void refuse(ErrorCode code, const std::string& message) { throw Error(code, message); }

void check_error_bound(const char* what, double value, double least, PrefilterMethod method) {
  if (!(value > 0.0 && value <= 1.0))
    refuse(ErrorCode::invalid_argument,
           std::string(what) + " is " + platform::number_text(value) + "; it must be above 0, at most 1");
  if (value >= least || method == PrefilterMethod::reference) return;
  refuse(ErrorCode::limit_exceeded, std::string(what) + " below " + (least < 5e-6 ? "1e-6" : "1e-5") +
                                        " is more than float arithmetic gives; the reference method has no bound");
}

std::vector<double> roughness_of(const PrefilterOptions& options, int mips) {
  if (options.roughness.empty()) return roughness_of_mips(RoughnessSchedule::filament, mips, options.size);
  if (options.roughness.size() < static_cast<std::size_t>(mips)) {
    refuse(ErrorCode::invalid_argument, std::to_string(mips) + " mips, but roughness names " +
                                            std::to_string(options.roughness.size()) + "; it needs one for each mip");
  }
  for (std::size_t mip = 0; mip < static_cast<std::size_t>(mips); ++mip) {
    const double roughness = options.roughness[mip];
    if (roughness >= 0.0 && roughness <= 1.0) continue;
    refuse(ErrorCode::invalid_argument, "roughness of mip " + std::to_string(mip) + " is " +
                                            platform::number_text(roughness) + "; it must be from 0 to 1");
  }
  return options.roughness;
}

int mips_of(const PrefilterOptions& options) {
  const int whole = full_chain_levels(options.size);
  const int named = options.roughness.empty() ? mips_of_chain(RoughnessSchedule::filament, options.size)
                                              : static_cast<int>(std::min<std::size_t>(options.roughness.size(), 99));
  const int mips = options.mips.value_or(named);
  if (mips >= 1 && mips <= whole) return mips;
  refuse(ErrorCode::invalid_argument, std::to_string(mips) + " mips; a cubemap of " + std::to_string(options.size) +
                                          " texels along an edge has 1 to " + std::to_string(whole));
}

MipMethod method_for(const PrefilterOptions& options, double reach, const MipPlan& mip) {
  if (mip.alpha < kLeastAlpha) return MipMethod::copy;
  if (options.method == PrefilterMethod::reference) return MipMethod::reference;
  const double bands = reach / (2.0 * mip.alpha);
  if (bands <= transforms::kMaximumSpectrumBands) return MipMethod::spectral;
  if (options.method == PrefilterMethod::automatic) return MipMethod::narrow;
  refuse(ErrorCode::limit_exceeded, "roughness " + platform::number_text(mip.roughness) + " needs " +
                                        std::to_string(static_cast<std::int64_t>(std::ceil(bands))) +
                                        " harmonic bands, " + std::to_string(transforms::kMaximumSpectrumBands) +
                                        " are possible; take another method, or automatic");
}

}  // namespace

PrefilterPlan PrefilterPlan::without(int sharp, int rough) const {
  const auto count = static_cast<int>(mips.size());
  image::require_range("the number of sharp mips that are left out", sharp, 0, count - 1);
  image::require_range("the number of rough mips that are left out", rough, 0, count - 1 - sharp);
  PrefilterPlan rest = *this;
  rest.first_mip += sharp;
  rest.mips.assign(mips.begin() + sharp, mips.end() - rough);
  if (!rest.uses(MipMethod::spectral)) rest.bands = 0;
  return rest;
}

bool PrefilterPlan::uses(MipMethod method) const noexcept {
  return platform::ranges::find(mips, method, &MipPlan::method) != mips.end();
}

int PrefilterPlan::rows_for_cubemap() const noexcept {
  const double alpha_of_bands = std::clamp(reach_within({}) / (2.0 * std::max(1, bands)), kLeastAlpha, 1.0);
  const double wanted = lights == LightsOf::ggx ? rings_within(least_alpha, tight()) : rings_within(alpha_of_bands, {});
  return 2 * transforms::fast_even_length(static_cast<int>(std::ceil(0.5 * wanted)));
}

PrefilterPlan PrefilterPlan::tightened(int steps) const {
  PrefilterPlan tighter = *this;
  tighter.tightenings += steps;
  const ErrorBounds tight = tighter.tight();
  for (MipPlan& mip : tighter.mips) {
    if (mip.method == MipMethod::spectral)
      mip.bands = choose_bands(mip.alpha, tight, transforms::kMaximumSpectrumBands);
  }
  if (bands == 0) return tighter;
  for (const auto& lobe : spectral_lobes) {
    const int wanted = std::max(bands_within(lobe->alpha(), tight), bands_for_dark(tight));
    tighter.bands = std::max(tighter.bands, std::min(transforms::kMaximumSpectrumBands, wanted));
  }
  return tighter;
}

double narrow_reach(const PrefilterPlan& plan) noexcept {
  const PrefilterOptions usual;
  return std::max(plan.reach, reach_for(usual.rms_error, usual.maximum_error));
}

std::vector<double> roughness_of_chain(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  const int mips = mips_of(options);
  std::vector<double> roughness = roughness_of(options, mips);
  roughness.resize(static_cast<std::size_t>(mips));
  return roughness;
}

transforms::GridSize MipPlan::grid() const noexcept {
  return lobe->alpha() > 0.0 ? transforms::grid_for_bands(bands.bands())
                             : transforms::grid_for_bands(bands.bands(), kKinkOversampling);
}

namespace {

/// Adds a spectral mip to what all of them share.
void take_in(const MipPlan& mip, int bands, PrefilterPlan& plan) {
  plan.light_alpha = std::min(plan.light_alpha, mip.lobe->light_alpha());
  plan.least_alpha = std::min(plan.least_alpha, mip.lobe->width_alpha());
  plan.bands = std::max(plan.bands, bands);
  plan.spectral_lobes.push_back(mip.lobe);
}

}  // namespace

PrefilterPlan plan_prefilter(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  if (static_cast<int>(options.method) < 0 || options.method > PrefilterMethod::reference) {
    refuse(ErrorCode::invalid_argument,
           "the method " + std::to_string(static_cast<int>(options.method)) + " is not one that Welkin knows");
  }
  check_error_bound("rms_error", options.rms_error, kLeastRmsError, options.method);
  check_error_bound("maximum_error", options.maximum_error, kLeastMaximumError, options.method);
  projection::check_policy(options.pixels);
  const int mips = mips_of(options);
  const std::vector<double> roughness = roughness_of(options, mips);
  PrefilterPlan plan;
  plan.size = options.size;
  plan.chain_mips = mips;
  plan.reach = reach_for(options.rms_error, options.maximum_error);
  plan.bounds = {options.rms_error, options.maximum_error};
  plan.may_integrate = options.method == PrefilterMethod::automatic;
  for (int level = 0; level < mips; ++level) {
    MipPlan mip;
    mip.size = std::max(1, options.size >> level);
    mip.roughness = roughness[static_cast<std::size_t>(level)];
    mip.alpha = mip.roughness * mip.roughness;
    mip.method = method_for(options, plan.reach, mip);
    if (mip.method != MipMethod::copy) mip.lobe = std::make_shared<const Lobe>(mip.alpha);
    if (mip.method == MipMethod::spectral) {
      mip.bands = choose_bands(mip.alpha, plan.bounds, transforms::kMaximumSpectrumBands);
      take_in(mip, std::max(mip.bands.bands(), bands_for_dark(plan.bounds)), plan);
    }
    if (mip.method == MipMethod::narrow) plan.narrow_size = std::max(plan.narrow_size, mip.size);
    plan.mips.push_back(std::move(mip));
  }
  return plan;
}

namespace {

/// Returns the bands of the first transform for a lobe other than GGX: as many as it takes for a picture with many
/// edges, whose energy of degree l is kEdges / l^2 of the whole.
int first_bands(const Lobe& lobe, double rms_error) {
  constexpr double kEdges = 6.0;
  constexpr double kShare = 0.4;
  constexpr int kFirstLook = 256;
  constexpr int most = transforms::kMaximumSpectrumBands;
  if (lobe.last_band() > 0) return lobe.last_band();
  for (int looked_at = kFirstLook;; looked_at = std::min(most, 2 * looked_at)) {
    const std::vector<double> spectrum = lobe.spectrum(looked_at);
    double lost = 0.0;
    int bands = looked_at;
    while (bands > kLeastLobeBands) {
      const double ratio = spectrum[static_cast<std::size_t>(bands - 1)] / bands;
      lost += kEdges * ratio * ratio;
      if (lost > kShare * kOfBound * rms_error * rms_error) break;
      --bands;
    }
    // what lies beyond is as much as what lies in the last third
    if (bands < looked_at * 2 / 3 || looked_at == most)
      return std::min(most, (bands + kBandStep - 1) / kBandStep * kBandStep);
  }
}

}  // namespace

PrefilterPlan plan_prefilter(const KernelChainOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  image::require_range("the number of kernels, which is that of mips,",
                       static_cast<int>(std::min<std::size_t>(options.kernels.size(), 99)), 1,
                       full_chain_levels(options.size));
  if (!(options.rms_error >= kLeastRmsError && options.rms_error <= 1.0)) {
    refuse(ErrorCode::invalid_argument,
           "rms_error is " + platform::number_text(options.rms_error) + "; it must be from 1e-6 to 1");
  }
  const bool reference = options.method == PrefilterMethod::reference;
  if (!reference && options.method != PrefilterMethod::automatic && options.method != PrefilterMethod::spectral)
    refuse(ErrorCode::invalid_argument,
           "kernels are prefiltered by the methods automatic, spectral, "
           "reference");
  projection::check_policy(options.pixels);
  PrefilterPlan plan;
  plan.size = options.size;
  plan.chain_mips = static_cast<int>(options.kernels.size());
  const PrefilterOptions usual;
  plan.reach = reach_for(usual.rms_error, usual.maximum_error);
  plan.bounds = {options.rms_error, std::min(1.0, options.rms_error / usual.rms_error * usual.maximum_error)};
  plan.lights = LightsOf::any;
  for (std::size_t level = 0; level < options.kernels.size(); ++level) {
    const ZonalKernel& kernel = options.kernels[level];
    MipPlan mip;
    mip.size = std::max(1, options.size >> level);
    mip.roughness = kernel.roughness();
    mip.lobe = kernel.lobe();
    mip.method = reference ? MipMethod::reference : MipMethod::spectral;
    if (!reference) take_in(mip, first_bands(*mip.lobe, options.rms_error), plan);
    plan.mips.push_back(std::move(mip));
  }
  return plan;
}

}  // namespace welkin::reflections
