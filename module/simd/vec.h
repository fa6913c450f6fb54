// One register of lanes, and how texels get into it. Only for the per-instruction-set kernel sources.
//
// Every kernel source is compiled once per instruction set, with WELKIN_ISA naming it and its namespace.
// Kernels count in groups of 16 logical lanes: 1 register of AVX-512, 2 of AVX2, 4 of SSE2. Lane k of a
// group meets the same operations in the same order whatever the width, so all builds give the same bits.
// That holds because only + - * / sqrt and data movement are used, and contraction is off.
//
// xsimd's namespace is renamed per instruction set on the compiler's command line (-Dxsimd=xsimd_avx2).
// Its inline functions would otherwise have the same names in all builds; where a compiler does not inline
// them the linker keeps one copy, and a machine without AVX could run the AVX one.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <xsimd/xsimd.hpp>

#include "platform/compiler.h"
#include "simd/dispatch.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

#if defined(__AVX512F__)
using Architecture = xsimd::avx512f;
#elif defined(__AVX2__)
using Architecture = xsimd::avx2;
#else
using Architecture = xsimd::sse2;
#endif

using Lanes = xsimd::batch<float, Architecture>;
using DoubleLanes = xsimd::batch<double, Architecture>;

inline constexpr int kWidth = static_cast<int>(Lanes::size);
inline constexpr int kDoubleWidth = static_cast<int>(DoubleLanes::size);

/// One register for each channel.
struct Rgb {
  Lanes red, green, blue;
};

namespace detail {

#if defined(__AVX512F__)

// The k-th texel's channel c lies at position 3k + c of 48 floats, in three registers. A permutation of
// the first two fetches what lies below 32, a second one adds the rest.
struct RgbIndices {
  std::int32_t low[3][16];
  std::int32_t high[3][16];
};

constexpr RgbIndices rgb_indices(bool reversed) {
  RgbIndices indices{};
  for (int c = 0; c < 3; ++c) {
    for (int lane = 0; lane < 16; ++lane) {
      const int position = 3 * (reversed ? 15 - lane : lane) + c;
      indices.low[c][lane] = position < 32 ? position : 0;
      indices.high[c][lane] = position < 32 ? lane : 16 + position - 32;
    }
  }
  return indices;
}

template <bool reversed>
alignas(64) inline constexpr RgbIndices kRgbIndices = rgb_indices(reversed);

WELKIN_INLINE __m512i load_indices(const std::int32_t* indices) { return _mm512_load_si512(indices); }

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_packed(__m512 v0, __m512 v1, __m512 v2) {
  const RgbIndices& indices = kRgbIndices<reversed>;
  const auto channel = [&](int c) WELKIN_INLINE_LAMBDA {
    const __m512 below = _mm512_permutex2var_ps(v0, load_indices(indices.low[c]), v1);
    return Lanes(_mm512_permutex2var_ps(below, load_indices(indices.high[c]), v2));
  };
  return {channel(0), channel(1), channel(2)};
}

// Two registers hold eight texels of four channels: lanes 0 to 7 take one channel, 8 to 15 another.
struct RgbaIndices {
  std::int32_t red_green[16];
  std::int32_t blue[16];
};

constexpr RgbaIndices rgba_indices(bool reversed) {
  RgbaIndices indices{};
  for (int lane = 0; lane < 8; ++lane) {
    const int texel = reversed ? 7 - lane : lane;
    indices.red_green[lane] = 4 * texel;
    indices.red_green[lane + 8] = 4 * texel + 1;
    indices.blue[lane] = 4 * texel + 2;
    indices.blue[lane + 8] = 4 * texel + 2;
  }
  return indices;
}

template <bool reversed>
alignas(64) inline constexpr RgbaIndices kRgbaIndices = rgba_indices(reversed);

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_rgba(__m512 v0, __m512 v1, __m512 v2, __m512 v3) {
  const __m512i red_green = load_indices(kRgbaIndices<reversed>.red_green);
  const __m512i blue = load_indices(kRgbaIndices<reversed>.blue);
  const __m512 first = reversed ? v2 : v0;
  const __m512 second = reversed ? v3 : v1;
  const __m512 third = reversed ? v0 : v2;
  const __m512 fourth = reversed ? v1 : v3;
  const __m512 rg_low = _mm512_permutex2var_ps(first, red_green, second);
  const __m512 rg_high = _mm512_permutex2var_ps(third, red_green, fourth);
  const __m512 b_low = _mm512_permutex2var_ps(first, blue, second);
  const __m512 b_high = _mm512_permutex2var_ps(third, blue, fourth);
  return {Lanes(_mm512_shuffle_f32x4(rg_low, rg_high, 0x44)), Lanes(_mm512_shuffle_f32x4(rg_low, rg_high, 0xEE)),
          Lanes(_mm512_shuffle_f32x4(b_low, b_high, 0x44))};
}

WELKIN_INLINE __m512d widen(const float* p) { return _mm512_cvtps_pd(_mm256_load_ps(p)); }
/// GCC 12 would rather give a load to each of the three permutations that use it: three times the load
/// traffic, a third of the kernel's time. The empty statement makes it a value in a register.
WELKIN_INLINE __m512 in_register(__m512 v) {
  WELKIN_IN_REGISTER(v);
  return v;
}

WELKIN_INLINE __m512 load(const float* p) { return in_register(_mm512_loadu_ps(p)); }
WELKIN_INLINE __m512 load(const std::uint16_t* p) {
  return in_register(_mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))));
}

#elif defined(__AVX2__)

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

WELKIN_INLINE __m256d widen(const float* p) { return _mm256_cvtps_pd(_mm_load_ps(p)); }
WELKIN_INLINE __m256 load(const float* p) { return _mm256_loadu_ps(p); }
WELKIN_INLINE __m256 load(const std::uint16_t* p) {
  return _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
}

#else

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

WELKIN_INLINE __m128d widen(const float* p) {
  return _mm_cvtps_pd(_mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(p))));
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

#endif

}  // namespace detail

/// Asks for the line-th cache line after an address; no address is wrong.
WELKIN_INLINE void fetch_line(const char* address, int line) {
  constexpr int line_bytes = 64;
  _mm_prefetch(address + static_cast<std::ptrdiff_t>(line) * line_bytes, _MM_HINT_T0);
}

/// `kDoubleWidth` aligned floats as doubles.
WELKIN_INLINE DoubleLanes load_widened(const float* first) { return DoubleLanes(detail::widen(first)); }

/// `kWidth` texels from `first` on, in memory order or reversed (the last one in lane 0).
template <bool reversed>
WELKIN_INLINE Rgb load_rgb(const float* first) {
  return detail::rgb_from_packed<reversed>(detail::load(first), detail::load(first + kWidth),
                                           detail::load(first + 2 * kWidth));
}

/// The same with four channels a texel, of which the fourth is dropped. Channel: float or binary16.
template <bool reversed, class Channel>
WELKIN_INLINE Rgb load_rgba(const Channel* first) {
  return detail::rgb_from_rgba<reversed>(detail::load(first), detail::load(first + kWidth),
                                         detail::load(first + 2 * kWidth), detail::load(first + 3 * kWidth));
}

// Four neighbouring texels of four floats as 16 logical lanes. Only for the per-instruction-set kernel sources.

constexpr int kParts = kLanes / kWidth;

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

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
