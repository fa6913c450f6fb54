// Operations of all instruction sets in terms of Quad and Pair, which vec_x86.h and vec_neon.h define before they
// include this.
#pragma once

#include <cstddef>
#include <cstdint>

#include "platform/compiler.h"
#include "simd/dispatch.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

/// One register for each channel.
template <class Register>
struct RgbOf {
  Register red, green, blue;
};

/// Four texels of four floats side by side: the 16 logical lanes.
template <class Register>
struct TexelsOf {
  Register part[static_cast<std::size_t>(kLanes) / Register::size];
};

template <class Lanes>
struct PairsOf {
  Lanes first, second;
};

/// Whole numbers in the 16 logical lanes.
template <class Register>
struct IntegersOf {
  Register part[static_cast<std::size_t>(kLanes) / Register::size];
};

/// Prefetches the line-th cache line after an address, which may lie outside any object. It computes with integers,
/// because a pointer must not leave its array.
WELKIN_INLINE void fetch_line(const char* address, int line) {
  constexpr std::uintptr_t line_bytes = 64;
  const std::uintptr_t target =
      reinterpret_cast<std::uintptr_t>(address) + static_cast<std::uintptr_t>(line) * line_bytes;
  WELKIN_FETCH(reinterpret_cast<const char*>(target));  // NOLINT(performance-no-int-to-ptr): see above
}

// AVX-512 has another (vec_avx512.h).
#ifndef __AVX512F__

/// Adds.
struct Adder {
  template <class Register>  // NOLINTNEXTLINE(readability-convert-member-functions-to-static): AVX-512's is none
  [[nodiscard]] WELKIN_INLINE Register add(Register a, Register b) const {
    return a + b;
  }
};

#endif

/// sums = the 16 lanes of each of four rows: lanes k and k + 8 first, then k and k + 4, k + 2, k + 1.
WELKIN_INLINE void sum_rows(const float* rows, Quad& sums) {
  const auto row_lanes = [&](int row) WELKIN_INLINE_LAMBDA {
    const float* const r = rows + row * kLanes;
    return (Quad::load_aligned(r) + Quad::load_aligned(r + 8)) +
           (Quad::load_aligned(r + 4) + Quad::load_aligned(r + 12));
  };
  Quad four[4] = {row_lanes(0), row_lanes(1), row_lanes(2), row_lanes(3)};
  transpose(four);
  sums = (four[0] + four[2]) + (four[1] + four[3]);
}

// For instruction sets whose registers have four floats.
#ifndef __AVX2__

using Lanes = Quad;
using DoubleLanes = Pair;
using NarrowLanes = Lanes;
using Block = Quad;

using Rgb = RgbOf<Lanes>;
using Texels = TexelsOf<Lanes>;
using Integers = xsimd::batch<std::int32_t, Lanes::arch_type>;
using IntegerGroup = IntegersOf<Integers>;
using Pairs = PairsOf<Lanes>;

template <bool reversed = false>
WELKIN_INLINE Texels weighted_columns(const Texels& texels, const float* weights) {
  Texels result;
  for (int k = 0; k < 4; ++k) result.part[k] = texels.part[k] * Lanes(weights[reversed ? 3 - k : k]);
  return result;
}

WELKIN_INLINE Quad folded(const Texels& texels) {
  return (texels.part[0] + texels.part[2]) + (texels.part[1] + texels.part[3]);
}

#endif

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
