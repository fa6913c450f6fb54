#include "welkin/roughness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "image/check_views.h"
#include "welkin/error.h"

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

}  // namespace

const char* name(RoughnessSchedule schedule) noexcept {
  switch (schedule) {
    case RoughnessSchedule::linear: return "linear";
    case RoughnessSchedule::filament: return "filament";
    case RoughnessSchedule::babylon: return "babylon";
  }
  return "linear";
}

std::vector<double> roughness_of_mips(RoughnessSchedule schedule, int mips, int size) {
  image::require_range("mips", mips, 1, kMostMips);
  image::require_range("size of mip 0", size, 1, image::kLargestFace);
  std::vector<double> table;
  for (int mip = 0; mip < mips; ++mip) {
    const double t = mips > 1 ? static_cast<double>(mip) / (mips - 1) : 0.0;
    switch (schedule) {
      case RoughnessSchedule::linear: table.push_back(t); break;
      case RoughnessSchedule::filament: table.push_back(1.0 - std::sqrt(1.0 - t)); break;
      case RoughnessSchedule::babylon: table.push_back(mip == 0 ? 0.0 : std::sqrt(babylon_alpha(mip, size))); break;
    }
  }
  return table;
}

double mip_of_roughness(const std::vector<double>& table, double roughness) {
  if (table.empty())
    throw Error(ErrorCode::invalid_argument, "the table of roughness is empty; it needs one entry a mip");
  for (std::size_t mip = 1; mip < table.size(); ++mip) {
    if (table[mip] >= table[mip - 1]) continue;
    throw Error(ErrorCode::invalid_argument, "the table of roughness falls at mip " + std::to_string(mip) + ", from " +
                                                 std::to_string(table[mip - 1]) + " to " + std::to_string(table[mip]) +
                                                 "; it must rise");
  }
  const auto above = std::lower_bound(table.begin(), table.end(), roughness);
  if (above == table.begin()) return 0.0;
  if (above == table.end()) return static_cast<double>(table.size() - 1);
  const double below = *(above - 1);
  return static_cast<double>(above - 1 - table.begin()) + (roughness - below) / (*above - below);
}

}  // namespace welkin
