// Rows of pixels to moments, and moments times weights to sums.
#include "projection/strip_kernels.h"

#include <cstdint>
#include <type_traits>

#include "image/image_kernels.h"
#include "projection/lane_sums.h"
#include "projection/projection_kernels.h"
#include "simd/packed_texels.h"

namespace welkin::projection::WELKIN_ISA {
namespace {

using simd::Adder, simd::kLanes, simd::kWidth, simd::Lanes, simd::load_rgb, simd::Rgb;

// Rows to moments.

constexpr int kPairs = kStripRows / 2;

constexpr int binomial(int n, int k) {
  if (k < 0 || k > n) return 0;
  int result = 1;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}
// The two polynomials of strip_kernels.h. B(i + j, 2 j) is 0 for i < j: the inner rows have no part in the higher
// moments, and `add` leaves these terms out.
constexpr int even_factor(int j, int i) { return binomial(i + j, 2 * j); }
constexpr int odd_factor(int j, int i) { return (2 * i + 1) * binomial(i + j, 2 * j) / (2 * j + 1); }

/// The moments from the k-th on of one column of registers, named apart by recursion: an array indexed in a loop stays
/// in memory with GCC 12.
template <int k, int moments>
struct Column {
  Lanes here;
  Column<k + 1, moments> next;

  /// Adds the i-th pair of rows from the middle, whose sum and difference are given; or begins with it.
  template <int i, bool begins>
  WELKIN_INLINE void add(const Adder& adder, Lanes sum, Lanes difference) {
    constexpr int factor = k % 2 == 0 ? even_factor(k / 2, i) : odd_factor(k / 2, i);
    if constexpr (begins) {
      here = (k % 2 == 0 ? sum : difference) * Lanes(static_cast<float>(factor));
    } else if constexpr (factor == 1) {
      here = adder.add(k % 2 == 0 ? sum : difference, here);
    } else if constexpr (factor != 0) {
      here = here + (k % 2 == 0 ? sum : difference) * Lanes(static_cast<float>(factor));
    }
    next.template add<i, begins>(adder, sum, difference);
  }
  WELKIN_INLINE void load(const float* from, int stride) {
    here = Lanes::load_aligned(from);
    next.load(from + stride, stride);
  }
  WELKIN_INLINE void store(float* to, int stride) const {
    here.store_aligned(to);
    next.store(to + stride, stride);
  }
  WELKIN_INLINE void store_without_fourth(float* to, int stride) const {
    simd::store_without_fourth(here, to);
    next.store_without_fourth(to + stride, stride);
  }
};

template <int moments>
struct Column<moments, moments> {
  template <int, bool>
  WELKIN_INLINE void add(const Adder&, Lanes, Lanes) {}
  WELKIN_INLINE void load(const float*, int) {}
  WELKIN_INLINE void store(float*, int) const {}
  WELKIN_INLINE void store_without_fourth(float*, int) const {}
};

template <class Channel, int channels>
WELKIN_INLINE Lanes load_values(const char* at) {
  if constexpr (std::is_same_v<Channel, SrgbByte>) {
    return simd::look_up<1, channels == 4>(image::kLinearFromSrgb.of, reinterpret_cast<const std::uint8_t*>(at));
  } else {
    return Lanes(simd::detail::load(reinterpret_cast<const Channel*>(at)));
  }
}

/// Pairs of rows end - 1 to begin, the outermost first.
template <class Channel, int channels, int moments, int begin, int end, bool begins>
WELKIN_INLINE void add_pairs(const char* middle, std::ptrdiff_t stride, const Adder& adder,
                             Column<0, moments>& column) {
  if constexpr (begin < end) {
    constexpr int i = end - 1;
    // x = +-(i + 1/2): an even polynomial meets the sum of the pair, an odd one below - above. `adder` is the same
    // addition on another unit, with AVX-512 a fused multiplication by 1; a quarter of the sums take it.
    const Lanes below = load_values<Channel, channels>(middle + i * stride);
    const Lanes above = load_values<Channel, channels>(middle - (i + 1) * stride);
    column.template add<i, begins>(adder, i % 4 == 0 ? adder.add(below, above) : below + above, below - above);
    add_pairs<Channel, channels, moments, begin, end - 1, false>(middle, stride, adder, column);
  }
}

/// moments[k][3 t + c] = the k-th moment of channel c of column t, t < `texels`, added up from the outer rows to the
/// inner ones. Eight rows at a time: 16 would be too many for a processor to see which it reads next, and where rows
/// are whole pages apart they come to the same eight lines of a first-level cache. (Measured on Zen 3 at 1024 and 2048:
/// 16 at a time take 8 to 13 % longer, 4 at a time 6 to 11 %, and asking for lines ahead gains nothing.)
template <class Channel, int channels, int moments>
WELKIN_INLINE_UNLESS_SENT void sum_columns(const StripRows& rows, int first, int texels, float* outer, float* out) {
  const Adder adder;
  constexpr auto kBytes = static_cast<std::ptrdiff_t>(sizeof(Channel));
  constexpr int kOuterStride = channels * strip_block(moments);
  const char* const middle = static_cast<const char*>(rows.first) + kPairs * rows.stride + channels * first * kBytes;
  for (int k = 0; k < channels * texels; k += kWidth) {
    Column<0, moments> column;
    add_pairs<Channel, channels, moments, kPairs / 2, kPairs, true>(middle + k * kBytes, rows.stride, adder, column);
    column.store(outer + k, kOuterStride);
  }
  for (int k = 0; k < channels * texels; k += kWidth) {
    Column<0, moments> column;
    column.load(outer + k, kOuterStride);
    add_pairs<Channel, channels, moments, 0, kPairs / 2, false>(middle + k * kBytes, rows.stride, adder, column);
    if constexpr (channels == 3) {
      column.store(out + k, moment_stride(moments));
    } else {
      column.store_without_fourth(out + k / 4 * 3, moment_stride(moments));
    }
  }
}

/// Does so from the last column to the first.
template <class Channel, int channels, int moments>
WELKIN_INLINE void sum_columns_reversed(const StripRows& rows, int first, int texels, float* scratch, float* out) {
  float* const sums = scratch;
  sum_columns<Channel, channels, moments>(rows, first, texels, scratch + moments * moment_stride(moments), sums);
  for (int m = 0; m < moments * moment_stride(moments); m += moment_stride(moments)) {
    for (int k = 0; k < texels; k += kLanes) simd::reverse_rgb(sums + m + 3 * k, out + m + 3 * (texels - kLanes - k));
  }
}

// Moments times weights.

// Moments stay packed, r g b r g b ..., and each weight is stored three times in a row, once per channel: 48 floats of
// 16 texels are whole registers of either, and nothing is shuffled before the end (`add_group_to_sums`).
constexpr int kGroup = 3 * kLanes;  ///< floats of 16 texels

struct Classes {
  Lanes ee, oe, eo, oo;
};

WELKIN_INLINE Classes classes_of(const Adder& adder, Lanes top_left, Lanes top_right, Lanes bottom_left,
                                 Lanes bottom_right) {
  const Lanes top_sum = adder.add(top_left, top_right);
  const Lanes top_difference = top_right - top_left;
  const Lanes bottom_sum = adder.add(bottom_left, bottom_right);
  const Lanes bottom_difference = bottom_right - bottom_left;
  return {adder.add(top_sum, bottom_sum), adder.add(top_difference, bottom_difference), bottom_sum - top_sum,
          bottom_difference - top_difference};
}

/// The moments of the four pieces, `piece` floats apart.
WELKIN_INLINE Classes load_classes(const Adder& adder, const float* at, int piece) {
  return classes_of(adder, Lanes::load_aligned(at), Lanes::load_aligned(at + piece),
                    Lanes::load_aligned(at + 2 * piece), Lanes::load_aligned(at + 3 * piece));
}

/// The running sums of functions f to 8 in one register of a group's columns.
template <int f>
struct FunctionSums {
  Lanes here;
  FunctionSums<f + 1> next;

  WELKIN_INLINE void add(const Classes& classes, const float* weights) {
    // Three bands have 4, 2, 2 and 1 functions that are (even, even), (odd, even), (even, odd) and (odd, odd) in
    // (u, v): see `symmetry_class` in texel_weights.cpp.
    const Lanes value = f < 4 ? classes.ee : f < 6 ? classes.oe : f < 8 ? classes.eo : classes.oo;
    here = here + value * Lanes::load_aligned(weights);
    next.add(classes, weights + kGroup);
  }
  WELKIN_INLINE void load(const float* lanes) {
    here = Lanes::load_aligned(lanes);
    next.load(lanes + kGroup);
  }
  WELKIN_INLINE void store(float* lanes) const {
    here.store_aligned(lanes);
    next.store(lanes + kGroup);
  }
};

template <>
struct FunctionSums<kStripFunctions> {
  WELKIN_INLINE void add(const Classes&, const float*) {}
  WELKIN_INLINE void load(const float*) {}
  WELKIN_INLINE void store(float*) const {}
};

/// lanes[9][48] += a block's moments times their weights.
template <int moments>
WELKIN_INLINE_UNLESS_SENT void add_products(const float* pieces, int groups, const float* weights, float* lanes) {
  const Adder adder;
  for (int lane = 0; lane < kGroup; lane += kWidth) {
    FunctionSums<0> sums;
    sums.load(lanes + lane);
    const float* weight = weights + lane;
    for (int group = 0; group < groups; ++group) {
      const float* at = pieces + group * kGroup + lane;
      for (int k = 0; k < moments; ++k, at += moment_stride(moments), weight += kStripFunctions * kGroup) {
        sums.add(load_classes(adder, at, moments * moment_stride(moments)), weight);
      }
    }
    sums.store(lanes + lane);
  }
}

/// From the lanes of packed texels, [9][48], to those of each channel's sums.
WELKIN_INLINE_UNLESS_SENT void add_group_to_sums(const float* group_lanes, double* sums) {
  alignas(64) float lanes[3][kLanes];
  for (int f = 0; f < kStripFunctions; ++f) {
    for (int k = 0; k < kLanes; k += kWidth) {
      const Rgb rgb = load_rgb<false>(group_lanes + f * kGroup + 3 * k);
      rgb.red.store_aligned(lanes[0] + k);
      rgb.green.store_aligned(lanes[1] + k);
      rgb.blue.store_aligned(lanes[2] + k);
    }
    for (int c = 0; c < 3; ++c) add_to_double_lanes(lanes[c], sums + (c * kStripFunctions + f) * kSumLanes);
  }
}

template <int moments>
constexpr int kPiece = moments* moment_stride(moments);

/// Calls use(first, count) for each block of columns, with the moments of its pieces in `scratch`.
template <class Channel, int channels, int moments, class Use>
WELKIN_INLINE void for_each_block(const StripPieces& pieces, int texels, float* scratch, const Use& use) {
  constexpr int piece = kPiece<moments>;
  float* const spare = scratch + 4 * piece;
  for (int first = 0; first < texels; first += strip_block(moments)) {
    const int count = texels - first < strip_block(moments) ? texels - first : strip_block(moments);
    // Position t of the left piece meets column texels - 1 - t of the right one: positions first to first + count - 1
    // are the right piece's columns from `mirrored` on, in the opposite order.
    const int mirrored = texels - first - count;
    sum_columns<Channel, channels, moments>(pieces.top_left, first, count, spare, scratch);
    sum_columns_reversed<Channel, channels, moments>(pieces.top_right, mirrored, count, spare, scratch + piece);
    sum_columns<Channel, channels, moments>(pieces.bottom_left, first, count, spare, scratch + 2 * piece);
    sum_columns_reversed<Channel, channels, moments>(pieces.bottom_right, mirrored, count, spare, scratch + 3 * piece);
    use(first, count);
  }
}

template <class Channel, int channels, int moments>
void sum_strips(const StripPieces& pieces, int texels, const float* weights, float* scratch, double* sums) {
  alignas(64) float lanes[kStripFunctions * kGroup] = {};
  for_each_block<Channel, channels, moments>(pieces, texels, scratch, [&](int, int count) WELKIN_INLINE_LAMBDA {
    add_products<moments>(scratch, count / kLanes, weights, lanes);
    weights += std::ptrdiff_t{moments} * kStripFunctions * 3 * count;
  });
  add_group_to_sums(lanes, sums);
}

/// One moment of a block: from four packed pieces to planes[channel][class][kChunk].
template <int moments>
WELKIN_INLINE void split_channels(const Adder& adder, const float* pieces, int texels, float* planes) {
  constexpr int piece = kPiece<moments>;
  for (int k = 0; k < texels; k += kWidth) {
    const float* const at = pieces + 3 * k;
    const Rgb rgb[4] = {load_rgb<false>(at), load_rgb<false>(at + piece), load_rgb<false>(at + 2 * piece),
                        load_rgb<false>(at + 3 * piece)};
    const auto put = [&](Lanes Rgb::*channel, float* to) WELKIN_INLINE_LAMBDA {
      const Classes classes = classes_of(adder, rgb[0].*channel, rgb[1].*channel, rgb[2].*channel, rgb[3].*channel);
      classes.ee.store_aligned(to);
      classes.oe.store_aligned(to + kChunk);
      classes.eo.store_aligned(to + 2 * kChunk);
      classes.oo.store_aligned(to + 3 * kChunk);
    };
    put(&Rgb::red, planes + k);
    put(&Rgb::green, planes + 4 * kChunk + k);
    put(&Rgb::blue, planes + 8 * kChunk + k);
  }
}

template <class Channel, int channels, int moments>
void fold_strips(const StripPieces& pieces, int texels, float* scratch, float* planes) {
  const Adder adder;
  for_each_block<Channel, channels, moments>(pieces, texels, scratch, [&](int first, int count) WELKIN_INLINE_LAMBDA {
    for (int k = 0; k < moments; ++k) {
      split_channels<moments>(adder, scratch + k * moment_stride(moments), count,
                              planes + k * kStripPlaneFloats + first);
    }
  });
}

// Weights of moments.

/// put(k, f, m, w): the m-th moment's weights w of function f in the columns from k on.
template <int moments, class Put>
WELKIN_INLINE void weigh(const MomentsFromRows& matrix, const float* rows, int row_stride, int functions, int groups,
                         const Put& put) {
  constexpr int pairs = moments / 2;
  constexpr int evens = moments - pairs;
  const std::ptrdiff_t row = std::ptrdiff_t{functions} * row_stride;
  for (int k = 0; k < groups * kLanes; k += kWidth) {
    for (int f = 0; f < functions; ++f) {
      const float* const at = rows + f * row_stride + k;
      Lanes sum[3];
      Lanes difference[3];
      for (int a = 0; a < pairs; ++a) {
        const Lanes above = Lanes::load_aligned(at + a * row);
        const Lanes below = Lanes::load_aligned(at + (moments - 1 - a) * row);
        // A polynomial through the rows' weights splits by parity: its even part at x is (w(x) + w(-x)) / 2, its odd
        // one (w(x) - w(-x)) / 2. The halves are in the matrix.
        sum[a] = above + below;
        difference[a] = below - above;
      }
      if constexpr (evens > pairs) sum[pairs] = Lanes::load_aligned(at + pairs * row);
      for (int m = 0; m < moments; ++m) {
        const bool even = m % 2 == 0;
        const float* const factors = even ? matrix.even[m / 2] : matrix.odd[m / 2];
        const Lanes* const terms = even ? sum : difference;
        Lanes weight = terms[0] * Lanes(factors[0]);
        for (int a = 1; a < (even ? evens : pairs); ++a) weight = weight + terms[a] * Lanes(factors[a]);
        put(k, f, m, weight);
      }
    }
  }
}

template <class Put>
WELKIN_INLINE void weigh_any(const MomentsFromRows& matrix, const float* rows, int row_stride, int functions,
                             int groups, const Put& put) {
  switch (matrix.moments) {
    case 4: return weigh<4>(matrix, rows, row_stride, functions, groups, put);
    case 5: return weigh<5>(matrix, rows, row_stride, functions, groups, put);
    default: return weigh<6>(matrix, rows, row_stride, functions, groups, put);
  }
}

void weigh_moments(const MomentsFromRows& matrix, const float* rows, int row_stride, int groups, float* weights) {
  constexpr int kMoment = kStripFunctions * kGroup;
  weigh_any(matrix, rows, row_stride, kStripFunctions, groups,
            [&](int k, int f, int m, Lanes weight) WELKIN_INLINE_LAMBDA {
              simd::store_thrice(weight,
                                 weights + (k / kLanes * matrix.moments + m) * kMoment + 3 * (k % kLanes) + f * kGroup);
            });
}

void weigh_planes(const MomentsFromRows& matrix, const float* rows, int row_stride, int functions, int groups,
                  float* weights) {
  weigh_any(matrix, rows, row_stride, functions, groups, [&](int k, int f, int m, Lanes weight) WELKIN_INLINE_LAMBDA {
    weight.store_aligned(weights + (m * functions + f) * kChunk + k);
  });
}

template <class Channel, int channels, int moments>
constexpr StripFunctions kBothWays{sum_strips<Channel, channels, moments>, fold_strips<Channel, channels, moments>};

template <class Channel, int channels, FoldFormat format>
constexpr StripKernels::ByMoments kStrips{{folds(format) ? kBothWays<Channel, channels, 4> : StripFunctions{},
                                           folds(format) ? kBothWays<Channel, channels, 5> : StripFunctions{},
                                           folds(format) ? kBothWays<Channel, channels, 6> : StripFunctions{}}};

}  // namespace

const StripKernels strip_kernels_table = {
    .strips = {kStrips<float, 3, fold_rgb32f>, kStrips<float, 4, fold_rgba32f>, kStrips<std::uint16_t, 4, fold_rgba16f>,
               kStrips<std::uint16_t, 3, fold_rgb16f>, kStrips<std::uint8_t, 3, fold_rgb8>,
               kStrips<std::uint8_t, 4, fold_rgba8>, kStrips<SrgbByte, 3, fold_srgb8>,
               kStrips<SrgbByte, 4, fold_srgba8>},
    .weigh_moments = weigh_moments,
    .weigh_planes = weigh_planes,
};

}  // namespace welkin::projection::WELKIN_ISA
