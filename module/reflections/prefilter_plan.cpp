#include "reflections/prefilter_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
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
constexpr double kLeastAlpha = 1e-6;     ///< below, a lobe is narrower than any texel by far: a copy
constexpr double kLeastRings = 256.0;    ///< of a `RingTable`
constexpr double kRingsOfAlpha = 9.5;    ///< times 1 / alpha: a third of the narrowest lobe's alpha is a ring's height
constexpr double kLeastRmsError = 1e-6;  ///< what float arithmetic leaves
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
  const int bands = bands_for(mip.alpha, reach);
  if (bands <= transforms::kMaximumSpectrumBands) return MipMethod::spectral;
  if (options.method == PrefilterMethod::automatic) return MipMethod::narrow;
  refuse(ErrorCode::limit_exceeded,
         "roughness " + platform::number_text(mip.roughness) + " needs " + std::to_string(bands) + " harmonic bands, " +
             std::to_string(transforms::kMaximumSpectrumBands) + " are possible; take another method, or automatic");
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
  const double wanted = std::max(kLeastRings, kRingsOfAlpha / least_alpha);
  return 2 * transforms::fast_even_length(static_cast<int>(std::ceil(0.5 * wanted)));
}

double PrefilterPlan::loss_at_peak() const noexcept {
  double loss = 0.0;
  for (const MipPlan& mip : mips) loss = std::max(loss, mip.bands.loss_at_peak);
  return loss;
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
  plan.maximum_error = options.maximum_error;
  for (int level = 0; level < mips; ++level) {
    MipPlan mip;
    mip.size = std::max(1, options.size >> level);
    mip.roughness = roughness[static_cast<std::size_t>(level)];
    mip.alpha = mip.roughness * mip.roughness;
    mip.method = method_for(options, plan.reach, mip);
    if (mip.method == MipMethod::spectral) {
      plan.least_alpha = std::min(plan.least_alpha, mip.alpha);
      mip.bands = choose_bands(mip.alpha, plan.reach, transforms::kMaximumSpectrumBands);
      plan.bands = std::max(plan.bands, mip.bands.bands());
    }
    if (mip.method == MipMethod::narrow) plan.narrow_alphas.push_back(mip.alpha);
    plan.mips.push_back(std::move(mip));
  }
  return plan;
}

}  // namespace welkin::reflections
