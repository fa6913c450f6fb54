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
WELKIN_INLINE void fold_quadrants(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes) {
  const int count = groups * kLanes;
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
      store_quadrant_classes(tl.red, tr.red, bl.red, br.red, planes + k);
      store_quadrant_classes(tl.green, tr.green, bl.green, br.green, planes + channel_stride + k);
      store_quadrant_classes(tl.blue, tr.blue, bl.blue, br.blue, planes + 2 * channel_stride + k);
    }
  }
}

WELKIN_INLINE void store_half_classes(Lanes first, Lanes second, float* plane) {
  (first + second).store_aligned(plane);
  (first - second).store_aligned(plane + kChunk);
}

template <class Channel, int channels>
WELKIN_INLINE void fold_halves(const void* first, const void* second, const FetchAhead& ahead, int groups,
                               float* planes) {
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

}  // namespace

void fold_quadrants_rgb_f32(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes) {
  fold_quadrants<float, 3>(runs, ahead, groups, planes);
}

void fold_quadrants_rgba_f32(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes) {
  fold_quadrants<float, 4>(runs, ahead, groups, planes);
}

void fold_quadrants_rgba_f16(const QuadrantRuns& runs, const FetchAhead& ahead, int groups, float* planes) {
  fold_quadrants<std::uint16_t, 4>(runs, ahead, groups, planes);
}

void fold_halves_rgb_f32(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes) {
  fold_halves<float, 3>(first, second, ahead, groups, planes);
}

void fold_halves_rgba_f32(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes) {
  fold_halves<float, 4>(first, second, ahead, groups, planes);
}

void fold_halves_rgba_f16(const void* first, const void* second, const FetchAhead& ahead, int groups, float* planes) {
  fold_halves<std::uint16_t, 4>(first, second, ahead, groups, planes);
}

}  // namespace welkin::simd::WELKIN_ISA
