// The inner loops of bringing many rows of pixels to few rings: see row_reduction.h.
#pragma once

#include <cstddef>

#include "simd/dispatch.h"

namespace welkin::transforms {

/// How many coarse edges an edge between rows gives its step to.
inline constexpr int kStepShares = 6;

/// Edges between rows that give to the same coarse edges.
struct StepRun {
  const float* const* rows;  ///< the first above the first edge, [edges + 1]
  std::ptrdiff_t first;      ///< float of each row
  const float* shares;       ///< [edges][kStepShares]
  int edges;
  int floats;  ///< of a row
};

/// sums[k][i] += the sum over edges of share k times (row below - row above)[i], k < kStepShares, edge after edge. No
/// two of `sums` overlap unless they are the same.
using ShareSteps = void (*)(const StepRun& run, float* const* sums);

/// out[3 i + c] = the sum over k < 6 of (1, 5, 10, 10, 5, 1)[k] / 16 times texel 2 i + k of `in`, i < count, by pairs
/// from the outside in. `out` may be `in`.
using HalveColumns = void (*)(const float* in, int count, float* out);

struct ReductionKernels {
  ShareSteps share_steps;
  HalveColumns halve_columns;
};
WELKIN_KERNEL_TABLES(ReductionKernels, reduction_kernels)

}  // namespace welkin::transforms
