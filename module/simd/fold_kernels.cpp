// From interleaved texels to planes of symmetry classes.
//
// Basis functions are even or odd in u and in v, so mirrored texels share their weights up to signs. With
// sums and differences taken first, four texels need one multiplication a basis function instead of four.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

constexpr int kClassesOfQuadrants = 4;
constexpr int kClassesOfHalves = 2;

WELKIN_INLINE void store_quadrant_classes(Lanes top_left, Lanes top_right, Lanes bottom_left, Lanes bottom_right,
                                          float* plane) {
  const Lanes top_sum = top_left + top_right;
  const Lanes top_difference = top_right - top_left;
  const Lanes bottom_sum = bottom_left + bottom_right;
  const Lanes bottom_difference = bottom_right - bottom_left;
  (top_sum + bottom_sum).store_aligned(plane);
  (top_difference + bottom_difference).store_aligned(plane + kChunk);
  (bottom_sum - top_sum).store_aligned(plane + 2 * kChunk);
  (bottom_difference - top_difference).store_aligned(plane + 3 * kChunk);
}

/// Channel: float or std::uint16_t (binary16); channels: 3 or 4 in memory.
template <class Channel, int channels, bool reversed>
WELKIN_INLINE Rgb load_texels(const Channel* run, int texel) {
  if constexpr (channels == 3) {
    return load_rgb<reversed>(run + 3 * texel);
  } else {
    return load_rgba<reversed>(run + 4 * texel);
  }
}

/// Asks for the cache lines of `bytes` bytes from `address` on; fewer than a line still ask for one.
template <int bytes, class Channel>
WELKIN_INLINE void fetch(const Channel* address) {
  for (int line = 0; line < bytes; line += 64) {
    _mm_prefetch(reinterpret_cast<const char*>(address) + line, _MM_HINT_T0);
  }
}

template <class Channel>
WELKIN_INLINE const Channel* row_of(const void* first, std::ptrdiff_t stride, int row) {
  return reinterpret_cast<const Channel*>(static_cast<const char*>(first) + row * stride);
}

template <class Channel, int channels, bool fetching>
WELKIN_INLINE void fold_rows(const QuadrantRuns& runs, const QuadrantRuns& ahead, int groups, float* planes) {
  const int count = groups * kLanes;
  for (int row = 0; row < runs.rows; ++row, planes += count) {
    const auto* const top_left = row_of<Channel>(runs.top_left, runs.top_stride, row);
    const auto* const top_right = row_of<Channel>(runs.top_right, runs.top_stride, row);
    const auto* const bottom_left = row_of<Channel>(runs.bottom_left, runs.bottom_stride, row);
    const auto* const bottom_right = row_of<Channel>(runs.bottom_right, runs.bottom_stride, row);
    for (int k = 0; k < count; k += kWidth) {
      const int mirrored = count - kWidth - k;
      if constexpr (fetching) {
        constexpr int bytes = kWidth * channels * static_cast<int>(sizeof(Channel));
        fetch<bytes>(row_of<Channel>(ahead.top_left, ahead.top_stride, row) + channels * k);
        fetch<bytes>(row_of<Channel>(ahead.top_right, ahead.top_stride, row) + channels * mirrored);
        fetch<bytes>(row_of<Channel>(ahead.bottom_left, ahead.bottom_stride, row) + channels * k);
        fetch<bytes>(row_of<Channel>(ahead.bottom_right, ahead.bottom_stride, row) + channels * mirrored);
      }
      const Rgb tl = load_texels<Channel, channels, false>(top_left, k);
      const Rgb tr = load_texels<Channel, channels, true>(top_right, mirrored);
      const Rgb bl = load_texels<Channel, channels, false>(bottom_left, k);
      const Rgb br = load_texels<Channel, channels, true>(bottom_right, mirrored);
      constexpr int channel_stride = kClassesOfQuadrants * kChunk;
      store_quadrant_classes(tl.red, tr.red, bl.red, br.red, planes + k);
      store_quadrant_classes(tl.green, tr.green, bl.green, br.green, planes + channel_stride + k);
      store_quadrant_classes(tl.blue, tr.blue, bl.blue, br.blue, planes + 2 * channel_stride + k);
    }
  }
}

template <class Channel, int channels>
WELKIN_INLINE void fold_quadrants(const QuadrantRuns& runs, const QuadrantRuns* ahead, int groups, float* planes) {
  if (ahead != nullptr) {
    fold_rows<Channel, channels, true>(runs, *ahead, groups, planes);
  } else {
    fold_rows<Channel, channels, false>(runs, {}, groups, planes);
  }
}

WELKIN_INLINE void store_half_classes(Lanes first, Lanes second, float* plane) {
  (first + second).store_aligned(plane);
  (first - second).store_aligned(plane + kChunk);
}

template <class Channel, int channels>
WELKIN_INLINE void fold_halves(const void* first, const void* second, int groups, float* planes) {
  for (int k = 0; k < groups * kLanes; k += kWidth) {
    const Rgb a = load_texels<Channel, channels, false>(static_cast<const Channel*>(first), k);
    const Rgb b = load_texels<Channel, channels, false>(static_cast<const Channel*>(second), k);
    constexpr int channel_stride = kClassesOfHalves * kChunk;
    store_half_classes(a.red, b.red, planes + k);
    store_half_classes(a.green, b.green, planes + channel_stride + k);
    store_half_classes(a.blue, b.blue, planes + 2 * channel_stride + k);
  }
}

}  // namespace

void fold_quadrants_rgb_f32(const QuadrantRuns& runs, const QuadrantRuns* ahead, int groups, float* planes) {
  fold_quadrants<float, 3>(runs, ahead, groups, planes);
}

void fold_quadrants_rgba_f32(const QuadrantRuns& runs, const QuadrantRuns* ahead, int groups, float* planes) {
  fold_quadrants<float, 4>(runs, ahead, groups, planes);
}

void fold_quadrants_rgba_f16(const QuadrantRuns& runs, const QuadrantRuns* ahead, int groups, float* planes) {
  fold_quadrants<std::uint16_t, 4>(runs, ahead, groups, planes);
}

void fold_halves_rgb_f32(const void* first, const void* second, int groups, float* planes) {
  fold_halves<float, 3>(first, second, groups, planes);
}

void fold_halves_rgba_f32(const void* first, const void* second, int groups, float* planes) {
  fold_halves<float, 4>(first, second, groups, planes);
}

void fold_halves_rgba_f16(const void* first, const void* second, int groups, float* planes) {
  fold_halves<std::uint16_t, 4>(first, second, groups, planes);
}

}  // namespace welkin::simd::WELKIN_ISA
