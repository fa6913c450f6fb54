// Where a cube face's texels lie between the texels of a grid of longitudes and latitudes.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

constexpr double kTangentOfPi8 = 0.41421356237309503;  // tan(pi / 8)
constexpr double kPi4 = 0.78539816339744828;
constexpr double kPi2 = 1.5707963267948966;

/// 3/2 x 2^20: adding and subtracting it rounds a number below 2^19 to a multiple of 2^-32.
constexpr double kRoundTo32Bits = 1572864.0;
/// 3/2 x 2^52: the same, to whole numbers.
constexpr double kRoundToWhole = 6755399441055744.0;

/// atan(x) / x as a polynomial of x^2, for |x| <= tan(pi / 8): Chebyshev interpolation (mpmath's chebyfit, 40 digits),
/// relative error 8e-13.
constexpr double kArcTangent[8] = {0x1.fffffffffe56dp-1,  -0x1.5555554ba45bcp-2, 0x1.99999046d1e86p-3,
                                   -0x1.24909144ba082p-3, 0x1.c6cc2f2f6f999p-4,  -0x1.7055c066509b3p-4,
                                   0x1.1da9c35cc3322p-4,  -0x1.34787b1b4ac83p-5};

/// atan(across / along) for 0 <= across <= along: atan(s) with |s| <= tan(pi / 8), or pi/4 + atan(s).
WELKIN_INLINE DoubleLanes angle(DoubleLanes across, DoubleLanes along) {
  const auto beyond = across > along * DoubleLanes(kTangentOfPi8);
  const DoubleLanes numerator = xsimd::select(beyond, across - along, across);
  const DoubleLanes denominator = xsimd::select(beyond, across + along, along);
  const DoubleLanes nothing(1e-300);  // for the origin
  const DoubleLanes s = numerator / xsimd::select(denominator > nothing, denominator, nothing);
  const DoubleLanes s2 = s * s;
  DoubleLanes series(kArcTangent[7]);
  for (int k = 6; k >= 0; --k) series = series * s2 + DoubleLanes(kArcTangent[k]);
  return xsimd::select(beyond, DoubleLanes(kPi4), DoubleLanes(0.0)) + s * series;
}

/// Registers over `count` values; the last one in part, through a copy.
template <class Step>
WELKIN_INLINE void for_each_register(int count, const Step& step) {
  int k = 0;
  for (; k + kDoubleWidth <= count; k += kDoubleWidth) step(k, kDoubleWidth);
  if (k < count) step(k, count - k);
}

WELKIN_INLINE DoubleLanes load_part(const double* values, int count) {
  if (count == kDoubleWidth) return DoubleLanes::load_unaligned(values);
  alignas(64) double part[kDoubleWidth] = {};
  for (int k = 0; k < count; ++k) part[k] = values[k];
  return DoubleLanes::load_aligned(part);
}

WELKIN_INLINE void store_part(DoubleLanes lanes, int count, double* values) {
  if (count == kDoubleWidth) return lanes.store_unaligned(values);
  alignas(64) double part[kDoubleWidth];
  lanes.store_aligned(part);
  for (int k = 0; k < count; ++k) values[k] = part[k];
}

}  // namespace

void plane_lengths(const double* u, double v, int count, double* lengths) {
  for_each_register(
      count, [&](int k, int part) __attribute__((always_inline)) {
        const DoubleLanes x = load_part(u + k, part);
        store_part(xsimd::sqrt(x * x + DoubleLanes(v * v)), part, lengths + k);
      });
}

void places_of_angles(const double* across, const double* along, int count, double quarter, double offset,
                      double* places) {
  const double scale = quarter / kPi2;
  for_each_register(
      count, [&](int k, int part) __attribute__((always_inline)) {
        const DoubleLanes x = load_part(along + k, part);
        const DoubleLanes y = load_part(across + k, part);
        const auto steep = y > x;
        const DoubleLanes turned = DoubleLanes(scale) * angle(xsimd::select(steep, x, y), xsimd::select(steep, y, x));
        const DoubleLanes rounded = (turned + DoubleLanes(kRoundTo32Bits)) - DoubleLanes(kRoundTo32Bits);
        const DoubleLanes all = xsimd::select(steep, DoubleLanes(quarter) - rounded, rounded);
        store_part(DoubleLanes(offset) + all, part, places + k);
      });
}

// With t the share of the way from the second to the third texel, the cubic B-spline weighs them
//   (1 - t)^3 / 6,  2/3 - t^2 + t^3 / 2,  2/3 - (1 - t)^2 + (1 - t)^3 / 2,  t^3 / 6.
// Where the place is a texel's own, t may be 0 or 1: the weights are the same function either way.
void taps_of_places(const double* places, int count, bool cubic, std::int32_t* first, float* weights) {
  for (int k = 0; k < count; ++k) {
    const double second = (places[k] - 0.5 + kRoundToWhole) - kRoundToWhole;
    first[k] = static_cast<std::int32_t>(second) - 1;
    const auto t = static_cast<float>(places[k] - second);
    const float rest = 1.0F - t;
    const float outer = t * t * t * (1.0F / 6.0F);
    const float rest_outer = rest * rest * rest * (1.0F / 6.0F);
    const float third = 2.0F / 3.0F - rest * rest + 3.0F * rest_outer;
    weights[4 * k] = cubic ? rest_outer : 0.0F;
    weights[4 * k + 1] = cubic ? (1.0F - (outer + rest_outer)) - third : rest;  // so that the sum is 1
    weights[4 * k + 2] = cubic ? third : t;
    weights[4 * k + 3] = cubic ? outer : 0.0F;
  }
}

}  // namespace welkin::simd::WELKIN_ISA
