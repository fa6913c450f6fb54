// What happens to the numbers of one order m between Legendre sums and coefficients. Plain loops: compilers make
// registers of them.
#include "simd/kernel_functions.h"

namespace welkin::simd::WELKIN_ISA {

void weigh_odd_parts(const float* columns, const double* weights, int groups, double* sums) {
  constexpr int numbers = 6;
  alignas(64) double lanes[numbers * kRingLanes] = {};
  for (int group = 0; group < groups; ++group) {
    const float* const odd = columns + std::ptrdiff_t{kColumnFloats} * group + numbers * kRingLanes;
    const double* const weight = weights + std::ptrdiff_t{kRingLanes} * group;
    for (int number = 0; number < numbers; ++number) {
      for (int k = 0; k < kRingLanes; ++k) {
        lanes[number * kRingLanes + k] += static_cast<double>(odd[number * kRingLanes + k]) * weight[k];
      }
    }
  }
  for (int number = 0; number < numbers; ++number) {
    double* const lane = lanes + number * kRingLanes;
    for (int half = kRingLanes / 2; half > 0; half /= 2) {
      for (int k = 0; k < half; ++k) lane[k] += lane[k + half];
    }
    sums[number] = lane[0];
  }
}

void integrate_sums(const IntegralRun& run, const float* sums, float* coefficients) {
  // The integral over the polar angle is not conjugated by the sign of the exponent, its data are: hence conj.
  alignas(64) double before[kHarmonicFloats] = {};  // J(l - 2)
  alignas(64) double here[kHarmonicFloats] = {};    // J(l - 1), and then J(l)
  for (int i = 0; i < run.count; ++i) {
    alignas(64) double next[kHarmonicFloats] = {};
    if (i == 0) {
      for (int k = 0; k < 6; ++k) next[k] = run.first[k];
    } else {
      const float* const sum = sums + std::ptrdiff_t{kHarmonicFloats} * (i - 1);
      for (int k = 0; k < kHarmonicFloats; ++k) {
        next[k] = run.alpha[i] * before[k] - run.beta[i] * static_cast<double>(sum[k]);
      }
    }
    float* const out = coefficients + std::ptrdiff_t{kHarmonicFloats} * i;
    for (int k = 0; k < kHarmonicFloats; k += 2) {
      out[k] = static_cast<float>(run.phase_real * next[k] + run.phase_imaginary * next[k + 1]);
      out[k + 1] = static_cast<float>(run.phase_imaginary * next[k] - run.phase_real * next[k + 1]);
    }
    for (int k = 0; k < kHarmonicFloats; ++k) {
      before[k] = here[k];
      here[k] = next[k];
    }
  }
}

void scale_harmonics(const ScaleRun& run, const float* in, float* out) {
  for (int i = 0; i < run.count; ++i) {
    const double scale = run.scale[i] * run.gamma[i];
    const auto real = static_cast<float>(scale * run.phase_real);
    const auto imaginary = static_cast<float>(scale * run.phase_imaginary);
    const float* const from = in + std::ptrdiff_t{kHarmonicFloats} * i;
    float* const to = out + std::ptrdiff_t{kHarmonicFloats} * i;
    for (int k = 0; k < kHarmonicFloats; k += 2) {
      to[k] = real * from[k] - imaginary * from[k + 1];
      to[k + 1] = real * from[k + 1] + imaginary * from[k];
    }
  }
}

}  // namespace welkin::simd::WELKIN_ISA
