// Rows of pixels to moments, and moments times weights to sums.
#include "projection/strip_kernels.h"

#include <cstdint>

#include "projection/lane_sums.h"
#include "projection/projection_kernels.h"
#include "simd/vec.h"

namespace welkin::projection::WELKIN_ISA {
namespace {

using simd::fetch_line_early, simd::kLanes, simd::kWidth, simd::Lanes, simd::load_rgb, simd::Rgb;

constexpr std::ptrdiff_t kCacheLine = 64;

/// Asks for the next lines of a list, `lines` (a power of two to 16, or 0) in eight times. A copy of its own of what
/// changes: that stays in registers.
class Fetcher {
 public:
  WELKIN_INLINE Fetcher(FetchList& list, int lines)
      : list_(list),
        at_once_(lines == 16 ? 2 : 1),
        skipped_(lines == 0   ? 8
                 : lines >= 8 ? 0
                              : 8 / lines - 1) {
    if (list.area < list.area_count) find_row();
    if (!WELKIN_FETCHES || list.area >= list.area_count) skipped_ = kAll;
  }
  WELKIN_INLINE ~Fetcher() { list_.line = line_; }
  Fetcher(const Fetcher&) = delete;
  Fetcher& operator=(const Fetcher&) = delete;

  [[nodiscard]] WELKIN_INLINE bool active() const { return WELKIN_FETCHES && skipped_ != kAll; }

  /// The i-th of eight times.
  WELKIN_INLINE void fetch(int i) {
    if (!active() || (i & skipped_) != 0) return;
    for (int k = 0; k < at_once_; ++k) fetch_line_early(at_ + (line_ + k) * kCacheLine);
    line_ += at_once_;
    if (line_ >= end_) next_row();
  }

 private:
  static constexpr int kAll = 8;

  WELKIN_INLINE void find_row() {
    const FetchList::Area& area = list_.areas[list_.area];
    at_ = area.first + list_.row * area.row_stride;
    end_ = area.lines;
    line_ = list_.line;
  }
  WELKIN_INLINE void next_row() {
    list_.line = 0;
    line_ = 0;
    if (++list_.row == list_.areas[list_.area].rows) {
      list_.row = 0;
      ++list_.area;
    }
    if (list_.area == list_.area_count) {
      skipped_ = kAll;
    } else {
      find_row();
    }
  }

  FetchList& list_;
  int at_once_;
  int skipped_;  ///< the times that are left out, as bits of their number; kAll: all of them
  const char* at_ = nullptr;
  int line_ = 0;
  int end_ = 0;
};

// Rows to moments.

using simd::Adder;

constexpr int kPairs = kStripRows / 2;

constexpr int binomial(int n, int k) {
  if (k < 0 || k > n) return 0;
  int result = 1;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}
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

template <class Channel>
WELKIN_INLINE Lanes load_values(const char* at) {
  return Lanes(simd::detail::load(reinterpret_cast<const Channel*>(at)));
}

/// Pairs of rows end - 1 to begin, the outermost first.
template <class Channel, int moments, int begin, int end, bool begins, bool fetches>
WELKIN_INLINE void add_pairs(const char* middle, std::ptrdiff_t stride, Fetcher& fetcher, bool fetch,
                             const Adder& adder, Column<0, moments>& column) {
  if constexpr (begin < end) {
    constexpr int i = end - 1;
    if constexpr (fetches) {
      if (fetch) fetcher.fetch(i);
    }
    const Lanes below = load_values<Channel>(middle + i * stride);
    const Lanes above = load_values<Channel>(middle - (i + 1) * stride);
    column.template add<i, begins>(adder, i % 4 == 0 ? adder.add(below, above) : below + above, below - above);
    add_pairs<Channel, moments, begin, end - 1, false, fetches>(middle, stride, fetcher, fetch, adder, column);
  }
}

/// Values that are summed up row by row to the half of a strip before the other half is read, where rows lie a multiple
/// of this many bytes apart: 16 rows would come to the same eight lines of a first-level cache (and take half as long
/// again).
constexpr std::ptrdiff_t kAliasing = 4096;
constexpr int kBlock = 192;

template <class Channel, int channels, int moments>
WELKIN_INLINE void store_column(const Column<0, moments>& column, int value, float* out, int stride) {
  if constexpr (channels == 3) {
    column.store(out + value, stride);
  } else {
    column.store_without_fourth(out + value / 4 * 3, stride);
  }
}

template <class Channel, int channels, int moments, bool fetches>
WELKIN_INLINE void sum_columns(const StripRows& rows, int texels, Fetcher& fetcher, float* out, int stride) {
  const Adder adder;
  const char* const middle = static_cast<const char*>(rows.first) + kPairs * rows.stride;
  const int values = channels * texels;
  constexpr auto kBytes = static_cast<std::ptrdiff_t>(sizeof(Channel));
  if (rows.stride % kAliasing != 0) {
    for (int k = 0; k < values; k += kWidth) {
      Column<0, moments> column;
      add_pairs<Channel, moments, 0, kPairs, true, fetches>(middle + k * kBytes, rows.stride, fetcher, k % kLanes == 0,
                                                            adder, column);
      store_column<Channel, channels, moments>(column, k, out, stride);
    }
    return;
  }
  alignas(64) float outer[moments * kBlock];
  for (int first = 0; first < values; first += kBlock) {
    const int count = values - first < kBlock ? values - first : kBlock;
    for (int k = 0; k < count; k += kWidth) {
      Column<0, moments> column;
      add_pairs<Channel, moments, kPairs / 2, kPairs, true, fetches>(middle + (first + k) * kBytes, rows.stride,
                                                                     fetcher, k % kLanes == 0, adder, column);
      column.store(outer + k, kBlock);
    }
    for (int k = 0; k < count; k += kWidth) {
      Column<0, moments> column;
      column.load(outer + k, kBlock);
      add_pairs<Channel, moments, 0, kPairs / 2, false, fetches>(middle + (first + k) * kBytes, rows.stride, fetcher,
                                                                 k % kLanes == 0, adder, column);
      store_column<Channel, channels, moments>(column, first + k, out, stride);
    }
  }
}

template <class Channel, int channels, int moments>
void sum_strip(const StripRows& rows, int texels, FetchList& fetch, int lines, float* out, int stride) {
  Fetcher fetcher(fetch, lines);
  if (fetcher.active()) {
    sum_columns<Channel, channels, moments, true>(rows, texels, fetcher, out, stride);
  } else {
    sum_columns<Channel, channels, moments, false>(rows, texels, fetcher, out, stride);
  }
}

void reverse_moments(const float* from, int count, int texels, int stride, float* to) {
  for (int row = 0; row < count; ++row) {
    for (int k = 0; k < texels; k += kLanes) {
      simd::reverse_rgb(from + row * stride + 3 * k, to + row * stride + 3 * (texels - kLanes - k));
    }
  }
}

// Weights of moments.

void weigh_moments(const MomentsFromRows& matrix, const float* rows, int row_stride, int groups, float* weights) {
  const int moments = matrix.moments;
  const int pairs = moments / 2;
  const int evens = moments - pairs;
  constexpr std::ptrdiff_t kMoment = std::ptrdiff_t{kStripFunctions} * 3 * kLanes;
  for (int k = 0; k < groups * kLanes; k += kWidth) {
    float* const group = weights + k / kLanes * moments * kMoment + 3 * (k % kLanes);
    for (int f = 0; f < kStripFunctions; ++f) {
      const float* const at = rows + f * row_stride + k;
      const std::ptrdiff_t row = std::ptrdiff_t{kStripFunctions} * row_stride;
      Lanes sum[3];
      Lanes difference[3];
      for (int a = 0; a < pairs; ++a) {
        const Lanes above = Lanes::load_aligned(at + a * row);
        const Lanes below = Lanes::load_aligned(at + (moments - 1 - a) * row);
        sum[a] = above + below;
        difference[a] = below - above;
      }
      if (evens > pairs) sum[pairs] = Lanes::load_aligned(at + pairs * row);
      for (int m = 0; m < moments; ++m) {
        const bool even = m % 2 == 0;
        const float* const factors = even ? matrix.even[m / 2] : matrix.odd[m / 2];
        const Lanes* const terms = even ? sum : difference;
        Lanes weight = terms[0] * Lanes(factors[0]);
        for (int a = 1; a < (even ? evens : pairs); ++a) weight = weight + terms[a] * Lanes(factors[a]);
        simd::store_thrice(weight, group + m * kMoment + f * 3 * kLanes);
      }
    }
  }
}

// Moments times weights.

struct Classes {
  Lanes ee, oe, eo, oo;
};

/// Lanes `at` of the four mirrored pieces, `piece` floats apart.
WELKIN_INLINE Classes load_classes(const Adder& adder, const float* at, int piece) {
  const Lanes top_left = Lanes::load_aligned(at);
  const Lanes top_right = Lanes::load_aligned(at + piece);
  const Lanes bottom_left = Lanes::load_aligned(at + 2 * piece);
  const Lanes bottom_right = Lanes::load_aligned(at + 3 * piece);
  const Lanes top_sum = adder.add(top_left, top_right);
  const Lanes top_difference = top_right - top_left;
  const Lanes bottom_sum = adder.add(bottom_left, bottom_right);
  const Lanes bottom_difference = bottom_right - bottom_left;
  return {adder.add(top_sum, bottom_sum), adder.add(top_difference, bottom_difference), bottom_sum - top_sum,
          bottom_difference - top_difference};
}

/// The running sums of functions f to 8: of `faces` faces, so that each weight is read once for all.
template <int f, int faces>
struct FunctionSums {
  Lanes first = Lanes(0.0F);  // braces would ask xsimd 8.1 for a list of lanes
  Lanes second = Lanes(0.0F);
  FunctionSums<f + 1, faces> next;

  static WELKIN_INLINE Lanes class_of(const Classes& classes) {
    return f < 4 ? classes.ee : f < 6 ? classes.oe : f < 8 ? classes.eo : classes.oo;
  }
  WELKIN_INLINE void add(const Classes& a, const Classes& b, const float* weights) {
    auto weight = Lanes::load_aligned(weights).data;
    WELKIN_IN_REGISTER(weight);
    first = first + class_of(a) * Lanes(weight);
    if constexpr (faces > 1) second = second + class_of(b) * Lanes(weight);
    next.add(a, b, weights + std::ptrdiff_t{3} * kLanes);
  }
  /// [function][48] of each face
  WELKIN_INLINE void store(float* a, float* b) const {
    first.store_aligned(a);
    if constexpr (faces > 1) second.store_aligned(b);
    next.store(a + std::ptrdiff_t{3} * kLanes, b + std::ptrdiff_t{3} * kLanes);
  }
};

template <int faces>
struct FunctionSums<kStripFunctions, faces> {
  WELKIN_INLINE void add(const Classes&, const Classes&, const float*) {}
  WELKIN_INLINE void store(float*, float*) const {}
};

template <int faces>
WELKIN_INLINE void sum_moments_of(const StripMoments& strip, int moments, int groups, const float* weights,
                                  FetchList& fetch, int lines) {
  constexpr int kFloats = kStripFunctions * 3 * kLanes;
  alignas(64) float packed[kFacesAtOnce][kFloats];
  const Adder adder;
  Fetcher fetcher(fetch, lines);
  const int stride = moment_stride(groups * kLanes);
  const int piece = moments * stride;
  for (int lane = 0; lane < 3 * kLanes; lane += kWidth) {
    FunctionSums<0, faces> sums;
    const float* weight = weights + lane;
    for (int group = 0; group < groups; ++group) {
      const float* first = strip.faces[0] + group * 3 * kLanes + lane;
      const float* second = strip.faces[faces - 1] + group * 3 * kLanes + lane;
      for (int k = 0; k < moments; ++k) {
        if (lane % kLanes == 0) {
          for (int i = 0; i < kPairs; ++i) fetcher.fetch(i);
        }
        const Classes a = load_classes(adder, first, piece);
        if constexpr (faces > 1) {
          sums.add(a, load_classes(adder, second, piece), weight);
        } else {
          sums.add(a, a, weight);
        }
        weight += kFloats;
        first += stride;
        second += stride;
      }
    }
    sums.store(packed[0] + lane, packed[faces - 1] + lane);
  }
  alignas(64) float lanes[3][kLanes];
  for (int face = 0; face < faces; ++face) {
    for (int f = 0; f < kStripFunctions; ++f) {
      for (int k = 0; k < kLanes; k += kWidth) {
        const Rgb rgb = load_rgb<false>(packed[face] + f * 3 * kLanes + 3 * k);
        rgb.red.store_aligned(lanes[0] + k);
        rgb.green.store_aligned(lanes[1] + k);
        rgb.blue.store_aligned(lanes[2] + k);
      }
      for (int c = 0; c < 3; ++c) {
        add_to_double_lanes(lanes[c], strip.sums[face] + (c * kStripFunctions + f) * kSumLanes);
      }
    }
  }
}

void sum_moments(const StripMoments& strip, int moment_count, int groups, const float* weights, FetchList& fetch,
                 int lines) {
  if (strip.face_count == kFacesAtOnce) {
    sum_moments_of<kFacesAtOnce>(strip, moment_count, groups, weights, fetch, lines);
  } else {
    sum_moments_of<1>(strip, moment_count, groups, weights, fetch, lines);
  }
}

}  // namespace

const StripKernels strip_kernels_table = {
    .sum_strip = {{sum_strip<float, 3, 4>, sum_strip<float, 3, 5>, sum_strip<float, 3, 6>},
                  {sum_strip<float, 4, 4>, sum_strip<float, 4, 5>, sum_strip<float, 4, 6>},
                  {sum_strip<std::uint16_t, 4, 4>, sum_strip<std::uint16_t, 4, 5>, sum_strip<std::uint16_t, 4, 6>}},
    .reverse_moments = reverse_moments,
    .weigh_moments = weigh_moments,
    .sum_moments = sum_moments,
};

}  // namespace welkin::projection::WELKIN_ISA
