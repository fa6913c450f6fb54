// AVX-512 (F, BW, DQ, VL): 16 floats a register. What these names mean is said in vec.h.
#pragma once

#include "simd/vec_x86.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

using Lanes = xsimd::batch<float, xsimd::avx512f>;
using DoubleLanes = xsimd::batch<double, xsimd::avx512f>;
using NarrowLanes = xsimd::batch<float, xsimd::avx2>;
using Block = Lanes;

using Rgb = RgbOf<Lanes>;
using Texels = TexelsOf<Lanes>;
using Integers = xsimd::batch<std::int32_t, Lanes::arch_type>;
using IntegerGroup = IntegersOf<Integers>;
using Pairs = PairsOf<Lanes>;

namespace detail {

// The k-th texel's channel c lies at position 3k + c of 48 floats, in three registers. No two of a channel's sixteen
// lie in the same lane, since 16 is 1 modulo 3: lane l has it in the register r with r + l = c modulo 3. So the
// registers are blended, and one permutation of the blend brings the texels in order. (A permutation of two registers,
// of which it would take two, has the time of several blends.)
struct RgbIndices {
  std::uint16_t second[3];  ///< lanes that come from the second register
  std::uint16_t third[3];
  alignas(64) std::int32_t lane[3][16];
};

constexpr RgbIndices rgb_indices(bool reversed) {
  RgbIndices indices{};
  for (int c = 0; c < 3; ++c) {
    for (int texel = 0; texel < 16; ++texel) {
      const int position = 3 * (reversed ? 15 - texel : texel) + c;
      const auto bit = static_cast<std::uint16_t>(1U << (position % 16));
      if (position / 16 == 1) indices.second[c] = static_cast<std::uint16_t>(indices.second[c] | bit);
      if (position / 16 == 2) indices.third[c] = static_cast<std::uint16_t>(indices.third[c] | bit);
      indices.lane[c][texel] = position % 16;
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
    const __m512 blend = _mm512_mask_mov_ps(_mm512_mask_mov_ps(v0, indices.second[c], v1), indices.third[c], v2);
    return Lanes(_mm512_permutexvar_ps(load_indices(indices.lane[c]), blend));
  };
  return {channel(0), channel(1), channel(2)};
}

// Four registers hold sixteen texels of four channels, register r the texels 4 r to 4 r + 3. Blended after turns within
// each four lanes, register kRegisters[c][j] has channel c of its q-th texel in lane 4 q + j.
struct RgbaIndices {
  alignas(64) std::int32_t lane[3][16];
};

constexpr RgbaIndices rgba_indices(bool reversed) {
  constexpr int kRegisters[3][4] = {{0, 2, 1, 3}, {2, 0, 3, 1}, {1, 3, 0, 2}};
  RgbaIndices indices{};
  for (int c = 0; c < 3; ++c) {
    for (int lane = 0; lane < 16; ++lane) {
      const int texel = 4 * kRegisters[c][lane % 4] + lane / 4;
      indices.lane[c][reversed ? 15 - texel : texel] = lane;
    }
  }
  return indices;
}

template <bool reversed>
alignas(64) inline constexpr RgbaIndices kRgbaIndices = rgba_indices(reversed);

template <bool reversed>
WELKIN_INLINE Rgb rgb_from_rgba(__m512 v0, __m512 v1, __m512 v2, __m512 v3) {
  constexpr __mmask16 kSecondHalves = 0xCCCC;
  constexpr __mmask16 kOddLanes = 0xAAAA;
  constexpr int kTurnedByTwo = 0x4E;
  constexpr int kTurnedByOne = 0xB1;
  const __m512 turned1 = _mm512_permute_ps(v1, kTurnedByTwo);
  const __m512 turned3 = _mm512_permute_ps(v3, kTurnedByTwo);
  const __m512 red_green01 = _mm512_mask_mov_ps(v0, kSecondHalves, turned1);  // r0 g0 r1 g1
  const __m512 blue01 = _mm512_mask_mov_ps(turned1, kSecondHalves, v0);       // b1 a1 b0 a0
  const __m512 red_green23 = _mm512_permute_ps(_mm512_mask_mov_ps(v2, kSecondHalves, turned3), kTurnedByOne);
  const __m512 blue23 = _mm512_permute_ps(_mm512_mask_mov_ps(turned3, kSecondHalves, v2), kTurnedByOne);
  const auto ordered = [](__m512 values, int c) WELKIN_INLINE_LAMBDA {
    return Lanes(_mm512_permutexvar_ps(load_indices(kRgbaIndices<reversed>.lane[c]), values));
  };
  return {ordered(_mm512_mask_mov_ps(red_green01, kOddLanes, red_green23), 0),
          ordered(_mm512_mask_mov_ps(red_green23, kOddLanes, red_green01), 1),
          ordered(_mm512_mask_mov_ps(blue01, kOddLanes, blue23), 2)};
}

/// GCC 12 would rather give a load to each of the three permutations that use it: three times the load traffic, a third
/// of the kernel's time.
WELKIN_INLINE __m512 in_register(__m512 v) {
  WELKIN_IN_REGISTER(v);
  return v;
}

WELKIN_INLINE __m512 load(const float* p) { return in_register(_mm512_loadu_ps(p)); }
WELKIN_INLINE __m512 load(const std::uint16_t* p) {
  return in_register(_mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))));
}

}  // namespace detail

WELKIN_INLINE DoubleLanes load_widened(const float* first) {
  return DoubleLanes(_mm512_cvtps_pd(_mm256_load_ps(first)));
}

WELKIN_INLINE Lanes narrow(DoubleLanes low, DoubleLanes high) {
  return Lanes(_mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1));
}

/// Reads four floats too many: a load that a mask keeps from them takes half again as long on Zen 5.
WELKIN_INLINE Texels load_rgb_texels(const float* rgb) {
  const __m512i order = _mm512_setr_epi32(0, 1, 2, 0, 3, 4, 5, 0, 6, 7, 8, 0, 9, 10, 11, 0);
  return {Lanes(_mm512_maskz_permutexvar_ps(0x7777, order, _mm512_loadu_ps(rgb)))};
}

WELKIN_INLINE Texels repeated_rgb(const float* rgb) {
  return {Lanes(_mm512_maskz_broadcast_f32x4(0x7777, _mm_loadu_ps(rgb)))};
}

template <bool reversed = false>
WELKIN_INLINE Texels weighted_columns(const Texels& texels, const float* weights) {
  const __m512i order = reversed ? _mm512_setr_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0)
                                 : _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
  const __m512 four = _mm512_broadcast_f32x4(_mm_loadu_ps(weights));
  return {texels.part[0] * Lanes(_mm512_permutexvar_ps(order, four))};
}

WELKIN_INLINE Quad folded(const Texels& texels) {
  const __m512 all = texels.part[0];
  const __m256 pairs = _mm256_add_ps(_mm512_castps512_ps256(all), _mm512_extractf32x8_ps(all, 1));
  return Quad(_mm_add_ps(_mm256_castps256_ps128(pairs), _mm256_extractf128_ps(pairs, 1)));
}

WELKIN_INLINE bool no_bit_set(const Texels& texels) {
  const __m512i bits = _mm512_castps_si512(texels.part[0]);
  return _mm512_test_epi32_mask(bits, bits) == 0;
}

namespace detail {

/// The blocks of four lanes of a to d added up by twos, as (0 + 1) of each and (2 + 3), and then those: a sum a block.
WELKIN_INLINE __m512 added_blocks(__m512 a, __m512 b, __m512 c, __m512 d) {
  const __m512 ab = _mm512_add_ps(_mm512_shuffle_f32x4(a, b, 0x44), _mm512_shuffle_f32x4(a, b, 0xEE));
  const __m512 cd = _mm512_add_ps(_mm512_shuffle_f32x4(c, d, 0x44), _mm512_shuffle_f32x4(c, d, 0xEE));
  return _mm512_add_ps(_mm512_shuffle_f32x4(ab, cd, 0x88), _mm512_shuffle_f32x4(ab, cd, 0xDD));
}

}  // namespace detail

// Four texels of a result in one register: what this set alone can do at once.
#define WELKIN_VEC_FOLDS_FOUR

WELKIN_INLINE Lanes folded(const Texels& first, const Texels& second, const Texels& third, const Texels& fourth) {
  return Lanes(detail::added_blocks(first.part[0], second.part[0], third.part[0], fourth.part[0]));
}

/// Texel k of the four becomes `texel` where replace[k].
WELKIN_INLINE Lanes with_texel(Lanes four, int k, bool replace, const float* texel) {
  const auto place = static_cast<__mmask16>(replace ? 0xF << 4 * k : 0);
  return Lanes(_mm512_mask_broadcast_f32x4(four, place, _mm_loadu_ps(texel)));
}

/// Four texels as packed RGB to rgb[12], the first or (reversed) the last one first.
template <bool reversed = false>
WELKIN_INLINE void store_four_rgb(Lanes four, float* rgb) {
  const __m512i order = reversed ? _mm512_setr_epi32(12, 13, 14, 8, 9, 10, 4, 5, 6, 0, 1, 2, 3, 7, 11, 15)
                                 : _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
  _mm512_mask_storeu_ps(rgb, 0x0FFF, _mm512_permutexvar_ps(order, four));
}

/// Each of four texels as RGB to a place of its own, `step` floats after the one before.
WELKIN_INLINE void store_four_rgb_apart(Lanes four, float* rgb, std::ptrdiff_t step) {
  _mm_mask_storeu_ps(rgb, 0x7, _mm512_castps512_ps128(four));
  _mm_mask_storeu_ps(rgb + step, 0x7, _mm512_extractf32x4_ps(four, 1));
  _mm_mask_storeu_ps(rgb + 2 * step, 0x7, _mm512_extractf32x4_ps(four, 2));
  _mm_mask_storeu_ps(rgb + 3 * step, 0x7, _mm512_extractf32x4_ps(four, 3));
}

/// thrice[3 k + c] = lane k, c < 3.
WELKIN_INLINE void store_thrice(Lanes values, float* thrice) {
  const __m512i low = _mm512_setr_epi32(0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5);
  const __m512i middle = _mm512_setr_epi32(5, 5, 6, 6, 6, 7, 7, 7, 8, 8, 8, 9, 9, 9, 10, 10);
  const __m512i high = _mm512_setr_epi32(10, 11, 11, 11, 12, 12, 12, 13, 13, 13, 14, 14, 14, 15, 15, 15);
  _mm512_store_ps(thrice, _mm512_permutexvar_ps(low, values));
  _mm512_store_ps(thrice + 16, _mm512_permutexvar_ps(middle, values));
  _mm512_store_ps(thrice + 32, _mm512_permutexvar_ps(high, values));
}

/// The first three of each four lanes, packed; what follows them up to 16 is overwritten too.
WELKIN_INLINE void store_without_fourth(Lanes values, float* packed) {
  const __m512i order = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
  _mm512_storeu_ps(packed, _mm512_permutexvar_ps(order, values));
}

/// 16 texels of packed RGB in the reversed order.
WELKIN_INLINE void reverse_rgb(const float* texels, float* reversed) {
  const __m512 v0 = _mm512_load_ps(texels);
  const __m512 v1 = _mm512_load_ps(texels + 16);
  const __m512 v2 = _mm512_load_ps(texels + 32);
  const __m512i low = _mm512_setr_epi32(29, 30, 31, 26, 27, 28, 23, 24, 25, 20, 21, 22, 17, 18, 19, 14);
  const __m512i middle = _mm512_setr_epi32(31, 0, 27, 28, 29, 24, 25, 26, 21, 22, 23, 18, 19, 20, 15, 16);
  const __m512i middle_end = _mm512_setr_epi32(0, 16, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const __m512i high = _mm512_setr_epi32(17, 12, 13, 14, 9, 10, 11, 6, 7, 8, 3, 4, 5, 0, 1, 2);
  _mm512_store_ps(reversed, _mm512_permutex2var_ps(v1, low, v2));
  const __m512 most = _mm512_permutex2var_ps(v0, middle, v1);
  _mm512_store_ps(reversed + 16, _mm512_permutex2var_ps(most, middle_end, v2));
  _mm512_store_ps(reversed + 32, _mm512_permutex2var_ps(v0, high, v1));
}

/// Adds on the units that multiply, where additions are what a kernel waits for: a 1 + b rounds once, as a + b does,
/// and has its bits. (AMD's cores have units of their own for either.)
class Adder {
 public:
  WELKIN_INLINE Adder() : one_(_mm512_set1_ps(1.0F)) {
    WELKIN_IN_REGISTER(one_);
  }  // else it would be an addition again
  [[nodiscard]] WELKIN_INLINE Lanes add(Lanes a, Lanes b) const { return Lanes(_mm512_fmadd_ps(a, one_, b)); }

 private:
  __m512 one_;
};

WELKIN_INLINE void transpose(Lanes (&rows)[16]) {
  __m512 pairs[16];
  for (int i = 0; i < 16; i += 4) {
    const __m512 ab_low = _mm512_unpacklo_ps(rows[i], rows[i + 1]);
    const __m512 ab_high = _mm512_unpackhi_ps(rows[i], rows[i + 1]);
    const __m512 cd_low = _mm512_unpacklo_ps(rows[i + 2], rows[i + 3]);
    const __m512 cd_high = _mm512_unpackhi_ps(rows[i + 2], rows[i + 3]);
    const auto join = [](__m512 a, __m512 b, bool high) WELKIN_INLINE_LAMBDA {
      const __m512d x = _mm512_castps_pd(a);
      const __m512d y = _mm512_castps_pd(b);
      return _mm512_castpd_ps(high ? _mm512_unpackhi_pd(x, y) : _mm512_unpacklo_pd(x, y));
    };
    pairs[i] = join(ab_low, cd_low, false);  // block b of pairs[i + c]: column 4b + c of rows i to i + 3
    pairs[i + 1] = join(ab_low, cd_low, true);
    pairs[i + 2] = join(ab_high, cd_high, false);
    pairs[i + 3] = join(ab_high, cd_high, true);
  }
  for (int c = 0; c < 4; ++c) {
    const __m512 low01 = _mm512_shuffle_f32x4(pairs[c], pairs[4 + c], 0x44);
    const __m512 high01 = _mm512_shuffle_f32x4(pairs[c], pairs[4 + c], 0xEE);
    const __m512 low23 = _mm512_shuffle_f32x4(pairs[8 + c], pairs[12 + c], 0x44);
    const __m512 high23 = _mm512_shuffle_f32x4(pairs[8 + c], pairs[12 + c], 0xEE);
    rows[c] = Lanes(_mm512_shuffle_f32x4(low01, low23, 0x88));
    rows[4 + c] = Lanes(_mm512_shuffle_f32x4(low01, low23, 0xDD));
    rows[8 + c] = Lanes(_mm512_shuffle_f32x4(high01, high23, 0x88));
    rows[12 + c] = Lanes(_mm512_shuffle_f32x4(high01, high23, 0xDD));
  }
}

/// Sums the lanes of each of 16 rows.
WELKIN_INLINE void sum_rows(const float* rows, Lanes& sums) {
  const auto quarter = [&](int first) WELKIN_INLINE_LAMBDA {  // 4 rows, 4 lanes left of each
    const float* const r = rows + first * kLanes;
    return detail::added_blocks(_mm512_load_ps(r), _mm512_load_ps(r + kLanes), _mm512_load_ps(r + 2 * kLanes),
                                _mm512_load_ps(r + 3 * kLanes));
  };
  // Block b of quarter i is row 4i + b. Interleaving the quarters brings the same lane of four rows together.
  const __m512 q0 = quarter(0);
  const __m512 q1 = quarter(4);
  const __m512 q2 = quarter(8);
  const __m512 q3 = quarter(12);
  const __m512 s02 = _mm512_add_ps(_mm512_unpacklo_ps(q0, q2), _mm512_unpackhi_ps(q0, q2));  // lanes 0+2 | 1+3
  const __m512 s13 = _mm512_add_ps(_mm512_unpacklo_ps(q1, q3), _mm512_unpackhi_ps(q1, q3));
  const __m512 sums_of_blocks = _mm512_add_ps(_mm512_unpacklo_ps(s02, s13), _mm512_unpackhi_ps(s02, s13));
  // Element i of block b is row 4i + b.
  const __m512i order = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
  sums = Lanes(_mm512_permutexvar_ps(order, sums_of_blocks));
}

/// 16 bytes as whole numbers.
WELKIN_INLINE IntegerGroup widened(Bytes bytes) { return {Integers(_mm512_cvtepu8_epi32(bytes))}; }

#define WELKIN_VEC_LOADS_PAIRS

/// See vec.h.
WELKIN_INLINE Pairs load_pairs(const float* pairs, Integers index) {
  return {Lanes(_mm512_i32gather_ps(index, pairs, 8)), Lanes(_mm512_i32gather_ps(index, pairs + 1, 8))};
}

/// In each four lanes their last.
WELKIN_INLINE Integers last_of_each_four(Integers values) {
  return Integers(_mm512_shuffle_epi32(values, static_cast<_MM_PERM_ENUM>(0xFF)));
}

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
