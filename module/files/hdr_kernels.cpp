// Byte mantissas and their common exponent, four texels at a time in the 16 logical lanes.
#include "files/hdr_kernels.h"

#include <algorithm>
#include <cstring>

#include "simd/vec.h"

namespace welkin::files::WELKIN_ISA {
namespace {

using simd::Bytes, simd::Integers, simd::kLanes, simd::kParts, simd::Lanes;

constexpr int kTexels = kLanes / 4;  // per group
constexpr int kComponents = 4;

/// 2^(exponent - 136) = 2^(half - 63) 2^(exponent - half - 73), where half is half the exponent, rounded down: both
/// factors are normal floats, and no product rounds.
WELKIN_INLINE Lanes values(Integers texels) {
  const Integers exponent = simd::last_of_each_four(texels);
  const Integers half = exponent >> 1;
  const auto first = xsimd::bitwise_cast<Lanes>((half + Integers(127 - 63)) << 23);
  const auto second = xsimd::bitwise_cast<Lanes>((exponent - half + Integers(127 - 73)) << 23);
  const Integers mantissas = xsimd::select(exponent > Integers(0), texels, Integers(0));
  return xsimd::to_float(mantissas) * first * second;
}

/// Converts four texels to twelve floats, and writes up to four more after them.
WELKIN_INLINE void convert_group(Bytes bytes, float* rgb) {
  const simd::IntegerGroup texels = simd::widened(bytes);
  for (int k = 0; k < kParts; ++k) {
    simd::store_without_fourth(values(texels.part[k]), rgb + k * 3 * (kTexels / kParts));
  }
}

/// Converts 16 texels of four planes to 48 floats, and writes up to four more after them.
WELKIN_INLINE void convert_run(const std::uint8_t* const (&planes)[kComponents], int first, float* rgb) {
  const Bytes components[kComponents] = {simd::load_bytes(planes[0] + first), simd::load_bytes(planes[1] + first),
                                         simd::load_bytes(planes[2] + first), simd::load_bytes(planes[3] + first)};
  Bytes texels[kComponents];
  simd::interleave(components, texels);
  convert_group(texels[0], rgb);
  convert_group(texels[1], rgb + 3 * kTexels);
  convert_group(texels[2], rgb + 6 * kTexels);
  convert_group(texels[3], rgb + 9 * kTexels);
}

void floats_from_rgbe(const std::uint8_t* planes, int length, float* rgb) {
  constexpr int beyond = 2;  // texels past a run's end that stores touch
  const std::uint8_t* const components[kComponents] = {planes, planes + length, planes + 2 * length,
                                                       planes + 3 * length};
  int first = 0;
  for (; first + kLanes + beyond <= length; first += kLanes) convert_run(components, first, rgb + 3 * first);
  // The rest is less than two runs.
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
