// Shares of narrow lobes in texels.
#include "reflections/narrow_kernels.h"

#include "simd/decay.h"
#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kLanes, simd::kWidth, simd::Lanes, simd::Quad;

constexpr float kTiny = 1e-30F;
constexpr float kPi = 3.14159265F;

WELKIN_INLINE Lanes at(const float* values, int index) { return Lanes::load_aligned(values + index * kLanes); }

/// e^-u for 0 <= u, taken as 16 beyond.
WELKIN_INLINE Lanes decay_to_sixteen(Lanes u) { return simd::decay(xsimd::min(u, Lanes(16.0F))); }

/// (1 - (1 + u) e^-u) / u^2 = Int_0^1 t e^(-u t) dt = 1/2 - u/3 + u^2/8 - ... + (-u)^n / (n! (n + 2)).
WELKIN_INLINE Lanes far_density(const SplitLobe& lobe, Lanes square) {
  const Lanes quarter = square * Lanes(0.25F);
  const Lanes u = Lanes(lobe.offset) + Lanes(lobe.split) * (quarter / (Lanes(1.0F) + quarter));
  auto series = Lanes(1.0F / 403200.0F);
  series = series * u - Lanes(1.0F / 45360.0F);
  series = series * u + Lanes(1.0F / 5760.0F);
  series = series * u - Lanes(1.0F / 840.0F);
  series = series * u + Lanes(1.0F / 144.0F);
  series = series * u - Lanes(1.0F / 30.0F);
  series = series * u + Lanes(0.125F);
  series = series * u - Lanes(1.0F / 3.0F);
  series = series * u + Lanes(0.5F);
  const Lanes closed = (Lanes(1.0F) - (Lanes(1.0F) + u) * decay_to_sixteen(u)) / xsimd::max(u * u, Lanes(kTiny));
  return xsimd::select(u < Lanes(1.0F), series, closed);
}

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

void place_cube(const CubeGroup& group, int first_column, int row, int count, const CornerLine& line) {
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
    const Lanes first = Lanes(1.0F) / xsimd::sqrt(across);
    const Lanes second = first / length;
    for (int i = 0; i < count; ++i) {
      const Lanes wanted = column0 + Lanes(static_cast<float>(first_column + i));
      const Lanes here = xsimd::min(xsimd::max(wanted, Lanes(0.0F)), size);
      const Lanes du = ((here - column0) - part) * step;
      const Lanes u = u0 + du;
      const Lanes norm = xsimd::sqrt(Lanes(1.0F) + u * u + v * v);
      const Lanes along = (Lanes(1.0F) + u * u0 + v * v0) / length;
      const Lanes scale = Lanes(2.0F) / (norm + along);
      (du * first * scale).store_aligned(line.x + i * kLanes + k);
      ((across * dv - u0 * v0 * du) * second * scale).store_aligned(line.y + i * kLanes + k);
    }
  }
}

void measure_line(const SplitLobe& lobe, ColumnRange columns, const CornerLine& line) {
  for (int k = 0; k < kLanes; k += kWidth) {
    Lanes x0 = at(line.x + k, columns.first);
    Lanes y0 = at(line.y + k, columns.first);
    far_density(lobe, x0 * x0 + y0 * y0).store_aligned(line.far + columns.first * kLanes + k);
    for (int i = columns.first + 1; i <= columns.end; ++i) {
      const Lanes x1 = at(line.x + k, i);
      const Lanes y1 = at(line.y + k, i);
      far_density(lobe, x1 * x1 + y1 * y1).store_aligned(line.far + i * kLanes + k);
      missed_by(lobe, edge_between(x0, y0, x1, y1)).store_aligned(line.edge + (i - 1) * kLanes + k);
      x0 = x1;
      y0 = y1;
    }
  }
}

/// Corners above and below at one column.
struct Side {
  Lanes x0, y0, far0, x1, y1, far1, edge;
};

WELKIN_INLINE Side side_at(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, int place) {
  Side side;
  side.x0 = Lanes::load_aligned(above.x + place);
  side.y0 = Lanes::load_aligned(above.y + place);
  side.far0 = Lanes::load_aligned(above.far + place);
  side.x1 = Lanes::load_aligned(below.x + place);
  side.y1 = Lanes::load_aligned(below.y + place);
  side.far1 = Lanes::load_aligned(below.far + place);
  side.edge = missed_by(lobe, edge_between(side.x0, side.y0, side.x1, side.y1));
  return side;
}

/// The far part over a texel: its area times the mean density, by a rule that is exact for squares: 8 parts of the
/// centre's, one of each corner's.
WELKIN_INLINE Lanes far_share(const SplitLobe& lobe, const Side& left, const Side& right, Lanes square) {
  const Lanes area = Lanes(0.5F) * xsimd::abs((right.x1 - left.x0) * (right.y0 - left.y1) -
                                              (right.y1 - left.y0) * (right.x0 - left.x1));
  const Lanes corners = (left.far0 + left.far1) + (right.far0 + right.far1);
  const Lanes mean = (Lanes(8.0F) * far_density(lobe, square) + corners) * Lanes(1.0F / 12.0F);
  const Lanes stretch = Lanes(1.0F) + square * Lanes(0.25F);
  return Lanes(lobe.far_scale) * mean * area / (stretch * stretch);
}

void weigh_close(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, ColumnRange columns,
                 float* weights, float* sums) {
  const Lanes zero(0.0F);
  for (int k = 0; k < kLanes; k += kWidth) {
    Lanes sum = Lanes::load_aligned(sums + k);
    Side left = side_at(lobe, above, below, columns.first * kLanes + k);
    for (int i = columns.first + 1; i <= columns.end; ++i) {
      const Side right = side_at(lobe, above, below, i * kLanes + k);
      const Lanes top = Lanes::load_aligned(above.edge + (i - 1) * kLanes + k);
      const Lanes bottom = Lanes::load_aligned(below.edge + (i - 1) * kLanes + k);
      const auto within = top >= zero && right.edge >= zero && bottom < zero && left.edge < zero;
      const Lanes missed = ((top - bottom) + (right.edge - left.edge)) * Lanes(0.5F / kPi);
      const Lanes share = xsimd::select(within, Lanes(1.0F), zero) - missed;
      const Lanes x = ((left.x0 + left.x1) + (right.x0 + right.x1)) * Lanes(0.25F);
      const Lanes y = ((left.y0 + left.y1) + (right.y0 + right.y1)) * Lanes(0.25F);
      const Lanes square = x * x + y * y;
      const Lanes quarter = square * Lanes(0.25F);
      const Lanes cosine = (Lanes(1.0F) - quarter) / (Lanes(1.0F) + quarter);  // 1 - 2 s
      const Lanes weight = xsimd::max(cosine * (share - far_share(lobe, left, right, square)), zero);
      weight.store_aligned(weights + (i - 1) * kLanes + k);
      sum = sum + weight;
      left = right;
    }
    sum.store_aligned(sums + k);
  }
}

/// A texel as a parallelogram about its centre.
struct Cell {
  Lanes square, area;         ///< the centre's distance, squared; the area
  Lanes b1, b2, c1, c2, mix;  ///< products of the centre and the sides e1 and e2: p e1, p e2, e1 e1, e2 e2, e1 e2
};

WELKIN_INLINE Cell cell_at(const CornerLine& above, const CornerLine& below, int left) {
  const auto load = [left](const float* values, int step)
                        WELKIN_INLINE_LAMBDA { return Lanes::load_aligned(values + left + step); };
  const Lanes half(0.5F);
  const Lanes x00 = load(above.x, 0);
  const Lanes x10 = load(above.x, kLanes);
  const Lanes x01 = load(below.x, 0);
  const Lanes x11 = load(below.x, kLanes);
  const Lanes y00 = load(above.y, 0);
  const Lanes y10 = load(above.y, kLanes);
  const Lanes y01 = load(below.y, 0);
  const Lanes y11 = load(below.y, kLanes);
  const Lanes x = ((x00 + x11) + (x10 + x01)) * Lanes(0.25F);
  const Lanes y = ((y00 + y11) + (y10 + y01)) * Lanes(0.25F);
  const Lanes dx = x11 - x00;
  const Lanes dy = y11 - y00;
  const Lanes ex = x10 - x01;
  const Lanes ey = y10 - y01;
  const Lanes across_x = (dx + ex) * half;
  const Lanes across_y = (dy + ey) * half;
  const Lanes down_x = (dx - ex) * half;
  const Lanes down_y = (dy - ey) * half;
  return {.square = x * x + y * y,
          .area = xsimd::abs(across_x * down_y - across_y * down_x),
          .b1 = x * across_x + y * across_y,
          .b2 = x * down_x + y * down_y,
          .c1 = across_x * across_x + across_y * across_y,
          .c2 = down_x * down_x + down_y * down_y,
          .mix = across_x * down_x + across_y * down_y};
}

/// The mean of v^-2, v = a^2 + r^2, over a cell, by its value at the centre: to fourth order in the sides. With
/// B = b / v and C = c / v, v(s, t)^-2 = v^-2 (1 + z)^-2, z = 2 B1 s + C1 s^2 + 2 B2 t + C2 t^2 + 2 G s t, is expanded
/// to 1 - 2 z + 3 z^2 - 4 z^3 + 5 z^4, and the means of s^2, s^4 and s^2 t^2 are 1/12, 1/80 and 1/144.
WELKIN_INLINE Lanes mean_of_cell(const Cell& cell, Lanes inverse) {
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
  return Lanes(1.0F) + (second + (fourth + mixed));
}

/// The near part's factor D = (1 + u) e^-u bends over a cell too: with D' = -u e^-u and D'' = (u - 1) e^-u by u, and
/// t = du / d(r^2), its own mean and that of its slope times the lobe's add up, for each side, to
/// e^-u ((u - 1) b^2 t^2 / 6 - u t c / 12 + 2 u t b B / 3).
void weigh_far(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, ColumnRange columns,
               float* weights, float* sums) {
  const Lanes one(1.0F);
  const Lanes density(lobe.width_squared * (1.0F / kPi));
  for (int k = 0; k < kLanes; k += kWidth) {
    Lanes sum = Lanes::load_aligned(sums + k);
    for (int i = columns.first; i < columns.end; ++i) {
      const Cell cell = cell_at(above, below, i * kLanes + k);
      const Lanes inverse = one / (cell.square + Lanes(lobe.width_squared));
      const Lanes quarter = cell.square * Lanes(0.25F);
      const Lanes stretch = one / (one + quarter);
      const Lanes u = Lanes(lobe.offset) + Lanes(lobe.split) * quarter * stretch;
      const Lanes t = Lanes(0.25F * lobe.split) * stretch * stretch;
      const Lanes b = (cell.b1 * cell.b1 + cell.b2 * cell.b2) * t;
      const Lanes bend = (u - one) * b * t * Lanes(1.0F / 6.0F) +
                         u * (b * inverse * Lanes(2.0F / 3.0F) - t * (cell.c1 + cell.c2) * Lanes(1.0F / 12.0F));
      const Lanes shape = (one + u) * mean_of_cell(cell, inverse) + bend;
      const Lanes cosine = (one - quarter) * stretch;  // 1 - 2 s
      const Lanes weight =
          xsimd::max(density * inverse * inverse * cell.area * cosine * decay_to_sixteen(u) * shape, Lanes(0.0F));
      weight.store_aligned(weights + i * kLanes + k);
      sum = sum + weight;
    }
    sum.store_aligned(sums + k);
  }
}

void add_texels(const float* rgb, const float* weights, int count, float* sum) {
  Quad sums = Quad::load_aligned(sum);
  for (int i = 0; i + 1 < count; ++i) sums = sums + Quad::load_unaligned(rgb + 3 * i) * Quad(weights[i * kLanes]);
  alignas(16) float last[4] = {};  // four floats from the last texel on may not all be the picture's
  for (int c = 0; c < 3; ++c) last[c] = rgb[3 * (count - 1) + c];
  sums = sums + Quad::load_aligned(last) * Quad(weights[(count - 1) * kLanes]);
  sums.store_aligned(sum);
}

}  // namespace

const NarrowKernels narrow_kernels_table = {
    .place_cube = place_cube,
    .measure_line = measure_line,
    .weigh_close = weigh_close,
    .weigh_far = weigh_far,
    .add_texels = add_texels,
};

}  // namespace welkin::reflections::WELKIN_ISA
