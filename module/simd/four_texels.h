// Four neighbouring texels of four floats as 16 logical lanes. Only for the per-instruction-set kernel sources.
#pragma once

#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {

constexpr int kParts = kGroup / kWidth;

/// Four texels side by side.
struct Texels {
  Lanes part[kParts];
};

WELKIN_INLINE Texels load_texels(const float* texels) {
  Texels result;
  for (int k = 0; k < kParts; ++k) result.part[k] = Lanes::load_unaligned(texels + k * kWidth);
  return result;
}

WELKIN_INLINE Texels weighted_ring(const float* texels, float weight) {
  Texels result;
  for (int k = 0; k < kParts; ++k) {
    result.part[k] = Lanes::load_unaligned(texels + k * kWidth) * Lanes(weight);
  }
  return result;
}

WELKIN_INLINE Texels weighted_ring(const Texels& texels, float weight) {
  Texels result;
  for (int k = 0; k < kParts; ++k) result.part[k] = texels.part[k] * Lanes(weight);
  return result;
}

WELKIN_INLINE Texels sum(const Texels& a, const Texels& b) {
  Texels result;
  for (int k = 0; k < kParts; ++k) result.part[k] = a.part[k] + b.part[k];
  return result;
}

/// Each texel times its own weight. Reversed: the last weight is the first texel's.
template <bool reversed = false>
WELKIN_INLINE Texels weighted_columns(const Texels& texels, const float* weights) {
  Texels result;
#if defined(__AVX512F__)
  const __m512i order = reversed ? _mm512_setr_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0)
                                 : _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
  const __m512 four = _mm512_broadcast_f32x4(_mm_loadu_ps(weights));
  result.part[0] = texels.part[0] * Lanes(_mm512_permutexvar_ps(order, four));
#elif defined(__AVX2__)
  const __m256 four = _mm256_broadcast_ps(reinterpret_cast<const __m128*>(weights));
  const __m256i first = _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
  const __m256i last = _mm256_setr_epi32(2, 2, 2, 2, 3, 3, 3, 3);
  const __m256i low = reversed ? _mm256_setr_epi32(3, 3, 3, 3, 2, 2, 2, 2) : first;
  const __m256i high = reversed ? _mm256_setr_epi32(1, 1, 1, 1, 0, 0, 0, 0) : last;
  result.part[0] = texels.part[0] * Lanes(_mm256_permutevar_ps(four, low));
  result.part[1] = texels.part[1] * Lanes(_mm256_permutevar_ps(four, high));
#else
  for (int k = 0; k < kParts; ++k) result.part[k] = texels.part[k] * Lanes(weights[reversed ? 3 - k : k]);
#endif
  return result;
}

/// (q0 + q2) + (q1 + q3)
WELKIN_INLINE __m128 folded(const Texels& texels) {
#if defined(__AVX512F__)
  const __m512 all = texels.part[0];
  const __m256 pairs = _mm256_add_ps(_mm512_castps512_ps256(all), _mm512_extractf32x8_ps(all, 1));
  return _mm_add_ps(_mm256_castps256_ps128(pairs), _mm256_extractf128_ps(pairs, 1));
#elif defined(__AVX2__)
  const __m256 pairs = _mm256_add_ps(texels.part[0], texels.part[1]);
  return _mm_add_ps(_mm256_castps256_ps128(pairs), _mm256_extractf128_ps(pairs, 1));
#else
  return _mm_add_ps(_mm_add_ps(texels.part[0], texels.part[2]), _mm_add_ps(texels.part[1], texels.part[3]));
#endif
}

#if defined(__AVX512F__)

/// Four foldings at once, side by side.
WELKIN_INLINE __m512 folded(const Texels& first, const Texels& second, const Texels& third, const Texels& fourth) {
  const __m512 a = first.part[0];
  const __m512 b = second.part[0];
  const __m512 c = third.part[0];
  const __m512 d = fourth.part[0];
  const __m512 ab = _mm512_add_ps(_mm512_shuffle_f32x4(a, b, 0x44), _mm512_shuffle_f32x4(a, b, 0xEE));
  const __m512 cd = _mm512_add_ps(_mm512_shuffle_f32x4(c, d, 0x44), _mm512_shuffle_f32x4(c, d, 0xEE));
  return _mm512_add_ps(_mm512_shuffle_f32x4(ab, cd, 0x88), _mm512_shuffle_f32x4(ab, cd, 0xDD));
}

#endif

}  // namespace welkin::simd::WELKIN_ISA
