// Passes over plain floats: a range check and the bandwidth yardstick.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {

bool any_outside(const float* values, int count, float low, float high) {
  // A comparison with NaN is false, so "not inside" catches it. No early exit: the loop vectorises.
  int outside = 0;
  for (int k = 0; k < count; ++k) outside |= static_cast<int>(!(values[k] >= low && values[k] <= high));
  return outside != 0;
}

float read_all(const float* values, std::int64_t groups) {
  constexpr int parts = kLanes / kWidth;
  Lanes sum[4 * parts];
  for (Lanes& s : sum) s = Lanes(0.0F);
  std::int64_t g = 0;
  for (; g + 4 <= groups; g += 4) {
    for (int k = 0; k < 4 * parts; ++k) sum[k] = sum[k] + Lanes::load_unaligned(values + g * kLanes + k * kWidth);
  }
  for (; g < groups; ++g) {
    for (int k = 0; k < parts; ++k) sum[k] = sum[k] + Lanes::load_unaligned(values + g * kLanes + k * kWidth);
  }
  alignas(64) float lanes[kWidth];
  float total = 0.0F;
  for (const Lanes& s : sum) {
    s.store_aligned(lanes);
    for (int k = 0; k < kWidth; ++k) total += lanes[k];
  }
  return total;
}

}  // namespace welkin::simd::WELKIN_ISA
