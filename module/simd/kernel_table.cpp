#include "simd/kernel_table.h"

namespace welkin::simd::WELKIN_ISA {

extern const Kernels table;
const Kernels table = {
    .directional_albedo = directional_albedo,
    .sheen_albedo = sheen_albedo,
    .fold_quadrants = {fold_quadrants_rgb_f32, fold_quadrants_rgba_f32, fold_quadrants_rgba_f16},
    .fold_halves = {fold_halves_rgb_f32, fold_halves_rgba_f32, fold_halves_rgba_f16},
    .weighted_sums = weighted_sums,
    .fold_sum_lanes = fold_sum_lanes,
    .integrate_texels = integrate_texels,
    .expand_texels = expand_texels,
    .plane_lengths = plane_lengths,
    .places_of_angles = places_of_angles,
    .taps_of_places = taps_of_places,
    .sample_grid = sample_grid,
    .sample_patches = sample_patches,
    .reduce_pairs = reduce_pairs,
    .evaluate_harmonics = evaluate_harmonics,
    .any_outside = any_outside,
    .read_all = read_all,
    .add_lobes = add_lobes,
    .measure_row = measure_row,
    .transform =
        {
            .load_row_quads = load_row_quads,
            .run_fourier_pass = run_fourier_pass,
            .multiply_complex = multiply_complex,
            .part_orders = part_orders,
            .join_orders = join_orders,
            .store_rings = store_rings,
            .analyse_order = analyse_order,
            .synthesise_order = synthesise_order,
            .find_start = find_start,
            .weigh_odd_parts = weigh_odd_parts,
            .integrate_sums = integrate_sums,
            .scale_harmonics = scale_harmonics,
            .spline_rings = spline_rings,
        },
    .sky =
        {
            .add_sunlight = add_sunlight,
            .add_source = add_source,
            .project_ring = project_sky_ring,
            .fold_orders = fold_sky_orders,
            .sum_orders = sum_sky_orders,
        },
    .sky_view = {.reduce = reduce_sky, .radiance = sky_radiance},
    .sky_rings = {.add_rings = add_sky_rings, .add_lobe = add_sky_lobe},
};

}  // namespace welkin::simd::WELKIN_ISA
