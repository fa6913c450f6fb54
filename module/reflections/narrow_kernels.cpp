// Shares of narrow lobes in texels.
#include "reflections/narrow_kernels.h"

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

/// An edge seen from the origin: `cross` and `dot` of its ends, its length.
struct Edge {
  Lanes cross, dot, length;
};

/// Int a^2 / (a^2 + r^2) dpsi along the edge, psi the angle about the origin, with the sign of `cross`. With h the
/// edge's distance, H^2 = h^2 + a^2 and psi(g) the angle under which it is seen from a distance g that is
/// psi(h) - h / H psi(H); as (psi(h) - psi(H)) + (1 - h / H) psi(H) both have their digits however small they are.
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
  const Lanes value = xsimd::max(sum, Lanes(kTiny));  // its sign tells on which side the origin is
  return xsimd::select(edge.cross < Lanes(0.0F), Lanes(0.0F) - value, value);
}

WELKIN_INLINE Edge edge_between(Lanes x0, Lanes y0, Lanes x1, Lanes y1) {
  const Lanes dx = x1 - x0;
  const Lanes dy = y1 - y0;
  return {x0 * y1 - y0 * x1, x0 * x1 + y0 * y1, xsimd::sqrt(dx * dx + dy * dy)};
}

/// What `missed_by` of an edge lacks that is an arc: 2 a^2 Int d(x) / (x^2 + H^2)^2 dx along the chord, where
/// d(x) = bend / 2 (x - x0) (x1 - x) lies between the two. To first order, which does as d is small beside x and H.
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
  const Lanes turn = Lanes(0.5F) * angle / hyp;
  const Lanes zeroth = (rise + turn) / square;
  const Lanes first = before - after;
  const Lanes second = turn - rise;
  return a2 * bend * ((begin + end) * first - second - begin * end * zeroth);
}

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

/// sin x and cos x for |x| below 0.3
WELKIN_INLINE Lanes sine_of(Lanes x) {
  const Lanes square = x * x;
  return x * (Lanes(1.0F) -
              square * (Lanes(1.0F / 6.0F) - square * (Lanes(1.0F / 120.0F) - square * Lanes(1.0F / 5040.0F))));
}
WELKIN_INLINE Lanes cosine_of(Lanes x) {
  const Lanes square = x * x;
  return Lanes(1.0F) - square * (Lanes(0.5F) - square * (Lanes(1.0F / 24.0F) - square * Lanes(1.0F / 720.0F)));
}

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

/// A texel about its centroid: s(a, b) = s + 2 b1 a + c1 a^2 + 2 b2 b + c2 b^2 + 2 mix a b, where a goes with the
/// columns and b with the rows, each over one.
struct Cell {
  Lanes s, area;  ///< steradians
  Lanes b1, b2, c1, c2, mix;
  Mask there;  ///< whether there is such a texel
};

/// A row of a face. s = x / 4 + x^2 / 16, where x = sin^2(theta) = t / (n^2 n0^2) and t is a quadratic form of the way
/// from the direction in the face's plane.
class CubeRow {
 public:
  WELKIN_INLINE CubeRow(const CubeGroup& group, int row, int k)
      : u0_(Lanes::load_unaligned(group.u + k)),
        column_(Lanes::load_unaligned(group.column + k)),
        size_(group.size),
        step_(2.0F / group.size) {
    const Lanes v0 = Lanes::load_unaligned(group.v + k);
    const Lanes row_here = Lanes::load_unaligned(group.row + k) + Lanes(static_cast<float>(row));
    row_there_ = row_here >= Lanes(0.0F) && row_here < size_;
    uu_ = Lanes(1.0F) + v0 * v0;
    vv_ = Lanes(1.0F) + u0_ * u0_;
    uv_ = Lanes(-2.0F) * u0_ * v0;
    inverse_ = Lanes(1.0F) / (uu_ + u0_ * u0_);
    const Lanes shift = Lanes(0.25F) * step_ * inverse_;  // of the centroid: solid angles fall like n^-3
    middle_ = Lanes(0.5F) - Lanes::load_unaligned(group.part + k) - shift * u0_;
    const Lanes middle_row = Lanes(0.5F) - Lanes::load_unaligned(group.part_row + k) - shift * v0;
    dv_ = (Lanes(static_cast<float>(row)) + middle_row) * step_;
    v_ = v0 + dv_;
    of_row_ = vv_ * dv_ * dv_;
    slope_ = uv_ * dv_;
    n_ = Lanes(1.0F) + v_ * v_;
  }

  [[nodiscard]] WELKIN_INLINE Cell cell(int i) const {
    const Lanes two(2.0F);
    const Lanes wanted = column_ + Lanes(static_cast<float>(i));
    const Lanes du = (Lanes(static_cast<float>(i)) + middle_) * step_;
    const Lanes u = u0_ + du;
    const Lanes inverse = Lanes(1.0F) / (n_ + u * u);
    const Lanes t = (uu_ * du + slope_) * du + of_row_;
    const Lanes tu = two * uu_ * du + slope_;
    const Lanes tv = two * vv_ * dv_ + uv_ * du;
    const Lanes both = inverse * inverse_;
    const Lanes x = t * both;
    const Lanes curve = Lanes(0.25F) * both * step_ * step_;
    const Lanes side = Lanes(0.125F) * both * step_;
    const Lanes lean = two * inverse;
    return {.s = Lanes(0.25F) * x * (Lanes(1.0F) + Lanes(0.25F) * x),
            .area = step_ * step_ * inverse * xsimd::sqrt(inverse),
            .b1 = side * (tu - lean * u * t),
            .b2 = side * (tv - lean * v_ * t),
            .c1 = curve * (uu_ - lean * u * tu),
            .c2 = curve * (vv_ - lean * v_ * tv),
            .mix = Lanes(0.5F) * curve * (uv_ - lean * (v_ * tu + u * tv)),
            .there = row_there_ && wanted >= Lanes(0.0F) && wanted < size_};
  }
  /// How a texel's width grows from its top to its bottom, over its middle one.
  [[nodiscard]] static WELKIN_INLINE Lanes growth() { return Lanes(0.0F); }

 private:
  Lanes u0_, column_, size_, step_;
  Lanes uu_, vv_, uv_;  ///< of the quadratic form
  Lanes inverse_;       ///< of n0^2
  Lanes middle_;        ///< from the direction to its own column's middle, columns
  Lanes dv_, v_, of_row_, slope_, n_;
  Mask row_there_;
};

/// A row of a lat-long: s is sin^2 of half the rows' angle and cos cos sin^2 of half the columns'.
class LatLongRow {
 public:
  WELKIN_INLINE LatLongRow(const LatLongGroup& group, int row, int k)
      : sine_of_middle_(Lanes::load_unaligned(group.sine_of_middle + k)),
        cosine_of_middle_(Lanes::load_unaligned(group.cosine_of_middle + k)),
        down_(group.down),
        across_(group.across),
        columns_(group.columns) {
    const Lanes zero(0.0F);
    const Lanes sine0 = Lanes::load_unaligned(group.sine + k);
    const Lanes cosine0 = Lanes::load_unaligned(group.cosine + k);
    const Lanes row_here = Lanes::load_unaligned(group.row + k) + Lanes(static_cast<float>(row));
    there_ = row_here >= zero && row_here < Lanes(group.rows);
    const Lanes middle = (Lanes(static_cast<float>(row) + 0.5F) - Lanes::load_unaligned(group.part_row + k)) * down_;
    const Lanes cosine = cosine0 * cosine_of(middle) + sine0 * sine_of(middle);
    growth_ = xsimd::select(there_, down_ * (sine0 * cosine_of(middle) - cosine0 * sine_of(middle)) / cosine, zero);
    const Lanes south = middle + growth_ * down_ * Lanes(1.0F / 12.0F);  // of the centroid
    sine_south_ = sine_of(south);
    cosine_south_ = cosine_of(south);
    const Lanes half = sine_of(south * Lanes(0.5F));
    of_row_ = half * half;
    area_ = cosine * down_ * across_;
    cosines_ = cosine0 * (cosine0 * cosine_south_ + sine0 * sine_south_);
    sines_ = cosine0 * (sine0 * cosine_south_ - cosine0 * sine_south_);
  }

  [[nodiscard]] WELKIN_INLINE Cell cell(int i) const {
    const Lanes half(0.5F);
    const float* const table = columns_ + 2 * i;
    const Lanes sine = Lanes(table[0]) * cosine_of_middle_ - Lanes(table[1]) * sine_of_middle_;
    const Lanes cosine = Lanes(table[1]) * cosine_of_middle_ + Lanes(table[0]) * sine_of_middle_;
    const Lanes square = sine * sine;
    const Lanes product = sine * cosine;
    const Lanes part = cosines_ * square;
    return {.s = of_row_ + part,
            .area = area_,
            .b1 = half * across_ * cosines_ * product,
            .b2 = half * down_ * (half * sine_south_ + sines_ * square),
            .c1 = Lanes(0.25F) * across_ * across_ * (cosines_ - Lanes(2.0F) * part),
            .c2 = Lanes(0.25F) * down_ * down_ * (cosine_south_ - Lanes(2.0F) * part),
            .mix = half * across_ * down_ * sines_ * product,
            .there = there_};
  }
  [[nodiscard]] WELKIN_INLINE Lanes growth() const { return growth_; }

 private:
  Lanes sine_of_middle_, cosine_of_middle_, down_, across_;
  const float* columns_;
  Lanes growth_, sine_south_, cosine_south_, of_row_, area_;
  Lanes cosines_, sines_;  ///< of both latitudes; of the direction's, times the row's sine
  Mask there_;
};

WELKIN_INLINE CubeRow row_of(const CubeGroup& group, int row, int k) { return {group, row, k}; }
WELKIN_INLINE LatLongRow row_of(const LatLongGroup& group, int row, int k) { return {group, row, k}; }

/// The mean of v^-2, v = q + s, over a cell: to fourth order in its sides. With B = b / v and C = c / v it is v^-2
/// times the mean of (1 + z)^-2, z = 2 B1 a + C1 a^2 + 2 B2 b + C2 b^2 + 2 G a b, which is expanded to 1 - 2 z + 3 z^2
/// - 4 z^3 + 5 z^4, and the means of a^2, a^4 and a^2 b^2 are 1/12, 1/80 and 1/144.
WELKIN_INLINE Lanes mean_by_series(const Cell& cell, Lanes v) {
  const Lanes inverse = Lanes(1.0F) / v;
  const Lanes b1 = cell.b1 * inverse;
  const Lanes b2 = cell.b2 * inverse;
  const Lanes p = b1 * b1;
  const Lanes q = b2 * b2;
  const Lanes c1 = cell.c1 * inverse;
  const Lanes c2 = cell.c2 * inverse;
  const Lanes g = cell.mix * inverse;
  const Lanes second = (p + q) - (c1 + c2) * Lanes(1.0F / 6.0F);
  const Lanes fourth = (c1 * c1 + c2 * c2) * Lanes(0.0375F) + (p * p + q * q) - (p * c1 + q * c2) * Lanes(0.6F);
  const Lanes mixed = (c1 * c2 + Lanes(2.0F) * g * g) * Lanes(1.0F / 24.0F) -
                      (p * c2 + q * c1 + Lanes(4.0F) * b1 * b2 * g) * Lanes(1.0F / 3.0F) + p * q * Lanes(10.0F / 3.0F);
  return inverse * inverse * (Lanes(1.0F) + (second + (fourth + mixed)));
}

/// The mean of v^-2 over a cell that is a trapezoid, by three by three Gauss points.
WELKIN_INLINE Lanes mean_by_points(const Cell& cell, Lanes v, Lanes growth) {
  constexpr float place = 0.387298335F;
  const auto inverse_square = [](Lanes value) WELKIN_INLINE_LAMBDA { return Lanes(1.0F) / (value * value); };
  const Lanes centre = growth * Lanes(1.0F / 12.0F);
  const Lanes bow = cell.c1 * Lanes(place * place);
  Lanes sum(0.0F);
  for (int k = -1; k <= 1; ++k) {
    const Lanes at(static_cast<float>(k) * place);
    const Lanes b = at - centre;
    const Lanes middle = v + (Lanes(2.0F) * cell.b2 + cell.c2 * b) * b;
    const Lanes lean = Lanes(2.0F * place) * (cell.b1 + cell.mix * b);
    const Lanes sides = inverse_square((middle + bow) - lean) + inverse_square((middle + bow) + lean);
    const Lanes row = Lanes(8.0F / 18.0F) * inverse_square(middle) + Lanes(5.0F / 18.0F) * sides;
    sum = sum + Lanes(k == 0 ? 8.0F / 18.0F : 5.0F / 18.0F) * (Lanes(1.0F) + growth * at) * row;
  }
  return sum;
}

/// The mean of P(x) over a cell, and what the end of the near part, which lies within the cell, adds to the near part.
struct FarMean {
  Lanes value, end;
};

/// By P's second derivative. About the end, where y = 1 - x is 0, the near part is 1 / x^2 - P = k y^2 for y > 0, and
/// nothing beyond: with y even over h to either side, the mean over a cell is k (y + h)^3 / 6 h for y < 0, and that
/// much of k (h - y)^3 / 6 h less than of the whole parabola for y > 0.
WELKIN_INLINE FarMean far_mean(const SplitLobe& lobe, const Cell& cell, Lanes x, Lanes growth) {
  const Lanes y = Lanes(1.0F) - xsimd::min(x, Lanes(1.0F));
  Lanes value(kFarPart[kFarTerms - 1]);
  Lanes slope(0.0F);
  Lanes curve(0.0F);
  for (int n = kFarTerms - 2; n >= 0; --n) {
    curve = curve * y + slope;
    slope = slope * y + value;
    value = value * y + Lanes(kFarPart[n]);
  }
  const Lanes spread = Lanes(1.0F) - growth * growth * Lanes(1.0F / 12.0F);  // of a trapezoid's height
  const Lanes scale(lobe.inverse_end);
  const Lanes first = (cell.c1 + spread * cell.c2) * scale * Lanes(1.0F / 12.0F);
  const Lanes second = (cell.b1 * cell.b1 + spread * cell.b2 * cell.b2) * scale * scale * Lanes(1.0F / 3.0F);
  const Lanes zero(0.0F);
  const Lanes half = xsimd::sqrt(Lanes(3.0F) * second);
  const Lanes inside = Lanes(1.0F) - x;
  const Lanes beyond = xsimd::max(half - xsimd::abs(inside), zero);
  const Lanes end = Lanes((3.0F - kFarPart[2]) / 6.0F) * beyond * beyond * beyond / (half + Lanes(kTiny));
  return {value - slope * first + curve * second, xsimd::select(inside > zero, zero - end, end)};
}

/// A row's weights, in parts: floats would lose what many columns beside a pole add.
class RowSum {
 public:
  WELKIN_INLINE void add(Lanes weight, int column) {
    part_ = part_ + weight;
    if (column % 32 != 0) return;
    whole_ = whole_ + part_;
    part_ = Lanes(0.0F);
  }
  [[nodiscard]] WELKIN_INLINE Lanes all() const { return whole_ + part_; }

 private:
  Lanes whole_ = Lanes(0.0F);
  Lanes part_ = Lanes(0.0F);
};

/// The shares of a lobe in the texels between two lines, from left to right.
class CloseShares {
 public:
  WELKIN_INLINE CloseShares(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, int first)
      : lobe_(lobe), above_(above), below_(below), left_(side(first)) {}

  /// `place`: of the left corners, in floats; each call's is the next corner's.
  WELKIN_INLINE Lanes next(int place) {
    const Lanes zero(0.0F);
    const Lanes right = side(place + kLanes);
    const Lanes top = Lanes::load_aligned(above_.edge + place);
    const Lanes bottom = Lanes::load_aligned(below_.edge + place);
    const auto within = top >= zero && right >= zero && bottom < zero && left_ < zero;
    const Lanes missed = ((top - bottom) + (right - left_)) * Lanes(0.5F / kPi);
    left_ = right;
    return xsimd::select(within, Lanes(1.0F), zero) - missed;
  }

 private:
  [[nodiscard]] WELKIN_INLINE Lanes side(int place) const {
    return missed_by(lobe_, edge_between(Lanes::load_aligned(above_.x + place), Lanes::load_aligned(above_.y + place),
                                         Lanes::load_aligned(below_.x + place), Lanes::load_aligned(below_.y + place)));
  }

  const SplitLobe& lobe_;
  const CornerLine& above_;
  const CornerLine& below_;
  Lanes left_;
};

template <class Group>
void weigh_row(const SplitLobe& lobe, const Group& group, int row, const RowRange& range, const CornerLine& above,
               const CornerLine& below, float* weights, float* sums) {
  const Lanes zero(0.0F);
  const bool cut = above.bend != nullptr;  // the own column of a lat-long is two: see `MeasureLine`
  for (int k = 0; k < kLanes; k += kWidth) {
    RowSum sum;
    const auto own = row_of(group, row, k);
    const Lanes growth = own.growth();
    const auto put = [&](int i, const Cell& cell, Lanes near) WELKIN_INLINE_LAMBDA {
      const Lanes all = (Lanes(1.0F) - Lanes(2.0F) * cell.s) * near;
      const Lanes weight = xsimd::select(cell.there, all, zero);
      weight.store_aligned(weights + i * kLanes + k);
      sum.add(weight, i);
    };
    const auto smooth = [&](int first, int end, auto mean) WELKIN_INLINE_LAMBDA {
      for (int i = first; i < end; ++i) {
        const Cell cell = own.cell(i);
        const Lanes v = cell.s + Lanes(lobe.offset);
        const Lanes x = v * Lanes(lobe.inverse_end);
        const Lanes whole = Lanes(lobe.scale) * mean(cell, v);
        const FarMean far = far_mean(lobe, cell, x, growth);
        const Lanes near = xsimd::select(x < Lanes(1.0F), whole - Lanes(lobe.far_scale) * far.value, zero);
        put(i, cell, cell.area * xsimd::max(near + Lanes(lobe.far_scale) * far.end, zero));
      }
    };
    const auto by_points = [&](const Cell& cell, Lanes v)
                               WELKIN_INLINE_LAMBDA { return mean_by_points(cell, v, growth); };
    const auto by_series = [](const Cell& cell, Lanes v) WELKIN_INLINE_LAMBDA { return mean_by_series(cell, v); };
    const auto all_smooth = [&](int first, int end) WELKIN_INLINE_LAMBDA {
      if (range.beside_pole)
        smooth(first, end, by_points);
      else
        smooth(first, end, by_series);
    };
    all_smooth(range.columns.first, range.close.first);
    if (range.close.first < range.close.end) {
      int place = range.close.first * kLanes + k;
      CloseShares shares(lobe, above, below, place);
      for (int i = range.close.first; i < range.close.end; ++i, place += kLanes) {
        Lanes share = shares.next(place);
        if (cut && i == 0) {
          place += kLanes;
          share = share + shares.next(place);
        }
        const Cell cell = own.cell(i);
        const Lanes x = (cell.s + Lanes(lobe.offset)) * Lanes(lobe.inverse_end);
        // not clamped at 0: beside a pole thousands of columns' rounding cancels
        const Lanes far = Lanes(lobe.far_scale) * cell.area * far_mean(lobe, cell, x, growth).value;
        put(i, cell, xsimd::select(x < Lanes(1.0F), share - far, zero));
      }
    }
    all_smooth(range.close.end, range.columns.end);
    (Lanes::load_aligned(sums + k) + sum.all()).store_aligned(sums + k);
  }
}

/// Keeps two sums of each run, of every other texel: one alone would wait for itself.
void sum_runs(const TexelRun* runs, int count, float* sums) {
  constexpr int kParts = kImageFloats / kWidth;
  Lanes sum[kParts];
  for (Lanes& part : sum) part = Lanes(0.0F);
  for (const TexelRun* run = runs; run != runs + count; ++run) {
    Lanes even[kParts];
    Lanes odd[kParts];
    for (int p = 0; p < kParts; ++p) even[p] = odd[p] = Lanes(0.0F);
    const auto add = [run](Lanes* own, int i) WELKIN_INLINE_LAMBDA {
      const Lanes weight(run->weights[i * kLanes]);
      for (int p = 0; p < kParts; ++p)
        own[p] = own[p] + weight * Lanes::load_aligned(run->texels + i * kImageFloats + p * kWidth);
    };
    int i = 0;
    for (; i + 1 < run->count; i += 2) {
      add(even, i);
      add(odd, i + 1);
    }
    if (i < run->count) add(even, i);
    for (int p = 0; p < kParts; ++p) sum[p] = sum[p] + (even[p] + odd[p]);
  }
  for (int p = 0; p < kParts; ++p) sum[p].store_aligned(sums + p * kWidth);
}

}  // namespace

const NarrowKernels narrow_kernels_table = {.measure_cube = measure_line<CubeGroup>,
                                            .measure_lat_long = measure_line<LatLongGroup>,
                                            .weigh_cube = weigh_row<CubeGroup>,
                                            .weigh_lat_long = weigh_row<LatLongGroup>,
                                            .sum_runs = sum_runs};

}  // namespace welkin::reflections::WELKIN_ISA
