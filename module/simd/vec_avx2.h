// AVX2 with F16C, without FMA: 8 floats a register. What these names mean is said in vec.h.
#pragma once

#include "simd/vec_x86.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

using Lanes = xsimd::batch<float, xsimd::avx2>;
using DoubleLanes = xsimd::batch<double, xsimd::avx2>;
using NarrowLanes = Lanes;
using Block = Quad;

using Rgb = RgbOf<Lanes>;
using Texels = TexelsOf<Lanes>;
using Integers = xsimd::batch<std::int32_t, Lanes::arch_type>;
using IntegerGroup = IntegersOf<Integers>;
using Pairs = PairsOf<Lanes>;

namespace detail {

// The k-th texel's channel c lies at position 3k + c of 24 floats. 3 and 8 have no common divisor, so the
// eight positions fall on eight different lanes: blending three registers gathers a channel, one
// permutation sorts it.
alignas(32) inline constexpr std::int32_t kRgbOrder[2][3][8] = {
    {{0, 3, 6, 1, 4, 7, 2, 5}, {1, 4, 7, 2, 5, 0, 3, 6}, {2, 5, 0, 3, 6, 1, 4, 7}},
    {{5, 2, 7, 4, 1, 6, 3, 0}, {6, 3, 0, 5, 2, 7, 4, 1}, {7, 4, 1, 6, 3, 0, 5, 2}}};

WELKIN_INLINE __m256 permute(__m256 v, const std::int32_t* order) {
  return _mm256_permutevar8x32_ps(v, _mm256_load_si256(reinterpret_cast<const __m256i*>(order)));
}

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_packed(__m256 v0, __m256 v1, __m256 v2) {
  const __m256 red = _mm256_blend_ps(_mm256_blend_ps(v0, v1, 0x92), v2, 0x24);
  const __m256 green = _mm256_blend_ps(_mm256_blend_ps(v0, v1, 0x24), v2, 0x49);
  const __m256 blue = _mm256_blend_ps(_mm256_blend_ps(v0, v1, 0x49), v2, 0x92);
  const auto& order = kRgbOrder[reversed ? 1 : 0];
  return {Lanes(permute(red, order[0])), Lanes(permute(green, order[1])), Lanes(permute(blue, order[2]))};
}

// Unpacking pairs leaves even texels in the low half and odd ones in the high half.
alignas(32) inline constexpr std::int32_t kRgbaOrder[2][8] = {{0, 4, 1, 5, 2, 6, 3, 7}, {7, 3, 6, 2, 5, 1, 4, 0}};

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_rgba(__m256 v0, __m256 v1, __m256 v2, __m256 v3) {
  const __m256d rg_low = _mm256_castps_pd(_mm256_unpacklo_ps(v0, v1));
  const __m256d rg_high = _mm256_castps_pd(_mm256_unpacklo_ps(v2, v3));
  const __m256d b_low = _mm256_castps_pd(_mm256_unpackhi_ps(v0, v1));
  const __m256d b_high = _mm256_castps_pd(_mm256_unpackhi_ps(v2, v3));
  const std::int32_t* const order = kRgbaOrder[reversed ? 1 : 0];
  return {Lanes(permute(_mm256_castpd_ps(_mm256_unpacklo_pd(rg_low, rg_high)), order)),
          Lanes(permute(_mm256_castpd_ps(_mm256_unpackhi_pd(rg_low, rg_high)), order)),
          Lanes(permute(_mm256_castpd_ps(_mm256_unpacklo_pd(b_low, b_high)), order))};
}

WELKIN_INLINE __m256 load(const float* p) { return _mm256_loadu_ps(p); }
WELKIN_INLINE __m256 load(const std::uint16_t* p) {
  return _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

}  // namespace detail

WELKIN_INLINE DoubleLanes load_widened(const float* first) { return DoubleLanes(_mm256_cvtps_pd(_mm_load_ps(first))); }

WELKIN_INLINE Lanes narrow(DoubleLanes low, DoubleLanes high) {
  return Lanes(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm256_cvtpd_ps(low)), _mm256_cvtpd_ps(high), 1));
}

namespace detail {

WELKIN_INLINE Lanes without_fourths(__m256 texels) { return Lanes(_mm256_blend_ps(texels, _mm256_setzero_ps(), 0x88)); }

}  // namespace detail

WELKIN_INLINE Texels load_rgb_texels(const float* rgb) {
  const __m256i from_first = _mm256_setr_epi32(0, 1, 2, 0, 3, 4, 5, 0);
  const __m256i from_fifth = _mm256_setr_epi32(2, 3, 4, 0, 5, 6, 7, 0);
  return {detail::without_fourths(_mm256_permutevar8x32_ps(_mm256_loadu_ps(rgb), from_first)),
          detail::without_fourths(_mm256_permutevar8x32_ps(_mm256_loadu_ps(rgb + 4), from_fifth))};
}

WELKIN_INLINE Texels repeated_rgb(const float* rgb) {
  const Lanes two = detail::without_fourths(_mm256_broadcast_ps(reinterpret_cast<const __m128*>(rgb)));
  return {two, two};
}

template <bool reversed = false>
WELKIN_INLINE Texels weighted_columns(const Texels& texels, const float* weights) {
  const __m256 four = _mm256_broadcast_ps(reinterpret_cast<const __m128*>(weights));
  const __m256i first = _mm256_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1);
  const __m256i last = _mm256_setr_epi32(2, 2, 2, 2, 3, 3, 3, 3);
  const __m256i low = reversed ? _mm256_setr_epi32(3, 3, 3, 3, 2, 2, 2, 2) : first;
  const __m256i high = reversed ? _mm256_setr_epi32(1, 1, 1, 1, 0, 0, 0, 0) : last;
  return {texels.part[0] * Lanes(_mm256_permutevar_ps(four, low)),
          texels.part[1] * Lanes(_mm256_permutevar_ps(four, high))};
}

WELKIN_INLINE Quad folded(const Texels& texels) {
  const __m256 pairs = _mm256_add_ps(texels.part[0], texels.part[1]);
  return Quad(_mm_add_ps(_mm256_castps256_ps128(pairs), _mm256_extractf128_ps(pairs, 1)));
}

WELKIN_INLINE bool no_bit_set(const Texels& texels) {
  const __m256i bits = _mm256_castps_si256(texels.part[0] | texels.part[1]);
  return _mm256_testz_si256(bits, bits) != 0;
}

/// thrice[3 k + c] = lane k, c < 3.
WELKIN_INLINE void store_thrice(Lanes values, float* thrice) {
  _mm256_store_ps(thrice, _mm256_permutevar8x32_ps(values, _mm256_setr_epi32(0, 0, 0, 1, 1, 1, 2, 2)));
  _mm256_store_ps(thrice + 8, _mm256_permutevar8x32_ps(values, _mm256_setr_epi32(2, 3, 3, 3, 4, 4, 4, 5)));
  _mm256_store_ps(thrice + 16, _mm256_permutevar8x32_ps(values, _mm256_setr_epi32(5, 5, 6, 6, 6, 7, 7, 7)));
}

/// The first three of each four lanes, packed; what follows them up to 8 is overwritten too.
WELKIN_INLINE void store_without_fourth(Lanes values, float* packed) {
  _mm256_storeu_ps(packed, _mm256_permutevar8x32_ps(values, _mm256_setr_epi32(0, 1, 2, 4, 5, 6, 3, 7)));
}

/// 16 texels of packed RGB in the reversed order: of eight, which are floats 0 to 23, 21 22 23 18 19 20 15 16,
/// 17 12 13 14 9 10 11 6 and 7 8 3 4 5 0 1 2.
WELKIN_INLINE void reverse_rgb(const float* texels, float* reversed) {
  for (int k = 0; k < 3 * kLanes; k += 24) {
    const __m256 a = _mm256_load_ps(texels + k);
    const __m256 b = _mm256_load_ps(texels + k + 8);
    const __m256 c = _mm256_load_ps(texels + k + 16);
    float* const to = reversed + 3 * kLanes - 24 - k;
    const __m256 ends = _mm256_permutevar8x32_ps(b, _mm256_setr_epi32(0, 0, 0, 0, 0, 0, 7, 7));
    const __m256 from_c = _mm256_permutevar8x32_ps(c, _mm256_setr_epi32(5, 6, 7, 2, 3, 4, 0, 0));
    const __m256 from_a = _mm256_permutevar8x32_ps(a, _mm256_setr_epi32(7, 7, 3, 4, 5, 0, 1, 2));
    const __m256 from_b = _mm256_permutevar8x32_ps(b, _mm256_setr_epi32(4, 4, 5, 6, 1, 2, 3, 3));
    const __m256 others =
        _mm256_permutevar8x32_ps(_mm256_blend_ps(a, c, 0x02), _mm256_setr_epi32(1, 1, 1, 1, 6, 6, 6, 6));
    _mm256_store_ps(to, _mm256_blend_ps(from_c, ends, 0x40));
    _mm256_store_ps(to + 8, _mm256_blend_ps(from_b, others, 0x81));
    _mm256_store_ps(to + 16, _mm256_blend_ps(from_a, ends, 0x02));
  }
}

/// 16 bytes as whole numbers.
WELKIN_INLINE IntegerGroup widened(Bytes bytes) {
  return {Integers(_mm256_cvtepu8_epi32(bytes)), Integers(_mm256_cvtepu8_epi32(_mm_srli_si128(bytes, 8)))};
}

#define WELKIN_VEC_LOADS_PAIRS

/// See vec.h.
WELKIN_INLINE Pairs load_pairs(const float* pairs, Integers index) {
  alignas(32) std::int32_t at[8];
  _mm256_store_si256(reinterpret_cast<__m256i*>(at), index);
  const auto two = [&](int a, int b) WELKIN_INLINE_LAMBDA {
    const __m128d low = _mm_load_sd(reinterpret_cast<const double*>(pairs + 2 * at[a]));
    return _mm_castpd_ps(_mm_loadh_pd(low, reinterpret_cast<const double*>(pairs + 2 * at[b])));
  };
  const __m256 even = _mm256_insertf128_ps(_mm256_castps128_ps256(two(0, 1)), two(4, 5), 1);
  const __m256 odd = _mm256_insertf128_ps(_mm256_castps128_ps256(two(2, 3)), two(6, 7), 1);
  return {Lanes(_mm256_shuffle_ps(even, odd, 0x88)), Lanes(_mm256_shuffle_ps(even, odd, 0xDD))};
}

/// In each four lanes their last.
WELKIN_INLINE Integers last_of_each_four(Integers values) { return Integers(_mm256_shuffle_epi32(values, 0xFF)); }

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
