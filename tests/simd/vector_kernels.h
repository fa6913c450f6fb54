// The vector layer's own functions, as kernels that tests call: each built once per instruction set, as every kernel
// is.
#pragma once

#include <cstdint>

#include "simd/dispatch.h"

namespace welkin::test {

/// to[16] from a[16] and b[16].
using FloatOperation = void (*)(const float* a, const float* b, float* to);
using DoubleOperation = void (*)(const double* a, const double* b, double* to);

struct VectorKernels {
  FloatOperation sum, difference, product, quotient, root, least, largest, magnitude;
  FloatOperation select_less;  ///< a < b ? a : b, by a comparison and a choice
  FloatOperation whole;        ///< of a, towards zero, as a float again
  DoubleOperation double_quotient, double_root, double_least, double_largest;
  void (*narrowed)(const double* a, float* to);
  void (*widened)(const float* a, double* to);
  void (*comparisons)(const float* a, const float* b, int* to);  ///< [5]: of how many lanes < <= > >= == hold
  bool (*any_less)(const float* a, const float* b);              ///< in any of the first lanes of a register
  bool (*all_less)(const float* a, const float* b);
  bool (*no_bit_set)(const float* texels);
  /// rgb[3][16] from 16 texels, in memory order and reversed
  void (*load_rgb)(const float* texels, bool reversed, float* rgb);
  void (*load_rgba)(const float* texels, bool reversed, float* rgb);
  void (*load_half_rgba)(const std::uint16_t* texels, bool reversed, float* rgb);
  void (*load_rgb_texels)(const float* texels, float* to);  ///< to[16]
  void (*weighted_columns)(const float* texels, const float* weights, bool reversed, float* to);
  void (*folded)(const float* texels, float* to);               ///< to[4]
  void (*store_thrice)(const float* a, float* to);              ///< to[48]
  void (*reverse_rgb)(const float* texels, float* to);          ///< [48] each
  void (*transposed)(const float* rows, float* to, int* size);  ///< [16][16]: the leading block of size^2
  void (*sum_rows)(const float* rows, float* sums);             ///< of 16 rows
};
WELKIN_KERNEL_TABLES(VectorKernels, vector_kernels)

}  // namespace welkin::test
