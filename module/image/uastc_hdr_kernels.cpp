// UASTC HDR's encoder, one block a lane: lines through the texels' logarithms, and the texels' indices along them.
#include "image/bc6h_kernels.h"
#include "image/bc6h_lines.h"
#include "image/bc6h_pairs.h"

namespace welkin::image::WELKIN_ISA {
namespace {

constexpr float kLargestLogarithm = 63487.0F;  ///< of 65504

/// A half's ten bits of mantissa to the eleven of a logarithm, which the decoder brings back by three straight pieces:
/// 3 m below 512, 4 m - 512, and 5 m - 2048 from 1536 on, in eighths of the half's last bit.
WELKIN_INLINE Lanes logarithm_of(Lanes half) {
  const Lanes exponent = truncated(half * Lanes(1.0F / 1024.0F));
  const Lanes eighths = (half - exponent * Lanes(1024.0F)) * Lanes(8.0F) + Lanes(4.0F);
  // The inverses of half_of_logarithm's lines, of the middle of a half's unit (4 of 8 eighths): every finite half comes
  // back from the truncated logarithm. The lines end at 3 x 512 = 1536 and 5 x 1536 - 2048 = 5632 eighths.
  const Lanes steep = eighths * Lanes(1.0F / 3.0F);
  const Lanes middle = (eighths + Lanes(512.0F)) * Lanes(0.25F);
  const Lanes gentle = (eighths + Lanes(2048.0F)) * Lanes(0.2F);
  return exponent * Lanes(2048.0F) +
         select(eighths < Lanes(1536.0F), steep, select(eighths < Lanes(5632.0F), middle, gentle));
}

void take_logarithms(BlockGroup& group, std::int32_t* flat) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    Lanes spread(0.0F);
    for (int value = 0; value < 3 * kTexels; ++value) {
      const Lanes first = Lanes::load_aligned(group.values[value % 3] + lane);
      spread = xsimd::max(spread, xsimd::abs(Lanes::load_aligned(group.values[value] + lane) - first));
    }
    xsimd::to_int(select(spread > Lanes(0.0F), Lanes(0.0F), Lanes(1.0F))).store_unaligned(flat + lane);
    for (float(&values)[kLanes] : group.values) {
      logarithm_of(Lanes::load_aligned(values + lane)).store_aligned(values + lane);
    }
  }
}

/// All texels of a block, on one line. No index has a bit less.
struct SingleTexels : AllTexels {
  static WELKIN_INLINE Lanes weight_of(Lanes index) {
    return truncated(index * Lanes(4.25F)) + select(index > Lanes(7.5F), Lanes(1.0F), Lanes(0.0F));
  }
  // NOLINTNEXTLINE(readability-convert-member-functions-to-static): as those of other texels
  [[nodiscard]] WELKIN_INLINE Lanes largest_index(int /*texel*/) const { return Lanes(steps); }
};

/// The texels of one side of a partition.
template <bool is_second>
struct PairTexels : SideTexels<is_second> {
  static constexpr float steps = 3.0F;
  static WELKIN_INLINE Lanes weight_of(Lanes index) {  // 0, 21, 43, 64
    return truncated(index * Lanes(21.34F) + select(index > Lanes(1.5F), Lanes(0.4F), Lanes(0.0F)));
  }
  [[nodiscard]] WELKIN_INLINE Lanes largest_index(int /*texel*/) const { return Lanes(steps); }
};

/// A register of stored lines, and what gives texels their indices along them.
template <class Texels>
struct StoredEnds {
  Lanes low[3], high[3];
  Projection projection;

  WELKIN_INLINE StoredEnds(const BlockLines& stored, int line, int lane) {
    for (int c = 0; c < 3; ++c) {
      low[c] = Lanes::load_aligned(stored.ends[line][0][c] + lane);
      high[c] = Lanes::load_aligned(stored.ends[line][1][c] + lane);
    }
    projection = between<Texels>(low, high);
  }
};

template <class Texels>
WELKIN_INLINE void fit(const BlockLanes& block, const Texels& texels, const BlockLines* stored, int line, int lane,
                       BlockLines& fitted) {
  const Centre centre = centre_of(block, texels);
  const Projection projection =
      stored == nullptr ? along_spread(block, texels, centre) : StoredEnds<Texels>(*stored, line, lane).projection;
  const FittedLine found = least_squares(block, texels, centre, projection, Lanes(kLargestLogarithm), false);
  for (int c = 0; c < 3; ++c) {
    found.low[c].store_aligned(fitted.ends[line][0][c] + lane);
    found.high[c].store_aligned(fitted.ends[line][1][c] + lane);
  }
}

WELKIN_INLINE BlockLanes lanes_of(const BlockGroup& group, int lane) {
  return {group.values[0] + lane, group.weights[0] + lane};
}

void fit_lines(const BlockGroup& group, const float* partitions, const BlockLines* stored, BlockLines& fitted) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block = lanes_of(group, lane);
    if (partitions == nullptr) {
      fit(block, SingleTexels(), stored, 0, lane, fitted);
      continue;
    }
    const Sides sides(Lanes::load_aligned(partitions + lane));
    fit(block, PairTexels<false>{{sides}}, stored, 0, lane, fitted);
    fit(block, PairTexels<true>{{sides}}, stored, 1, lane, fitted);
  }
}

/// The decoder's logarithm: floor((low (64 - w) + high w + 32) / 64).
WELKIN_INLINE Lanes between_ends(Lanes low, Lanes high, Lanes weight) {
  return truncated((low * (Lanes(64.0F) - weight) + high * weight + Lanes(32.0F)) * Lanes(1.0F / 64.0F));
}

/// A texel's part of a block's error. What is decoded is the lower end of a unit. A unit in a half's last place is two
/// of these, nearly.
WELKIN_INLINE Lanes square_of(const BlockLanes& block, int texel, const Lanes (&low)[3], const Lanes (&high)[3],
                              Lanes weight) {
  Lanes square(0.0F);
  for (int c = 0; c < 3; ++c) {
    const Lanes off = between_ends(low[c], high[c], weight) + Lanes(0.5F) - block.value(texel, c);
    square = square + off * off;
  }
  // 2048 logarithms and 1024 half floats per power of two: half a unit, and a quarter squared, so that errors compare
  // with those of BC6H.
  return square * xsimd::min(block.weight(texel), Lanes(1.0F)) * Lanes(0.25F);
}

void index_lines(const BlockGroup& group, const float* partitions, const BlockLines& stored, BlockIndices& to) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block = lanes_of(group, lane);
    Lanes error(0.0F);
    if (partitions == nullptr) {
      const StoredEnds<SingleTexels> line(stored, 0, lane);
      for (int k = 0; k < kTexels; ++k) {
        const Lanes index = index_at(block, SingleTexels(), line.projection, k);
        xsimd::to_int(index).store_aligned(to.indices[k] + lane);
        error = error + square_of(block, k, line.low, line.high, SingleTexels::weight_of(index));
      }
    } else {
      using Texels = PairTexels<false>;  // no index has a bit less, so that those of both sides are limited alike
      const Sides sides(Lanes::load_aligned(partitions + lane));
      const StoredEnds<Texels> first(stored, 0, lane);
      const StoredEnds<Texels> second(stored, 1, lane);
      for (int k = 0; k < kTexels; ++k) {
        const Mask is_second = sides.is_second(k);
        const Lanes index = select(is_second, index_at(block, Texels{{sides}}, second.projection, k),
                                   index_at(block, Texels{{sides}}, first.projection, k));
        xsimd::to_int(index).store_aligned(to.indices[k] + lane);
        Lanes low[3];
        Lanes high[3];
        for (int c = 0; c < 3; ++c) {
          low[c] = select(is_second, second.low[c], first.low[c]);
          high[c] = select(is_second, second.high[c], first.high[c]);
        }
        error = error + square_of(block, k, low, high, Texels::weight_of(index));
      }
    }
    error.store_aligned(to.errors + lane);
  }
}

void rank_partitions_of(const BlockGroup& group, std::uint32_t allowed, int slots, float (*partitions)[kLanes]) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    Ranking ranking;
    rank_partitions(lanes_of(group, lane), allowed, slots, ranking);
    for (int rank = 0; rank < slots; ++rank) ranking.partitions[rank].store_aligned(partitions[rank] + lane);
  }
}

}  // namespace

const UastcHdrKernels uastc_hdr_kernels_table = {
    .take_logarithms = take_logarithms,
    .rank_partitions = rank_partitions_of,
    .fit_lines = fit_lines,
    .index_lines = index_lines,
};

}  // namespace welkin::image::WELKIN_ISA
