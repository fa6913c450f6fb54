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

WELKIN_INLINE void load_line(const BlockLines& lines, int line, int lane, Lanes (&low)[3], Lanes (&high)[3]) {
  for (int c = 0; c < 3; ++c) {
    low[c] = Lanes::load_aligned(lines.ends[line][0][c] + lane);
    high[c] = Lanes::load_aligned(lines.ends[line][1][c] + lane);
  }
}

template <class Texels>
WELKIN_INLINE Projection along_stored(const BlockLines& stored, int line, int lane) {
  Lanes low[3];
  Lanes high[3];
  load_line(stored, line, lane, low, high);
  return between<Texels>(low, high);
}

template <class Texels>
WELKIN_INLINE void fit(const BlockLanes& block, const Texels& texels, const BlockLines* stored, int line, int lane,
                       BlockLines& fitted) {
  const Centre centre = centre_of(block, texels);
  Projection projection;
  if (stored == nullptr) {
    Lanes axis[3];
    principal_axis(block, texels, centre, axis);
    projection = along_axis(block, texels, axis);
  } else {
    projection = along_stored<Texels>(*stored, line, lane);
  }
  const FittedLine found = least_squares(block, texels, centre, projection, Lanes(kLargestLogarithm), false);
  for (int c = 0; c < 3; ++c) {
    found.low[c].store_aligned(fitted.ends[line][0][c] + lane);
    found.high[c].store_aligned(fitted.ends[line][1][c] + lane);
  }
}

WELKIN_INLINE BlockLanes lanes_of(const BlockGroup& group, int lane) {
  return {group.values[0] + lane, group.weights[0] + lane};
}

void fit_single(const BlockGroup& group, const BlockLines* stored, BlockLines& fitted) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    fit(lanes_of(group, lane), SingleTexels(), stored, 0, lane, fitted);
  }
}

void fit_pairs(const BlockGroup& group, const float* partitions, const BlockLines* stored, BlockLines& fitted) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block = lanes_of(group, lane);
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
  // 2048 logarithms and 1024 halves to a power of two: half a unit, and a quarter squared, so that errors compare with
  // those of BC6H.
  return square * xsimd::min(block.weight(texel), Lanes(1.0F)) * Lanes(0.25F);
}

void index_single(const BlockGroup& group, const BlockLines& stored, BlockIndices& to) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block = lanes_of(group, lane);
    Lanes low[3];
    Lanes high[3];
    load_line(stored, 0, lane, low, high);
    const Projection projection = between<SingleTexels>(low, high);
    Lanes error(0.0F);
    for (int k = 0; k < kTexels; ++k) {
      const Lanes index = index_at(block, SingleTexels(), projection, k);
      xsimd::to_int(index).store_aligned(to.indices[k] + lane);
      error = error + square_of(block, k, low, high, SingleTexels::weight_of(index));
    }
    error.store_aligned(to.errors + lane);
  }
}

void index_pairs(const BlockGroup& group, const float* partitions, const BlockLines& stored, BlockIndices& to) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block = lanes_of(group, lane);
    const Sides sides(Lanes::load_aligned(partitions + lane));
    const PairTexels<false> first{{sides}};
    Lanes low[2][3];
    Lanes high[2][3];
    for (int line = 0; line < 2; ++line) load_line(stored, line, lane, low[line], high[line]);
    const Projection projections[2] = {between<PairTexels<false>>(low[0], high[0]),
                                       between<PairTexels<false>>(low[1], high[1])};
    Lanes error(0.0F);
    for (int k = 0; k < kTexels; ++k) {
      const Mask is_second = sides.is_second(k);
      const Lanes index =
          select(is_second, index_at(block, first, projections[1], k), index_at(block, first, projections[0], k));
      xsimd::to_int(index).store_aligned(to.indices[k] + lane);
      Lanes low_here[3];
      Lanes high_here[3];
      for (int c = 0; c < 3; ++c) {
        low_here[c] = select(is_second, low[1][c], low[0][c]);
        high_here[c] = select(is_second, high[1][c], high[0][c]);
      }
      error = error + square_of(block, k, low_here, high_here, PairTexels<false>::weight_of(index));
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
    .fit_single = fit_single,
    .index_single = index_single,
    .rank_partitions = rank_partitions_of,
    .fit_pairs = fit_pairs,
    .index_pairs = index_pairs,
};

}  // namespace welkin::image::WELKIN_ISA
