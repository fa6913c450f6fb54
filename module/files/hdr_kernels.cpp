// Mantissas of a byte and their common exponent, four texels side by side in the 16 logical lanes.
#include "files/hdr_kernels.h"

#include <algorithm>
#include <cstring>

#include "simd/vec.h"

namespace welkin::files::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kParts, simd::Lanes;
using Integers = xsimd::batch<std::int32_t, Lanes::arch_type>;

constexpr int kTexels = kLanes / 4;  // of a group
constexpr int kComponents = 4;

/// The bytes of four texels as whole numbers, a texel's four in a row.
struct Group {
  Integers part[kParts];
};

#if defined(__AVX512F__)
WELKIN_INLINE Group widened(__m128i bytes) { return {Integers(_mm512_cvtepu8_epi32(bytes))}; }
WELKIN_INLINE Integers last_of_each(Integers texels) {
  return Integers(_mm512_shuffle_epi32(texels, static_cast<_MM_PERM_ENUM>(0xFF)));
}
#elif defined(__AVX2__)
WELKIN_INLINE Group widened(__m128i bytes) {
  return {Integers(_mm256_cvtepu8_epi32(bytes)), Integers(_mm256_cvtepu8_epi32(_mm_srli_si128(bytes, 8)))};
}
WELKIN_INLINE Integers last_of_each(Integers texels) { return Integers(_mm256_shuffle_epi32(texels, 0xFF)); }
#else
WELKIN_INLINE Group widened(__m128i bytes) {
  const __m128i zero = _mm_setzero_si128();
  const __m128i low = _mm_unpacklo_epi8(bytes, zero);
  const __m128i high = _mm_unpackhi_epi8(bytes, zero);
  return {Integers(_mm_unpacklo_epi16(low, zero)), Integers(_mm_unpackhi_epi16(low, zero)),
          Integers(_mm_unpacklo_epi16(high, zero)), Integers(_mm_unpackhi_epi16(high, zero))};
}
WELKIN_INLINE Integers last_of_each(Integers texels) { return Integers(_mm_shuffle_epi32(texels, 0xFF)); }
#endif

/// 2^(exponent - 136) = 2^(half - 63) 2^(exponent - half - 73), with half the exponent, rounded down: neither factor
/// leaves the range of normal floats, and neither product rounds.
WELKIN_INLINE Lanes values(Integers texels) {
  const Integers exponent = last_of_each(texels);
  const Integers half = exponent >> 1;
  const auto first = xsimd::bitwise_cast<Lanes>((half + Integers(127 - 63)) << 23);
  const auto second = xsimd::bitwise_cast<Lanes>((exponent - half + Integers(127 - 73)) << 23);
  const Integers mantissas = xsimd::select(exponent > Integers(0), texels, Integers(0));
  return xsimd::to_float(mantissas) * first * second;
}

/// Four texels to twelve floats, and up to four more that follow them.
WELKIN_INLINE void convert_group(__m128i bytes, float* rgb) {
  const Group group = widened(bytes);
  for (int k = 0; k < kParts; ++k) {
    simd::store_without_fourth(values(group.part[k]), rgb + k * 3 * (kTexels / kParts));
  }
}

/// 16 texels of four planes to 48 floats, and up to four more that follow them.
WELKIN_INLINE void convert_run(const std::uint8_t* const (&planes)[kComponents], int first, float* rgb) {
  const auto load = [&](int component) WELKIN_INLINE_LAMBDA {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(planes[component] + first));
  };
  const __m128i red = load(0);
  const __m128i green = load(1);
  const __m128i blue = load(2);
  const __m128i exponents = load(3);
  const __m128i low[2] = {_mm_unpacklo_epi8(red, green), _mm_unpacklo_epi8(blue, exponents)};
  const __m128i high[2] = {_mm_unpackhi_epi8(red, green), _mm_unpackhi_epi8(blue, exponents)};
  convert_group(_mm_unpacklo_epi16(low[0], low[1]), rgb);
  convert_group(_mm_unpackhi_epi16(low[0], low[1]), rgb + 3 * kTexels);
  convert_group(_mm_unpacklo_epi16(high[0], high[1]), rgb + 6 * kTexels);
  convert_group(_mm_unpackhi_epi16(high[0], high[1]), rgb + 9 * kTexels);
}

void floats_from_rgbe(const std::uint8_t* planes, int length, float* rgb) {
  constexpr int beyond = 2;  // texels, that stores behind a run touch
  const std::uint8_t* const components[kComponents] = {planes, planes + length, planes + 2 * length,
                                                       planes + 3 * length};
  int first = 0;
  for (; first + kLanes + beyond <= length; first += kLanes) convert_run(components, first, rgb + 3 * first);
  // What is left is less than two runs.
  for (; first < length; first += kLanes) {
    const auto count = static_cast<std::size_t>(std::min(kLanes, length - first));
    std::uint8_t bytes[kComponents][kLanes] = {};
    for (int c = 0; c < kComponents; ++c) std::memcpy(bytes[c], components[c] + first, count);
    const std::uint8_t* const padded[kComponents] = {bytes[0], bytes[1], bytes[2], bytes[3]};
    float texels[3 * (kLanes + beyond)];
    convert_run(padded, 0, texels);
    std::memcpy(rgb + 3 * first, texels, 3 * count * sizeof(float));
  }
}

}  // namespace

const HdrKernels hdr_kernels_table = {.floats_from_rgbe = floats_from_rgbe};

}  // namespace welkin::files::WELKIN_ISA
