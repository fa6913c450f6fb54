#include "simd/kernel_functions.h"

namespace welkin::simd::WELKIN_ISA {

extern const Kernels table;
const Kernels table = {
    .fold_quadrants = {fold_quadrants_rgb_f32, fold_quadrants_rgba_f32, fold_quadrants_rgba_f16},
    .fold_halves = {fold_halves_rgb_f32, fold_halves_rgba_f32, fold_halves_rgba_f16},
    .weighted_sums = weighted_sums,
    .fold_sum_lanes = fold_sum_lanes,
    .integrate_texels = integrate_texels,
    .expand_texels = expand_texels,
    .any_outside = any_outside,
    .read_all = read_all,
};

}  // namespace welkin::simd::WELKIN_ISA
