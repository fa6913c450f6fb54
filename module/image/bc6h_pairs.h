// BC6H blocks with two lines, one block a lane: the partition that leaves out least, the mode that its ends allow, and
// the ends and indices. Only for the sources of kernels.
#pragma once

#include "image/bc6h.h"
#include "image/bc6h_kernels.h"
#include "image/bc6h_lines.h"

namespace welkin::image::WELKIN_ISA {

// ---- Which partition

inline constexpr int kMoments = 10;  ///< weight, three sums, six sums of products

/// Returns the spread that a line through one side of a partition leaves out, for ranks only: the trace less 48/49 of
/// the largest eigenvalue, as an index of eight steps leaves about 1/49 of the spread along its line.
/// The eigenvalue is tr N^6 / tr N^5 times the trace, with the covariance N over its trace.
WELKIN_INLINE Lanes left_out(const Lanes (&sums)[kMoments]) {
  const Lanes inverse = Lanes(1.0F) / xsimd::max(sums[0], Lanes(1.0e-6F));
  const Lanes r = sums[1] * inverse;
  const Lanes g = sums[2] * inverse;
  const Lanes b = sums[3] * inverse;
  const Lanes rr = sums[4] - sums[1] * r;
  const Lanes gg = sums[7] - sums[2] * g;
  const Lanes bb = sums[9] - sums[3] * b;
  const Lanes trace = xsimd::max(rr + gg + bb, Lanes(0.0F));
  const Lanes scale = Lanes(1.0F) / (trace + Lanes(1.0e-6F));
  const Lanes n[6] = {rr * scale, (sums[5] - sums[1] * g) * scale, (sums[6] - sums[1] * b) * scale,
                      gg * scale, (sums[8] - sums[2] * b) * scale, bb * scale};
  const auto squared = [](const Lanes(&m)[6], Lanes(&to)[6]) WELKIN_INLINE_LAMBDA {
    to[0] = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
    to[1] = m[0] * m[1] + m[1] * m[3] + m[2] * m[4];
    to[2] = m[0] * m[2] + m[1] * m[4] + m[2] * m[5];
    to[3] = m[1] * m[1] + m[3] * m[3] + m[4] * m[4];
    to[4] = m[1] * m[2] + m[3] * m[4] + m[4] * m[5];
    to[5] = m[2] * m[2] + m[4] * m[4] + m[5] * m[5];
  };
  const auto trace_of_product = [](const Lanes(&p)[6], const Lanes(&q)[6]) WELKIN_INLINE_LAMBDA {
    const Lanes beside = p[1] * q[1] + p[2] * q[2] + p[4] * q[4];
    return p[0] * q[0] + p[3] * q[3] + p[5] * q[5] + (beside + beside);
  };
  Lanes second[6];
  Lanes fourth[6];
  squared(n, second);
  squared(second, fourth);
  const Lanes fifth = trace_of_product(fourth, n);
  const Lanes eigenvalue = trace_of_product(fourth, second) / xsimd::max(fifth, Lanes(1.0e-20F));
  return trace * (Lanes(1.0F) - Lanes(48.0F / 49.0F) * xsimd::min(eigenvalue, Lanes(1.0F)));
}

/// The partitions that leave out least, the best one first.
struct Ranking {
  Lanes scores[kMaxPartitionsTried];
  Lanes partitions[kMaxPartitionsTried];

  WELKIN_INLINE void insert(Lanes score, Lanes partition, int slots) {
    for (int k = 0; k < slots; ++k) {
      const Mask better = score < scores[k];
      const Lanes pushed_score = select(better, scores[k], score);
      const Lanes pushed = select(better, partitions[k], partition);
      scores[k] = select(better, score, scores[k]);
      partitions[k] = select(better, partition, partitions[k]);
      score = pushed_score;
      partition = pushed;
    }
  }
};

WELKIN_INLINE void moments_of(const BlockLanes& block, const Centre& centre, int texel, Lanes* moments) {
  const Lanes weight = block.weight(texel);
  const Lanes r = block.value(texel, 0) - centre.mean[0];
  const Lanes g = block.value(texel, 1) - centre.mean[1];
  const Lanes b = block.value(texel, 2) - centre.mean[2];
  moments[0] = weight;
  moments[1] = weight * r;
  moments[2] = weight * g;
  moments[3] = weight * b;
  moments[4] = moments[1] * r;
  moments[5] = moments[1] * g;
  moments[6] = moments[1] * b;
  moments[7] = moments[2] * g;
  moments[8] = moments[2] * b;
  moments[9] = moments[3] * b;
}

/// `allowed`: bit k is set for a partition that may be taken.
WELKIN_INLINE void rank_partitions(const BlockLanes& block, std::uint32_t allowed, int slots, Ranking& ranking) {
  const Centre centre = centre_of(block, AllTexels());
  Lanes moments[kTexels][kMoments];
  Lanes all[kMoments];
  for (int m = 0; m < kMoments; ++m) all[m] = Lanes(0.0F);
  for (int k = 0; k < kTexels; ++k) {
    moments_of(block, centre, k, moments[k]);
    for (int m = 0; m < kMoments; ++m) all[m] = all[m] + moments[k][m];
  }
  for (int k = 0; k < slots; ++k) ranking.scores[k] = ranking.partitions[k] = Lanes(kBig);
  for (int partition = 0; partition < kBc6hPartitions; ++partition) {
    if ((allowed >> partition & 1U) == 0) continue;
    Lanes side[kMoments];
    Lanes other[kMoments];
    for (int m = 0; m < kMoments; ++m) side[m] = Lanes(0.0F);
    for (int k = 0; k < kTexels; ++k) {
      if ((unsigned{kBc6hSecondLines[partition]} >> k & 1U) == 0) continue;
      for (int m = 0; m < kMoments; ++m) side[m] = side[m] + moments[k][m];
    }
    for (int m = 0; m < kMoments; ++m) other[m] = all[m] - side[m];
    ranking.insert(left_out(side) + left_out(other), Lanes(static_cast<float>(partition)), slots);
  }
}

// ---- Two lines

/// A partition a lane.
struct Sides {
  Lanes second[kTexels];  ///< 1 for texels of the second line, 0 for others
  Lanes anchor;           ///< of the second line: 2, 8 or 15

  WELKIN_INLINE explicit Sides(Lanes partition) {
    alignas(64) float numbers[kWidth];
    alignas(64) std::int32_t masks[kWidth];
    alignas(64) float anchors[kWidth];
    partition.store_aligned(numbers);
    for (int lane = 0; lane < kWidth; ++lane) {
      const auto number = static_cast<int>(numbers[lane]);
      masks[lane] = std::int32_t{kBc6hSecondLines[number]};
      anchors[lane] = static_cast<float>(kBc6hAnchors[number]);
    }
    const Integers mask = Integers::load_aligned(masks);
    for (int k = 0; k < kTexels; ++k) second[k] = xsimd::to_float((mask >> k) & Integers(1));
    anchor = Lanes::load_aligned(anchors);
  }

  [[nodiscard]] WELKIN_INLINE Mask is_second(int texel) const { return second[texel] > Lanes(0.0F); }
};

inline constexpr float kSteps = 7.0F;
inline constexpr float kAnchorLimit = 3.0F;

/// One side of a partition, as `AllTexels`.
template <bool is_second>
struct SideTexels {
  static constexpr float steps = kSteps;
  static constexpr float anchor_limit = kAnchorLimit;
  const Sides& sides;

  static WELKIN_INLINE Lanes weight_of(Lanes index) { return truncated(index * Lanes(9.25F)); }
  [[nodiscard]] WELKIN_INLINE Lanes share(int texel, Lanes weight) const {
    return is_second ? weight * sides.second[texel] : weight - weight * sides.second[texel];
  }
  [[nodiscard]] WELKIN_INLINE Lanes inside(int texel, Lanes value, Lanes otherwise) const {
    return is_second ? select(sides.is_second(texel), value, otherwise)
                     : select(sides.is_second(texel), otherwise, value);
  }
  template <class ValueOf>
  [[nodiscard]] WELKIN_INLINE Lanes at_anchor(const ValueOf& value) const {
    if constexpr (is_second) {
      return select(sides.anchor == Lanes(15.0F), value(15), select(sides.anchor == Lanes(8.0F), value(8), value(2)));
    } else {
      return value(0);
    }
  }
  [[nodiscard]] WELKIN_INLINE Lanes largest_index(int texel) const {
    if constexpr (!is_second) return Lanes(texel == 0 ? kAnchorLimit : kSteps);
    if (texel != 2 && texel != 8 && texel != 15) return Lanes(kSteps);
    return select(sides.anchor == Lanes(static_cast<float>(texel)), Lanes(kAnchorLimit), Lanes(kSteps));
  }
};

/// All that is stored of a block with two lines.
struct LinePair {
  Lanes mode;  ///< 1 to 10
  Lanes ends[4][3];
  Lanes indices[kTexels];
  Lanes error;
};

/// The limits of a mode: how many bits an end has, and the bound of differences to the first one, -reach <= d < reach.
struct ModeChoice {
  Lanes mode, step, inverse;
  Lanes reach[3];
};

/// The first mode, by falling precision, that can say the differences. Mode 10 has none and takes all.
template <bool is_signed>
WELKIN_INLINE ModeChoice choose_mode(const Lanes (&v)[4][3]) {
  ModeChoice choice{Lanes(10.0F), Lanes(1024.0F), Lanes(1.0F / 1024.0F), {Lanes(kBig), Lanes(kBig), Lanes(kBig)}};
  struct Candidate {
    float mode, step, red, green, blue;
  };
  // By rising precision: an end of `end_bits` has the step 2^(16 - end_bits) and a difference of n bits reaches
  // 2^(n - 1); a later candidate that fits replaces the ones before.
  constexpr Candidate candidates[] = {{2, 512, 32, 32, 32}, {9, 256, 16, 16, 32}, {8, 256, 16, 32, 16},
                                      {7, 256, 32, 16, 16}, {6, 128, 16, 16, 16}, {1, 64, 16, 16, 16},
                                      {5, 32, 8, 8, 16},    {4, 32, 8, 16, 8},    {3, 32, 16, 8, 8}};
  float step = 0.0F;
  Lanes wanted[3] = {Lanes(0.0F), Lanes(0.0F), Lanes(0.0F)};
  for (const Candidate& candidate : candidates) {
    if (candidate.step != step) {
      step = candidate.step;
      const Precision<is_signed> precision(Lanes(step), Lanes(1.0F / step));
      for (int c = 0; c < 3; ++c) {
        const Lanes first = precision.stored(v[0][c]);
        wanted[c] = Lanes(0.0F);
        for (int end = 1; end < 4; ++end) {
          const Lanes difference = precision.stored(v[end][c]) - first;
          // -reach <= d < reach if max(d + 1, -d) <= reach, for whole d.
          wanted[c] = xsimd::max(wanted[c], xsimd::max(difference + Lanes(1.0F), Lanes(0.0F) - difference));
        }
      }
    }
    const Mask fits = (wanted[0] <= Lanes(candidate.red)) & (wanted[1] <= Lanes(candidate.green)) &
                      (wanted[2] <= Lanes(candidate.blue));
    choice.mode = select(fits, Lanes(candidate.mode), choice.mode);
    choice.step = select(fits, Lanes(step), choice.step);
    choice.inverse = select(fits, Lanes(1.0F / step), choice.inverse);
    choice.reach[0] = select(fits, Lanes(candidate.red), choice.reach[0]);
    choice.reach[1] = select(fits, Lanes(candidate.green), choice.reach[1]);
    choice.reach[2] = select(fits, Lanes(candidate.blue), choice.reach[2]);
  }
  return choice;
}

/// Rounds the ends. The first end takes its nearest number; the others may take the next where the mode can say it.
template <bool is_signed>
WELKIN_INLINE void store_ends(const FittedLine (&lines)[2], LinePair& pair, Lanes (&meant)[4][3]) {
  Lanes v[4][3];
  for (int end = 0; end < 4; ++end) {
    for (int c = 0; c < 3; ++c) {
      const FittedLine& line = lines[end / 2];
      v[end][c] = decoders_number<is_signed>(end % 2 == 0 ? line.low[c] : line.high[c]);
    }
  }
  const ModeChoice choice = choose_mode<is_signed>(v);
  const Precision<is_signed> precision(choice.step, choice.inverse);
  pair.mode = choice.mode;
  for (int c = 0; c < 3; ++c) {
    const Lanes first = precision.stored(v[0][c]);
    const auto next = [&](int end, Lanes number) WELKIN_INLINE_LAMBDA {
      const Lanes other = precision.next(v[end][c], number);
      const Lanes difference = other - first;
      const Mask fits = (difference < choice.reach[c]) & (difference >= Lanes(0.0F) - choice.reach[c]);
      return select(fits, other, number);
    };
    const Lanes near[3] = {precision.stored(v[1][c]), precision.stored(v[2][c]), precision.stored(v[3][c])};
    const EndChoice one = best_pair(lines[0], precision, v[0][c], v[1][c], first, first, near[0], next(1, near[0]));
    const EndChoice two =
        best_pair(lines[1], precision, v[2][c], v[3][c], near[1], next(2, near[1]), near[2], next(3, near[2]));
    pair.ends[0][c] = one.low;
    pair.ends[1][c] = one.high;
    pair.ends[2][c] = two.low;
    pair.ends[3][c] = two.high;
    for (int end = 0; end < 4; ++end) meant[end][c] = precision.meant(pair.ends[end][c]);
  }
}

/// The stored block of two lines, and the projections that its indices come from.
template <bool is_signed>
WELKIN_INLINE void stored_pair(const BlockLanes& block, const Sides& sides, const FittedLine (&lines)[2],
                               Projection (&projections)[2], LinePair& pair) {
  Lanes meant[4][3];
  store_ends<is_signed>(lines, pair, meant);
  Lanes middles[4][3];
  for (int end = 0; end < 4; ++end) {
    for (int c = 0; c < 3; ++c) middles[end][c] = middle_of<is_signed>(meant[end][c]);
  }
  const SideTexels<false> first{sides};
  const SideTexels<true> second{sides};
  projections[0] = between<SideTexels<false>>(middles[0], middles[1]);
  projections[1] = between<SideTexels<true>>(middles[2], middles[3]);
  pair.error = Lanes(0.0F);
  for (int k = 0; k < kTexels; ++k) {
    const Mask is_second = sides.is_second(k);
    pair.indices[k] =
        select(is_second, index_at(block, second, projections[1], k), index_at(block, first, projections[0], k));
    const Lanes s = along<SideTexels<false>>(pair.indices[k]);
    Lanes square(0.0F);
    for (int c = 0; c < 3; ++c) {
      const Lanes low = select(is_second, meant[2][c], meant[0][c]);
      const Lanes high = select(is_second, meant[3][c], meant[1][c]);
      const Lanes off = decoded<is_signed>(low + Lanes(0.5F), high - low, s) - block.value(k, c);
      square = square + off * off;
    }
    pair.error = pair.error + square * xsimd::min(block.weight(k), Lanes(1.0F));
  }
}

WELKIN_INLINE void keep_better(const LinePair& other, Lanes partition, int lane, TwoLineBlocks& blocks) {
  const Lanes error = Lanes::load_aligned(blocks.errors + lane);
  const Mask better = other.error < error;
  if (!xsimd::any(better)) return;
  select(better, other.error, error).store_aligned(blocks.errors + lane);
  const auto keep = [&](std::int32_t* to, Lanes value) WELKIN_INLINE_LAMBDA {
    const Lanes kept = select(better, value, xsimd::to_float(Integers::load_aligned(to + lane)));
    xsimd::to_int(kept).store_aligned(to + lane);
  };
  keep(blocks.modes, other.mode);
  keep(blocks.partitions, partition);
  for (int end = 0; end < 4; ++end) {
    for (int c = 0; c < 3; ++c) keep(blocks.ends[3 * end + c], other.ends[end][c]);
  }
  for (int k = 0; k < kTexels; ++k) keep(blocks.indices[k], other.indices[k]);
}

template <bool is_signed>
WELKIN_INLINE void encode_pair(const BlockLanes& block, int tried, int lane, TwoLineBlocks& blocks) {
  const Lanes largest(31743.0F);
  Ranking ranking;
  rank_partitions(block, ~0U, tried, ranking);
  Lanes(kBig).store_aligned(blocks.errors + lane);
  for (int rank = 0; rank < tried; ++rank) {
    const Sides sides(ranking.partitions[rank]);
    const SideTexels<false> first{sides};
    const SideTexels<true> second{sides};
    const Centre centres[2] = {centre_of(block, first), centre_of(block, second)};
    Projection projections[2] = {along_spread(block, first, centres[0]), along_spread(block, second, centres[1])};
    for (int turn = 0; turn < 2; ++turn) {
      const FittedLine lines[2] = {least_squares(block, first, centres[0], projections[0], largest, is_signed),
                                   least_squares(block, second, centres[1], projections[1], largest, is_signed)};
      LinePair pair;
      stored_pair<is_signed>(block, sides, lines, projections, pair);
      keep_better(pair, ranking.partitions[rank], lane, blocks);
    }
  }
}

}  // namespace welkin::image::WELKIN_ISA
