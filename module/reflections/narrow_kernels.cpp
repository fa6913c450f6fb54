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

void place_cube(const CubeGroup& group, int row, ColumnRange corners, const CornerLine& line) {
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

void place_lat_long(const LatLongGroup& group, int row, ColumnRange corners, const CornerLine& line) {
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

/// The far part's density at a point of the plane, less the lobe's factor 1 - 2 s; and whether there is a near part.
struct Density {
  Lanes far;
  decltype(Lanes() < Lanes()) near;
};

WELKIN_INLINE Density density_at(const SplitLobe& lobe, Lanes square) {
  const Lanes one(1.0F);
  const Lanes quarter = square * Lanes(0.25F);
  const Lanes inverse = one / (one + quarter);
  const Lanes x = (Lanes(lobe.offset) + quarter * inverse) * Lanes(lobe.inverse_end);
  const Lanes steradians = inverse * inverse;
  const Lanes width = square + Lanes(lobe.width_squared);
  const Lanes whole = Lanes(lobe.width_squared / kPi) / (width * width);
  const auto near = x < one;
  return {xsimd::select(near, steradians * Lanes(lobe.far_scale) * far_polynomial(xsimd::min(x, one)), whole), near};
}

void measure_corners(const SplitLobe& lobe, ColumnRange corners, const CornerLine& line) {
  for (int i = corners.first * kLanes; i < corners.end * kLanes; i += kWidth) {
    const Lanes x = Lanes::load_aligned(line.x + i);
    const Lanes y = Lanes::load_aligned(line.y + i);
    density_at(lobe, x * x + y * y).far.store_aligned(line.far + i);
  }
}

void measure_edges(const SplitLobe& lobe, ColumnRange columns, const CornerLine& line) {
  for (int i = columns.first * kLanes; i < columns.end * kLanes; i += kWidth) {
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

/// Corners above and below at one column.
struct Side {
  Lanes x0, y0, x1, y1;
};

WELKIN_INLINE Side side_at(const CornerLine& above, const CornerLine& below, int place) {
  return {Lanes::load_aligned(above.x + place), Lanes::load_aligned(above.y + place),
          Lanes::load_aligned(below.x + place), Lanes::load_aligned(below.y + place)};
}

/// A texel as a parallelogram about its centroid.
struct Cell {
  Lanes square, area;         ///< the centre's distance, squared; the area
  Lanes b1, b2, c1, c2, mix;  ///< products of the centre and the sides e1 and e2: p e1, p e2, e1 e1, e2 e2, e1 e2
};

WELKIN_INLINE Cell cell_between(const Side& left, const Side& right) {
  const Lanes half(0.5F);
  const Lanes dx = right.x1 - left.x0;
  const Lanes dy = right.y1 - left.y0;
  const Lanes ex = right.x0 - left.x1;
  const Lanes ey = right.y0 - left.y1;
  // The centroid, by the two triangles beside a diagonal: beside a pole a texel's ends are of different lengths.
  const Lanes above = (right.x0 - left.x0) * dy - (right.y0 - left.y0) * dx;
  const Lanes below = dx * (left.y1 - left.y0) - dy * (left.x1 - left.x0);
  const Lanes third = Lanes(1.0F / 3.0F) / (above + below + Lanes(kTiny));
  const Lanes x = left.x0 + (dx * (above + below) + (right.x0 - left.x0) * above + (left.x1 - left.x0) * below) * third;
  const Lanes y = left.y0 + (dy * (above + below) + (right.y0 - left.y0) * above + (left.y1 - left.y0) * below) * third;
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

/// The mean over a texel, by a rule that is exact to third order for parallelograms: 8 parts of the centre's, one of
/// each corner's.
WELKIN_INLINE Lanes mean_of(const float* above, const float* below, int left, Lanes centre) {
  const auto load = [left](const float* values, int step)
                        WELKIN_INLINE_LAMBDA { return Lanes::load_aligned(values + left + step); };
  const Lanes corners = (load(above, 0) + load(below, 0)) + (load(above, kLanes) + load(below, kLanes));
  return (Lanes(8.0F) * centre + corners) * Lanes(1.0F / 12.0F);
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

/// 1 - 2 s
WELKIN_INLINE Lanes cosine_at(Lanes square) {
  const Lanes quarter = square * Lanes(0.25F);
  return (Lanes(1.0F) - quarter) / (Lanes(1.0F) + quarter);
}

void weigh_close(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, ColumnRange columns,
                 float* weights, float* sums) {
  const Lanes zero(0.0F);
  for (int k = 0; k < kLanes; k += kWidth) {
    RowSum sum;
    const auto edge_of = [&lobe](const Side& side) WELKIN_INLINE_LAMBDA {
      return missed_by(lobe, edge_between(side.x0, side.y0, side.x1, side.y1));
    };
    Side left = side_at(above, below, columns.first * kLanes + k);
    Lanes left_edge = edge_of(left);
    for (int i = columns.first; i < columns.end; ++i) {
      const int place = i * kLanes + k;
      const Side right = side_at(above, below, place + kLanes);
      const Lanes right_edge = edge_of(right);
      const Lanes top = Lanes::load_aligned(above.edge + place);
      const Lanes bottom = Lanes::load_aligned(below.edge + place);
      const auto within = top >= zero && right_edge >= zero && bottom < zero && left_edge < zero;
      const Lanes missed = ((top - bottom) + (right_edge - left_edge)) * Lanes(0.5F / kPi);
      const Lanes share = xsimd::select(within, Lanes(1.0F), zero) - missed;
      const Cell cell = cell_between(left, right);
      const Density centre = density_at(lobe, cell.square);
      const Lanes far = cell.area * mean_of(above.far, below.far, place, centre.far);
      // not clamped at 0: beside a pole thousands of columns' rounding cancels
      const Lanes all = cosine_at(cell.square) * (share - far);
      // rows beyond a pole, and columns beyond a face, have no area, and what is left of their edges is rounding
      const Lanes weight = xsimd::select(centre.near && cell.area > zero, all, zero);
      weight.store_aligned(weights + place);
      sum.add(weight, i);
      left = right;
      left_edge = right_edge;
    }
    (Lanes::load_aligned(sums + k) + sum.all()).store_aligned(sums + k);
  }
}

void weigh_far(const SplitLobe& lobe, const CornerLine& above, const CornerLine& below, ColumnRange columns,
               float* weights, float* sums) {
  for (int k = 0; k < kLanes; k += kWidth) {
    RowSum sum;
    Side left = side_at(above, below, columns.first * kLanes + k);
    for (int i = columns.first; i < columns.end; ++i) {
      const int place = i * kLanes + k;
      const Side right = side_at(above, below, place + kLanes);
      const Cell cell = cell_between(left, right);
      const Density centre = density_at(lobe, cell.square);
      const Lanes inverse = Lanes(1.0F) / (cell.square + Lanes(lobe.width_squared));
      const Lanes whole = Lanes(lobe.width_squared / kPi) * inverse * inverse * mean_of_cell(cell, inverse);
      const Lanes far = mean_of(above.far, below.far, place, centre.far);
      const Lanes all = cosine_at(cell.square) * cell.area * xsimd::max(whole - far, Lanes(0.0F));
      const Lanes weight = xsimd::select(centre.near, all, Lanes(0.0F));
      weight.store_aligned(weights + place);
      sum.add(weight, i);
      left = right;
    }
    (Lanes::load_aligned(sums + k) + sum.all()).store_aligned(sums + k);
  }
}

void sum_runs(const TexelRun* runs, int count, float* sums) {
  constexpr int kParts = kImageFloats / kWidth;
  Lanes sum[kParts];
  for (Lanes& part : sum) part = Lanes(0.0F);
  for (const TexelRun* run = runs; run != runs + count; ++run) {
    const float* texel = run->texels;
    Lanes own[kParts];
    for (Lanes& part : own) part = Lanes(0.0F);
    for (int i = 0; i < run->count; ++i, texel += kImageFloats) {
      const Lanes weight(run->weights[i * kLanes]);
      for (int p = 0; p < kParts; ++p) own[p] = own[p] + weight * Lanes::load_aligned(texel + p * kWidth);
    }
    for (int p = 0; p < kParts; ++p) sum[p] = sum[p] + own[p];
  }
  for (int p = 0; p < kParts; ++p) sum[p].store_aligned(sums + p * kWidth);
}

}  // namespace

const NarrowKernels narrow_kernels_table = {.place_cube = place_cube,
                                            .place_lat_long = place_lat_long,
                                            .measure_corners = measure_corners,
                                            .measure_edges = measure_edges,
                                            .weigh_close = weigh_close,
                                            .weigh_far = weigh_far,
                                            .sum_runs = sum_runs};

}  // namespace welkin::reflections::WELKIN_ISA
