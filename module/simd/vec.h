// The vector layer of the kernels: registers of lanes, and how texels get into them. Only for kernel sources.
//
// Every kernel source is compiled once per instruction set, with WELKIN_ISA naming it and its namespace. Kernels count
// in groups of 16 logical lanes (kLanes): 1 register of AVX-512, 2 of AVX2, 4 of SSE2 or NEON. Lane k of a group meets
// the same operations in the same order whatever the width, so all builds give the same bits. That holds because only
// + - * / sqrt and data movement are used, and contraction is off.
//
// xsimd's namespace is renamed per instruction set on the compiler's command line (-Dxsimd=xsimd_avx2). Its inline
// functions would otherwise have the same names in all builds; where a compiler does not inline them the linker keeps
// one copy, and a machine without AVX could run the AVX one.
//
// Two operators of xsimd's differ between its sets. != (of a NaN false with AVX, true with SSE2) is not for kernels,
// and NEON's registers have none. The sign's change (0 - x with AVX-512, which leaves a zero's sign) is for values that
// are not 0, or whose sign is lost then.
//
// A header an instruction set defines:
//   Quad, Pair            registers of four floats and of two doubles
//   Lanes, DoubleLanes    registers of floats and of doubles, of the set's full width
//   NarrowLanes           the widest register of at most eight floats
//   Rgb                   three registers of Lanes; Texels: four texels of four floats, a group of Lanes
//   Block                 the register of which as many as it has floats are transposed together: Quad, or Lanes
//   load_widened(p)       kDoubleWidth aligned floats as doubles
//   narrow(low, high)     two registers of doubles as one of floats, each rounded
//   load_rgb_texels(p)    Texels: four of packed RGB, their fourth values 0; reads up to 16 floats
//   repeated_rgb(p)       Texels: one of RGB in all four places, its fourth value 0; reads 4 floats
//   weighted_columns<reversed>(texels, weights)  each texel times its own weight; reversed: the last is the first one's
//   folded(texels)        the sum of the four, (q0 + q2) + (q1 + q3), as a Quad (four floats)
//   store_thrice(lanes, p), store_without_fourth(lanes, p), reverse_rgb(p, q)  between packed RGB and others
//   Adder                 adds on units that would be idle, where there are any
//   no_bit_set(texels)    whether all bits are 0
//   transpose(rows)       of an array of Blocks
//   sum_rows(rows, sums)  for a Block of rows: the sum of each one's 16 lanes
//   Integers, IntegerGroup  a register of whole numbers as wide as Lanes; as many as make 16 lanes
//   Bytes                 16 bytes; load_bytes(p); interleave(from, to): four planes of bytes to texels of four
//   widened(bytes)        16 bytes as an IntegerGroup; last_of_each_four(integers): in each four lanes their last
//   Pairs, load_pairs(p, numbers)  pairs of floats, their first ones and their second ones; or what is below
//   detail::load(p)       kWidth floats, or as many binary16 as floats
//   detail::rgb_from_...  what load_rgb and load_rgba below call, or (WELKIN_VEC_LOADS_CHANNELS) these two themselves
#pragma once

#if defined(__AVX512F__)
#include "simd/vec_avx512.h"
#elif defined(__AVX2__)
#include "simd/vec_avx2.h"
#elif defined(__SSE2__) || defined(_M_X64)
#include "simd/vec_sse2.h"
#elif defined(__aarch64__)
#include "simd/vec_neon.h"
#else
#error "There is no vector layer for this processor yet."
#endif

namespace welkin::simd {
inline namespace WELKIN_ISA {

inline constexpr int kWidth = static_cast<int>(Lanes::size);
inline constexpr int kDoubleWidth = static_cast<int>(DoubleLanes::size);
inline constexpr int kNarrowWidth = static_cast<int>(NarrowLanes::size);
inline constexpr int kBlock = static_cast<int>(Block::size);
inline constexpr int kParts = kLanes / kWidth;  ///< registers of a group

#ifndef WELKIN_VEC_LOADS_CHANNELS

/// `kWidth` texels from `first` on, in memory order or reversed (the last one in lane 0).
template <bool reversed>
WELKIN_INLINE Rgb load_rgb(const float* first) {
  return detail::rgb_from_packed<reversed>(detail::load(first), detail::load(first + kWidth),
                                           detail::load(first + 2 * kWidth));
}

/// Loads texels of four channels in the same order and drops the fourth. Channel: float or binary16.
template <bool reversed, class Channel>
WELKIN_INLINE Rgb load_rgba(const Channel* first) {
  return detail::rgb_from_rgba<reversed>(detail::load(first), detail::load(first + kWidth),
                                         detail::load(first + 2 * kWidth), detail::load(first + 3 * kWidth));
}

#endif

#ifndef WELKIN_VEC_LOADS_PAIRS

/// The pairs of floats with these numbers, their first ones and their second ones.
WELKIN_INLINE Pairs load_pairs(const float* pairs, Integers index) {
  alignas(Lanes) std::int32_t at[kWidth];
  alignas(Lanes) float values[2][kWidth];
  index.store_aligned(at);
  for (int k = 0; k < kWidth; ++k) {
    values[0][k] = pairs[2 * at[k]];
    values[1][k] = pairs[2 * at[k] + 1];
  }
  return {Lanes::load_aligned(values[0]), Lanes::load_aligned(values[1])};
}

#endif

/// Four texels of a row, all times one weight.
WELKIN_INLINE Texels weighted_ring(const float* texels, float weight) {
  Texels result;
  for (int k = 0; k < kParts; ++k) result.part[k] = Lanes::load_unaligned(texels + k * kWidth) * Lanes(weight);
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

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
