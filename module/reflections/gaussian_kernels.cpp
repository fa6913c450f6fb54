// Shares of Gaussians in texels.
#include "reflections/gaussian_kernels.h"

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::Block, simd::kBlock, simd::kLanes, simd::kWidth, simd::Lanes, simd::NarrowLanes, simd::Quad;

/// The error function, its slope, and x times that: how the function changes where x grows by a share.
struct Rise {
  Lanes value, slope, change;
};

/// 1 - 1 / (1 + more)^16 is the error function of `x` >= 0 (Abramowitz and Stegun, Handbook of Mathematical Functions,
/// 7.1.28, to 3e-7). `slope`: 16 times that of `more`.
struct Series {
  Lanes x, more, slope;
};

constexpr float kWhole = 3.3F;  ///< from there on the error function counts as 1: 3e-6 are left

WELKIN_INLINE Series series_at(Lanes place) {
  const Lanes x = xsimd::min(xsimd::abs(place), Lanes(kWhole));
  auto p = Lanes(0.0000430638F);
  p = p * x + Lanes(0.0002765672F);
  p = p * x + Lanes(0.0001520143F);
  p = p * x + Lanes(0.0092705272F);
  p = p * x + Lanes(0.0422820123F);
  p = p * x + Lanes(0.0705230784F);
  auto slope = Lanes(6.0F * 16.0F * 0.0000430638F);
  slope = slope * x + Lanes(5.0F * 16.0F * 0.0002765672F);
  slope = slope * x + Lanes(4.0F * 16.0F * 0.0001520143F);
  slope = slope * x + Lanes(3.0F * 16.0F * 0.0092705272F);
  slope = slope * x + Lanes(2.0F * 16.0F * 0.0422820123F);
  slope = slope * x + Lanes(16.0F * 0.0705230784F);
  return {x, p * x, slope};
}

/// `value` with the sign of `place`, 1 where it is whole: what a neighbour has of 3e-6 is nothing to one that is far.
WELKIN_INLINE Lanes signed_rise(Lanes place, Lanes value) {
  const Lanes there = xsimd::select(xsimd::abs(place) < Lanes(kWhole), value, Lanes(1.0F));
  return xsimd::select(place < Lanes(0.0F), Lanes(0.0F) - there, there);
}

WELKIN_INLINE Rise rise(Lanes place) {
  const Series series = series_at(place);
  const Lanes inverse = Lanes(1.0F) / (series.more + Lanes(1.0F));
  const Lanes two = inverse * inverse;
  const Lanes four = two * two;
  const Lanes eight = four * four;
  const Lanes rest = eight * eight;
  const Lanes here = series.slope * rest * inverse;
  const Lanes change = here * series.x;
  return {signed_rise(place, Lanes(1.0F) - rest), here,
          xsimd::select(place < Lanes(0.0F), Lanes(0.0F) - change, change)};
}

/// The same with all digits for places near 0 too, without the change: (1 + more)^16 - 1 is a product.
WELKIN_INLINE Rise precise_rise(Lanes place) {
  const Lanes one(1.0F);
  const Series series = series_at(place);
  const Lanes more = series.more;
  const Lanes two = (one + more) * (one + more);
  const Lanes four = two * two;
  const Lanes eight = four * four;
  const Lanes whole = more * (Lanes(2.0F) + more) * (one + two) * (one + four) * (one + eight);
  const Lanes inverse = one / (one + whole);
  return {signed_rise(place, whole * inverse), series.slope * inverse / (one + more), Lanes(0.0F)};
}

/// What a lane's rows have in common for all Gaussians.
struct Bend {
  Lanes half_log;  ///< of the row's cosine over the direction's own
  Lanes factor;    ///< the root of that
};

WELKIN_INLINE Bend bend_at(Lanes down, Lanes tangent) {
  const Lanes z = tangent * down - down * down * Lanes(0.5F);
  const Lanes half_log = z * (Lanes(0.5F) - z * (Lanes(0.25F) - z * Lanes(1.0F / 6.0F)));
  return {half_log, Lanes(1.0F) + half_log * (Lanes(1.0F) + half_log * Lanes(0.5F))};
}

void weigh(const GaussianLobe& lobe, const GaussianReach& reach, const GaussianGroup& group, int rows, int columns,
           float* lines, float* weights, float* sums) {
  const int width = 2 * columns;
  const int texels = (2 * rows + 1) * width;
  float* const values = lines;
  float* const changes = lines + kLanes * width;
  float* const factors = changes + kLanes * width;
  float* const logs = factors + kLanes * (2 * rows + 1);
  for (int k = 0; k < kLanes; k += kWidth) {
    for (int i = 0; i < texels; ++i) Lanes(0.0F).store_aligned(weights + i * kLanes + k);
    const Lanes from_line = Lanes::load_unaligned(group.from_line + k);
    const Lanes part_row = Lanes::load_unaligned(group.part_row + k);
    const Lanes across = Lanes::load_unaligned(group.across + k);
    const Lanes tangent = Lanes::load_unaligned(group.tangent + k);
    const Lanes down(group.down);
    for (int j = 0; j <= 2 * rows; ++j) {
      const Bend bend = bend_at((Lanes(static_cast<float>(j - rows) + 0.5F) - part_row) * down, tangent);
      bend.factor.store_aligned(factors + j * kLanes + k);
      bend.half_log.store_aligned(logs + j * kLanes + k);
    }
    const Rise end{Lanes(1.0F), Lanes(0.0F),
                   Lanes(0.0F)};  // what lies beyond a Gaussian's reach counts as its last texel's
    Lanes sum = Lanes::load_aligned(sums + k);
    for (int g = 0; g < lobe.count; ++g) {
      const int side = reach.columns[g];
      const Lanes step = across * Lanes(lobe.root[g]);
      Rise before{Lanes(-1.0F), Lanes(0.0F), Lanes(0.0F)};
      for (int i = -side; i < side; ++i) {
        const Rise after = i + 1 < side ? rise((Lanes(static_cast<float>(i + 1)) - from_line) * step) : end;
        (after.value - before.value).store_aligned(values + (i + side) * kLanes + k);
        (after.change - before.change).store_aligned(changes + (i + side) * kLanes + k);
        before = after;
      }
      const int far = reach.rows[g];
      const Lanes step_down = down * Lanes(lobe.root[g]);
      // a row's light lies at its mean place, which is not the row's middle where the Gaussian is narrower
      const Lanes to_place = Lanes(0.25F) * tangent / Lanes(lobe.root[g]);
      const Lanes to_middle = Lanes(0.5F) * tangent * down;
      const Lanes weight_of_row(lobe.weight[g]);
      Rise above{Lanes(-1.0F), Lanes(0.0F), Lanes(0.0F)};
      for (int j = -far; j <= far; ++j) {
        const Rise below = j < far ? rise((Lanes(static_cast<float>(j + 1)) - part_row) * step_down) : end;
        const Lanes whole = below.value - above.value;
        const Lanes moved = (above.slope - below.slope) * to_place -
                            whole * to_middle * (Lanes(static_cast<float>(j) + 0.5F) - part_row);
        const Lanes share = (whole * Lanes::load_aligned(factors + (j + rows) * kLanes + k) + moved) * weight_of_row;
        const Lanes change = (whole * Lanes::load_aligned(logs + (j + rows) * kLanes + k) + moved) * weight_of_row;
        float* const row = weights + ((j + rows) * width + columns - side) * kLanes + k;
        for (int i = 0; i < 2 * side; ++i) {
          const Lanes weight = share * Lanes::load_aligned(values + i * kLanes + k) +
                               change * Lanes::load_aligned(changes + i * kLanes + k);
          (Lanes::load_aligned(row + i * kLanes) + weight).store_aligned(row + i * kLanes);
          sum = sum + weight;
        }
        above = below;
      }
    }
    sum.store_aligned(sums + k);
  }
}

void weigh_polar(const GaussianLobe& lobe, const GaussianReach& reach, const PolarGroup& group,
                 const PolarWindow& window, const float* columns, float* lines, float* weights, float* sums) {
  const Lanes zero(0.0F);
  const Lanes one(1.0F);
  const int width = window.columns;
  const int parts = group.column_parts;
  float* const places = lines;                                  // sines of half the angles to the lines between columns
  float* const stretch = lines + kLanes * (width * parts + 1);  // 1 over the cosines of those to the columns' middles
  for (int k = 0; k < kLanes; k += kWidth) {
    for (int row = 0; row <= 2 * window.rows; ++row) {
      const ColumnsOfRow own = columns_of_row(window, row);
      for (int i = own.first; i < own.end; ++i) zero.store_aligned(weights + (row * width + i) * kLanes + k);
    }
    const Lanes sine_of_part = Lanes::load_unaligned(group.sine_of_part + k);
    const Lanes cosine_of_part = Lanes::load_unaligned(group.cosine_of_part + k);
    const Lanes part_row = Lanes::load_unaligned(group.part_row + k);
    const Lanes row_of = Lanes::load_unaligned(group.row + k);
    const Lanes sine = Lanes::load_unaligned(group.sine_latitude + k);
    const Lanes cosine = Lanes::load_unaligned(group.cosine_latitude + k);
    Lanes before(0.0F);
    for (int i = 0; i <= width * parts; ++i) {
      const Lanes column_sine(columns[2 * i]);
      const Lanes column_cosine(columns[2 * i + 1]);
      (column_sine * cosine_of_part - column_cosine * sine_of_part).store_aligned(places + i * kLanes + k);
      const Lanes here = column_cosine * cosine_of_part + column_sine * sine_of_part;
      if (i > 0) (Lanes(2.0F) / xsimd::max(here + before, Lanes(1e-4F))).store_aligned(stretch + (i - 1) * kLanes + k);
      before = here;
    }
    Lanes sum = Lanes::load_aligned(sums + k);
    const Lanes height = Lanes(group.down) / Lanes(static_cast<float>(group.divided));
    for (int g = 0; g < lobe.count; ++g) {
      const int side = reach.columns[g];
      const Lanes root(lobe.root[g]);
      for (int j = -reach.rows[g]; j <= reach.rows[g]; ++j) {
        const ColumnsOfRow own = columns_of_row(window, j + window.rows);
        const int from = side < 0 || -side - window.first < own.first ? own.first : -side - window.first;
        const int to = side < 0 || side + 1 - window.first > own.end ? own.end : side + 1 - window.first;
        const Lanes row = row_of + Lanes(static_cast<float>(j));
        const auto exists = row >= zero && row < Lanes(group.rows);
        float* const weights_of_row = weights + (j + window.rows) * width * kLanes + k;
        for (int part = 0; part < group.divided; ++part) {
          const Lanes top =
              (Lanes(static_cast<float>(j)) - part_row) * Lanes(group.down) + height * Lanes(static_cast<float>(part));
          const Lanes bottom = top + height;
          const Rise above = precise_rise(top * root);
          const Rise below = precise_rise(bottom * root);
          const Lanes share = below.value - above.value;
          // the light's mean place within the row, for its cosine
          const Lanes mean = Lanes(0.5F) * (above.slope - below.slope) / (xsimd::max(share, Lanes(1e-6F)) * root);
          const Lanes place = xsimd::min(xsimd::max(mean, top), bottom);
          const Lanes there = xsimd::max(
              cosine * (one - Lanes(0.5F) * place * place) + sine * place * (one - place * place * Lanes(1.0F / 6.0F)),
              zero);
          const Lanes scale = xsimd::max(Lanes(2.0F) * root * xsimd::sqrt(cosine * there), Lanes(1e-3F));
          const Lanes weight_of_row =
              xsimd::select(exists, share * Lanes(lobe.weight[g]) * there * Lanes(2.0F) * root / scale, zero);
          Lanes left = precise_rise(Lanes::load_aligned(places + from * parts * kLanes + k) * scale).value;
          // in parts of a row, or floats lose what many columns add
          Lanes sum_of_row(0.0F);
          Lanes sum_of_part(0.0F);
          for (int i = from; i < to; ++i) {
            Lanes share_of_column(0.0F);
            for (int line = i * parts; line < (i + 1) * parts; ++line) {
              const Lanes right = precise_rise(Lanes::load_aligned(places + (line + 1) * kLanes + k) * scale).value;
              share_of_column = share_of_column + (right - left) * Lanes::load_aligned(stretch + line * kLanes + k);
              left = right;
            }
            const Lanes weight = xsimd::max(weight_of_row * share_of_column, zero);
            (Lanes::load_aligned(weights_of_row + i * kLanes) + weight).store_aligned(weights_of_row + i * kLanes);
            sum_of_part = sum_of_part + weight;
            if ((i - from) % 32 == 31) {
              sum_of_row = sum_of_row + sum_of_part;
              sum_of_part = zero;
            }
          }
          sum = sum + (sum_of_row + sum_of_part);
        }
      }
    }
    sum.store_aligned(sums + k);
  }
}

void spread(const float* weights, int rows, int columns, bool mirrored, float* plain, float* spread) {
  const int padded = (columns + 7) / 8 * 8;
  const std::ptrdiff_t lane_floats = spread_floats(rows, columns);
  const std::ptrdiff_t plain_floats = lane_floats / 3;
  for (int lane = 0; lane < kLanes; lane += kBlock) {
    for (int row = 0; row < rows; ++row) {
      const float* const from = weights + row * columns * kLanes + lane;
      for (int column = 0; column < padded; column += kBlock) {
        Block block[kBlock];
        for (int i = 0; i < kBlock; ++i) {
          const int own = mirrored ? columns - 1 - column - i : column + i;
          block[i] = own >= 0 && own < columns ? Block::load_aligned(from + own * kLanes) : Block(0.0F);
        }
        simd::transpose(block);
        // what goes beyond the row is written again by the next one
        for (int k = 0; k < kBlock; ++k)
          block[k].store_unaligned(plain + (lane + k) * plain_floats + row * padded + column);
      }
    }
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const float* const from = plain + lane * plain_floats;
    float* const to = spread + lane * lane_floats;
    for (int k = 0; k < rows * padded; k += kWidth) simd::store_thrice(Lanes::load_aligned(from + k), to + 3 * k);
  }
}

void spread_lane(const float* weights, const PolarWindow& window, bool mirrored, float* spread) {
  for (int row = 0; row <= 2 * window.rows; ++row) {
    const ColumnsOfRow own = columns_of_row(window, row);
    for (int i = own.first; i < own.end; ++i) {
      const float weight = weights[(row * window.columns + i) * kLanes];
      float* const to = spread + 3 * (row * window.columns + (mirrored ? window.columns - 1 - i : i));
      for (int k = 0; k < 3; ++k) to[k] = weight;
    }
  }
}

constexpr int kNarrowParts = kWindowFloats / simd::kNarrowWidth;

/// `eights`: as in `rows`, or 0 where the number is not known when this is compiled: sums stay in registers then.
template <int windows, int eights>
void add_all(const WindowRows& rows, const std::ptrdiff_t* offsets, const float* weights,
             float (*sums)[kWindowFloats]) {
  NarrowLanes sum[windows][kNarrowParts];
  for (int m = 0; m < windows; ++m) {
    for (int p = 0; p < kNarrowParts; ++p) sum[m][p] = NarrowLanes(0.0F);
  }
  for (int row = 0; row < rows.count; ++row) {
    const float* const texels = rows.first[row * rows.step];
    for (int eight = 0; eight < (eights > 0 ? eights : rows.eights); ++eight, weights += kWindowFloats) {
      for (int p = 0; p < kNarrowParts; ++p) {
        const int place = p * simd::kNarrowWidth;
        const NarrowLanes weight = NarrowLanes::load_aligned(weights + place);
        for (int m = 0; m < windows; ++m)
          sum[m][p] =
              sum[m][p] + NarrowLanes::load_unaligned(texels + offsets[m] + kWindowFloats * eight + place) * weight;
      }
    }
  }
  for (int m = 0; m < windows; ++m) {
    for (int p = 0; p < kNarrowParts; ++p) sum[m][p].store_aligned(sums[m] + p * simd::kNarrowWidth);
  }
}

void add_windows(const WindowRows& rows, const std::ptrdiff_t* offsets, int windows, const float* weights,
                 float (*sums)[kWindowFloats]) {
  switch (windows) {
    case 1: return add_all<1, 0>(rows, offsets, weights, sums);
    case 2:
      return rows.eights == 2 ? add_all<2, 2>(rows, offsets, weights, sums)
                              : add_all<2, 0>(rows, offsets, weights, sums);
    case 3: return add_all<3, 0>(rows, offsets, weights, sums);
    default:
      return rows.eights == 1 ? add_all<4, 1>(rows, offsets, weights, sums)
                              : add_all<4, 0>(rows, offsets, weights, sums);
  }
}

void add_run(const float* texels, const float* weights, int count, float* sums) {
  NarrowLanes sum[kNarrowParts];
  for (int p = 0; p < kNarrowParts; ++p) sum[p] = NarrowLanes(0.0F);  // a run by itself: long ones lose less
  const int whole = count / 8 * 8;
  for (int k = 0; k < 3 * whole; k += kWindowFloats) {
    for (int p = 0; p < kNarrowParts; ++p) {
      const int place = k + p * simd::kNarrowWidth;
      sum[p] = sum[p] + NarrowLanes::load_unaligned(texels + place) * NarrowLanes::load_unaligned(weights + place);
    }
  }
  for (int p = 0; p < kNarrowParts; ++p) {
    float* const to = sums + p * simd::kNarrowWidth;
    (NarrowLanes::load_aligned(to) + sum[p]).store_aligned(to);
  }
  for (int i = 3 * whole; i < 3 * count; ++i) sums[i - 3 * whole] += texels[i] * weights[i];
}

void fold(const float (*sums)[kWindowFloats], int count, const float* scale, float least, float* const* rgb) {
  for (int m = 0; m < count; ++m) {
    const auto texel = [&](int place) WELKIN_INLINE_LAMBDA { return Quad::load_unaligned(sums[m] + 3 * place); };
    alignas(16) float four[4];
    (((texel(0) + texel(4)) + (texel(2) + texel(6))) + ((texel(1) + texel(5)) + (texel(3) + texel(7))))
        .store_aligned(four);
    for (int c = 0; c < 3; ++c) {
      const float value = rgb[m][c] + scale[m] * four[c];
      rgb[m][c] = value < least ? least : value;
    }
  }
}

}  // namespace

const GaussianKernels gaussian_kernels_table = {.weigh = weigh,
                                                .weigh_polar = weigh_polar,
                                                .spread = spread,
                                                .spread_lane = spread_lane,
                                                .add_windows = add_windows,
                                                .add_run = add_run,
                                                .fold = fold};

}  // namespace welkin::reflections::WELKIN_ISA
