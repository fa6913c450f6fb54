// NEON, the baseline of 64-bit ARM: 4 floats a register. What these names mean is said in vec.h.
#pragma once

#include "simd/neon_registers.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

using Quad = xsimd::batch<float, xsimd::neon64>;
using Pair = xsimd::batch<double, xsimd::neon64>;

/// The first double plus the second.
WELKIN_INLINE double sum(Pair values) { return vgetq_lane_f64(values, 0) + vgetq_lane_f64(values, 1); }

/// The first three of four floats.
WELKIN_INLINE void store_rgb(Quad values, float* rgb) {
  vst1_f32(rgb, vget_low_f32(values));
  vst1q_lane_f32(rgb + 2, values, 2);
}

WELKIN_INLINE void transpose(Quad (&rows)[4]) {
  const float64x2_t ab_even = vreinterpretq_f64_f32(vtrn1q_f32(rows[0], rows[1]));  // a0 b0 a2 b2
  const float64x2_t ab_odd = vreinterpretq_f64_f32(vtrn2q_f32(rows[0], rows[1]));
  const float64x2_t cd_even = vreinterpretq_f64_f32(vtrn1q_f32(rows[2], rows[3]));
  const float64x2_t cd_odd = vreinterpretq_f64_f32(vtrn2q_f32(rows[2], rows[3]));
  rows[0] = Quad(vreinterpretq_f32_f64(vtrn1q_f64(ab_even, cd_even)));
  rows[1] = Quad(vreinterpretq_f32_f64(vtrn1q_f64(ab_odd, cd_odd)));
  rows[2] = Quad(vreinterpretq_f32_f64(vtrn2q_f64(ab_even, cd_even)));
  rows[3] = Quad(vreinterpretq_f32_f64(vtrn2q_f64(ab_odd, cd_odd)));
}

}  // namespace WELKIN_ISA
}  // namespace welkin::simd

#include "simd/vec_common.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

namespace detail {

template <bool reversed>
WELKIN_INLINE Lanes ordered(float32x4_t v) {
  if constexpr (!reversed) return Lanes(v);
  const float32x4_t pairs = vrev64q_f32(v);  // 1 0 3 2
  return Lanes(vextq_f32(pairs, pairs, 2));
}

WELKIN_INLINE float32x4_t load(const float* p) { return vld1q_f32(p); }

/// Converts binary16 exactly, denormals included, unless FPCR selects ARM's alternative format.
WELKIN_INLINE float32x4_t widened(uint16x4_t halves) { return vcvt_f32_f16(vreinterpret_f16_u16(halves)); }
WELKIN_INLINE float32x4_t load(const std::uint16_t* p) { return widened(vld1_u16(p)); }

WELKIN_INLINE Lanes without_fourth(float32x4_t texel) { return Lanes(vsetq_lane_f32(0.0F, texel, 3)); }

}  // namespace detail

// Loads that part channels are instructions here: load_rgb and load_rgba are this header's own.
#define WELKIN_VEC_LOADS_CHANNELS

template <bool reversed>
WELKIN_INLINE Rgb load_rgb(const float* first) {
  const float32x4x3_t channels = vld3q_f32(first);
  return {detail::ordered<reversed>(channels.val[0]), detail::ordered<reversed>(channels.val[1]),
          detail::ordered<reversed>(channels.val[2])};
}

template <bool reversed>
WELKIN_INLINE Rgb load_rgba(const float* first) {
  const float32x4x4_t channels = vld4q_f32(first);
  return {detail::ordered<reversed>(channels.val[0]), detail::ordered<reversed>(channels.val[1]),
          detail::ordered<reversed>(channels.val[2])};
}

template <bool reversed>
WELKIN_INLINE Rgb load_rgba(const std::uint16_t* first) {
  const uint16x4x4_t channels = vld4_u16(first);
  return {detail::ordered<reversed>(detail::widened(channels.val[0])),
          detail::ordered<reversed>(detail::widened(channels.val[1])),
          detail::ordered<reversed>(detail::widened(channels.val[2]))};
}

WELKIN_INLINE DoubleLanes load_widened(const float* first) { return DoubleLanes(vcvt_f64_f32(vld1_f32(first))); }

WELKIN_INLINE Lanes narrow(DoubleLanes low, DoubleLanes high) {
  return Lanes(vcombine_f32(vcvt_f32_f64(low), vcvt_f32_f64(high)));
}

WELKIN_INLINE Texels load_rgb_texels(const float* rgb) {
  const float32x4_t last_four = vld1q_f32(rgb + 8);
  return {detail::without_fourth(vld1q_f32(rgb)), detail::without_fourth(vld1q_f32(rgb + 3)),
          detail::without_fourth(vld1q_f32(rgb + 6)), Lanes(vextq_f32(last_four, vdupq_n_f32(0.0F), 1))};
}

WELKIN_INLINE Texels repeated_rgb(const float* rgb) {
  const Lanes one = detail::without_fourth(vld1q_f32(rgb));
  return {one, one, one, one};
}

WELKIN_INLINE bool no_bit_set(const Texels& texels) {
  const Lanes bits = (texels.part[0] | texels.part[1]) | (texels.part[2] | texels.part[3]);
  return vmaxvq_u32(vreinterpretq_u32_f32(bits)) == 0;
}

/// thrice[3 k + c] = lane k, c < 3.
WELKIN_INLINE void store_thrice(Lanes values, float* thrice) {
  vst3q_f32(thrice, float32x4x3_t{{values.data, values.data, values.data}});
}

/// The first three of four lanes; what follows them is overwritten too.
WELKIN_INLINE void store_without_fourth(Lanes values, float* packed) { vst1q_f32(packed, values); }

/// 16 texels of packed RGB in the reversed order.
WELKIN_INLINE void reverse_rgb(const float* texels, float* reversed) {
  for (int k = 0; k < kLanes; ++k) {
    const float* const from = texels + 3 * (kLanes - 1 - k);
    for (int c = 0; c < 3; ++c) reversed[3 * k + c] = from[c];
  }
}

/// 16 bytes.
using Bytes = uint8x16_t;

WELKIN_INLINE Bytes load_bytes(const std::uint8_t* p) { return vld1q_u8(p); }

/// The k-th byte of each of four, one after the other, for k = 0, 1, 2, ... 15.
WELKIN_INLINE void interleave(const Bytes (&from)[4], Bytes (&to)[4]) {
  const uint16x8_t low[2] = {vreinterpretq_u16_u8(vzip1q_u8(from[0], from[1])),
                             vreinterpretq_u16_u8(vzip1q_u8(from[2], from[3]))};
  const uint16x8_t high[2] = {vreinterpretq_u16_u8(vzip2q_u8(from[0], from[1])),
                              vreinterpretq_u16_u8(vzip2q_u8(from[2], from[3]))};
  to[0] = vreinterpretq_u8_u16(vzip1q_u16(low[0], low[1]));
  to[1] = vreinterpretq_u8_u16(vzip2q_u16(low[0], low[1]));
  to[2] = vreinterpretq_u8_u16(vzip1q_u16(high[0], high[1]));
  to[3] = vreinterpretq_u8_u16(vzip2q_u16(high[0], high[1]));
}

/// 16 bytes as whole numbers.
WELKIN_INLINE IntegerGroup widened(Bytes bytes) {
  const uint16x8_t low = vmovl_u8(vget_low_u8(bytes));
  const uint16x8_t high = vmovl_high_u8(bytes);
  return {Integers(vreinterpretq_s32_u32(vmovl_u16(vget_low_u16(low)))),
          Integers(vreinterpretq_s32_u32(vmovl_high_u16(low))),
          Integers(vreinterpretq_s32_u32(vmovl_u16(vget_low_u16(high)))),
          Integers(vreinterpretq_s32_u32(vmovl_high_u16(high)))};
}

/// In each four lanes their last.
WELKIN_INLINE Integers last_of_each_four(Integers values) { return Integers(vdupq_laneq_s32(values, 3)); }

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
