// Registers of 128 bits, which all x86 instruction sets have. Included by vec_*.h.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <xsimd/xsimd.hpp>

#include "platform/compiler.h"
#include "simd/dispatch.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

/// Four floats and two doubles, with which every build works alike where no more can be done side by side.
using Quad = xsimd::batch<float, xsimd::sse2>;
using Pair = xsimd::batch<double, xsimd::sse2>;

/// 16 bytes.
using Bytes = __m128i;

WELKIN_INLINE Bytes load_bytes(const std::uint8_t* p) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p)); }

/// The k-th byte of each of four, one after the other, for k = 0, 1, 2, ... 15.
WELKIN_INLINE void interleave(const Bytes (&from)[4], Bytes (&to)[4]) {
  const __m128i low[2] = {_mm_unpacklo_epi8(from[0], from[1]), _mm_unpacklo_epi8(from[2], from[3])};
  const __m128i high[2] = {_mm_unpackhi_epi8(from[0], from[1]), _mm_unpackhi_epi8(from[2], from[3])};
  to[0] = _mm_unpacklo_epi16(low[0], low[1]);
  to[1] = _mm_unpackhi_epi16(low[0], low[1]);
  to[2] = _mm_unpacklo_epi16(high[0], high[1]);
  to[3] = _mm_unpackhi_epi16(high[0], high[1]);
}

/// The first double plus the second.
WELKIN_INLINE double sum(Pair values) { return _mm_cvtsd_f64(_mm_add_sd(values, _mm_unpackhi_pd(values, values))); }

/// The first three of four floats.
WELKIN_INLINE void store_rgb(Quad values, float* rgb) {
  _mm_storel_pi(reinterpret_cast<__m64*>(rgb), values);
  _mm_store_ss(rgb + 2, _mm_movehl_ps(values, values));
}

WELKIN_INLINE void transpose(Quad (&rows)[4]) {
  __m128 a = rows[0];
  __m128 b = rows[1];
  __m128 c = rows[2];
  __m128 d = rows[3];
  _MM_TRANSPOSE4_PS(a, b, c, d);
  rows[0] = Quad(a);
  rows[1] = Quad(b);
  rows[2] = Quad(c);
  rows[3] = Quad(d);
}

}  // namespace WELKIN_ISA
}  // namespace welkin::simd

#include "simd/vec_common.h"
