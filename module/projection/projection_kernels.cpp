// From interleaved texels to planes of symmetry classes.
//
// Basis functions are even or odd in u and in v, so mirrored texels share their weights up to signs. With
// sums and differences taken first, four texels need one multiplication a basis function instead of four.
#include "projection/projection_kernels.h"

#include <type_traits>

#include "image/image_kernels.h"
#include "projection/lane_sums.h"
#include "simd/packed_texels.h"

namespace welkin::projection::WELKIN_ISA {
namespace {

using simd::DoubleLanes, simd::fetch_line, simd::kDoubleWidth, simd::kLanes, simd::kWidth, simd::Lanes, simd::load_rgb,
    simd::load_rgba, simd::Pair, simd::Rgb, simd::sum;

constexpr int kClassesOfQuadrants = 4;
constexpr int kClassesOfHalves = 2;

WELKIN_INLINE void store_quadrant_classes(const simd::Adder& adder, Lanes top_left, Lanes top_right, Lanes bottom_left,
                                          Lanes bottom_right, float* plane) {
  // Eight additions for four classes: sums and differences in u first, then those of them in v (a Hadamard matrix as a
  // product of two). Each texel counts with the sign of its mirror image in the class.
  const Lanes top_sum = adder.add(top_left, top_right);
  const Lanes top_difference = top_right - top_left;
  const Lanes bottom_sum = adder.add(bottom_left, bottom_right);
  const Lanes bottom_difference = bottom_right - bottom_left;
  adder.add(top_sum, bottom_sum).store_aligned(plane);
  (top_difference + bottom_difference).store_aligned(plane + kChunk);
  (bottom_sum - top_sum).store_aligned(plane + 2 * kChunk);
  (bottom_difference - top_difference).store_aligned(plane + 3 * kChunk);
}

/// Channel: float, std::uint16_t (binary16), std::uint8_t (of 255) or SrgbByte; channels: 3 or 4 in memory.
template <class Channel, int channels, bool reversed>
WELKIN_INLINE Rgb load_texels(const Channel* run, int texel) {
  if constexpr (std::is_same_v<Channel, SrgbByte>) {
    constexpr int step = reversed ? -channels : channels;
    const std::uint8_t* const first = &run[channels * (reversed ? texel + kWidth - 1 : texel)].value;
    const float* const table = image::kLinearFromSrgb.of;
    return {simd::look_up<step>(table, first), simd::look_up<step>(table, first + 1),
            simd::look_up<step>(table, first + 2)};
  } else if constexpr (std::is_same_v<Channel, float> && channels == 3) {
    return load_rgb<reversed>(run + 3 * texel);
  } else if constexpr (channels == 3) {
    return simd::load_packed_rgb<reversed>(run + 3 * texel);
  } else if constexpr (sizeof(Channel) == 1) {
    return simd::load_byte_rgba<reversed>(run + 4 * texel);
  } else {
    return load_rgba<reversed>(run + 4 * texel);
  }
}

/// One row of four mirrored runs.
template <class Channel>
struct RowPointers {
  WELKIN_INLINE RowPointers(const QuadrantRuns& runs, int row)
      : top_left(at(runs.top_left, row * runs.top_stride)),
        top_right(at(runs.top_right, row * runs.top_stride)),
        bottom_left(at(runs.bottom_left, row * runs.bottom_stride)),
        bottom_right(at(runs.bottom_right, row * runs.bottom_stride)) {}

  static WELKIN_INLINE const Channel* at(const void* first, std::ptrdiff_t offset) {
    return reinterpret_cast<const Channel*>(static_cast<const char*>(first) + offset);
  }

  const Channel* top_left;
  const Channel* top_right;
  const Channel* bottom_left;
  const Channel* bottom_right;
};

template <class Channel, int channels>
void fold_quadrants(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes) {
  const int count = groups * kLanes;
  const simd::Adder adder;
  for (int row = 0; row < runs.rows; ++row, planes += count) {
    const RowPointers<Channel> here(runs, row);
    for (int k = 0; k < count; k += kWidth) {
      const int mirrored = count - kWidth - k;
      if (ahead.lines > 0 && k % kLanes == 0) {
        const int line = row * groups + k / kLanes;
        for (const char* stretch : ahead.stretches) fetch_line(stretch, line);
      }
      const Rgb tl = load_texels<Channel, channels, false>(here.top_left, k);
      const Rgb tr = load_texels<Channel, channels, true>(here.top_right, mirrored);
      const Rgb bl = load_texels<Channel, channels, false>(here.bottom_left, k);
      const Rgb br = load_texels<Channel, channels, true>(here.bottom_right, mirrored);
      constexpr int channel_stride = kClassesOfQuadrants * kChunk;
      store_quadrant_classes(adder, tl.red, tr.red, bl.red, br.red, planes + k);
      store_quadrant_classes(adder, tl.green, tr.green, bl.green, br.green, planes + channel_stride + k);
      store_quadrant_classes(adder, tl.blue, tr.blue, bl.blue, br.blue, planes + 2 * channel_stride + k);
    }
  }
}

WELKIN_INLINE void store_half_classes(Lanes first, Lanes second, float* plane) {
  (first + second).store_aligned(plane);
  (first - second).store_aligned(plane + kChunk);
}

template <class Channel, int channels>
void fold_halves(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes) {
  for (int k = 0; k < groups * kLanes; k += kWidth) {
    if (ahead.lines > 0 && k % kLanes == 0) {
      for (const char* stretch : ahead.stretches) fetch_line(stretch, k / kLanes);
    }
    const Rgb a = load_texels<Channel, channels, false>(static_cast<const Channel*>(first), k);
    const Rgb b = load_texels<Channel, channels, false>(static_cast<const Channel*>(second), k);
    constexpr int channel_stride = kClassesOfHalves * kChunk;
    store_half_classes(a.red, b.red, planes + k);
    store_half_classes(a.green, b.green, planes + channel_stride + k);
    store_half_classes(a.blue, b.blue, planes + 2 * channel_stride + k);
  }
}

// Planes times weights, summed: the one loop that all projections share.

/// The running sums of `count` weights for three channels: registers named apart by recursion. (An array indexed in a
/// loop stays in memory with GCC 12: measured, the loop then takes twice as long.) Each weight is loaded once for all
/// channels.
template <int count>
struct RgbSums {
  Lanes red = Lanes(0.0F);  // braces would ask xsimd 8.1 for a list of lanes
  Lanes green = Lanes(0.0F);
  Lanes blue = Lanes(0.0F);
  RgbSums<count - 1> next;

  WELKIN_INLINE void add(const Rgb& values, const float* weights) {
    auto weight = Lanes::load_aligned(weights).data;
    WELKIN_IN_REGISTER(weight);
    red = red + values.red * Lanes(weight);
    green = green + values.green * Lanes(weight);
    blue = blue + values.blue * Lanes(weight);
    next.add(values, weights + kChunk);
  }
  /// To one part of a group's lanes, [count][3][kLanes].
  WELKIN_INLINE void store(float* lanes) const {
    red.store_aligned(lanes);
    green.store_aligned(lanes + kLanes);
    blue.store_aligned(lanes + 2 * kLanes);
    next.store(lanes + 3 * kLanes);
  }
};

template <>
struct RgbSums<0> {
  WELKIN_INLINE void add(const Rgb&, const float*) {}
  WELKIN_INLINE void store(float*) const {}
};

/// From [count][3][kLanes] to the sums of the first of `total` weights of each channel.
WELKIN_INLINE void add_to_sums(const float* lanes, int count, int total, double* sums) {
  for (int w = 0; w < count; ++w) {
    for (int c = 0; c < 3; ++c) {
      add_to_double_lanes(lanes + (3 * w + c) * kLanes, sums + (std::ptrdiff_t{c} * total + w) * kSumLanes);
    }
  }
}

/// The lines ahead that FoldQuadrants has left, prefetched a few at a time. (The last ones need time to arrive, so
/// the first two thirds of a chunk's products prefetch all.)
class LinesLeft {
 public:
  WELKIN_INLINE LinesLeft(const FetchAhead& ahead, int groups, int iterations)
      : ahead_(ahead), line_(groups), at_once_((3 * (ahead.lines - groups) + 2 * iterations - 1) / (2 * iterations)) {}

  WELKIN_INLINE void fetch() {
    // at_once_ = ceil(left / (2/3 iterations)), left being the lines that folding has not prefetched.
    for (const int end = line_ + at_once_; line_ < end && line_ < ahead_.lines; ++line_) {
      for (const char* stretch : ahead_.stretches) fetch_line(stretch, line_);
    }
  }

 private:
  const FetchAhead& ahead_;
  int line_;
  int at_once_;
};

/// `count` of a class's `total` weights, for three channels that lie `channel` floats apart. Narrow registers walk the
/// whole chunk once for each part of the group.
template <int count>
WELKIN_INLINE void sum_class(const float* plane, int channel, const float* weights, int groups, int total,
                             LinesLeft& ahead, double* sums) {
  alignas(64) float lanes[3 * count * kLanes];
  for (int part = 0; part < kLanes; part += kWidth) {
    RgbSums<count> class_sums;
    for (int k = part; k < groups * kLanes; k += kLanes) {
      if (part == 0) ahead.fetch();
      class_sums.add({Lanes::load_aligned(plane + k), Lanes::load_aligned(plane + channel + k),
                      Lanes::load_aligned(plane + 2 * channel + k)},
                     weights + k);
    }
    class_sums.store(lanes + part);
  }
  add_to_sums(lanes, count, total, sums);
}

/// Any number of weights, for three channels at once: class by class, as many at a time as have registers.
/// With 32 registers eight weights at a time have 24 sums, three values, a weight and a product; with 16, three weights
/// have 9 sums, three values, a weight and two products.
WELKIN_INLINE void sum_any(const float* planes, int class_count, const float* weights, const ClassCounts& counts,
                           int groups, const FetchAhead& ahead, double* sums) {
  const int total = counts.count[0] + counts.count[1] + counts.count[2] + counts.count[3];
  const int channel = class_count * kChunk;
  LinesLeft lines(ahead, groups, groups * class_count);
  for (int c = 0; c < class_count; ++c) {
    const float* const plane = planes + c * kChunk;
    const auto step = [&]<int count>() WELKIN_INLINE_LAMBDA {
      sum_class<count>(plane, channel, weights, groups, total, lines, sums);
      weights += count * kChunk;
      sums += count * kSumLanes;
    };
    int left = counts.count[c];
    if constexpr (kWidth == kLanes) {
      for (; left >= 8; left -= 8) step.template operator()<8>();
      for (; left >= 4; left -= 4) step.template operator()<4>();
    } else {
      for (; left > 4 || left == 3; left -= 3) step.template operator()<3>();  // 15 of 16 registers
    }
    for (; left >= 2; left -= 2) step.template operator()<2>();
    if (left == 1) step.template operator()<1>();
  }
}

/// The three channels in one pass, where a group is one register and all 27 sums have registers. (A pass for each
/// channel loads 39 registers for 54 multiplications and additions, and AVX-512 loads one of them in a cycle.)
template <int n0, int n1, int n2, int n3>
[[maybe_unused]] WELKIN_INLINE void sum_three_at_once(const float* planes, int class_count, const float* weights,
                                                      int groups, const FetchAhead& ahead, double* sums) {
  constexpr int total = n0 + n1 + n2 + n3;
  const int channel = class_count * kChunk;
  const auto load = [&](const float* plane) WELKIN_INLINE_LAMBDA {
    return Rgb{Lanes::load_aligned(plane), Lanes::load_aligned(plane + channel),
               Lanes::load_aligned(plane + 2 * channel)};
  };
  RgbSums<n0> class0;
  RgbSums<n1> class1;
  RgbSums<n2> class2;
  RgbSums<n3> class3;
  LinesLeft lines(ahead, groups, groups);
  for (int k = 0; k < groups * kLanes; k += kLanes) {
    lines.fetch();
    class0.add(load(planes + k), weights + k);
    class1.add(load(planes + kChunk + k), weights + n0 * kChunk + k);
    if constexpr (n2 > 0) class2.add(load(planes + 2 * kChunk + k), weights + (n0 + n1) * kChunk + k);
    if constexpr (n3 > 0) class3.add(load(planes + 3 * kChunk + k), weights + (n0 + n1 + n2) * kChunk + k);
  }
  alignas(64) float lanes[3 * total * kLanes];
  class0.store(lanes);
  class1.store(lanes + 3 * n0 * kLanes);
  class2.store(lanes + 3 * (n0 + n1) * kLanes);
  class3.store(lanes + 3 * (n0 + n1 + n2) * kLanes);
  add_to_sums(lanes, total, total, sums);
}

[[maybe_unused]] constexpr bool same(const ClassCounts& counts, int n0, int n1, int n2, int n3) {
  return counts.count[0] == n0 && counts.count[1] == n1 && counts.count[2] == n2 && counts.count[3] == n3;
}

void weighted_sums(const float* planes, int class_count, const float* weights, const ClassCounts& counts, int groups,
                   const FetchAhead& ahead, double* sums) {
  if constexpr (kWidth == kLanes) {
    if (same(counts, 4, 2, 2, 1)) {  // cubemap, three bands
      sum_three_at_once<4, 2, 2, 1>(planes, class_count, weights, groups, ahead, sums);
      return;
    }
    if (same(counts, 3, 2, 0, 0)) {  // lat-long, three bands
      sum_three_at_once<3, 2, 0, 0>(planes, class_count, weights, groups, ahead, sums);
      return;
    }
  }
  sum_any(planes, class_count, weights, counts, groups, ahead, sums);
}

void fold_sum_lanes(const double* lanes, int count, double* sums) {
  // Two lanes at a time is all that is left to do side by side; every build does it in these registers.
  for (int i = 0; i < count; ++i, lanes += kSumLanes) {
    // (0 + 4) + (2 + 6) in one half of the pair, (1 + 5) + (3 + 7) in the other: halves of 4, of 2, of 1.
    const Pair even = Pair::load_unaligned(lanes) + Pair::load_unaligned(lanes + 4);
    const Pair odd = Pair::load_unaligned(lanes + 2) + Pair::load_unaligned(lanes + 6);
    sums[i] = sum(even + odd);
  }
}

// Checks of a row of values.

bool any_outside(const float* values, int count, float low, float high) {
  // A comparison with NaN is false, so "not inside" catches it.
  int k = 0;
  xsimd::batch_bool<float, Lanes::arch_type> inside(true);
  for (; k + kWidth <= count; k += kWidth) {
    const Lanes here = Lanes::load_unaligned(values + k);
    inside = inside & (here >= Lanes(low)) & (here <= Lanes(high));
  }
  bool outside = !xsimd::all(inside);
  for (; k < count; ++k) outside |= !(values[k] >= low && values[k] <= high);
  return outside;
}

RowMeasure measure_row(const float* values, int count) {
  constexpr int kRegisters = kLanes / kWidth;
  Lanes sum[kRegisters];
  Lanes least[kRegisters];
  Lanes largest[kRegisters];
  Lanes odd[kRegisters];  // 0 as long as all values are finite, else NaN
  for (int k = 0; k < kRegisters; ++k) {
    sum[k] = odd[k] = Lanes(0.0F);
    least[k] = Lanes(3.402823466e38F);
    largest[k] = Lanes(-3.402823466e38F);
  }
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (int k = 0; k < kRegisters; ++k) {
      const Lanes value = Lanes::load_unaligned(values + i + k * kWidth);
      sum[k] = sum[k] + value;
      least[k] = xsimd::min(least[k], value);
      largest[k] = xsimd::max(largest[k], value);
      // 0 x is 0 for finite x, and NaN for NaN and infinities; a sum keeps a NaN. So one product and one sum take the
      // place of a comparison and a branch for each value.
      odd[k] = odd[k] + value * Lanes(0.0F);
    }
  }
  alignas(64) float lanes[4][kLanes];
  for (int k = 0; k < kRegisters; ++k) {
    sum[k].store_aligned(lanes[0] + k * kWidth);
    least[k].store_aligned(lanes[1] + k * kWidth);
    largest[k].store_aligned(lanes[2] + k * kWidth);
    odd[k].store_aligned(lanes[3] + k * kWidth);
  }
  for (int half = kLanes / 2; half > 0; half /= 2) {
    for (int k = 0; k < half; ++k) {
      lanes[0][k] += lanes[0][k + half];
      lanes[1][k] = lanes[1][k + half] < lanes[1][k] ? lanes[1][k + half] : lanes[1][k];
      lanes[2][k] = lanes[2][k + half] > lanes[2][k] ? lanes[2][k + half] : lanes[2][k];
      lanes[3][k] += lanes[3][k + half];
    }
  }
  RowMeasure measure{lanes[0][0], lanes[1][0], lanes[2][0], true};
  float not_a_number = lanes[3][0];
  for (; i < count; ++i) {
    measure.sum += values[i];
    if (values[i] < measure.least) measure.least = values[i];
    if (values[i] > measure.largest) measure.largest = values[i];
    not_a_number += values[i] * 0.0F;
  }
  measure.finite = not_a_number == 0.0F;
  return measure;
}

// Harmonics summed at many directions.

WELKIN_INLINE DoubleLanes points(double start, double step, DoubleLanes u) {
  return DoubleLanes(start) + DoubleLanes(step) * u;
}

void evaluate_harmonics(const DirectionRun& run, const math::BasisRecurrence& recurrence, const double* coefficients,
                        int bands, float* rgb) {
  const double* const red = coefficients;
  const double* const green = red + bands * bands;
  const double* const blue = green + bands * bands;
  for (int first = 0; first < run.count; first += kDoubleWidth) {
    const int part = run.count - first < kDoubleWidth ? run.count - first : kDoubleWidth;
    alignas(64) double lanes[3][kDoubleWidth] = {};
    for (int k = 0; k < part; ++k) lanes[0][k] = run.u[first + k];
    for (int k = part; k < kDoubleWidth; ++k) lanes[0][k] = run.u[first];
    const DoubleLanes u = DoubleLanes::load_aligned(lanes[0]);
    const DoubleLanes x = points(run.start[0], run.step[0], u);
    const DoubleLanes y = points(run.start[1], run.step[1], u);
    const DoubleLanes z = points(run.start[2], run.step[2], u);
    // The basis is a polynomial of a unit direction: normalize once per point. Lanes beyond `count` repeat the first
    // point, so that none divides by 0.
    const DoubleLanes scale = DoubleLanes(1.0) / xsimd::sqrt(x * x + y * y + z * z);
    DoubleLanes sums[3] = {DoubleLanes(0.0), DoubleLanes(0.0), DoubleLanes(0.0)};
    math::for_each_basis_value(recurrence, x * scale, y * scale, z * scale, DoubleLanes(1.0), bands,
                               [&](int index, DoubleLanes value) WELKIN_INLINE_LAMBDA {
                                 sums[0] = sums[0] + DoubleLanes(red[index]) * value;
                                 sums[1] = sums[1] + DoubleLanes(green[index]) * value;
                                 sums[2] = sums[2] + DoubleLanes(blue[index]) * value;
                               });
    for (int c = 0; c < 3; ++c) sums[c].store_aligned(lanes[c]);
    for (int k = 0; k < part; ++k) {
      for (int c = 0; c < 3; ++c) rgb[3 * (first + k) + c] = static_cast<float>(lanes[c][k]);
    }
  }
}

}  // namespace

const ProjectionKernels projection_kernels_table = {
    .fold_quadrants = {fold_quadrants<float, 3>, fold_quadrants<float, 4>, fold_quadrants<std::uint16_t, 4>,
                       folds(fold_rgb16f) ? fold_quadrants<std::uint16_t, 3> : nullptr,
                       folds(fold_rgb8) ? fold_quadrants<std::uint8_t, 3> : nullptr,
                       folds(fold_rgba8) ? fold_quadrants<std::uint8_t, 4> : nullptr,
                       folds(fold_srgb8) ? fold_quadrants<SrgbByte, 3> : nullptr,
                       folds(fold_srgba8) ? fold_quadrants<SrgbByte, 4> : nullptr},
    .fold_halves = {fold_halves<float, 3>, fold_halves<float, 4>, fold_halves<std::uint16_t, 4>,
                    folds(fold_rgb16f) ? fold_halves<std::uint16_t, 3> : nullptr,
                    folds(fold_rgb8) ? fold_halves<std::uint8_t, 3> : nullptr,
                    folds(fold_rgba8) ? fold_halves<std::uint8_t, 4> : nullptr,
                    folds(fold_srgb8) ? fold_halves<SrgbByte, 3> : nullptr,
                    folds(fold_srgba8) ? fold_halves<SrgbByte, 4> : nullptr},
    .weighted_sums = weighted_sums,
    .fold_sum_lanes = fold_sum_lanes,
    .evaluate_harmonics = evaluate_harmonics,
    .any_outside = any_outside,
    .measure_row = measure_row,
};

}  // namespace welkin::projection::WELKIN_ISA
