#include "reflections/prefilter_plan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>

#include "image/pixels.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "reflections/ring_table.h"
#include "transform/ring_fft.h"
#include "transform/spectrum.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {
namespace {

constexpr int kLargestSize = 8192;
constexpr int kMostSamples = 1 << 20;
constexpr double kLeastAlpha = 1e-6;     ///< below, a lobe is narrower than any texel by far: a copy
constexpr double kLeastRmsError = 1e-6;  ///< what float arithmetic leaves
constexpr double kLeastMaximumError = 1e-5;

[[noreturn]] void refuse(ErrorCode code, const std::string& message) { throw Error(code, message); }

void check_error_bound(const char* what, double value, double least, PrefilterMethod method) {
  if (!(value > 0.0 && value <= 1.0))
    refuse(ErrorCode::invalid_argument,
           std::string(what) + " is " + platform::number_text(value) + "; it must be above 0, at most 1");
  if (value >= least || method == PrefilterMethod::reference || method == PrefilterMethod::sampled) return;
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
  if (options.method == PrefilterMethod::sampled) return MipMethod::sampled;
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

bool PrefilterPlan::is_summed(int face_size, const MipPlan& mip) const noexcept {
  // Larger texels are left to the transform.
  const bool small_texels = 0.5 * std::numbers::pi <= 2.0 * least_alpha * face_size;
  return sums && small_texels && mip.method == MipMethod::spectral &&
         LobeTable::serves(face_size, {mip.size, mip.alpha});
}

std::vector<LobeMip> PrefilterPlan::summed_mips(int face_size) const {
  std::vector<LobeMip> summed;
  for (const MipPlan& mip : mips) {
    if (is_summed(face_size, mip)) summed.push_back({mip.size, mip.alpha});
  }
  return summed;
}

bool PrefilterPlan::needs_rings(int face_size) const noexcept {
  return std::any_of(mips.begin(), mips.end(), [&](const MipPlan& mip) {
    return mip.method == MipMethod::spectral && !is_summed(face_size, mip);
  });
}

int PrefilterPlan::rows_for_cubemap(int face_size) const noexcept {
  const double wanted = rings_within(least_alpha, tight());
  const int rows = 2 * transforms::fast_even_length(static_cast<int>(std::ceil(0.5 * wanted)));
  if (RingTable::serves({face_size, rows})) return rows;
  const double fine = std::clamp(std::numbers::pi / (0.2 * least_alpha), 512.0, 2048.0);
  const int least = face_size <= 512 ? 2 : 1;  // a ring's texel blurs too
  return 2 * face_size * std::max(least, static_cast<int>(std::ceil(fine / (2.0 * face_size))));
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
  for (const double alpha : spectral_alphas) {
    const int wanted = std::max(bands_within(alpha, tight), bands_for_dark(tight));
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

PrefilterPlan plan_prefilter(const PrefilterOptions& options) {
  image::require_range("size", options.size, 1, kLargestSize);
  if (static_cast<int>(options.method) < 0 || options.method > PrefilterMethod::reference) {
    refuse(ErrorCode::invalid_argument,
           "the method " + std::to_string(static_cast<int>(options.method)) + " is not one that Welkin knows");
  }
  check_error_bound("rms_error", options.rms_error, kLeastRmsError, options.method);
  check_error_bound("maximum_error", options.maximum_error, kLeastMaximumError, options.method);
  image::require_range("samples", options.samples, 1, kMostSamples);
  projection::check_policy(options.pixels);
  const int mips = mips_of(options);
  const std::vector<double> roughness = roughness_of(options, mips);
  PrefilterPlan plan;
  plan.size = options.size;
  plan.chain_mips = mips;
  plan.samples = options.samples;
  plan.reach = reach_for(options.rms_error, options.maximum_error);
  plan.bounds = {options.rms_error, options.maximum_error};
  // their weights are made for the default bounds
  const PrefilterOptions usual;
  plan.sums = options.method == PrefilterMethod::automatic &&
              plan.reach <= reach_for(usual.rms_error, usual.maximum_error) + 1e-9;
  for (int level = 0; level < mips; ++level) {
    MipPlan mip;
    mip.size = std::max(1, options.size >> level);
    mip.roughness = roughness[static_cast<std::size_t>(level)];
    mip.alpha = mip.roughness * mip.roughness;
    mip.method = method_for(options, plan.reach, mip);
    if (mip.method == MipMethod::spectral) {
      plan.least_alpha = std::min(plan.least_alpha, mip.alpha);
      plan.spectral_alphas.push_back(mip.alpha);
      mip.bands = choose_bands(mip.alpha, plan.bounds, transforms::kMaximumSpectrumBands);
      plan.bands = std::max({plan.bands, mip.bands.bands(), bands_for_dark(plan.bounds)});
    }
    if (mip.method == MipMethod::narrow) plan.narrow_alphas.push_back(mip.alpha);
    plan.mips.push_back(std::move(mip));
  }
  return plan;
}

}  // namespace welkin::reflections

namespace welkin {
namespace {

constexpr int kMostMips = 16;

/// 2^(mip / 0.8) = 2^(5 mip / 4), by square roots and an exact scaling.
double babylon_alpha(int mip, int size) {
  const int quarters = 5 * mip;
  const double root = std::sqrt(std::numbers::sqrt2);
  double power = 1.0;
  for (int k = 0; k < quarters % 4; ++k) power *= root;
  return std::min(1.0, std::ldexp(power, quarters / 4) / size);
}

/// The root of mip = 6 r (1.7 - 0.7 r) in [0, 1].
double unity_roughness(int mip) {
  constexpr double kSteps = 6.0;  // UNITY_SPECCUBE_LOD_STEPS
  const double t = std::min(1.0, mip / kSteps);
  return t < 1.0 ? (1.7 - std::sqrt(2.89 - 2.8 * t)) / 1.4 : 1.0;
}

/// REFLECTION_CAPTURE_ROUGHEST_MIP is 1, REFLECTION_CAPTURE_ROUGHNESS_MIP_SCALE 1.2.
double unreal_roughness(int mip, int last_mip) {
  return std::min(1.0, math::exponential(std::numbers::ln2 * (mip - last_mip + 2) / 1.2));
}

double roughness_of_mip(RoughnessSchedule schedule, int mip, int mips, int size) {
  if (mip == 0) return 0.0;
  const double t = static_cast<double>(mip) / (mips - 1);
  switch (schedule) {
    case RoughnessSchedule::filament: return 1.0 - std::sqrt(1.0 - t);
    case RoughnessSchedule::babylon: return std::sqrt(babylon_alpha(mip, size));
    case RoughnessSchedule::unity: return unity_roughness(mip);
    case RoughnessSchedule::unreal: return unreal_roughness(mip, mips - 1);
    case RoughnessSchedule::linear: break;
  }
  return t;
}

}  // namespace

const char* name(RoughnessSchedule schedule) noexcept {
  switch (schedule) {
    case RoughnessSchedule::linear: return "linear";
    case RoughnessSchedule::filament: return "filament";
    case RoughnessSchedule::babylon: return "babylon";
    case RoughnessSchedule::unity: return "unity";
    case RoughnessSchedule::unreal: return "unreal";
  }
  return "linear";
}

std::vector<double> roughness_of_mips(RoughnessSchedule schedule, int mips, int size) {
  const platform::FloatingPointScope floating_point;
  image::require_range("mips", mips, 1, kMostMips);
  image::require_range("size of mip 0", size, 1, image::kLargestFace);
  std::vector<double> table;
  table.reserve(static_cast<std::size_t>(mips));
  for (int mip = 0; mip < mips; ++mip) table.push_back(roughness_of_mip(schedule, mip, mips, size));
  return table;
}

int mips_of_chain(RoughnessSchedule schedule, int size) {
  image::require_range("size of mip 0", size, 1, image::kLargestFace);
  constexpr int kLeastTexels = 16;
  constexpr int kLeastMips = 5;
  constexpr int kUnityMips = 7;  // 0 to UNITY_SPECCUBE_LOD_STEPS
  const int whole = full_chain_levels(size);
  switch (schedule) {
    case RoughnessSchedule::babylon:
    case RoughnessSchedule::unreal: return whole;
    case RoughnessSchedule::unity: return std::min(kUnityMips, whole);
    case RoughnessSchedule::linear:
    case RoughnessSchedule::filament: break;
  }
  const int to_least = size >= kLeastTexels ? full_chain_levels(size / kLeastTexels) : 1;
  return std::min(whole, std::max(kLeastMips, to_least));
}

double mip_of_roughness(const std::vector<double>& table, double roughness) {
  const platform::FloatingPointScope floating_point;
  if (table.empty())
    throw Error(ErrorCode::invalid_argument, "the table of roughness is empty; it needs one entry a mip");
  for (std::size_t mip = 1; mip < table.size(); ++mip) {
    if (table[mip] >= table[mip - 1]) continue;
    throw Error(ErrorCode::invalid_argument, "the table of roughness falls at mip " + std::to_string(mip) + ", from " +
                                                 platform::number_text(table[mip - 1]) + " to " +
                                                 platform::number_text(table[mip]) + "; it must rise");
  }
  const auto above = std::lower_bound(table.begin(), table.end(), roughness);
  if (above == table.begin()) return 0.0;
  if (above == table.end()) return static_cast<double>(table.size() - 1);
  const double below = *(above - 1);
  return static_cast<double>(above - 1 - table.begin()) + (roughness - below) / (*above - below);
}

}  // namespace welkin
