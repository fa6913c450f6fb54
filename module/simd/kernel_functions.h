// The kernels of one instruction set, declared in its namespace. Each is defined in a source of its own.
#pragma once

#include "simd/kernels.h"

namespace welkin::simd::WELKIN_ISA {

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

bool any_outside(const float* values, int count, float low, float high);
float read_all(const float* values, std::int64_t groups);

}  // namespace welkin::simd::WELKIN_ISA
