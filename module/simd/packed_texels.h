// Loads of texels of bytes and of packed halves by channel. Only for kernel sources.
#pragma once

#include <cstring>
#include <utility>

#include "simd/vec.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {
namespace detail {

/// kWidth bytes as floats.
#if defined(__AVX512F__)
WELKIN_INLINE __m512 floats_of_bytes(const std::uint8_t* p) {
  return _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(load_bytes(p)));
}
#elif defined(__AVX2__)
WELKIN_INLINE __m256 floats_of_bytes(const std::uint8_t* p) {
  return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p))));
}
#else
WELKIN_INLINE Lanes::register_type floats_of_bytes(const std::uint8_t* p) {
  std::uint32_t four = 0;
  std::memcpy(&four, p, sizeof(four));
#ifdef WELKIN_VEC_LOADS_CHANNELS
  const uint16x8_t wide = vmovl_u8(vcreate_u8(four));
  return vcvtq_f32_u32(vmovl_u16(vget_low_u16(wide)));
#else
  const __m128i zero = _mm_setzero_si128();
  const __m128i bytes = _mm_cvtsi32_si128(static_cast<int>(four));
  return _mm_cvtepi32_ps(_mm_unpacklo_epi16(_mm_unpacklo_epi8(bytes, zero), zero));
#endif
}
#endif

/// Divides by 255 and rounds once. 1 / 255 = 2^-8 + 2^-16 + 2^-24 + ...: eight bits times the first two terms are
/// exact, and the rest is too small for its own rounding to be seen. image/pixels.cpp decodes by the same product.
WELKIN_INLINE Lanes::register_type load(const std::uint8_t* p) {
  const Lanes value(floats_of_bytes(p));
  return value * Lanes(0x1.01p-8F) + value * Lanes(static_cast<float>(1.0 / 255.0 - 0x1.01p-8));
}

template <int step, bool without_fourth, int... k>
WELKIN_INLINE Lanes look_up(const float* table, const std::uint8_t* first, std::integer_sequence<int, k...> /*lanes*/) {
  return Lanes{(without_fourth && k % 4 == 3 ? 0.0F : table[first[step * k]])...};
}

}  // namespace detail

/// The table's values of kWidth bytes, `step` apart; or 0 for every fourth. (Inserted into a register: on Zen 3 0.24 ns
/// each, in memory 0.39, by gathers 0.42.)
template <int step, bool without_fourth = false>
WELKIN_INLINE Lanes look_up(const float* table, const std::uint8_t* first) {
  return detail::look_up<step, without_fourth>(table, first, std::make_integer_sequence<int, kWidth>{});
}

#ifdef WELKIN_VEC_LOADS_CHANNELS

/// kWidth texels of three channels. Channel: std::uint8_t (of 255) or std::uint16_t (binary16).
template <bool reversed, class Channel>
WELKIN_INLINE Rgb load_packed_rgb(const Channel* first) {
  alignas(16) float values[3 * kWidth];
  for (int k = 0; k < 3 * kWidth; k += kWidth) vst1q_f32(values + k, detail::load(first + k));
  return load_rgb<reversed>(values);
}

/// Reads four channels, of which the fourth is dropped.
template <bool reversed>
WELKIN_INLINE Rgb load_byte_rgba(const std::uint8_t* first) {
  alignas(16) float values[4 * kWidth];
  for (int k = 0; k < 4 * kWidth; k += kWidth) vst1q_f32(values + k, detail::load(first + k));
  return load_rgba<reversed>(values);
}

#else

/// kWidth texels of three channels. Channel: std::uint8_t (of 255) or std::uint16_t (binary16).
template <bool reversed, class Channel>
WELKIN_INLINE Rgb load_packed_rgb(const Channel* first) {
  return detail::rgb_from_packed<reversed>(detail::load(first), detail::load(first + kWidth),
                                           detail::load(first + 2 * kWidth));
}

/// Reads four channels, of which the fourth is dropped.
template <bool reversed>
WELKIN_INLINE Rgb load_byte_rgba(const std::uint8_t* first) {
  return detail::rgb_from_rgba<reversed>(detail::load(first), detail::load(first + kWidth),
                                         detail::load(first + 2 * kWidth), detail::load(first + 3 * kWidth));
}

#endif

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
