// Weights of the texels of a cubemap face in each harmonic.
//
// On the face, r^2 = 1 + u^2 + v^2, the face-local direction is (u, v, 1) / r and the solid angle of an area
// element is du dv / r^3. A texel of half-width h = 1/N around (u, v) weighs
//
//   exact:     W(l, m) = Int Int Y(l, m)((u, v, 1) / r) r^-3 du dv
//   midpoint:  W(l, m) = Y(l, m)((u, v, 1) / r at the centre) Int Int r^-3 du dv.
#include "image/image_kernels.h"
#include "simd/vec.h"

namespace welkin::image::WELKIN_ISA {
namespace {

using simd::DoubleLanes, simd::kDoubleWidth, simd::kLanes, simd::kWidth, simd::Lanes;

/// |u| of the texel in a left half's column: N - 1 - 2 column is an integer, so u is rounded once or twice.
WELKIN_INLINE double centre(int size, int index) {
  return static_cast<double>(size - 1 - 2 * index) / static_cast<double>(size);
}

/// |v| of the run's texels.
WELKIN_INLINE double centre_of_row(const TexelRun& run) {
  return (static_cast<double>(run.size - 1 - 2 * run.row) - 2.0 * run.row_offset) / static_cast<double>(run.size);
}

constexpr int padded(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

WELKIN_INLINE void clear_padding(const TexelRun& run, float* weights, int stride) {
  for (int f = 0; f < run.bands * run.bands; ++f) {
    for (int k = run.count; k < padded(run.count); ++k) weights[f * stride + k] = 0.0F;
  }
}

constexpr int kMaximumFunctions = math::kRecurrenceBands * math::kRecurrenceBands;

/// Adds scale Y at (u, v, 1) to sums[slot].
WELKIN_INLINE void add_basis(const TexelRun& run, const math::BasisRecurrence& recurrence, DoubleLanes u, double v,
                             DoubleLanes area, bool unit_scale, const int* slot, DoubleLanes* sums) {
  const DoubleLanes q = DoubleLanes(1.0) / (DoubleLanes(1.0) + u * u + DoubleLanes(v) * DoubleLanes(v));
  const DoubleLanes s = xsimd::sqrt(q);
  const DoubleLanes scale = unit_scale ? area : area * q * s;
  math::for_each_basis_value(recurrence, u * s, DoubleLanes(v) * s, s, scale, run.bands,
                             [&](int index, DoubleLanes value)
                                 WELKIN_INLINE_LAMBDA { sums[slot[index]] = sums[slot[index]] + value; });
}

/// One register's worth of texels.
WELKIN_INLINE void integrate_lanes(const TexelRun& run, const math::BasisRecurrence& recurrence,
                                   const math::GaussRule& rule, DoubleLanes u, double v, const int* slot,
                                   DoubleLanes* sums) {
  const double h = 1.0 / static_cast<double>(run.size);
  DoubleLanes solid_angle(0.0);
  const int rows = run.along_middle ? 1 : rule.order;
  for (int j = 0; j < rows; ++j) {
    const double v_node = run.along_middle ? v : v + h * rule.nodes[j];
    const double height = run.along_middle ? 2.0 * h : h * rule.weights[j];
    for (int i = 0; i < rule.order; ++i) {
      const DoubleLanes u_node = u + DoubleLanes(h * rule.nodes[i]);
      const DoubleLanes area(h * rule.weights[i] * height);
      if (run.midpoint) {
        const DoubleLanes q = DoubleLanes(1.0) / (DoubleLanes(1.0) + u_node * u_node + DoubleLanes(v_node * v_node));
        solid_angle = solid_angle + area * q * xsimd::sqrt(q);
      } else {
        add_basis(run, recurrence, u_node, v_node, area, false, slot, sums);
      }
    }
  }
  if (run.midpoint) add_basis(run, recurrence, u, v, solid_angle, true, slot, sums);
}

void integrate_texels(const TexelRun& run, const math::BasisRecurrence& recurrence, const math::GaussRule& rule,
                      const int* slot, float* weights, int stride) {
  const int functions = run.bands * run.bands;
  const double v = centre_of_row(run);
  for (int first = 0; first < padded(run.count); first += kWidth) {
    DoubleLanes sums[2][kMaximumFunctions];
    for (int half = 0; half < 2; ++half) {
      alignas(64) double u[kDoubleWidth];
      for (int k = 0; k < kDoubleWidth; ++k)
        u[k] = centre(run.size, run.first_column + first + half * kDoubleWidth + k);
      for (int f = 0; f < functions; ++f) sums[half][f] = DoubleLanes(0.0);
      integrate_lanes(run, recurrence, rule, DoubleLanes::load_aligned(u), v, slot, sums[half]);
    }
    for (int f = 0; f < functions; ++f) {
      simd::narrow(sums[0][f], sums[1][f]).store_unaligned(weights + f * stride + first);
    }
  }
  clear_padding(run, weights, stride);
}

/// Factors of one call: texel area 4 h^2 times the normalization of each harmonic, each product
/// rounded to float once (two roundings would bias every weight of a face alike), and h^2.
struct Factors {
  explicit Factors(int size)
      : area(4.0 / (static_cast<double>(size) * static_cast<double>(size))),
        y00(static_cast<float>(area * 0.28209479177387814)),  // sqrt(1 / 4 pi)
        y1(static_cast<float>(area * 0.4886025119029199)),    // sqrt(3 / 4 pi)
        y2(static_cast<float>(area * 1.0925484305920792)),    // sqrt(15 / 4 pi)
        y20(static_cast<float>(area * 0.31539156525252005)),  // sqrt(5 / 16 pi)
        y22(static_cast<float>(area * 0.5462742152960396)),   // sqrt(15 / 16 pi)
        h_squared(static_cast<float>(0.25 * area)) {}

  double area;
  Lanes y00, y1, y2, y20, y22;
  float h_squared;
};

/// Where in `weights` each of the nine functions goes: slot[l(l+1)+m] rows down.
struct Rows {
  float* weights;
  const int* slot;
  int stride;

  WELKIN_INLINE void put(int index, int position, Lanes value) const {
    value.store_unaligned(weights + slot[index] * stride + position);
  }
};

/// The integral of r^-n over a texel, to second order in its size h, as a multiple of 4 h^2 r^-n:
/// 1 + h^2/6 Laplacian(r^-n) r^n = 1 + h^2/6 (n^2 q - n (n + 2) q^2), with q = r^-2.
WELKIN_INLINE Lanes spread(float n, Lanes q, float h_squared) {
  return Lanes(1.0F) + Lanes(h_squared / 6.0F) * q * (Lanes(n * n) - Lanes(n * (n + 2.0F)) * q);
}

/// The nine exact integrals. With f = r^-n and F its integral over the texel, the next terms of the
/// expansion are Int u f = u F (1 - n h^2/3 q), Int u v f = u v F (1 - 2 n h^2/3 q) and
/// Int (u^2 - v^2) f = (u^2 - v^2) F (1 - 2 n h^2/3 q): from 2 f_u = -2 n u q f in the Laplacian of u f.
WELKIN_INLINE void expand_exact(const Rows& rows, const Factors& factor, int bands, int k, Lanes u, Lanes v, Lanes q) {
  const float h_squared = factor.h_squared;
  const Lanes s = xsimd::sqrt(q);
  const Lanes solid_angle = q * s * spread(3.0F, q, h_squared);  // Int r^-3
  rows.put(0, k, solid_angle * factor.y00);
  if (bands < 2) return;
  const Lanes first = q * q * spread(4.0F, q, h_squared);  // Int r^-4: one power of 1/r for band 1
  const Lanes first_edge = first * (Lanes(1.0F) - Lanes(4.0F * h_squared / 3.0F) * q) * factor.y1;
  rows.put(1, k, first_edge * v);
  rows.put(2, k, first * factor.y1);
  rows.put(3, k, first_edge * u);
  if (bands < 3) return;
  const Lanes second = q * q * s * spread(5.0F, q, h_squared);  // Int r^-5: two powers for band 2
  const Lanes second_edge = second * (Lanes(1.0F) - Lanes(5.0F * h_squared / 3.0F) * q) * factor.y2;
  const Lanes second_corner = second * (Lanes(1.0F) - Lanes(10.0F * h_squared / 3.0F) * q);
  rows.put(4, k, second_corner * (u * v) * factor.y2);
  rows.put(5, k, second_edge * v);
  rows.put(6, k, (Lanes(3.0F) * second - solid_angle) * factor.y20);
  rows.put(7, k, second_edge * u);
  rows.put(8, k, second_corner * ((u - v) * (u + v)) * factor.y22);
}

/// Solid angle times the harmonics at the centre.
WELKIN_INLINE void expand_midpoint(const Rows& rows, const Factors& factor, int bands, int k, Lanes u, Lanes v,
                                   Lanes q) {
  const Lanes s = xsimd::sqrt(q);
  const Lanes solid_angle = q * s * spread(3.0F, q, factor.h_squared);
  rows.put(0, k, solid_angle * factor.y00);
  if (bands < 2) return;
  const Lanes first = solid_angle * s * factor.y1;
  rows.put(1, k, first * v);
  rows.put(2, k, first);
  rows.put(3, k, first * u);
  if (bands < 3) return;
  const Lanes second = solid_angle * q;
  rows.put(4, k, second * (u * v) * factor.y2);
  rows.put(5, k, second * factor.y2 * v);
  rows.put(6, k, (Lanes(3.0F) * second - solid_angle) * factor.y20);
  rows.put(7, k, second * factor.y2 * u);
  rows.put(8, k, second * ((u - v) * (u + v)) * factor.y22);
}

/// 1 / size as a float and what that lacks, so that a product with an integer is off by its own rounding
/// only and not by one that all texels share.
struct Inverse {
  explicit Inverse(int size)
      : high(static_cast<float>(1.0 / size)), low(static_cast<float>(1.0 / size - static_cast<double>(high))) {}

  [[nodiscard]] WELKIN_INLINE Lanes times(Lanes integer) const { return integer * Lanes(high) + integer * Lanes(low); }

  float high;
  float low;
};

void expand_texels(const TexelRun& run, const int* slot, float* weights, int stride) {
  const Inverse inverse(run.size);
  const Factors factors(run.size);
  const Rows rows{weights, slot, stride};
  const Lanes v = run.row_offset == 0.0 ? inverse.times(Lanes(static_cast<float>(run.size - 1 - 2 * run.row)))
                                        : Lanes(static_cast<float>(centre_of_row(run)));
  alignas(64) float steps[kWidth];
  for (int k = 0; k < kWidth; ++k) steps[k] = static_cast<float>(2 * k);
  const Lanes step = Lanes::load_aligned(steps);
  for (int first = 0; first < padded(run.count); first += kWidth) {
    const auto start = static_cast<float>(run.size - 1 - 2 * (run.first_column + first));
    const Lanes u = inverse.times(Lanes(start) - step);
    const Lanes q = Lanes(1.0F) / (Lanes(1.0F) + u * u + v * v);
    if (run.midpoint) {
      expand_midpoint(rows, factors, run.bands, first, u, v, q);
    } else {
      expand_exact(rows, factors, run.bands, first, u, v, q);
    }
  }
  clear_padding(run, weights, stride);
}

}  // namespace

const TexelKernels texel_kernels_table = {
    .integrate_texels = integrate_texels,
    .expand_texels = expand_texels,
};

}  // namespace welkin::image::WELKIN_ISA
