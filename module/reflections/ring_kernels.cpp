// Sums over a cubemap's points, of sixteen images at a time, and what each texel gives to the rings.
#include "reflections/ring_kernels.h"

#include <cstddef>
#include <cstdint>

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kNarrowWidth, simd::kWidth, simd::Lanes, simd::NarrowLanes, simd::Quad;

constexpr int kRegisters = kRecordFloats / kWidth;
constexpr int kShareRegisters = kShareLanes / kNarrowWidth;

/// Registers that are summed at a time: as many as the processor has in addition to those of the products.
constexpr int kAtATime = kRegisters < 6 ? kRegisters : 6;

void sum_ring_taps(const RingRun& run, const RingLayout& layout) {
  alignas(64) float sums[kRecordFloats];
  for (int k = 0; k < run.count; ++k) {
    const RingTap* const first = run.taps + run.ends[k];
    const RingTap* const end = run.taps + run.ends[k + 1];
    for (int part = 0; part < kRegisters; part += kAtATime) {
      Lanes sum[kAtATime];
      for (int r = 0; r < kAtATime; ++r) sum[r] = Lanes(0.0F);
      for (const RingTap* tap = first; tap != end; ++tap) {
        const float* const record = run.records + static_cast<std::size_t>(tap->record) * kRecordFloats + part * kWidth;
        const Lanes weight(tap->weight);
        for (int r = 0; r < kAtATime; ++r) sum[r] += weight * Lanes::load_aligned(record + r * kWidth);
      }
      for (int r = 0; r < kAtATime; ++r) sum[r].store_aligned(sums + (part + r) * kWidth);
    }
    for (int image = 0; image < kRingImages; ++image) {
      float* const to = layout.to[image] + layout.step[image] * k;
      to[0] = sums[3 * image];
      to[1] = sums[3 * image + 1];
      to[2] = sums[3 * image + 2];
    }
  }
}

void weigh_light(const float* radiance, const float* steradians, int count, float* light) {
  int k = 0;
  for (; k + kWidth <= count; k += kWidth)
    (Lanes::load_unaligned(radiance + k) * Lanes::load_unaligned(steradians + k)).store_unaligned(light + k);
  for (; k < count; ++k) light[k] = radiance[k] * steradians[k];
}

// Texel i of the result has its middle at i + 1/2 large texels, texel j of the row at (j + 1/2) / 2: those from 2 i -
// 3 to 2 i + 4 lie up to 7/4 from it, in four pairs that are as far on either side. So texel -2 of the result, the
// farthest that a texel of the row gives light to, begins with texel -7: `kMargin`. The light of -2 and -1 is folded
// back after that.
void halve_row(const HalvedRow& row, float* rgb) {
  constexpr int beyond = 2;  // texels of the result that lie beyond either end
  constexpr int margin = 3 * HalvedRow::kMargin;
  const int floats = 3 * row.size;
  float* const light = row.scratch + margin;
  for (int k = 0; k < margin; ++k) row.scratch[k] = light[floats + k] = 0.0F;
  for (int k = 0; k < HalvedRow::kBeyond; ++k) light[floats + margin + k] = 0.0F;
  for (int first = 0; first < floats; first += kWidth) {
    Lanes sum(0.0F);
    for (int k = 0; k < row.count; ++k) sum += Lanes(row.shares[k]) * Lanes::load_unaligned(row.light[k] + first);
    sum.store_unaligned(light + first);
  }
  const int half = row.size / 2;
  const int count = half + 2 * beyond;
  const auto sum = [](const float* from, auto zero) {
    using Register = decltype(zero);
    const auto pair = [from](int near, int far) {
      return Register::load_unaligned(from + 3 * near) + Register::load_unaligned(from + 3 * far);
    };
    return pair(0, 7) * Register(kHalvedShares[0]) + pair(1, 6) * Register(kHalvedShares[1]) +
           pair(2, 5) * Register(kHalvedShares[2]) + pair(3, 4) * Register(kHalvedShares[3]);
  };
  // each texel is written as four floats, of which the next one overwrites the fourth
  if constexpr (kWidth > Quad::size) {  // sums between texels of the result cost less than narrow registers
    // Written over what it reads: a sum reads at its own place and after it, and is written before any later one.
    for (int first = 0; first < 6 * count; first += kWidth)
      sum(row.scratch + first, Lanes(0.0F)).store_unaligned(row.scratch + first);
    for (int i = 0; i < count; ++i) Quad::load_unaligned(row.scratch + 6 * i).store_unaligned(row.scratch + 3 * i);
  } else {
    for (int i = 0; i < count; ++i) sum(row.scratch + 6 * i, Quad(0.0F)).store_unaligned(row.scratch + 3 * i);
  }
  float* const inside = row.scratch + 3 * beyond;
  for (int end = 0; end < 2; ++end) {
    const int step = end == 0 ? 3 : -3;
    float* const at = inside + (end == 0 ? 0 : 3 * (half - 1));
    for (int k = 0; k < kFolded; ++k) {
      for (int c = 0; c < 3; ++c)
        at[step * k + c] += at[c - step] * kFirstBeyond[k] + at[c - 2 * step] * kSecondBeyond[k];
    }
  }
  for (int i = 0; i + 1 < half; ++i)
    (Quad::load_unaligned(inside + 3 * i) * Quad(row.scale[i])).store_unaligned(rgb + 3 * i);
  for (int c = 3 * half - 3; c < 3 * half; ++c) rgb[c] = inside[c] * row.scale[half - 1];
}

/// `kPoints` at once, so that the processor need not wait for each sum.
template <int kPoints>
void evaluate_points(const float* coefficients, const int* cells, const float* points, float* values) {
  const float* from[kPoints];
  NarrowLanes sums[kPoints][kShareRegisters];
  for (int i = 0; i < kPoints; ++i) {
    from[i] = coefficients + std::ptrdiff_t{kSharePowers * kShareLanes} * cells[i];
    for (int r = 0; r < kShareRegisters; ++r) sums[i][r] = NarrowLanes::load_unaligned(from[i] + r * kNarrowWidth);
  }
  for (int power = 1; power < kSharePowers; ++power) {
    for (int i = 0; i < kPoints; ++i) {
      const NarrowLanes point(points[i]);
      for (int r = 0; r < kShareRegisters; ++r) {
        const float* const next = from[i] + power * kShareLanes + r * kNarrowWidth;
        sums[i][r] = sums[i][r] * point + NarrowLanes::load_unaligned(next);
      }
    }
  }
  for (int i = 0; i < kPoints; ++i) {
    for (int r = 0; r < kShareRegisters; ++r) sums[i][r].store_unaligned(values + i * kShareLanes + r * kNarrowWidth);
  }
}

void evaluate_shares(const float* coefficients, const int* cells, const float* points, int count, float* values) {
  constexpr int kTogether = kShareRegisters == 1 ? 4 : 2;
  int i = 0;
  for (; i + kTogether <= count; i += kTogether)
    evaluate_points<kTogether>(coefficients, cells + i, points + i, values + i * kShareLanes);
  for (; i < count; ++i) evaluate_points<1>(coefficients, cells + i, points + i, values + i * kShareLanes);
}

// With F_c(x) the integral of column c's share from before all columns up to the longitude x, a part from x0 to x1
// gives column c exactly F_c(x1) - F_c(x0) (`wanted`): of the columns from `first` - 2 on, those before the upper
// end's own five have been passed by it (F = 1), and what the lower end had passed is taken off. The points' shares
// times widths are the Gauss rule for the same integrals. Their difference from `wanted` goes to both points alike: a
// part's sum over its points is exact, and each point has its own rings.
void share_columns(const ColumnShares& shares, int* columns, float* across) {
  constexpr int kColumns = 2 * kShareLanes;  // a point's columns end within a part's eight
  const float* point = shares.point_shares;
  for (int part = 0; part < shares.count; ++part) {
    const int lower = 2 * part + (shares.falling ? 1 : 0);
    const int upper = 2 * part + (shares.falling ? 0 : 1);
    const float* const low = shares.end_shares + std::ptrdiff_t{kShareLanes} * lower;
    const float* const high = shares.end_shares + std::ptrdiff_t{kShareLanes} * upper;
    const int first = shares.end_columns[lower];
    const int reach = shares.end_columns[upper] - first;
    float wanted[kColumns] = {};
    for (int k = 0; k < reach && k < kShareLanes; ++k) wanted[k] = 1.0F;
    for (int k = 0; k < kSpread && reach + k < kShareLanes; ++k) wanted[reach + k] = high[k];
    for (int k = 0; k < kSpread; ++k) wanted[k] -= low[k];
    float sums[kShareLanes] = {};
    for (int k = 0; k < kShareLanes; ++k) sums[k] = wanted[k];
    float* const to = across + std::ptrdiff_t{kPartPoints * kShareLanes} * part;
    for (int i = 0; i < kPartPoints; ++i, point += kShareLanes) {
      float moved[kColumns] = {};
      int offset = shares.point_columns[kPartPoints * part + i] - first;
      offset = offset < 0 ? 0 : (offset > kShareLanes - kSpread ? kShareLanes - kSpread : offset);
      const float width = shares.widths[kPartPoints * part + i];
      for (int k = 0; k < kShareLanes; ++k) moved[offset + k] = point[k] * width;
      for (int k = 0; k < kShareLanes; ++k) to[i * kShareLanes + k] = moved[k];
      for (int k = 0; k < kShareLanes; ++k) sums[k] -= moved[k];
    }
    for (int i = 0; i < kPartPoints; ++i) {
      for (int k = 0; k < kShareLanes; ++k) to[i * kShareLanes + k] += sums[k] * (1.0F / kPartPoints);
    }
    columns[part] = first - kSpread / 2;
  }
}

WELKIN_INLINE void add_scaled(float* to, float scale, const NarrowLanes (&values)[kShareRegisters]) {
  for (int r = 0; r < kShareRegisters; ++r) {
    float* const part = to + r * kNarrowWidth;
    (NarrowLanes::load_unaligned(part) + NarrowLanes(scale) * values[r]).store_unaligned(part);
  }
}

// Green's theorem. With c(x) a column's share at the longitude x and R(p) a ring's share integrated over the sphere's
// area from the pole to the polar angle p, the integral of both over a texel is Int c(x) (R(p_outer(x)) -
// R(p_inner(x))) dx, as dR / dp is the ring's share times sin p: a sum over the edges of `across` times R, with a
// minus sign for inner ones. Edges along meridians have dx = 0. R is `whole` for rings that lie on the pole's side of
// the point's five, `along` for these, and 0 for those farther away.
void add_edge(const TexelEdge& edge, const RingWindow& window, const float* whole, int stride, float* block) {
  const RingEdges& line = *edge.line;
  for (std::uint32_t part = edge.first; part < edge.end; ++part) {
    const int offset = line.columns[part] - window.first_column;
    float* const column = block + (offset < 0 ? 0 : (offset > window.columns ? window.columns : offset));
    for (std::uint32_t point = kPartPoints * part; point < kPartPoints * (part + 1); ++point) {
      const NarrowLanes sign(edge.inner ? -1.0F : 1.0F);
      const float* const shares = line.across + std::size_t{kShareLanes} * point;
      NarrowLanes across[kShareRegisters];
      for (int r = 0; r < kShareRegisters; ++r)
        across[r] = sign * NarrowLanes::load_unaligned(shares + r * kNarrowWidth);
      int passed = line.rings[point] - kSpread / 2 - window.first_ring;
      passed = passed < 0 ? 0 : (passed > window.rings - kSpread ? window.rings - kSpread : passed);
      float* row = column;
      for (int k = 0; k < passed; ++k, row += stride) add_scaled(row, whole[k], across);
      const float* const along = line.along + std::size_t{kShareLanes} * point;
      for (int k = 0; k < kSpread; ++k, row += stride) add_scaled(row, along[k], across);
    }
  }
}

WELKIN_INLINE int bits_below(std::uint32_t bits, int bit) {
  int count = 0;
  for (std::uint32_t rest = bits & ((1U << static_cast<unsigned>(bit)) - 1U); rest != 0; rest &= rest - 1) ++count;
  return count;
}

void write_folded(const WeighedTexel& texel, const RingBand& band, int ring, const float* row) {
  const RingWindow& window = texel.window;
  const auto write = [&](const RingCells& cells, int first) WELKIN_INLINE_LAMBDA {
    const std::uint32_t record =
        cells.image == 0 ? texel.record
                         : texel.first_image + static_cast<std::uint32_t>(bits_below(texel.images, cells.image));
    std::uint32_t* next = band.next + (cells.ring - band.first_ring) * band.width + cells.column;
    for (int k = 0; k < cells.count; ++k, next += cells.step) band.taps[(*next)++] = {record, row[first + k]};
  };
  for_folded(ring, window.first_column, window.columns, band.rows, band.width, write);
}

void weigh_texel(const WeighedTexel& texel, const RingBand& band, float* block) {
  const RingWindow& window = texel.window;
  const int stride = window.columns + kShareLanes;
  const float* const whole = band.whole + 2 + window.first_ring;
  for (int k = 0; k < texel.edge_count; ++k) add_edge(texel.edges[k], window, whole, stride, block);
  float* row = block;
  for (int k = 0; k < window.rings; ++k, row += stride) {
    const int ring = window.first_ring + k;
    if (ring >= texel.clip_first && ring < texel.clip_end) {
      if (texel.images != 0) {
        write_folded(texel, band, ring, row);
      } else {
        std::uint32_t* const next = band.next + (ring - band.first_ring) * band.width + window.first_column;
        for (int column = 0; column < window.columns; ++column) band.taps[next[column]++] = {texel.record, row[column]};
      }
    }
  }
  const NarrowLanes zero(0.0F);
  for (float* part = block; part < row; part += kNarrowWidth) zero.store_unaligned(part);
}

}  // namespace

const RingKernels ring_kernels_table = {
    .sum_ring_taps = sum_ring_taps,
    .weigh_light = weigh_light,
    .halve_row = halve_row,
    .evaluate_shares = evaluate_shares,
    .share_columns = share_columns,
    .weigh_texel = weigh_texel,
};

}  // namespace welkin::reflections::WELKIN_ISA
