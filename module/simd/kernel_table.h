// The kernels of one instruction set, declared in its namespace. Each is defined in a source of its own.
#pragma once

#include "simd/kernels.h"

namespace welkin::simd::WELKIN_ISA {

void directional_albedo(const AlbedoRule& rule, float alpha, const float* normal_view, float* whole, float* fresnel);
void sheen_albedo(const AlbedoRule& rule, float alpha, const float* normal_view, float* albedo);

void fold_quadrants_rgb_f32(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes);
void fold_quadrants_rgba_f32(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes);
void fold_quadrants_rgba_f16(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes);

void fold_halves_rgb_f32(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes);
void fold_halves_rgba_f32(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes);
void fold_halves_rgba_f16(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes);

void weighted_sums(const float* planes, int class_count, const float* weights, const ClassCounts& counts, int groups,
                   const FetchAhead& ahead, double* sums);

void fold_sum_lanes(const double* lanes, int count, double* sums);

void integrate_texels(const TexelRun& run, const BasisRecurrence& recurrence, const GaussRule& rule, const int* place,
                      float* weights, int stride);
void expand_texels(const TexelRun& run, const int* place, float* weights, int stride);

void plane_lengths(const double* u, double v, int count, double* lengths);
void places_of_angles(const double* across, const double* along, int count, double quarter, double offset,
                      double* places);
void taps_of_places(const double* places, int count, bool cubic, std::int32_t* first, float* weights);
void sample_grid(const GridRun& run, float* rgb);

void sample_patches(const PatchRun& run, float* rgb);
void reduce_pairs(const float* top, const float* bottom, const float* top_weights, const float* bottom_weights,
                  int count, float* rgb);
void evaluate_harmonics(const DirectionRun& run, const BasisRecurrence& recurrence, const double* coefficients,
                        int bands, float* rgb);

bool any_outside(const float* values, int count, float low, float high);
float read_all(const float* values, std::int64_t groups);

void add_lobes(const LobeRow& row, const LobeLight* lights, int count, float* rgb);
RowMeasure measure_row(const float* values, int count);

void add_sky_rings(const SkyRings& rings, float* sums);
void add_sky_lobe(const SkyRings& rings, float* sums);

void load_row_quads(const RowQuads& rows, int width, float* planes);
void run_fourier_pass(const FourierPass& pass, const float* in, float* out);
void multiply_complex(const float* in, std::ptrdiff_t step, const float* factors, bool conjugate, int count,
                      float* out);
void part_orders(const float* z, int width, int orders, int channel, float* columns, std::ptrdiff_t order_stride);
void join_orders(const float* columns, std::ptrdiff_t order_stride, int orders, int channel, int width, float* z);
void store_rings(const float* red, const float* green, const float* blue, int width, const RingRows& rows);

void analyse_order(const LegendreRun& run, const float* columns, double* state, float* sums);
void synthesise_order(const LegendreRun& run, const float* coefficients, float* columns);
int find_start(const double* a, const double* x, double threshold, int last, double* state);
void weigh_odd_parts(const float* columns, const double* weights, int groups, double* sums);
void integrate_sums(const IntegralRun& run, const float* sums, float* coefficients);
void scale_harmonics(const ScaleRun& run, const float* in, float* out);
void spline_rings(const SplineRun& run, float* columns, float* scratch);

void add_sunlight(const SunlitSample& sample, int nodes, const SkySuns& suns, float* slice, float* sums);
void add_source(const SourceSample& sample, const SunAxis& axis, int size, int next_row, const SkySuns& suns,
                float* picture, float* sums);
void project_sky_ring(const SkyRing& ring, float* harmonics);
void fold_sky_orders(const float* harmonics, const float* weights, int bands, int used, float* by_order);
void sum_sky_orders(const float* by_order, int used, const float* azimuth_cosines, float* out);
void reduce_sky(const SkyRun& run, float* of_sun);
void sky_radiance(const SkyRun& run, const double* directions, int count, float* rgb);

}  // namespace welkin::simd::WELKIN_ISA
