// The kernel of Radiance images: mantissas and exponents to floats.
#pragma once

#include <cstdint>

#include "simd/dispatch.h"

namespace welkin::files {

/// rgb[3 i + c] = planes[length c + i] 2^(planes[3 length + i] - 136), i < length, and 0 where that exponent is 0. A
/// float holds each of these values. Nothing beyond rgb[3 length - 1] is written.
using FloatsFromRgbe = void (*)(const std::uint8_t* planes, int length, float* rgb);

struct HdrKernels {
  FloatsFromRgbe floats_from_rgbe;
};
WELKIN_KERNEL_TABLES(HdrKernels, hdr_kernels)

}  // namespace welkin::files
