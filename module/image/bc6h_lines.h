// Lines through the texels of a block, one block in each lane: fitted, rounded to what a block can store, and looked at
// for what they leave out. Only for kernel sources.
//
// BC6H computes in the halves' bits as numbers h, which is nearly a logarithm (UASTC HDR in ASTC's own). A decoder
// works on v of 16 bits and ends with h = floor(31 v / 64) (signed: 31 v / 32, towards 0); so v = (64 h + 32) / 31 is
// the middle of what becomes h. Every number of the decoder is a whole one below 2^24 or a whole number of 64ths below
// 2^17, which floats hold exactly: errors are exact.
#pragma once

#include "simd/vec.h"

namespace welkin::image::WELKIN_ISA {

using simd::Integers, simd::kLanes, simd::kWidth, simd::Lanes;
using Mask = xsimd::batch_bool<float, Lanes::arch_type>;

inline constexpr int kTexels = 16;
inline constexpr float kBig = 1.0e30F;

WELKIN_INLINE Lanes truncated(Lanes a) { return xsimd::to_float(xsimd::to_int(a)); }
WELKIN_INLINE Lanes clamped(Lanes a, Lanes low, Lanes high) { return xsimd::min(xsimd::max(a, low), high); }
WELKIN_INLINE Lanes select(Mask mask, Lanes a, Lanes b) { return xsimd::select(mask, a, b); }

/// The lanes of one register of a group of blocks.
struct BlockLanes {
  const float* values;   ///< [48], kLanes floats apart
  const float* weights;  ///< [16], kLanes floats apart

  [[nodiscard]] WELKIN_INLINE Lanes value(int texel, int channel) const {
    return Lanes::load_aligned(values + (3 * texel + channel) * kLanes);
  }
  [[nodiscard]] WELKIN_INLINE Lanes weight(int texel) const { return Lanes::load_aligned(weights + texel * kLanes); }
};

/// The texels of one line: all of a block's. Those of one side of a partition are `SideTexels`, which has members.
// NOLINTBEGIN(readability-convert-member-functions-to-static)
struct AllTexels {
  static constexpr float steps = 15.0F;  ///< the largest index
  static constexpr float anchor_limit = 7.0F;

  [[nodiscard]] WELKIN_INLINE Lanes share(int /*texel*/, Lanes weight) const { return weight; }
  [[nodiscard]] WELKIN_INLINE Lanes inside(int /*texel*/, Lanes value, Lanes /*otherwise*/) const { return value; }
  /// The value of the texel whose index has a bit less.
  template <class ValueOf>
  [[nodiscard]] WELKIN_INLINE Lanes at_anchor(const ValueOf& value) const {
    return value(0);
  }
  [[nodiscard]] WELKIN_INLINE Lanes largest_index(int texel) const { return Lanes(texel == 0 ? anchor_limit : steps); }
  /// Returns the decoder's weight of an index, in 64ths.
  static WELKIN_INLINE Lanes weight_of(Lanes index) { return truncated(index * Lanes(4.25F) + Lanes(0.5F)); }
};
// NOLINTEND(readability-convert-member-functions-to-static)

/// The projection of a fit: h . direction + offset is the index of a texel h, not yet a whole number.
struct Projection {
  Lanes direction[3];
  Lanes offset;

  [[nodiscard]] WELKIN_INLINE Lanes at(const BlockLanes& block, int texel) const {
    return block.value(texel, 0) * direction[0] + block.value(texel, 1) * direction[1] +
           (block.value(texel, 2) * direction[2] + offset);
  }
};

/// Two ends, and how a change of both changes the sum of squares: a low^2 + 2 b low high + c high^2.
struct FittedLine {
  Lanes low[3], high[3];
  Lanes a, b, c;
};

/// Mean and weight of a line's texels.
struct Centre {
  Lanes weight;
  Lanes mean[3];
};

template <class Texels>
WELKIN_INLINE Centre centre_of(const BlockLanes& block, const Texels& texels) {
  Centre centre{Lanes(0.0F), {Lanes(0.0F), Lanes(0.0F), Lanes(0.0F)}};
  for (int k = 0; k < kTexels; ++k) {
    const Lanes weight = texels.share(k, block.weight(k));
    centre.weight = centre.weight + weight;
    for (int c = 0; c < 3; ++c) centre.mean[c] = centre.mean[c] + weight * block.value(k, c);
  }
  const Lanes inverse = Lanes(1.0F) / centre.weight;
  for (int c = 0; c < 3; ++c) centre.mean[c] = centre.mean[c] * inverse;
  return centre;
}

/// The direction in which the texels spread most: the covariance's largest eigenvector, by three multiplications with
/// it from the column of its largest diagonal element on. Its length is arbitrary, and 0 if all texels are equal.
template <class Texels>
WELKIN_INLINE void principal_axis(const BlockLanes& block, const Texels& texels, const Centre& centre,
                                  Lanes (&axis)[3]) {
  Lanes rr(0.0F), rg(0.0F), rb(0.0F), gg(0.0F), gb(0.0F), bb(0.0F);
  for (int k = 0; k < kTexels; ++k) {
    const Lanes weight = texels.share(k, block.weight(k));
    const Lanes r = block.value(k, 0) - centre.mean[0];
    const Lanes g = block.value(k, 1) - centre.mean[1];
    const Lanes b = block.value(k, 2) - centre.mean[2];
    const Lanes wr = weight * r;
    const Lanes wg = weight * g;
    rr = rr + wr * r;
    rg = rg + wr * g;
    rb = rb + wr * b;
    gg = gg + wg * g;
    gb = gb + wg * b;
    bb = bb + weight * b * b;
  }
  // Over its trace: the largest eigenvalue is then from 1/3 to 1, and the products of four matrices, of values up to
  // 3e4, stay within a float. Each multiplication takes the share of the second axis down by the quotient of the
  // eigenvalues.
  const Lanes scale = Lanes(1.0F) / (rr + gg + bb + Lanes(1.0e-20F));
  for (Lanes* const entry : {&rr, &rg, &rb, &gg, &gb, &bb}) *entry = *entry * scale;
  // The column of the largest diagonal element is the matrix times that axis: it is 0 only if the whole matrix is, for
  // |n_ij| <= sqrt(n_ii n_jj), and it has a part along the first eigenvector unless that is orthogonal to the axis in
  // which texels spread most.
  const Mask red = (rr >= gg) & (rr >= bb);
  const Mask green = gg >= bb;
  axis[0] = select(red, rr, select(green, rg, rb));
  axis[1] = select(red, rg, select(green, gg, gb));
  axis[2] = select(red, rb, select(green, gb, bb));
  for (int turn = 0; turn < 3; ++turn) {
    const Lanes r = rr * axis[0] + rg * axis[1] + rb * axis[2];
    const Lanes g = rg * axis[0] + gg * axis[1] + gb * axis[2];
    const Lanes b = rb * axis[0] + gb * axis[1] + bb * axis[2];
    axis[0] = r;
    axis[1] = g;
    axis[2] = b;
  }
}

/// Returns the projection to indices along the axis, the outermost texels at the ends, the anchor in the lower half.
template <class Texels>
WELKIN_INLINE Projection along_axis(const BlockLanes& block, const Texels& texels, const Lanes (&axis)[3]) {
  const Projection plain{{axis[0], axis[1], axis[2]}, Lanes(0.0F)};
  Lanes least(kBig);
  Lanes most(-kBig);
  for (int k = 0; k < kTexels; ++k) {
    const Lanes position = plain.at(block, k);
    least = xsimd::min(least, texels.inside(k, position, Lanes(kBig)));
    most = xsimd::max(most, texels.inside(k, position, Lanes(-kBig)));
  }
  const Lanes anchor = texels.at_anchor([&](int k) WELKIN_INLINE_LAMBDA { return plain.at(block, k); });
  // The index is the rounded position from `first` on, in steps; index_at truncates, hence the 1/2. If the anchor is in
  // the upper half, the ends are exchanged (its index must not have the upper bit).
  const Lanes range = most - least;
  const Mask turned = anchor - least > most - anchor;
  const Lanes size = select(range > Lanes(0.0F), Lanes(Texels::steps) / range, Lanes(0.0F));
  const Lanes scale = select(turned, Lanes(0.0F) - size, size);
  const Lanes first = select(turned, most, least);
  return {{axis[0] * scale, axis[1] * scale, axis[2] * scale}, Lanes(0.5F) - first * scale};
}

/// The projection that a fit begins with, along the direction in which the texels spread most.
template <class Texels>
WELKIN_INLINE Projection along_spread(const BlockLanes& block, const Texels& texels, const Centre& centre) {
  Lanes axis[3];
  principal_axis(block, texels, centre, axis);
  return along_axis(block, texels, axis);
}

template <class Texels>
WELKIN_INLINE Lanes index_at(const BlockLanes& block, const Texels& texels, const Projection& projection, int texel) {
  return truncated(clamped(projection.at(block, texel), Lanes(0.0F), texels.largest_index(texel) + Lanes(0.5F)));
}

/// Returns the decoder's weight of an index, 0 to 1: whole 64ths.
template <class Texels>
WELKIN_INLINE Lanes along(Lanes index) {
  return Texels::weight_of(index) * Lanes(1.0F / 64.0F);
}

/// The ends whose line is nearest to the texels if they keep the indices that the projection gives them. With s along
/// the line, p = w s and d = texel - mean: sums of p d say all, as those of (w - p) d are their opposites.
template <class Texels>
WELKIN_INLINE FittedLine least_squares(const BlockLanes& block, const Texels& texels, const Centre& centre,
                                       const Projection& projection, Lanes largest, bool is_signed) {
  Lanes sum_p(0.0F), sum_ps(0.0F), red(0.0F), green(0.0F), blue(0.0F);
  for (int k = 0; k < kTexels; ++k) {
    const Lanes s = along<Texels>(index_at(block, texels, projection, k));
    const Lanes p = texels.share(k, block.weight(k)) * s;
    sum_p = sum_p + p;
    sum_ps = sum_ps + p * s;
    red = red + p * (block.value(k, 0) - centre.mean[0]);
    green = green + p * (block.value(k, 1) - centre.mean[1]);
    blue = blue + p * (block.value(k, 2) - centre.mean[2]);
  }
  // Minimizes sum w ((1 - s) low + s high - d)^2, d from the mean. With
  //   a = sum w (1 - s)^2,   b = sum w s (1 - s),   c = sum w s^2,   R = sum w s d = -sum w (1 - s) d
  // the normal equations are a low + b high = -R and b low + c high = R. Their solution is
  //   low = -(b + c) R / det,   high = (a + b) R / det,   b + c = sum_p,   a + b = W - sum_p.
  // det = a c - b^2 is W^2 times the weighted variance of s: below 1e-6 of W^2 all texels have one index, and both ends
  // are the mean.
  FittedLine line;
  line.c = sum_ps;
  line.b = sum_p - sum_ps;
  line.a = centre.weight - sum_p - line.b;
  const Lanes determinant = line.a * line.c - line.b * line.b;
  const Mask good = determinant > Lanes(1.0e-6F) * centre.weight * centre.weight;
  const Lanes inverse = select(good, Lanes(1.0F) / select(good, determinant, Lanes(1.0F)), Lanes(0.0F));
  const Lanes low = sum_p * inverse;
  const Lanes high = (centre.weight - sum_p) * inverse;
  const Lanes least = is_signed ? Lanes(0.0F) - largest : Lanes(0.0F);
  const Lanes sums[3] = {red, green, blue};
  for (int c = 0; c < 3; ++c) {
    line.low[c] = clamped(centre.mean[c] - sums[c] * low, least, largest);
    line.high[c] = clamped(centre.mean[c] + sums[c] * high, least, largest);
  }
  return line;
}

/// How ends are stored: with p bits, a step of 2^(16 - p) in v.
template <bool is_signed>
struct Precision {
  Lanes step, inverse;
  Lanes half_step;  ///< what a stored number stands for lies so far above it: 0 with 16 bits
  Lanes rounding;   ///< what is added before truncation
  Lanes largest;    ///< stored number

  /// 2^(16 - bits)
  WELKIN_INLINE Precision(Lanes step_of, Lanes inverse_of)
      : step(step_of),
        inverse(inverse_of),
        half_step(select(step_of > Lanes(1.0F), step_of * Lanes(0.5F), Lanes(0.0F))),
        // A stored n of fewer than 16 bits means the middle of n step to (n + 1) step, so truncation finds the nearest;
        // with 16 bits n means itself, and 1/2 is added before.
        rounding(select(step_of > Lanes(1.0F), Lanes(0.0F), Lanes(0.5F))),
        largest(Lanes(is_signed ? 32768.0F : 65536.0F) * inverse_of - Lanes(1.0F)) {}

  [[nodiscard]] WELKIN_INLINE Lanes stored(Lanes v) const {
    if constexpr (is_signed) {
      const Lanes number = xsimd::min(truncated(xsimd::abs(v) * inverse + rounding), largest);
      return select(v < Lanes(0.0F), Lanes(0.0F) - number, number);
    } else {
      return xsimd::min(truncated(v * inverse + rounding), largest);
    }
  }

  [[nodiscard]] WELKIN_INLINE Lanes meant(Lanes number) const {
    if constexpr (is_signed) {
      const Lanes size = xsimd::abs(number);
      const Lanes middle = select(size >= largest, Lanes(32767.0F), size * step + half_step);
      const Lanes v = select(size > Lanes(0.0F), middle, Lanes(0.0F));
      return select(number < Lanes(0.0F), Lanes(0.0F) - v, v);
    } else {
      const Lanes middle = select(number >= largest, Lanes(65535.0F), number * step + half_step);
      return select(number > Lanes(0.0F), middle, Lanes(0.0F));
    }
  }

  /// The stored number on the other side of v.
  [[nodiscard]] WELKIN_INLINE Lanes next(Lanes v, Lanes number) const {
    const Lanes other = number + select(v > meant(number), Lanes(1.0F), Lanes(-1.0F));
    return clamped(other, is_signed ? Lanes(0.0F) - largest : Lanes(0.0F), largest);
  }
};

/// v of h.
template <bool is_signed>
WELKIN_INLINE Lanes decoders_number(Lanes h) {
  if constexpr (is_signed) {
    const Lanes size = xsimd::min(xsimd::abs(h) * Lanes(32.0F / 31.0F) + Lanes(16.0F / 31.0F), Lanes(32767.0F));
    return select(h < Lanes(0.0F), Lanes(0.0F) - size, size);
  } else {
    return xsimd::min(h * Lanes(64.0F / 31.0F) + Lanes(32.0F / 31.0F), Lanes(65535.0F));
  }
}

/// h of v, not rounded: where texels lie along decoded ends.
template <bool is_signed>
WELKIN_INLINE Lanes middle_of(Lanes v) {
  if constexpr (is_signed) return v * Lanes(31.0F / 32.0F);
  return v * Lanes(31.0F / 64.0F) - Lanes(0.5F);
}

/// A half between two ends as the decoder computes it, exactly. `middle` = low + 1/2, `reach` = high - low.
template <bool is_signed>
WELKIN_INLINE Lanes decoded(Lanes middle, Lanes reach, Lanes s) {
  // floor((low (64 - w) + high w + 32) / 64) = floor(low + 1/2 + (high - low) w / 64).
  const Lanes exact = middle + reach * s;
  if constexpr (is_signed) {
    const Lanes towards_zero = truncated(exact);
    const Lanes v = towards_zero - select(towards_zero > exact, Lanes(1.0F), Lanes(0.0F));
    return truncated(v * Lanes(31.0F / 32.0F));
  } else {
    return truncated(truncated(exact) * Lanes(31.0F / 64.0F));
  }
}

/// Ends as a block stores them, and what they mean.
struct StoredLine {
  Lanes low[3], high[3];
};

/// The projection whose index is 0 at one end and the largest at the other.
template <class Texels>
WELKIN_INLINE Projection between(const Lanes (&low)[3], const Lanes (&high)[3]) {
  Lanes reach[3];
  for (int c = 0; c < 3; ++c) reach[c] = high[c] - low[c];
  // index = steps (h - low) . reach / |reach|^2 + 1/2, truncated later. Equal ends give index 0.
  const Lanes square = reach[0] * reach[0] + reach[1] * reach[1] + reach[2] * reach[2];
  const Lanes scale = select(square > Lanes(0.0F),
                             Lanes(Texels::steps) / select(square > Lanes(0.0F), square, Lanes(1.0F)), Lanes(0.0F));
  Projection projection;
  for (int c = 0; c < 3; ++c) projection.direction[c] = reach[c] * scale;
  projection.offset = Lanes(0.5F) - (low[0] * projection.direction[0] + low[1] * projection.direction[1] +
                                     low[2] * projection.direction[2]);
  return projection;
}

/// Numbers for the two ends of a channel: of the nearest and the next for each, the pair whose sum of squares is least.
struct EndChoice {
  Lanes low, high;
};

template <bool is_signed>
WELKIN_INLINE EndChoice best_pair(const FittedLine& line, const Precision<is_signed>& precision, Lanes low, Lanes high,
                                  Lanes first_low, Lanes next_low, Lanes first_high, Lanes next_high) {
  const Lanes lows[2] = {first_low, next_low};
  const Lanes highs[2] = {first_high, next_high};
  EndChoice best{first_low, first_high};
  Lanes least(kBig);
  for (int i = 0; i < 2; ++i) {
    const Lanes off_low = precision.meant(lows[i]) - low;
    // The fitted ends have the least sum of squares, where its gradient is 0, and the sum is quadratic: moving the ends
    // by off_low and off_high adds a off_low^2 + 2 b off_low off_high + c off_high^2. The mixed term is why the nearest
    // numbers need not be the best ones.
    const Lanes of_low = line.a * off_low * off_low;
    const Lanes twice = Lanes(2.0F) * line.b * off_low;
    for (int j = 0; j < 2; ++j) {
      const Lanes off_high = precision.meant(highs[j]) - high;
      const Lanes error = of_low + off_high * (twice + line.c * off_high);
      const Mask better = error < least;
      least = select(better, error, least);
      best.low = select(better, lows[i], best.low);
      best.high = select(better, highs[j], best.high);
    }
  }
  return best;
}

}  // namespace welkin::image::WELKIN_ISA
