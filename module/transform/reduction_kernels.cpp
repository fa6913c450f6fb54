#include "transform/reduction_kernels.h"

#include "simd/vec.h"

namespace welkin::transforms::WELKIN_ISA {
namespace {

using simd::kWidth, simd::Lanes;

WELKIN_INLINE void share_register(const StepRun& run, float* const* sums, int at) {
  Lanes total[kStepShares];
  for (int k = 0; k < kStepShares; ++k) total[k] = Lanes::load_unaligned(sums[k] + at);
  // Each row is loaded once, as the one below an edge and then the one above the next.
  Lanes above = Lanes::load_unaligned(run.rows[0] + run.first + at);
  for (int edge = 0; edge < run.edges; ++edge) {
    const Lanes below = Lanes::load_unaligned(run.rows[edge + 1] + run.first + at);
    const Lanes step = below - above;
    const float* const shares = run.shares + edge * kStepShares;
    for (int k = 0; k < kStepShares; ++k) total[k] = total[k] + step * Lanes(shares[k]);
    above = below;
  }
  for (int k = 0; k < kStepShares; ++k) total[k].store_unaligned(sums[k] + at);
}

void share_steps(const StepRun& run, float* const* sums) {
  int at = 0;
  for (; at + kWidth <= run.floats; at += kWidth) share_register(run, sums, at);
  for (; at < run.floats; ++at) {
    for (int edge = 0; edge < run.edges; ++edge) {
      const float step = run.rows[edge + 1][run.first + at] - run.rows[edge][run.first + at];
      for (int k = 0; k < kStepShares; ++k) sums[k][at] += step * run.shares[edge * kStepShares + k];
    }
  }
}

// Plain loops, which the compiler vectorizes: the order of operations is that of the source.
void halve_columns(const float* in, int count, float* out) {
  // The filter at every column, of which every other one is kept: twice the sums, in a loop whose loads follow each
  // other. 3 floats are one texel: taps 0 and 5, 1 and 4, 2 and 3 share their factor.
  constexpr int block = 32;  // texels of the result
  float sums[6 * block];
  for (int first = 0; first < count; first += block) {
    const int texels = count - first < block ? count - first : block;
    const float* const from = in + 6 * static_cast<std::ptrdiff_t>(first);
    for (int k = 0; k < 6 * texels; ++k) {
      sums[k] = (from[k] + from[k + 15]) * 0.0625F + (from[k + 3] + from[k + 12]) * 0.3125F +
                (from[k + 6] + from[k + 9]) * 0.625F;
    }
    float* const to = out + 3 * static_cast<std::ptrdiff_t>(first);
    for (int i = 0; i < texels; ++i) {
      for (int c = 0; c < 3; ++c) to[3 * i + c] = sums[6 * i + c];
    }
  }
}

}  // namespace

const ReductionKernels reduction_kernels_table = {
    .share_steps = share_steps,
    .halve_columns = halve_columns,
};

}  // namespace welkin::transforms::WELKIN_ISA
