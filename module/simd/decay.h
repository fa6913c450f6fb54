// The exponential that falls, as kernels need it. Only for kernel sources.
#pragma once

#include "simd/vec.h"

namespace welkin::simd {
inline namespace WELKIN_ISA {

/// e^-u for 0 <= u <= 16: a sixteenth of it by its series, 16 times with itself.
WELKIN_INLINE Lanes decay(Lanes u) {
  const Lanes x = u * Lanes(-1.0F / 16.0F);
  auto sum = Lanes(1.0F / 40320.0F);
  sum = sum * x + Lanes(1.0F / 5040.0F);
  sum = sum * x + Lanes(1.0F / 720.0F);
  sum = sum * x + Lanes(1.0F / 120.0F);
  sum = sum * x + Lanes(1.0F / 24.0F);
  sum = sum * x + Lanes(1.0F / 6.0F);
  sum = sum * x + Lanes(0.5F);
  sum = sum * x + Lanes(1.0F);
  sum = sum * x + Lanes(1.0F);
  const Lanes two = sum * sum;
  const Lanes four = two * two;
  const Lanes eight = four * four;
  return eight * eight;
}

}  // namespace WELKIN_ISA
}  // namespace welkin::simd
