// Which roughness each mip has, engine by engine.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "image/pixels.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin {
namespace {

constexpr int kMaxMips = 16;

// Each is the inverse of what the engine's shader computes, which is `mip_by_formula`: the roughness that it looks up
// at a whole mip.

/// mip = 0.8 log2(size alpha), so alpha = 2^(mip / 0.8) / size. 2^(5 mip / 4) by square roots and an exact scaling.
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

/// mip = last_mip - 1 - (1 - 1.2 log2(roughness)), so roughness = 2^((mip - last_mip + 2) / 1.2).
/// REFLECTION_CAPTURE_ROUGHEST_MIP is 1, REFLECTION_CAPTURE_ROUGHNESS_MIP_SCALE 1.2.
double unreal_roughness(int mip, int last_mip) {
  return std::min(1.0, math::exponential(std::numbers::ln2 * (mip - last_mip + 2) / 1.2));
}

double roughness_of_mip(RoughnessSchedule schedule, int mip, int mips, int size) {
  if (mip == 0) return 0.0;
  const double t = static_cast<double>(mip) / (mips - 1);
  switch (schedule) {
    // t = r (2 - r) = 1 - (1 - r)^2
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
  static constexpr std::array kNames{"linear", "filament", "babylon", "unity", "unreal"};
  return platform::name_in<RoughnessSchedule::unreal>(kNames, schedule, "linear");
}

std::vector<double> mip_roughness(RoughnessSchedule schedule, int mips, int size) {
  const platform::FloatingPointScope floating_point;
  image::require_range("mips", mips, 1, kMaxMips);
  image::require_range("size of mip 0", size, 1, image::kLargestFace);
  std::vector<double> table;
  table.reserve(static_cast<std::size_t>(mips));
  for (int mip = 0; mip < mips; ++mip) table.push_back(roughness_of_mip(schedule, mip, mips, size));
  return table;
}

int default_mip_count(RoughnessSchedule schedule, int size) {
  image::require_range("size of mip 0", size, 1, image::kLargestFace);
  constexpr int kMinTexels = 4;
  constexpr int kMinMips = 5;
  constexpr int kUnityMips = 7;  // 0 to UNITY_SPECCUBE_LOD_STEPS
  const int whole = full_chain_levels(size);
  switch (schedule) {
    case RoughnessSchedule::babylon:
    case RoughnessSchedule::unreal: return whole;
    case RoughnessSchedule::unity: return std::min(kUnityMips, whole);
    case RoughnessSchedule::linear:
    case RoughnessSchedule::filament: break;
  }
  const int to_least = size >= kMinTexels ? full_chain_levels(size / kMinTexels) : 1;
  return std::min(whole, std::max(kMinMips, to_least));
}

void PrefilterOptions::use_schedule(RoughnessSchedule schedule, bool fit_lookups) {
  if (!mips) mips = default_mip_count(schedule, size);
  roughness = mip_roughness(schedule, *mips, size);
  if (fit_lookups) lobe_roughness = fitted_mip_roughness(schedule, *mips, size);
}

double mip_for_roughness(const std::vector<double>& table, double roughness) {
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
