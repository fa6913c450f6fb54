// SSE2, the baseline of x86-64: 4 floats a register. What these names mean is said in vec.h.
#pragma once

#include "simd/vec_x86.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

namespace detail {

template <bool reversed>
WELKIN_INLINE Lanes ordered(__m128 v) {
  return Lanes(reversed ? _mm_shuffle_ps(v, v, _MM_SHUFFLE(0, 1, 2, 3)) : v);
}

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_packed(__m128 v0, __m128 v1, __m128 v2) {
  // v0 = r0 g0 b0 r1, v1 = g1 b1 r2 g2, v2 = b2 r3 g3 b3
  const __m128 r2r3 = _mm_shuffle_ps(v1, v2, _MM_SHUFFLE(1, 1, 2, 2));
  const __m128 g0g1 = _mm_shuffle_ps(v0, v1, _MM_SHUFFLE(0, 0, 1, 1));
  const __m128 g2g3 = _mm_shuffle_ps(v1, v2, _MM_SHUFFLE(2, 2, 3, 3));
  const __m128 b0b1 = _mm_shuffle_ps(v0, v1, _MM_SHUFFLE(1, 1, 2, 2));
  return {ordered<reversed>(_mm_shuffle_ps(v0, r2r3, _MM_SHUFFLE(2, 0, 3, 0))),
          ordered<reversed>(_mm_shuffle_ps(g0g1, g2g3, _MM_SHUFFLE(2, 0, 2, 0))),
          ordered<reversed>(_mm_shuffle_ps(b0b1, v2, _MM_SHUFFLE(3, 0, 2, 0)))};
}

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_rgba(__m128 v0, __m128 v1, __m128 v2, __m128 v3) {
  const __m128 rg_low = _mm_unpacklo_ps(v0, v1);
  const __m128 rg_high = _mm_unpacklo_ps(v2, v3);
  const __m128 b_low = _mm_unpackhi_ps(v0, v1);
  const __m128 b_high = _mm_unpackhi_ps(v2, v3);
  return {ordered<reversed>(_mm_movelh_ps(rg_low, rg_high)), ordered<reversed>(_mm_movehl_ps(rg_high, rg_low)),
          ordered<reversed>(_mm_movelh_ps(b_low, b_high))};
}

WELKIN_INLINE __m128 load(const float* p) { return _mm_loadu_ps(p); }

/// Four binary16 values, exactly: exponent and mantissa moved to their places are the value times 2^-112
/// (denormals too), and a multiplication by a power of two is exact. Infinities and NaNs get theirs back.
WELKIN_INLINE __m128 load(const std::uint16_t* p) {
  const __m128i half = _mm_unpacklo_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)), _mm_setzero_si128());
  const __m128i magnitude = _mm_and_si128(half, _mm_set1_epi32(0x7FFF));
  const __m128i sign = _mm_slli_epi32(_mm_and_si128(half, _mm_set1_epi32(0x8000)), 16);
  const __m128 scaled =
      _mm_mul_ps(_mm_castsi128_ps(_mm_slli_epi32(magnitude, 13)), _mm_castsi128_ps(_mm_set1_epi32(0x77800000)));
  const __m128i special = _mm_and_si128(_mm_cmpgt_epi32(magnitude, _mm_set1_epi32(0x7BFF)), _mm_set1_epi32(0x7F800000));
  return _mm_or_ps(scaled, _mm_castsi128_ps(_mm_or_si128(sign, special)));
}

}  // namespace detail

WELKIN_INLINE DoubleLanes load_widened(const float* first) {
  return DoubleLanes(_mm_cvtps_pd(_mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(first)))));
}

WELKIN_INLINE Lanes narrow(DoubleLanes low, DoubleLanes high) {
  return Lanes(_mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high)));
}

namespace detail {

WELKIN_INLINE Lanes without_fourth(__m128 texel) {
  return Lanes(_mm_and_ps(texel, _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0))));
}

}  // namespace detail

WELKIN_INLINE Texels load_rgb_texels(const float* rgb) {
  const __m128i last_four = _mm_castps_si128(_mm_loadu_ps(rgb + 8));
  return {detail::without_fourth(_mm_loadu_ps(rgb)), detail::without_fourth(_mm_loadu_ps(rgb + 3)),
          detail::without_fourth(_mm_loadu_ps(rgb + 6)), Lanes(_mm_castsi128_ps(_mm_srli_si128(last_four, 4)))};
}

WELKIN_INLINE Texels repeated_rgb(const float* rgb) {
  const Lanes one = detail::without_fourth(_mm_loadu_ps(rgb));
  return {one, one, one, one};
}

WELKIN_INLINE bool no_bit_set(const Texels& texels) {
  const __m128 bits = (texels.part[0] | texels.part[1]) | (texels.part[2] | texels.part[3]);
  return _mm_movemask_epi8(_mm_cmpeq_epi32(_mm_castps_si128(bits), _mm_setzero_si128())) == 0xFFFF;
}

/// thrice[3 k + c] = lane k, c < 3.
WELKIN_INLINE void store_thrice(Lanes values, float* thrice) {
  _mm_store_ps(thrice, _mm_shuffle_ps(values, values, _MM_SHUFFLE(1, 0, 0, 0)));
  _mm_store_ps(thrice + 4, _mm_shuffle_ps(values, values, _MM_SHUFFLE(2, 2, 1, 1)));
  _mm_store_ps(thrice + 8, _mm_shuffle_ps(values, values, _MM_SHUFFLE(3, 3, 3, 2)));
}

/// The first three of four lanes; what follows them is overwritten too.
WELKIN_INLINE void store_without_fourth(Lanes values, float* packed) { _mm_storeu_ps(packed, values); }

/// 16 texels of packed RGB in the reversed order: of four, which are floats 0 to 11, 9 10 11 6, 7 8 3 4 and 5 0 1 2.
WELKIN_INLINE void reverse_rgb(const float* texels, float* reversed) {
  for (int k = 0; k < 3 * kLanes; k += 12) {
    const __m128 a = _mm_load_ps(texels + k);
    const __m128 b = _mm_load_ps(texels + k + 4);
    const __m128 c = _mm_load_ps(texels + k + 8);
    float* const to = reversed + 3 * kLanes - 12 - k;
    const __m128 last = _mm_shuffle_ps(c, b, _MM_SHUFFLE(2, 2, 3, 3));
    _mm_store_ps(to, _mm_shuffle_ps(c, last, _MM_SHUFFLE(2, 0, 2, 1)));
    const __m128 left = _mm_shuffle_ps(b, c, _MM_SHUFFLE(0, 0, 3, 3));
    const __m128 right = _mm_shuffle_ps(a, b, _MM_SHUFFLE(0, 0, 3, 3));
    _mm_store_ps(to + 4, _mm_shuffle_ps(left, right, _MM_SHUFFLE(2, 0, 2, 0)));
    const __m128 first = _mm_shuffle_ps(b, a, _MM_SHUFFLE(0, 0, 1, 1));
    _mm_store_ps(to + 8, _mm_shuffle_ps(first, a, _MM_SHUFFLE(2, 1, 2, 0)));
  }
}

/// 16 bytes as whole numbers.
WELKIN_INLINE IntegerGroup widened(Bytes bytes) {
  const __m128i zero = _mm_setzero_si128();
  const __m128i low = _mm_unpacklo_epi8(bytes, zero);
  const __m128i high = _mm_unpackhi_epi8(bytes, zero);
  return {Integers(_mm_unpacklo_epi16(low, zero)), Integers(_mm_unpackhi_epi16(low, zero)),
          Integers(_mm_unpacklo_epi16(high, zero)), Integers(_mm_unpackhi_epi16(high, zero))};
}

/// In each four lanes their last.
WELKIN_INLINE Integers last_of_each_four(Integers values) { return Integers(_mm_shuffle_epi32(values, 0xFF)); }

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
