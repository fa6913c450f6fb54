// Directional albedo by quadrature, sixteen view angles at a time. What is integrated, and why over these variables, is
// in reflections/brdf_table.h; the names are the same there.
#include "reflections/brdf_kernels.h"

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kWidth, simd::Lanes;

using IntegerLanes = xsimd::batch<std::int32_t, Lanes::arch_type>;

constexpr float kPi = 3.14159265F;

WELKIN_INLINE Lanes fifth_power(Lanes x) {
  const Lanes x2 = x * x;
  return x2 * x2 * x;
}

WELKIN_INLINE Lanes fourth_root(Lanes x) { return xsimd::sqrt(xsimd::sqrt(x)); }

/// A view direction against the normal, sixteen of them.
struct View {
  explicit WELKIN_INLINE View(Lanes normal_view)
      : cosine(normal_view),
        sine(xsimd::sqrt((Lanes(1.0F) - normal_view) * (Lanes(1.0F) + normal_view))),
        tangent(sine / cosine) {}

  Lanes cosine, sine, tangent;
};

/// Slope of the half vector, in the azimuth whose cosine against the view is `azimuth`, at which the light reaches the
/// horizon: the positive root of m^2 - 2 b m - 1 = 0 with b = tangent x azimuth, without cancellation.
WELKIN_INLINE Lanes horizon_slope(const View& view, float azimuth) {
  const Lanes b = view.tangent * Lanes(azimuth);
  const Lanes root = xsimd::sqrt(b * b + Lanes(1.0F));
  return azimuth >= 0.0F ? root + b : Lanes(1.0F) / (root - b);
}

struct Albedo {
  Lanes whole, fresnel;
};

/// One azimuth of the GGX integral: Int 4 V (n.l) (v.h) / (n.h) F sin(psi) cos(psi) dpsi, m = a tan(psi) the half
/// vector's slope, tan(psi) = sinh(x), f = e^-x = p^8. Half angle formulas give, without any transcendental function,
///   sin(psi) = tanh(x) = (1 - f^2) / (1 + f^2) = s / q,  cos(psi) = 1 / cosh(x) = 2 f / (1 + f^2) = c / q,
///   m = a s / c,  dpsi = dx / cosh(x) = c / q dx,  dx = -8 dp / p.
/// h is (m cos(phi), m sin(phi), 1) / sqrt(1 + m^2), so (n.h)^2 = c^2 / d with d = c^2 + a^2 s^2, and with k = a t
///   (v.h) / (n.h) = (n.v) (1 + t m cos(phi)) = (n.v) lean / c,     lean = c + k cos(phi) s,
///   n.l = 2 (v.h) (n.h) - n.v = light / d,                         light = (n.v) (2 c lean - d),
///   1 / (2 V) = (n.v) ((n.l) n + sqrt((n.l)^2 (1 - a^2) + a^2)) = (n.v) (light n + root) / d,  n = sqrt(1 + k^2),
/// as (n.v)^2 (1 - a^2) + a^2 = (n.v)^2 (1 + a^2 t^2). n.v and d cancel, which leaves 2 c s lean light / (q^3 (light n
/// + root)) dx; 2 c lean - d is written as c^2 + 2 c k cos(phi) s - a^2 s^2. The sum's factors 8 and span follow it,
/// the 2 and those of the azimuths in `directional_albedo`.
WELKIN_INLINE Albedo along_azimuth(const AlbedoRule& rule, const View& view, float alpha, float azimuth) {
  const Lanes one(1.0F);
  const Lanes alpha2(alpha * alpha);
  const Lanes one_minus_alpha2((1.0F - alpha) * (1.0F + alpha));
  const Lanes k = view.tangent * Lanes(alpha);
  const Lanes n = xsimd::sqrt(k * k + one);
  const Lanes k_azimuth = k * Lanes(azimuth);
  const Lanes sine_azimuth = view.sine * Lanes(alpha * azimuth);
  const Lanes end_r = horizon_slope(view, azimuth) / Lanes(alpha);
  // e^-x at sinh(x) = end_r, without the difference sqrt(r^2 + 1) - r, or where the tail is cut off
  const Lanes end_f = xsimd::max(one / (end_r + xsimd::sqrt(end_r * end_r + one)), Lanes(kAlbedoTail));
  const Lanes span = one - xsimd::sqrt(fourth_root(end_f));
  Albedo sum{Lanes(0.0F), Lanes(0.0F)};
  for (int i = 0; i < rule.radii; ++i) {
    const Lanes p = one - span * Lanes(rule.radius_positions[i]);
    const Lanes p4 = (p * p) * (p * p);
    const Lanes f = p4 * p4;
    const Lanes f2 = f * f;
    const Lanes c = f + f;  // c and s: cosine and sine of psi, both times q
    const Lanes s = one - f2;
    const Lanes q = one + f2;
    const Lanes c2 = c * c;
    const Lanes lean = c + k_azimuth * s;
    const Lanes d = c2 + alpha2 * (s * s);
    const Lanes light = xsimd::max(view.cosine * (c2 + (c + c) * (k_azimuth * s) - alpha2 * (s * s)), Lanes(0.0F));
    const Lanes root = xsimd::sqrt(one_minus_alpha2 * (light * light) + alpha2 * (d * d));
    const Lanes weight =
        Lanes(rule.radius_weights[i]) * (c * s) * (lean * light) / ((p * q) * (q * q) * (light * n + root));
    const Lanes view_half = (view.cosine * c + sine_azimuth * s) / xsimd::sqrt(d);
    sum.whole = sum.whole + weight;
    sum.fresnel = sum.fresnel + weight * fifth_power(one - view_half);
  }
  // 8: dx = 8 dp / p
  const Lanes scale = span * Lanes(8.0F);
  return {sum.whole * scale, sum.fresnel * scale};
}

/// log(1 - x) for 0 <= x < 1: exponent and mantissa, log(mantissa) = 2 artanh(t), |t| < 0.172, the first term left out
/// below 1e-9. Where the exponent is 0 the numerator is x itself: nothing of a small x is lost.
WELKIN_INLINE Lanes log_of_one_minus(Lanes x) {
  const Lanes one(1.0F);
  const auto bits = xsimd::bitwise_cast<IntegerLanes>(one - x);
  const IntegerLanes exponent = (bits - IntegerLanes(0x3F3504F3)) >> 23;  // of sqrt(1/2)
  const auto mantissa = xsimd::bitwise_cast<Lanes>(bits - (exponent << 23));
  const Lanes whole = xsimd::to_float(exponent);
  const Lanes numerator = xsimd::select(whole == Lanes(0.0F), -x, mantissa - one);
  const Lanes t = numerator / (mantissa + one);
  const Lanes t2 = t * t;
  const Lanes series =
      one + t2 * (Lanes(1.0F / 3.0F) + t2 * (Lanes(0.2F) + t2 * (Lanes(1.0F / 7.0F) + t2 * Lanes(1.0F / 9.0F))));
  return whole * Lanes(0.693147181F) + (t + t) * series;
}

/// e^y for -80 < y <= 0, relative error below 1e-6 at -20: 2^whole by the exponent's bits, the rest by Taylor's series
/// on [-0.35, 0.35], the first term left out below 1e-7.
WELKIN_INLINE Lanes exponential(Lanes y) {
  constexpr float rounder = 12582912.0F;  // 1.5 x 2^23: a sum with it has no fraction left
  const Lanes shifted = y * Lanes(1.44269504F) + Lanes(rounder);
  const Lanes whole = shifted - Lanes(rounder);
  const Lanes r = y - whole * Lanes(0.693147181F);
  Lanes series(1.0F);
  for (int k = 7; k >= 1; --k) series = Lanes(1.0F) + series * r * Lanes(1.0F / static_cast<float>(k));
  const IntegerLanes power = xsimd::bitwise_cast<IntegerLanes>(shifted) - IntegerLanes(0x4B400000);
  return xsimd::bitwise_cast<Lanes>(xsimd::bitwise_cast<IntegerLanes>(series) + (power << 23));
}

/// One azimuth of the sheen integral over z = n.h = p^4: Int (1 - z^2)^half_power (n.l) (v.h) / (n.l + n.v - (n.l)
/// (n.v)) dz, dz = 4 p^3 dp. v.h = (n.v) z + sin(v) sqrt(1 - z^2) cos(phi) and n.l = 2 (v.h) z - n.v. z begins at the
/// horizon's slope, z^2 = 1 / (1 + slope^2), and ends where 1 - z^2 is (1 - from2) (1 - kSheenTail / half_power): its
/// power is at most e^-kSheenTail of the first there, as (1 - x / n)^n is below e^-x.
WELKIN_INLINE Lanes sheen_along_azimuth(const AlbedoRule& rule, const View& view, float half_power, float azimuth) {
  const Lanes one(1.0F);
  const Lanes slope = horizon_slope(view, azimuth);
  const Lanes from2 = one / (one + slope * slope);
  // The first of what is integrated is the largest. Lanes that it leaves out are 0, however wide the register.
  const auto counts = log_of_one_minus(xsimd::min(from2, Lanes(0.99999994F))) * Lanes(half_power) > Lanes(-kSheenTail);
  if (xsimd::none(counts)) return Lanes(0.0F);
  const float reach = half_power > kSheenTail ? kSheenTail / half_power : 1.0F;
  const Lanes to2 = from2 + (one - from2) * Lanes(reach);
  const Lanes first = fourth_root(xsimd::sqrt(from2));
  const Lanes span = fourth_root(xsimd::sqrt(to2)) - first;
  Lanes sum(0.0F);
  for (int i = 0; i < rule.radii; ++i) {
    const Lanes p = first + span * Lanes(rule.radius_positions[i]);
    const Lanes p3 = p * p * p;
    const Lanes z = p3 * p;
    const Lanes z2 = xsimd::min(z * z, Lanes(0.99999994F));
    const Lanes view_half = view.cosine * z + view.sine * xsimd::sqrt(one - z2) * Lanes(azimuth);
    const Lanes light = xsimd::max((view_half + view_half) * z - view.cosine, Lanes(0.0F));
    const Lanes density = exponential(xsimd::max(log_of_one_minus(z2) * Lanes(half_power), Lanes(-80.0F)));
    sum = sum + Lanes(rule.radius_weights[i]) * density * (p3 * view_half * light) /
                    (light + view.cosine - light * view.cosine);
  }
  return xsimd::select(counts, sum * span * Lanes(4.0F), Lanes(0.0F));
}

void directional_albedo(const AlbedoRule& rule, float alpha, const float* normal_view, float* whole, float* fresnel) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const View view(Lanes::load_unaligned(normal_view + lane));
    Albedo sum{Lanes(0.0F), Lanes(0.0F)};
    for (int j = 0; j < rule.azimuths; ++j) {
      const Albedo part = along_azimuth(rule, view, alpha, rule.azimuth_cosines[j]);
      // 1 / pi of the distribution, 2 for both halves of the azimuths, 4 V = 2 / (...)
      const Lanes weight(rule.azimuth_weights[j] * (4.0F / kPi));
      sum.whole = sum.whole + weight * part.whole;
      sum.fresnel = sum.fresnel + weight * part.fresnel;
    }
    sum.whole.store_unaligned(whole + lane);
    sum.fresnel.store_unaligned(fresnel + lane);
  }
}

void sheen_albedo(const AlbedoRule& rule, float alpha, const float* normal_view, float* albedo) {
  const float power = 1.0F / alpha;
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const View view(Lanes::load_unaligned(normal_view + lane));
    Lanes sum(0.0F);
    for (int j = 0; j < rule.azimuths; ++j) {
      sum =
          sum + Lanes(rule.azimuth_weights[j]) * sheen_along_azimuth(rule, view, 0.5F * power, rule.azimuth_cosines[j]);
    }
    // (2 + power) / (2 pi) of the distribution, and both halves of the azimuths; 4 V has no factor
    (sum * Lanes((2.0F + power) / kPi)).store_unaligned(albedo + lane);
  }
}

}  // namespace

const BrdfKernels brdf_kernels_table = {
    .directional_albedo = directional_albedo,
    .sheen_albedo = sheen_albedo,
};

}  // namespace welkin::reflections::WELKIN_ISA
