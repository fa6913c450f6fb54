// BC6H's encoder, one block a lane: radiance to the halves' bits, and blocks with one line.
#include "image/bc6h_kernels.h"

#include "image/bc6h_lines.h"
#include "image/bc6h_pairs.h"

namespace welkin::image::WELKIN_ISA {
namespace {

constexpr float kLargestHalfBits = 31743.0F;  // of 65504

/// How much more the light of a texel makes it count. An error of a bright texel shifts the block's mean: with 1 the
/// worst mean of a level of 16 texels or more is off by 0.34 %, with 2 by 0.31, with 2.5 by 0.16 (`normal`, the seven
/// images of docs/notes/textures.md); errors grow by a hundredth from 1 to 2 and a thousandth from there.
constexpr float kBrightness = 2.5F;

/// Loads rows of 16 blocks as values by lanes: four floats of four blocks are transposed at a time.
void load(const float* const* rows, BlockGroup& group) {
  for (int row = 0; row < 4; ++row) {
    for (int lane = 0; lane < kLanes; lane += 4) {
      const float* const from[4] = {rows[4 * lane + row], rows[4 * (lane + 1) + row], rows[4 * (lane + 2) + row],
                                    rows[4 * (lane + 3) + row]};
      for (int value = 0; value < 12; value += 4) {
        simd::Quad four[4] = {simd::Quad::load_unaligned(from[0] + value), simd::Quad::load_unaligned(from[1] + value),
                              simd::Quad::load_unaligned(from[2] + value), simd::Quad::load_unaligned(from[3] + value)};
        simd::transpose(four);
        for (int k = 0; k < 4; ++k) four[k].store_aligned(group.values[12 * row + value + k] + lane);
      }
    }
  }
}

/// A half's bits as a number, of a value from 0 to 65504: to the nearest, ties to even. What is below 2^-14 is added to
/// a number whose last bit counts 2^-24, so that the sum is rounded there.
WELKIN_INLINE Lanes half_bits(Lanes value) {
  const auto bits = xsimd::bitwise_cast<Integers>(value);
  const Integers odd = (bits >> 13) & Integers(1);
  // 13 bits of mantissa are dropped. Adding 0xFFF carries if they exceed half a unit, and one more if they are half a
  // unit of an odd number: ties go to even. 112 = 127 - 15 is the difference of the exponents' biases. Adding 1/2 to
  // what is below 2^-14 gives a float from 1/2 to 1, whose last bit counts 2^-24, as a denormal half's does; 0x3F000000
  // represents 1/2.
  const Integers normal = ((bits + Integers(0xFFF) + odd) >> 13) - Integers(112 << 10);
  const auto small = xsimd::bitwise_cast<Integers>(value + Lanes(0.5F)) - Integers(0x3F000000);
  return select(value < Lanes(6.103515625e-5F), xsimd::to_float(small), xsimd::to_float(normal));
}

template <bool is_signed>
WELKIN_INLINE void prepare_lanes(float* values, float* weights, std::int32_t* clamped_counts, float* sums) {
  const Lanes most(65504.0F);
  Lanes changed(0.0F);
  Lanes channels[3] = {Lanes(0.0F), Lanes(0.0F), Lanes(0.0F)};
  Lanes count(0.0F);
  Lanes light[kTexels];
  for (int k = 0; k < kTexels; ++k) {
    Lanes total(0.0F);
    const Lanes weight = Lanes::load_aligned(weights + k * kLanes);
    for (int c = 0; c < 3; ++c) {
      float* const at = values + (3 * k + c) * kLanes;
      const Lanes given = Lanes::load_aligned(at);
      const Lanes least = is_signed ? Lanes(-65504.0F) : Lanes(0.0F);
      const Mask inside = (given >= least) & (given <= most);  // NaN is not
      changed = changed + select(inside, Lanes(0.0F), Lanes(1.0F));
      const Lanes value = select(inside, given, select(given > most, most, select(given < least, least, Lanes(0.0F))));
      const Lanes size = xsimd::abs(value);
      const Lanes half = half_bits(size);
      (is_signed ? select(value < Lanes(0.0F), Lanes(0.0F) - half, half) : half).store_aligned(at);
      total = total + size;
      channels[c] = channels[c] + weight * size;
    }
    light[k] = total;
    count = count + weight;
  }
  for (int c = 0; c < 3; ++c) channels[c].store_aligned(sums + c * kLanes);
  const Lanes sum = channels[0] + channels[1] + channels[2];
  // Below this every half is 0, and a quotient could be infinite.
  const Mask lit = sum > Lanes(1.0e-30F);
  // light[k] inverse is the texel's light over the weighted mean.
  const Lanes inverse = select(lit, count / select(lit, sum, Lanes(1.0F)), Lanes(0.0F));
  for (int k = 0; k < kTexels; ++k) {
    float* const at = weights + k * kLanes;
    (Lanes::load_aligned(at) * (Lanes(1.0F) + Lanes(kBrightness) * light[k] * inverse)).store_aligned(at);
  }
  xsimd::to_int(changed).store_unaligned(clamped_counts);
}

void prepare(BlockGroup& group, bool is_signed, std::int32_t* clamped_counts, float (*light)[kLanes]) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    if (is_signed) {
      prepare_lanes<true>(group.values[0] + lane, group.weights[0] + lane, clamped_counts + lane, light[0] + lane);
    } else {
      prepare_lanes<false>(group.values[0] + lane, group.weights[0] + lane, clamped_counts + lane, light[0] + lane);
    }
  }
}

/// A block with one line, all of its numbers.
struct SingleLine {
  Lanes mode;  ///< 11 to 14
  StoredLine ends;
  Projection projection;
  Lanes error;
};

/// Stores ends and mode of a fitted line. The bounds leave space for the next numbers of both ends, which must not
/// differ by more than the mode's differences can say.
template <bool is_signed>
WELKIN_INLINE void store_ends(const FittedLine& line, SingleLine& to, Lanes (&low)[3], Lanes (&reach)[3]) {
  Lanes v_low[3];
  Lanes v_high[3];
  Lanes difference(0.0F);
  for (int c = 0; c < 3; ++c) {
    v_low[c] = decoders_number<is_signed>(line.low[c]);
    v_high[c] = decoders_number<is_signed>(line.high[c]);
    difference = xsimd::max(difference, xsimd::abs(v_high[c] - v_low[c]));
  }
  const auto by_mode = [&](float mode11, float mode12, float mode13, float mode14) WELKIN_INLINE_LAMBDA {
    // Differences have 4, 8 and 9 bits in steps of 1, 16 and 32: they reach 7, 127 and 255 steps upwards. Rounding one
    // end up and the other down may add 2, so lines fit for sure up to 5, 125 and 253 steps. The mode of the finest
    // steps is taken.
    return select(difference <= Lanes(5.0F), Lanes(mode14),
                  select(difference <= Lanes(125.0F * 16.0F), Lanes(mode13),
                         select(difference <= Lanes(253.0F * 32.0F), Lanes(mode12), Lanes(mode11))));
  };
  to.mode = by_mode(11.0F, 12.0F, 13.0F, 14.0F);
  const Precision<is_signed> precision(by_mode(64.0F, 32.0F, 16.0F, 1.0F),
                                       by_mode(1.0F / 64.0F, 1.0F / 32.0F, 1.0F / 16.0F, 1.0F));
  for (int c = 0; c < 3; ++c) {
    const Lanes near_low = precision.stored(v_low[c]);
    const Lanes near_high = precision.stored(v_high[c]);
    const EndChoice best = best_pair(line, precision, v_low[c], v_high[c], near_low, precision.next(v_low[c], near_low),
                                     near_high, precision.next(v_high[c], near_high));
    to.ends.low[c] = best.low;
    to.ends.high[c] = best.high;
    low[c] = precision.meant(best.low);
    reach[c] = precision.meant(best.high) - low[c];
  }
}

template <bool is_signed>
WELKIN_INLINE SingleLine stored_line(const BlockLanes& block, const FittedLine& line) {
  SingleLine single;
  Lanes low[3];
  Lanes reach[3];
  store_ends<is_signed>(line, single, low, reach);
  Lanes from[3];
  Lanes to[3];
  for (int c = 0; c < 3; ++c) {
    from[c] = middle_of<is_signed>(low[c]);
    to[c] = middle_of<is_signed>(low[c] + reach[c]);
    low[c] = low[c] + Lanes(0.5F);
  }
  const AllTexels texels;
  single.projection = between<AllTexels>(from, to);
  single.error = Lanes(0.0F);
  for (int k = 0; k < kTexels; ++k) {
    const Lanes s = along<AllTexels>(index_at(block, texels, single.projection, k));
    Lanes square(0.0F);
    for (int c = 0; c < 3; ++c) {
      const Lanes off = decoded<is_signed>(low[c], reach[c], s) - block.value(k, c);
      square = square + off * off;
    }
    // Weights above 1, which are for brightness, serve the fit only. The error is the plain sum of squares, with texels
    // beyond the image's edge at their small weight.
    single.error = single.error + square * xsimd::min(block.weight(k), Lanes(1.0F));
  }
  return single;
}

/// The ten bits behind the first end's lowest ten: the other end, or its difference and the first end's upper bits, the
/// uppermost first.
WELKIN_INLINE Integers second_ten(Integers low, Integers high, Integers mode) {
  const auto bit = [&](int from, int to) WELKIN_INLINE_LAMBDA { return ((low >> from) & Integers(1)) << to; };
  const Integers difference = high - low;
  const Integers twelve = (difference & Integers(0x1FF)) | bit(10, 9);
  const Integers thirteen = (difference & Integers(0xFF)) | bit(11, 8) | bit(10, 9);
  const Integers fourteen =
      (difference & Integers(0xF)) | bit(15, 4) | bit(14, 5) | bit(13, 6) | bit(12, 7) | bit(11, 8) | bit(10, 9);
  return xsimd::select(
      mode == Integers(11), high & Integers(0x3FF),
      xsimd::select(mode == Integers(12), twelve, xsimd::select(mode == Integers(13), thirteen, fourteen)));
}

/// The words of a block: 5 bits of mode, six times ten of ends, and 63 of indices.
WELKIN_INLINE void pack(const BlockLanes& block, const SingleLine& single, std::int32_t* words) {
  const Integers mode = xsimd::to_int(single.mode);
  Integers first[3] = {Integers(0), Integers(0), Integers(0)};
  Integers second[3] = {Integers(0), Integers(0), Integers(0)};
  for (int c = 0; c < 3; ++c) {
    const Integers low = xsimd::to_int(single.ends.low[c]);
    first[c] = low & Integers(0x3FF);
    second[c] = second_ten(low, xsimd::to_int(single.ends.high[c]), mode);
  }
  const AllTexels texels;
  const auto index = [&](int k)
                         WELKIN_INLINE_LAMBDA { return xsimd::to_int(index_at(block, texels, single.projection, k)); };
  // Prefixes 0x03, 0x07, 0x0B and 0x0F. The first index has 3 bits and lies at bit 65, all others at 4 k + 64.
  const Integers prefix = ((mode - Integers(11)) << 2) | Integers(3);
  const Integers word0 = prefix | (first[0] << 5) | (first[1] << 15) | (first[2] << 25);
  const Integers word1 = (first[2] >> 7) | (second[0] << 3) | (second[1] << 13) | (second[2] << 23);
  Integers word2 = (second[2] >> 9) | (index(0) << 1);
  Integers word3 = index(8);
  for (int k = 1; k < 8; ++k) {
    word2 = word2 | (index(k) << (4 * k));
    word3 = word3 | (index(k + 8) << (4 * k));
  }
  word0.store_aligned(words);
  word1.store_aligned(words + kLanes);
  word2.store_aligned(words + 2 * kLanes);
  word3.store_aligned(words + 3 * kLanes);
}

WELKIN_INLINE void keep_better(const SingleLine& other, SingleLine& best) {
  const Mask better = other.error < best.error;
  best.error = select(better, other.error, best.error);
  best.mode = select(better, other.mode, best.mode);
  best.projection.offset = select(better, other.projection.offset, best.projection.offset);
  for (int c = 0; c < 3; ++c) {
    best.ends.low[c] = select(better, other.ends.low[c], best.ends.low[c]);
    best.ends.high[c] = select(better, other.ends.high[c], best.ends.high[c]);
    best.projection.direction[c] = select(better, other.projection.direction[c], best.projection.direction[c]);
  }
}

template <bool is_signed>
WELKIN_INLINE void single_lanes(const BlockLanes& block, bool refine, std::int32_t* words, float* errors) {
  const AllTexels texels;
  const Lanes largest(kLargestHalfBits);
  const Centre centre = centre_of(block, texels);
  const Projection projection = along_spread(block, texels, centre);
  SingleLine best = stored_line<is_signed>(block, least_squares(block, texels, centre, projection, largest, is_signed));
  if (refine) {
    keep_better(
        stored_line<is_signed>(block, least_squares(block, texels, centre, best.projection, largest, is_signed)), best);
  }
  pack(block, best, words);
  best.error.store_aligned(errors);
}

void single_lines(const BlockGroup& group, bool is_signed, bool refine, EncodedBlocks& blocks) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block{group.values[0] + lane, group.weights[0] + lane};
    if (is_signed) {
      single_lanes<true>(block, refine, blocks.words[0] + lane, blocks.errors + lane);
    } else {
      single_lanes<false>(block, refine, blocks.words[0] + lane, blocks.errors + lane);
    }
  }
}

void two_lines(const BlockGroup& group, bool is_signed, int tried, TwoLineBlocks& blocks) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    const BlockLanes block{group.values[0] + lane, group.weights[0] + lane};
    if (is_signed) {
      encode_pair<true>(block, tried, lane, blocks);
    } else {
      encode_pair<false>(block, tried, lane, blocks);
    }
  }
}

/// The value of a half's bits as a number.
template <bool is_signed>
WELKIN_INLINE Lanes value_of(Lanes number) {
  const Lanes bits = is_signed ? xsimd::abs(number) : number;
  // Ten bits of mantissa go to 23, and 127 - 15 = 112 is added to the exponent. Denormals are multiples of 2^-24.
  const auto normal = xsimd::bitwise_cast<Lanes>((xsimd::to_int(bits) << 13) + Integers(112 << 23));
  const Lanes value = select(bits < Lanes(1024.0F), bits * Lanes(0x1p-24F), normal);
  return is_signed ? select(number < Lanes(0.0F), Lanes(0.0F) - value, value) : value;
}

template <bool is_signed>
WELKIN_INLINE void try_lanes(EndTrials& trials, int lane) {
  const Lanes low = Lanes::load_aligned(trials.low + lane);
  const Lanes reach = Lanes::load_aligned(trials.high + lane) - low;
  const Lanes middle = low + Lanes(0.5F);
  Lanes squares(0.0F);
  Lanes light(0.0F);
  for (int k = 0; k < trials.texels; ++k) {
    const Lanes number = decoded<is_signed>(middle, reach, Lanes(trials.along[k]));
    const Lanes off = number - Lanes(trials.wanted[k]);
    squares = squares + off * off;
    light = light + value_of<is_signed>(number);
  }
  squares.store_aligned(trials.squares + lane);
  light.store_aligned(trials.light + lane);
}

void try_ends(EndTrials& trials, bool is_signed) {
  for (int lane = 0; lane < kLanes; lane += kWidth) {
    if (is_signed) {
      try_lanes<true>(trials, lane);
    } else {
      try_lanes<false>(trials, lane);
    }
  }
}

}  // namespace

const Bc6hKernels bc6h_kernels_table = {
    .load = load,
    .prepare = prepare,
    .single_lines = single_lines,
    .two_lines = two_lines,
    .try_ends = try_ends,
};

}  // namespace welkin::image::WELKIN_ISA
