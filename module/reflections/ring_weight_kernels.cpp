// What each texel of a cubemap gives to the rings of latitude.
#include "reflections/ring_weight_kernels.h"

#include <cstddef>
#include <cstdint>

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kNarrowWidth, simd::NarrowLanes;

constexpr int kRegisters = kShareLanes / kNarrowWidth;

/// `kPoints` at once, so that the processor need not wait for each sum.
template <int kPoints>
void evaluate_points(const float* coefficients, const int* cells, const float* places, float* values) {
  const float* from[kPoints];
  NarrowLanes sums[kPoints][kRegisters];
  for (int i = 0; i < kPoints; ++i) {
    from[i] = coefficients + std::ptrdiff_t{kSharePowers * kShareLanes} * cells[i];
    for (int r = 0; r < kRegisters; ++r) sums[i][r] = NarrowLanes::load_unaligned(from[i] + r * kNarrowWidth);
  }
  for (int power = 1; power < kSharePowers; ++power) {
    for (int i = 0; i < kPoints; ++i) {
      const NarrowLanes place(places[i]);
      for (int r = 0; r < kRegisters; ++r) {
        const float* const next = from[i] + power * kShareLanes + r * kNarrowWidth;
        sums[i][r] = sums[i][r] * place + NarrowLanes::load_unaligned(next);
      }
    }
  }
  for (int i = 0; i < kPoints; ++i) {
    for (int r = 0; r < kRegisters; ++r) sums[i][r].store_unaligned(values + i * kShareLanes + r * kNarrowWidth);
  }
}

void evaluate_shares(const float* coefficients, const int* cells, const float* places, int count, float* values) {
  constexpr int kAtATime = kRegisters == 1 ? 4 : 2;
  int i = 0;
  for (; i + kAtATime <= count; i += kAtATime)
    evaluate_points<kAtATime>(coefficients, cells + i, places + i, values + i * kShareLanes);
  for (; i < count; ++i) evaluate_points<1>(coefficients, cells + i, places + i, values + i * kShareLanes);
}

void share_columns(const ColumnShares& shares, int* columns, float* across) {
  constexpr int kPlaces = 2 * kShareLanes;  // a point's columns end within a part's eight
  const float* point = shares.point_shares;
  for (int part = 0; part < shares.count; ++part) {
    const int lower = 2 * part + (shares.falling ? 1 : 0);
    const int upper = 2 * part + (shares.falling ? 0 : 1);
    const float* const low = shares.end_shares + std::ptrdiff_t{kShareLanes} * lower;
    const float* const high = shares.end_shares + std::ptrdiff_t{kShareLanes} * upper;
    const int first = shares.end_columns[lower];
    const int reach = shares.end_columns[upper] - first;
    float wanted[kPlaces] = {};
    for (int k = 0; k < reach && k < kShareLanes; ++k) wanted[k] = 1.0F;
    for (int k = 0; k < kSpread && reach + k < kShareLanes; ++k) wanted[reach + k] = high[k];
    for (int k = 0; k < kSpread; ++k) wanted[k] -= low[k];
    float sums[kShareLanes] = {};
    for (int k = 0; k < kShareLanes; ++k) sums[k] = wanted[k];
    float* const to = across + std::ptrdiff_t{kPartPoints * kShareLanes} * part;
    for (int i = 0; i < kPartPoints; ++i, point += kShareLanes) {
      float moved[kPlaces] = {};
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

WELKIN_INLINE void add_scaled(float* to, float scale, const NarrowLanes (&values)[kRegisters]) {
  for (int r = 0; r < kRegisters; ++r) {
    float* const part = to + r * kNarrowWidth;
    (NarrowLanes::load_unaligned(part) + NarrowLanes(scale) * values[r]).store_unaligned(part);
  }
}

void add_edge(const TexelEdge& edge, const RingWindow& window, const float* whole, int stride, float* block) {
  const RingEdges& line = *edge.line;
  for (std::uint32_t part = edge.first; part < edge.end; ++part) {
    const int offset = line.columns[part] - window.first_column;
    float* const column = block + (offset < 0 ? 0 : (offset > window.columns ? window.columns : offset));
    for (std::uint32_t point = kPartPoints * part; point < kPartPoints * (part + 1); ++point) {
      const NarrowLanes sign(edge.inner ? -1.0F : 1.0F);
      const float* const shares = line.across + std::size_t{kShareLanes} * point;
      NarrowLanes across[kRegisters];
      for (int r = 0; r < kRegisters; ++r) across[r] = sign * NarrowLanes::load_unaligned(shares + r * kNarrowWidth);
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

const RingWeightKernels ring_weight_kernels_table = {
    .evaluate_shares = evaluate_shares,
    .share_columns = share_columns,
    .weigh_texel = weigh_texel,
};

}  // namespace welkin::reflections::WELKIN_ISA
