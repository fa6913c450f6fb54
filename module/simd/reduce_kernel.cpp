// Two rows of texels to one of half the length.
#include "simd/kernel_functions.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

/// Texels of the result that are worked on at a time: their six kilobytes stay in the first-level cache.
constexpr int kBlock = 64;

}  // namespace

// Plain loops: the compiler vectorises the first, which has most of the work, and the order of additions is that of the
// source in any case.
void reduce_pairs(const float* top, const float* bottom, const float* top_weights, const float* bottom_weights,
                  int count, float* rgb) {
  float columns[6 * kBlock];
  for (int first = 0; first < count; first += kBlock) {
    const int texels = count - first < kBlock ? count - first : kBlock;
    const int from = 6 * first;
    for (int k = 0; k < 6 * texels; ++k) {
      columns[k] = top[from + k] * top_weights[from + k] + bottom[from + k] * bottom_weights[from + k];
    }
    for (int i = 0; i < texels; ++i) {
      for (int c = 0; c < 3; ++c) rgb[3 * (first + i) + c] = columns[6 * i + c] + columns[6 * i + 3 + c];
    }
  }
}

}  // namespace welkin::simd::WELKIN_ISA
