// Shares of a lobe's near part in texels, and sums by them.
#include "reflections/near_kernels.h"

#include "reflections/ring_kernels.h"
#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kWidth, simd::Lanes;

constexpr float kTiny = 1e-30F;
constexpr float kPi = 3.14159265F;

/// The angle of (x, y), y of any sign, from -pi to pi. Arc tangent up to 1: Abramowitz and Stegun, Handbook of
/// Mathematical Functions, 4.4.49, to 2e-8.
WELKIN_INLINE Lanes angle_of(Lanes y, Lanes x) {
  const Lanes tall = xsimd::abs(y);
  const Lanes wide = xsimd::abs(x);
  const Lanes z = xsimd::min(tall, wide) / xsimd::max(xsimd::max(tall, wide), Lanes(kTiny));
  const Lanes w = z * z;
  auto sum = Lanes(0.0028662257F);
  sum = sum * w - Lanes(0.0161657367F);
  sum = sum * w + Lanes(0.0429096138F);
  sum = sum * w - Lanes(0.0752896400F);
  sum = sum * w + Lanes(0.1065626393F);
  sum = sum * w - Lanes(0.1420889944F);
  sum = sum * w + Lanes(0.1999355085F);
  sum = sum * w - Lanes(0.3333314528F);
  Lanes angle = z + z * w * sum;
  angle = xsimd::select(tall > wide, Lanes(0.5F * kPi) - angle, angle);
  angle = xsimd::select(x < Lanes(0.0F), Lanes(kPi) - angle, angle);
  return xsimd::select(y < Lanes(0.0F), Lanes(0.0F) - angle, angle);
}

// Closed form of a lobe over a texel. In the stereographic plane about a direction, r = 2 tan(theta / 2), the lobe
// 1 / (q + s)^2 is radially symmetric, and the share of it within r is r^2 / (r^2 + a^2), a^2 = `width_squared`
// (derived at `split_lobe`). A region about the origin is a fan of sectors dpsi, so its share is Int r^2 / (r^2 + a^2)
// dpsi / 2 pi along its boundary, or the winding number about the origin less Int a^2 / (a^2 + r^2) dpsi / 2 pi.
// `missed_by` is the latter integral for a straight edge without its 2 pi, `missed_by_bend` corrects it for an arc,
// and `CloseShares` adds up the four edges of a texel. A cubemap's edges are great circles: the image of one at a
// distance d from the direction is a circle of curvature sin(d) / 2, which is as good as straight within two texels.
// Only parallels get a bend.

/// An edge seen from the origin: `cross` and `dot` of its ends, its length.
struct Edge {
  Lanes cross, dot, length;
};

/// Returns Int a^2 / (a^2 + r^2) dpsi along the edge, psi the angle about the origin, with the sign of `cross`.
///
/// With h the distance of the edge's line and x the way along it from the foot of the perpendicular, r^2 = h^2 + x^2
/// and dpsi = h dx / (h^2 + x^2). With H^2 = h^2 + a^2 (`hyp`) the integrand's partial fractions are
///   a^2 h / ((x^2 + h^2) (x^2 + H^2)) = h / (x^2 + h^2) - h / (x^2 + H^2),
/// so the integral is psi(h) - h / H psi(H), where psi(g) is the angle under which the edge is seen from a distance g,
/// tan psi(g) = g length / (g^2 + x0 x1). Here x0 x1 = dot - h^2, so psi(h) has the tangent area / dot and psi(H) has
/// hyp length / rest.
///
/// The two terms nearly cancel where a is small compared with h. They are therefore summed as (psi(h) - psi(H)) + (1 -
/// h / H) psi(H): H - h = a^2 / (H + h) gives 1 - h / H = a^2 / (H (H + h)), and the tangent of the difference of two
/// angles gives
///   psi(h) - psi(H) = atan2(area rest - hyp length dot, dot rest + area hyp length),
///   area rest - hyp length dot = length (h (dot + a^2) - H dot) = length a^2 (h - dot / (H + h)).
/// Both are products with a^2, so they keep their digits however small they are.
WELKIN_INLINE Lanes missed_by(const SplitLobe& lobe, const Edge& edge) {
  const Lanes a2(lobe.width_squared);
  const Lanes length = xsimd::max(edge.length, Lanes(kTiny));
  const Lanes area = xsimd::abs(edge.cross);
  const Lanes h = area / length;
  const Lanes hyp = xsimd::sqrt(h * h + a2);
  const Lanes inverse = Lanes(1.0F) / (hyp + h);
  const Lanes rest = edge.dot + a2;
  const Lanes difference = angle_of(length * a2 * (h - edge.dot * inverse), edge.dot * rest + area * hyp * length);
  const Lanes sum = difference + a2 * inverse / hyp * angle_of(hyp * length, rest);
  // rounding must not make it 0 or negative: see `CloseShares`
  const Lanes value = xsimd::max(sum, Lanes(kTiny));  // its sign tells on which side the origin is
  return xsimd::select(edge.cross < Lanes(0.0F), Lanes(0.0F) - value, value);
}

WELKIN_INLINE Edge edge_between(Lanes x0, Lanes y0, Lanes x1, Lanes y1) {
  const Lanes dx = x1 - x0;
  const Lanes dy = y1 - y0;
  return {x0 * y1 - y0 * x1, x0 * x1 + y0 * y1, xsimd::sqrt(dx * dx + dy * dy)};
}

/// Returns what `missed_by` of an edge lacks that is an arc: 2 a^2 Int d(x) / (x^2 + H^2)^2 dx along the chord, where
/// d(x) = bend / 2 (x - x0) (x1 - x) lies between the two. To first order, which does as d is small compared with x
/// and H.
///
/// The density of the share in the plane is d(r^2 / (r^2 + a^2)) / (2 pi r dr) = a^2 / (pi (r^2 + a^2)^2), times 2 pi
/// as in `missed_by`, and r^2 = x^2 + h^2 on the chord. With I_k = Int x^k / (x^2 + H^2)^2 dx from x0 (`begin`) to x1
/// (`end`) the integral is a^2 bend ((x0 + x1) I_1 - I_2 - x0 x1 I_0), where
///   I_1 = 1/2 / (x0^2 + H^2) - 1/2 / (x1^2 + H^2),
///   I_0 = (rise + rotation) / H^2,  rise = [x / 2 / (x^2 + H^2)],  rotation = psi(H) / (2 H),
///   I_2 = Int 1 / (x^2 + H^2) dx - H^2 I_0 = 2 rotation - (rise + rotation) = rotation - rise.
/// Without it the shares of directions next to a row's edge were off by 5e-3 (docs/maths/reflections.md).
WELKIN_INLINE Lanes missed_by_bend(const SplitLobe& lobe, Lanes x0, Lanes y0, Lanes x1, Lanes y1, Lanes bend) {
  const Edge edge = edge_between(x0, y0, x1, y1);
  const Lanes a2(lobe.width_squared);
  const Lanes inverse = Lanes(1.0F) / xsimd::max(edge.length, Lanes(kTiny));
  const Lanes begin = (x0 * (x1 - x0) + y0 * (y1 - y0)) * inverse;
  const Lanes end = begin + edge.length;
  const Lanes h = edge.cross * inverse;
  const Lanes square = h * h + a2;
  const Lanes hyp = xsimd::sqrt(square);
  const Lanes angle = angle_of(hyp * edge.length, edge.dot + a2);
  const Lanes before = Lanes(0.5F) / (begin * begin + square);
  const Lanes after = Lanes(0.5F) / (end * end + square);
  const Lanes rise = end * after - begin * before;
  const Lanes rotation = Lanes(0.5F) * angle / hyp;
  const Lanes zeroth = (rise + rotation) / square;
  const Lanes first = before - after;
  const Lanes second = rotation - rise;
  return a2 * bend * ((begin + end) * first - second - begin * end * zeroth);
}

// A direction n0 = (u0, v0, 1) and a corner n = (u0 + du, v0 + dv, 1), both in the face's frame. The plane's axes at n0
// are (1, 0, -u0) / sqrt(1 + u0^2), along which only u changes, and (-u0 v0, 1 + u0^2, -v0) / (sqrt(1 + u0^2) |n0|).
// Their products with n are
//   du / sqrt(1 + u0^2)   and   ((1 + u0^2) dv - u0 v0 du) / (sqrt(1 + u0^2) |n0|),
// as n0 itself drops out: both are linear in (du, dv), and differences of nearly equal numbers never arise. The
// stereographic plane has them times 2 / (|n| (1 + cos theta)), |n| cos theta = n n0 / |n0| (`along`).
// du and dv are differences of whole numbers less the part of a texel, in that order, for the same reason.
void place(const CubeGroup& group, int row, ColumnRange corners, const CornerLine& line) {
  const Lanes size(group.size);
  const Lanes step(2.0F / group.size);
  for (int k = 0; k < kLanes; k += kWidth) {
    const Lanes u0 = Lanes::load_unaligned(group.u + k);
    const Lanes v0 = Lanes::load_unaligned(group.v + k);
    const Lanes column0 = Lanes::load_unaligned(group.column + k);
    const Lanes row0 = Lanes::load_unaligned(group.row + k);
    const Lanes part = Lanes::load_unaligned(group.part + k);
    const Lanes row_here = xsimd::min(xsimd::max(row0 + Lanes(static_cast<float>(row)), Lanes(0.0F)), size);
    const Lanes dv = ((row_here - row0) - Lanes::load_unaligned(group.part_row + k)) * step;
    const Lanes v = v0 + dv;
    const Lanes across = Lanes(1.0F) + u0 * u0;
    const Lanes length = xsimd::sqrt(across + v0 * v0);
    const Lanes inverse = Lanes(1.0F) / length;
    const Lanes first = Lanes(1.0F) / xsimd::sqrt(across);
    const Lanes second = first * inverse;
    for (int i = corners.first; i < corners.end; ++i) {
      const Lanes wanted = column0 + Lanes(static_cast<float>(i));
      const Lanes here = xsimd::min(xsimd::max(wanted, Lanes(0.0F)), size);
      const Lanes du = ((here - column0) - part) * step;
      const Lanes u = u0 + du;
      const Lanes norm = xsimd::sqrt(Lanes(1.0F) + u * u + v * v);
      const Lanes along = (Lanes(1.0F) + u * u0 + v * v0) * inverse;
      const Lanes scale = Lanes(2.0F) / (norm + along);
      (du * first * scale).store_aligned(line.x + i * kLanes + k);
      ((across * dv - u0 * v0 * du) * second * scale).store_aligned(line.y + i * kLanes + k);
    }
  }
}

/// sin x and cos x for |x| below 0.3: the first terms left out of Taylor's series are below 6e-11 and 2e-9 there.
WELKIN_INLINE Lanes sine_of(Lanes x) {
  const Lanes square = x * x;
  return x * (Lanes(1.0F) -
              square * (Lanes(1.0F / 6.0F) - square * (Lanes(1.0F / 120.0F) - square * Lanes(1.0F / 5040.0F))));
}
WELKIN_INLINE Lanes cosine_of(Lanes x) {
  const Lanes square = x * x;
  return Lanes(1.0F) - square * (Lanes(0.5F) - square * (Lanes(1.0F / 24.0F) - square * Lanes(1.0F / 720.0F)));
}

// A direction of latitude p0 and a corner of latitude p = p0 - south, L to the east. The axes of the tangent plane at
// the direction are east and south, on which the corner has cos p sin L and
//   sin p0 cos p cos L - cos p0 sin p = sin(p0 - p) - 2 sin p0 cos p sin^2(L / 2);
// the stereographic plane has them over cos^2(theta / 2) = 1 - s, with s = sin^2(south / 2) + cos p0 cos p sin^2(L / 2)
// (the haversine formula). With L / 2 from a table of whole columns less the direction's part of one, by the sum
// formulas of sine and cosine, every term keeps its digits next to the direction.
void place(const LatLongGroup& group, int row, ColumnRange corners, const CornerLine& line) {
  const Lanes one(1.0F);
  for (int k = 0; k < kLanes; k += kWidth) {
    const Lanes sine0 = Lanes::load_unaligned(group.sine + k);
    const Lanes cosine0 = Lanes::load_unaligned(group.cosine + k);
    const Lanes sine_of_part = Lanes::load_unaligned(group.sine_of_part + k);
    const Lanes cosine_of_part = Lanes::load_unaligned(group.cosine_of_part + k);
    const Lanes row0 = Lanes::load_unaligned(group.row + k);
    const Lanes row_here =
        xsimd::min(xsimd::max(row0 + Lanes(static_cast<float>(row)), Lanes(0.0F)), Lanes(group.rows));
    const Lanes south = ((row_here - row0) - Lanes::load_unaligned(group.part_row + k)) * Lanes(group.down);
    const Lanes sine = sine_of(south);
    const Lanes cosine = cosine0 * cosine_of(south) + sine0 * sine;
    const auto pole = cosine < Lanes(1e-6F);  // a point, which rounding would make a line that is bent without limit
    const Lanes cosine_here = xsimd::select(pole, Lanes(0.0F), cosine);
    const Lanes sine_here = sine0 * cosine_of(south) - cosine0 * sine;
    // The image of a parallel is a circle of curvature (sin p0 + sin p) / (2 cos p): the parallel lies pi / 2 - p
    // about the pole, and the pole pi / 2 - p0 from the direction. tan p is that of the direction's own parallel; for
    // others it is (sin p - sin p0) / (2 cos p) more, which is of the order of their distance, two rows at most. On
    // the northern half the circle's centre lies towards the pole, so the arc bulges to larger y than its chord.
    xsimd::select(pole, Lanes(0.0F), sine_here / cosine).store_aligned(line.bend + k);
    const Lanes half = sine_of(south * Lanes(0.5F));
    const Lanes half_square = half * half;
    for (int i = corners.first; i < corners.end; ++i) {
      Lanes sine_half(0.0F);
      Lanes cosine_half(1.0F);
      if (i != 1) {
        const float* const table = group.columns + 2 * (i > 1 ? i - 1 : i);
        sine_half = Lanes(table[0]) * cosine_of_part - Lanes(table[1]) * sine_of_part;
        cosine_half = Lanes(table[1]) * cosine_of_part + Lanes(table[0]) * sine_of_part;
      }
      const Lanes across = cosine_here * sine_half;
      const Lanes square = half_square + cosine0 * across * sine_half;  // sin^2(theta / 2)
      const Lanes scale = one / (one - square);
      (Lanes(2.0F) * across * cosine_half * scale).store_aligned(line.x + i * kLanes + k);
      ((sine - Lanes(2.0F) * sine0 * across * sine_half) * scale).store_aligned(line.y + i * kLanes + k);
    }
  }
}

template <class Group>
void measure_line(const SplitLobe& lobe, const Group& group, int row, ColumnRange corners, const CornerLine& line) {
  place(group, row, corners, line);
  for (int i = corners.first * kLanes; i < (corners.end - 1) * kLanes; i += kWidth) {
    const auto load = [i](const float* values, int step)
                          WELKIN_INLINE_LAMBDA { return Lanes::load_aligned(values + i + step); };
    const Lanes x0 = load(line.x, 0);
    const Lanes y0 = load(line.y, 0);
    const Lanes x1 = load(line.x, kLanes);
    const Lanes y1 = load(line.y, kLanes);
    Lanes missed = missed_by(lobe, edge_between(x0, y0, x1, y1));
    if (line.bend != nullptr) {
      const Lanes bend = Lanes::load_aligned(line.bend + (i & (kLanes - 1)));
      missed = missed + missed_by_bend(lobe, x0, y0, x1, y1, bend);
    }
    missed.store_aligned(line.edge + i);
  }
}

using Mask = decltype(Lanes() < Lanes());

/// Gauss-Legendre points of an interval from -1/2 to 1/2, and their weights, which add up to 1.
template <int count>
struct Rule;
template <>
struct Rule<2> {
  static constexpr float points[] = {-0.2886751346F, 0.2886751346F};
  static constexpr float weights[] = {0.5F, 0.5F};
};
template <>
struct Rule<3> {
  static constexpr float points[] = {-0.3872983346F, 0.0F, 0.3872983346F};
  static constexpr float weights[] = {0.2777777778F, 0.4444444444F, 0.2777777778F};
};
template <>
struct Rule<4> {
  static constexpr float points[] = {-0.4305681558F, -0.1699905218F, 0.1699905218F, 0.4305681558F};
  static constexpr float weights[] = {0.1739274226F, 0.3260725774F, 0.3260725774F, 0.1739274226F};
};

/// Points of texels in a row, `count` along each edge.
template <class Group, int count>
class RowPoints;

/// Points of texels in a row of a face. sin^2(theta) = t / (n^2 n0^2), where t is a quadratic form of the way from the
/// direction in the face's plane: it has its digits however close the point is.
///
/// t = |n x n0|^2 = |(du, dv, 0) x (u0, v0, 1)|^2 = du^2 (1 + v0^2) - 2 u0 v0 du dv + dv^2 (1 + u0^2), as n x n0 does
/// not change where a multiple of n0 is added to n. s = sin^2(theta / 2) = (1 - cos theta) / 2 follows as
/// sin^2 / (2 (1 + cos)), which subtracts nothing either. A face's point has the solid angle du dv / |n|^3.
template <int count>
class RowPoints<CubeGroup, count> {
 public:
  WELKIN_INLINE RowPoints(const CubeGroup& group, int row, int k)
      : u0_(Lanes::load_unaligned(group.u + k)),
        column_(Lanes::load_unaligned(group.column + k)),
        middle_(Lanes(0.5F) - Lanes::load_unaligned(group.part + k)),
        size_(group.size),
        step_(2.0F / group.size) {
    const Lanes one(1.0F);
    const Lanes v0 = Lanes::load_unaligned(group.v + k);
    const Lanes row_here = Lanes::load_unaligned(group.row + k) + Lanes(static_cast<float>(row));
    row_there_ = row_here >= Lanes(0.0F) && row_here < size_;
    uu_ = one + v0 * v0;
    inverse_ = one / (uu_ + u0_ * u0_);
    const Lanes middle_row = Lanes(static_cast<float>(row) + 0.5F) - Lanes::load_unaligned(group.part_row + k);
    for (int j = 0; j < count; ++j) {
      const Lanes dv = (middle_row + Lanes(Rule<count>::points[j])) * step_;
      const Lanes v = v0 + dv;
      of_row_[j] = (one + u0_ * u0_) * dv * dv;
      slope_[j] = Lanes(-2.0F) * u0_ * v0 * dv;
      n_[j] = one + v * v;
    }
  }

  [[nodiscard]] WELKIN_INLINE Mask there(int i) const {
    const Lanes wanted = column_ + Lanes(static_cast<float>(i));
    return row_there_ && wanted >= Lanes(0.0F) && wanted < size_;
  }
  /// Calls `take(s, area)` for each point of a texel: its steradians, times cos(theta).
  template <class Take>
  WELKIN_INLINE void visit(int i, const Take& take) const {
    const Lanes one(1.0F);
    for (int k = 0; k < count; ++k) {
      const Lanes du = (Lanes(static_cast<float>(i) + Rule<count>::points[k]) + middle_) * step_;
      const Lanes u = u0_ + du;
      const Lanes square = u * u;
      const Lanes across = uu_ * du;
      for (int j = 0; j < count; ++j) {
        const Lanes inverse = one / (n_[j] + square);
        const Lanes x = ((across + slope_[j]) * du + of_row_[j]) * (inverse * inverse_);
        const Lanes cosine = xsimd::sqrt(xsimd::max(one - x, Lanes(0.0F)));
        const Lanes share(Rule<count>::weights[k] * Rule<count>::weights[j]);
        take(Lanes(0.5F) * x / (one + cosine), (share * step_ * step_) * (inverse * xsimd::sqrt(inverse)) * cosine);
      }
    }
  }

 private:
  Lanes u0_, column_;
  Lanes middle_;  ///< from the direction to its own column's middle, columns
  Lanes size_, step_, uu_;
  Lanes inverse_;  ///< of n0^2
  Lanes of_row_[count], slope_[count], n_[count];
  Mask row_there_;
};

/// Points of texels in a row of a lat-long: s is sin^2 of half the rows' angle and cos cos sin^2 of half the columns'
/// (the haversine formula), cos theta = 1 - 2 s. The sine of half the columns' angle is that of i whole columns less
/// the way from the direction to the point in a column, by the difference formula; only s itself must keep its digits.
template <int count>
class RowPoints<LatLongGroup, count> {
 public:
  WELKIN_INLINE RowPoints(const LatLongGroup& group, int row, int k) : columns_(group.columns) {
    const Lanes zero(0.0F);
    const Lanes down(group.down);
    const Lanes sine0 = Lanes::load_unaligned(group.sine + k);
    const Lanes cosine0 = Lanes::load_unaligned(group.cosine + k);
    const Lanes row_here = Lanes::load_unaligned(group.row + k) + Lanes(static_cast<float>(row));
    there_ = row_here >= zero && row_here < Lanes(group.rows);
    const Lanes middle = Lanes(static_cast<float>(row) + 0.5F) - Lanes::load_unaligned(group.part_row + k);
    for (int j = 0; j < count; ++j) {
      const Lanes south = (middle + Lanes(Rule<count>::points[j])) * down;
      const Lanes half = sine_of(south * Lanes(0.5F));
      const Lanes cosine = cosine0 * cosine_of(south) + sine0 * sine_of(south);
      of_row_[j] = half * half;
      cosines_[j] = cosine0 * cosine;
      area_[j] = Lanes(Rule<count>::weights[j] * group.across) * cosine * down;
    }
    const Lanes sine_of_middle = Lanes::load_unaligned(group.sine_of_middle + k);
    const Lanes cosine_of_middle = Lanes::load_unaligned(group.cosine_of_middle + k);
    for (int i = 0; i < count; ++i) {
      const Lanes rotation(0.5F * Rule<count>::points[i] * group.across);
      sine_of_point_[i] = sine_of_middle * cosine_of(rotation) - cosine_of_middle * sine_of(rotation);
      cosine_of_point_[i] = cosine_of_middle * cosine_of(rotation) + sine_of_middle * sine_of(rotation);
    }
  }

  [[nodiscard]] WELKIN_INLINE Mask there(int /*i*/) const { return there_; }
  template <class Take>
  WELKIN_INLINE void visit(int i, const Take& take) const {
    const Lanes sine_here(columns_[2 * i]);
    const Lanes cosine_here(columns_[2 * i + 1]);
    for (int k = 0; k < count; ++k) {
      const Lanes sine = sine_here * cosine_of_point_[k] - cosine_here * sine_of_point_[k];
      const Lanes square = sine * sine;
      for (int j = 0; j < count; ++j) {
        const Lanes s = of_row_[j] + cosines_[j] * square;
        take(s, Lanes(Rule<count>::weights[k]) * area_[j] * (Lanes(1.0F) - (s + s)));
      }
    }
  }

 private:
  const float* columns_;
  Lanes of_row_[count], cosines_[count], area_[count];
  Lanes sine_of_point_[count], cosine_of_point_[count];
  Mask there_;
};

/// The shares of a lobe in the texels between two lines, from left to right.
///
/// A texel's boundary is its top from left to right, its right side downwards, its bottom and its left side the other
/// way: with every edge measured from left to right or downwards, `missed` is top + right - bottom - left over 2 pi,
/// and the share is (1 where the origin is within, else 0) - `missed`. About an origin within, psi grows along the top
/// and the right side and falls along the bottom and the left one. Neighbours read the same four values with opposite
/// tests and `missed_by` is never 0, so exactly one texel of a row has the origin, and what one edge takes from a
/// texel it gives to the next: the shares of all texels add up to 1 but for rounding.
class CloseShares {
 public:
  WELKIN_INLINE CloseShares(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, int first)
      : lobe_(lobe), above_(above), below_(below), left_(side(first)) {}

  /// `left`: of the left corners, in floats; each call's is the next corner's.
  WELKIN_INLINE Lanes next(int left) {
    const Lanes zero(0.0F);
    const Lanes right = side(left + kLanes);
    const Lanes top = Lanes::load_aligned(above_.edge + left);
    const Lanes bottom = Lanes::load_aligned(below_.edge + left);
    const auto within = top >= zero && right >= zero && bottom < zero && left_ < zero;
    const Lanes missed = ((top - bottom) + (right - left_)) * Lanes(0.5F / kPi);
    left_ = right;
    return xsimd::select(within, Lanes(1.0F), zero) - missed;
  }

 private:
  [[nodiscard]] WELKIN_INLINE Lanes side(int at) const {
    return missed_by(lobe_, edge_between(Lanes::load_aligned(above_.x + at), Lanes::load_aligned(above_.y + at),
                                         Lanes::load_aligned(below_.x + at), Lanes::load_aligned(below_.y + at)));
  }

  const SplitLobe& lobe_;
  const CornerLine& above_;
  const CornerLine& below_;
  Lanes left_;
};

/// One register's directions of a group, and a row of texels about them.
template <class Group>
class RowWeights {
 public:
  WELKIN_INLINE RowWeights(const SplitLobe& lobe, const Group& group, int row, int k, float* weights)
      : lobe_(lobe), group_(group), row_(row), k_(k), weights_(weights + k) {}

  /// By points: 1 / x^2 - P(x) where x < 1. Both and their slopes meet at x = 1 (`kFarPart`), and near it the
  /// difference is (3 - 2.2343) (1 - x)^2: a texel that the end cuts needs no finer rule. `area` has the lobe's cosine.
  template <int count>
  void integrate(ColumnRange columns) const {
    if (columns.first >= columns.end) return;
    const RowPoints<Group, count> points(group_, row_, k_);
    for (int i = columns.first; i < columns.end; ++i) {
      Lanes sum(0.0F);
      points.visit(i, [&](Lanes s, Lanes area) WELKIN_INLINE_LAMBDA {
        const Lanes x = (s + Lanes(lobe_.offset)) * Lanes(lobe_.inverse_end);
        const Lanes near = Lanes(1.0F) / (x * x) - far_polynomial(x);
        sum += xsimd::select(x < Lanes(1.0F), area * near, Lanes(0.0F));
      });
      put(i, points.there(i), Lanes(lobe_.far_scale) * sum);
    }
  }

  /// The lobe in closed form, less what the cosine takes of it, which is small next to the direction, and the far part:
  /// both by points. Not clamped at 0: next to a pole thousands of columns' rounding cancels.
  ///
  /// With w = 1 / x^2 and P the far part, the near part's share is Int (w - P) c over the texel, c the cosine, which is
  /// Int w - Int (P + w (1 - c) / c) c. `share` is Int w, `area` is dw c, and 1 - c = 2 s. w (1 - c) / c is at most
  /// about q / 2 of the peak of w, at s = q, so that few points do for it. Beyond the end nothing is near: there P = w.
  void subtract_far(ColumnRange columns, const CornerLine& above, const CornerLine& below) const {
    const bool cut = above.bend != nullptr;  // the own column of a lat-long is two: see `MeasureLine`
    const RowPoints<Group, 3> points(group_, row_, k_);
    int left = columns.first * kLanes + k_;
    CloseShares shares(lobe_, above, below, left);
    for (int i = columns.first; i < columns.end; ++i, left += kLanes) {
      Lanes share = shares.next(left);
      if (cut && i == 0) {
        left += kLanes;
        share = share + shares.next(left);
      }
      Lanes far(0.0F);
      Lanes nearest(1.0F);
      points.visit(i, [&](Lanes s, Lanes area) WELKIN_INLINE_LAMBDA {
        const Lanes one(1.0F);
        const Lanes x = (s + Lanes(lobe_.offset)) * Lanes(lobe_.inverse_end);
        const Lanes whole = one / (x * x);
        const Lanes twice = s + s;
        far += area * (xsimd::select(x < one, far_polynomial(x), whole) + twice / (one - twice) * whole);
        nearest = xsimd::min(nearest, x);
      });
      // other directions of the group may be close where this one sees nothing
      put(i, points.there(i) && nearest < Lanes(1.0F), share - Lanes(lobe_.far_scale) * far);
    }
  }

 private:
  WELKIN_INLINE void put(int i, Mask there, Lanes weight) const {
    xsimd::select(there, weight, Lanes(0.0F)).store_aligned(weights_ + i * kLanes);
  }

  const SplitLobe& lobe_;
  const Group& group_;
  int row_;
  int k_;
  float* weights_;
};

template <class Group>
void weigh_row(const SplitLobe& lobe, const Group& group, int row, const RowRange& range, const CornerLine& above,
               const CornerLine& below, float* weights) {
  const auto& [columns, fine, close] = range;
  for (int k = 0; k < kLanes; k += kWidth) {
    const RowWeights<Group> row_weights(lobe, group, row, k, weights);
    row_weights.template integrate<2>({columns.first, fine.first});
    row_weights.template integrate<2>({fine.end, columns.end});
    for (const ColumnRange outer : {ColumnRange{fine.first, close.first}, ColumnRange{close.end, fine.end}}) {
      if (lobe.fine)
        row_weights.template integrate<4>(outer);
      else
        row_weights.template integrate<3>(outer);
    }
    if (close.first < close.end) row_weights.subtract_far(close, above, below);
  }
}

/// Adds up in parts of parts: floats would lose what thousands of columns next to a pole add. n texels one after the
/// other would round each weight up to n times; here it is 32 + 32 + n / 1024 times.
void scale_weights(float* weights, int texels, const float* sums) {
  constexpr int kPart = 32;
  constexpr int kParts = 32;
  for (int k = 0; k < kLanes; k += kWidth) {
    Lanes whole(0.0F);
    for (int i = 0; i < texels;) {
      Lanes parts(0.0F);
      for (int p = 0; p < kParts && i < texels; ++p) {
        Lanes part(0.0F);
        for (const int end = i + kPart < texels ? i + kPart : texels; i < end; ++i)
          part += Lanes::load_aligned(weights + i * kLanes + k);
        parts += part;
      }
      whole += parts;
    }
    const Lanes scale = Lanes::load_unaligned(sums + k) / whole;
    for (int i = 0; i < texels; ++i) {
      float* const weight = weights + i * kLanes + k;
      (Lanes::load_aligned(weight) * scale).store_aligned(weight);
    }
  }
}

/// Keeps two sums, of every other texel: one alone would wait for itself. They are added up in parts of parts, as
/// floats would lose what thousands of columns next to a pole add: a part has 64 to 127 texels, as it ends where runs
/// or their pieces of 64 do, so that the order of additions depends on the runs alone.
const float* sum_runs(const NearTaps& taps, float* sums) {
  constexpr int kRegisters = kRecordFloats / kWidth;
  constexpr int kPart = 64;
  constexpr int kParts = 16;
  Lanes even[kRegisters];
  Lanes odd[kRegisters];
  Lanes parts[kRegisters];
  Lanes sum[kRegisters];
  for (int r = 0; r < kRegisters; ++r) even[r] = odd[r] = parts[r] = sum[r] = Lanes(0.0F);
  const auto add_part = [&]() WELKIN_INLINE_LAMBDA {
    for (int r = 0; r < kRegisters; ++r) {
      parts[r] += even[r] + odd[r];
      even[r] = odd[r] = Lanes(0.0F);
    }
  };
  const auto add_parts = [&]() WELKIN_INLINE_LAMBDA {
    for (int r = 0; r < kRegisters; ++r) {
      sum[r] += parts[r];
      parts[r] = Lanes(0.0F);
    }
  };
  int texels = 0;
  int added = 0;
  const float* weights = taps.weights;
  for (const NearRun* run = taps.runs; run != taps.runs + taps.count; ++run) {
    const float* const records = taps.records + (taps.rows[run->row] + std::ptrdiff_t{run->first} * kRecordFloats);
    const auto add = [weights, records](Lanes* to, int i) WELKIN_INLINE_LAMBDA {
      const Lanes weight(weights[i]);
      for (int r = 0; r < kRegisters; ++r)
        to[r] += weight * Lanes::load_aligned(records + i * kRecordFloats + r * kWidth);
    };
    for (int i = 0; i < run->count;) {
      const int first = i;
      const int end = run->count - i < kPart ? run->count : i + kPart;
      for (; i + 1 < end; i += 2) {
        add(even, i);
        add(odd, i + 1);
      }
      if (i < end) add(even, i++);
      texels += i - first;
      if (texels < kPart) continue;
      add_part();
      texels = 0;
      if (++added % kParts == 0) add_parts();
    }
    weights += run->count;
  }
  add_part();
  add_parts();
  for (int r = 0; r < kRegisters; ++r) sum[r].store_aligned(sums + r * kWidth);
  return weights;
}

}  // namespace

const NearKernels near_kernels_table = {.cube = {measure_line<CubeGroup>, weigh_row<CubeGroup>},
                                        .lat_long = {measure_line<LatLongGroup>, weigh_row<LatLongGroup>},
                                        .scale = scale_weights,
                                        .sum_runs = sum_runs};

}  // namespace welkin::reflections::WELKIN_ISA
