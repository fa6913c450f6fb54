// Between rows of pixels in memory and 16 rings in lanes: transpositions.
#include "simd/kernel_functions.h"
#include "simd/lanes.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

/// Where float `index` of a row of rgb texels goes: [channel][width][kComplexFloats].
WELKIN_INLINE float* place_of(float* planes, int width, int index) {
  return planes + std::ptrdiff_t{kComplexFloats} * (std::ptrdiff_t{index % 3} * width + index / 3);
}

#if defined(__AVX512F__)
constexpr int kBlock = 16;  // floats of each row that are transposed together, and lanes

struct Block {
  __m512 row[kBlock];
};

WELKIN_INLINE void transpose(Block& block) {
  __m512 pairs[kBlock];
  for (int i = 0; i < kBlock; i += 4) {
    const __m512 ab_low = _mm512_unpacklo_ps(block.row[i], block.row[i + 1]);
    const __m512 ab_high = _mm512_unpackhi_ps(block.row[i], block.row[i + 1]);
    const __m512 cd_low = _mm512_unpacklo_ps(block.row[i + 2], block.row[i + 3]);
    const __m512 cd_high = _mm512_unpackhi_ps(block.row[i + 2], block.row[i + 3]);
    const auto join = [](__m512 a, __m512 b, bool high) __attribute__((always_inline)) {
      const __m512d x = _mm512_castps_pd(a);
      const __m512d y = _mm512_castps_pd(b);
      return _mm512_castpd_ps(high ? _mm512_unpackhi_pd(x, y) : _mm512_unpacklo_pd(x, y));
    };
    pairs[i] = join(ab_low, cd_low, false);  // block b of pairs[i + c]: column 4b + c of rows i to i + 3
    pairs[i + 1] = join(ab_low, cd_low, true);
    pairs[i + 2] = join(ab_high, cd_high, false);
    pairs[i + 3] = join(ab_high, cd_high, true);
  }
  for (int c = 0; c < 4; ++c) {
    const __m512 low01 = _mm512_shuffle_f32x4(pairs[c], pairs[4 + c], 0x44);
    const __m512 high01 = _mm512_shuffle_f32x4(pairs[c], pairs[4 + c], 0xEE);
    const __m512 low23 = _mm512_shuffle_f32x4(pairs[8 + c], pairs[12 + c], 0x44);
    const __m512 high23 = _mm512_shuffle_f32x4(pairs[8 + c], pairs[12 + c], 0xEE);
    block.row[c] = _mm512_shuffle_f32x4(low01, low23, 0x88);
    block.row[4 + c] = _mm512_shuffle_f32x4(low01, low23, 0xDD);
    block.row[8 + c] = _mm512_shuffle_f32x4(high01, high23, 0x88);
    block.row[12 + c] = _mm512_shuffle_f32x4(high01, high23, 0xDD);
  }
}
WELKIN_INLINE __m512 load(const float* from) { return _mm512_loadu_ps(from); }
WELKIN_INLINE void store(__m512 value, float* to) { _mm512_store_ps(to, value); }
WELKIN_INLINE void store_row(__m512 value, float* to) { _mm512_storeu_ps(to, value); }
WELKIN_INLINE __m512 sum(__m512 a, __m512 b) { return _mm512_add_ps(a, b); }
WELKIN_INLINE __m512 difference(__m512 a, __m512 b) { return _mm512_sub_ps(a, b); }
WELKIN_INLINE __m512 zero() { return _mm512_setzero_ps(); }
#else
constexpr int kBlock = 4;

struct Block {
  __m128 row[kBlock];
};

WELKIN_INLINE void transpose(Block& block) {
  _MM_TRANSPOSE4_PS(block.row[0], block.row[1], block.row[2], block.row[3]);
}
WELKIN_INLINE __m128 load(const float* from) { return _mm_loadu_ps(from); }
WELKIN_INLINE void store(__m128 value, float* to) { _mm_store_ps(to, value); }
WELKIN_INLINE void store_row(__m128 value, float* to) { _mm_storeu_ps(to, value); }
WELKIN_INLINE __m128 sum(__m128 a, __m128 b) { return _mm_add_ps(a, b); }
WELKIN_INLINE __m128 difference(__m128 a, __m128 b) { return _mm_sub_ps(a, b); }
WELKIN_INLINE __m128 zero() { return _mm_setzero_ps(); }
#endif

}  // namespace

void load_row_quads(const RowQuads& rows, int width, float* planes) {
  const int floats = 3 * width;
  const int whole = floats - floats % kBlock;
  for (int index = 0; index < whole; index += kBlock) {
    for (int lane = 0; lane < kRingLanes; lane += kBlock) {
      Block even;
      Block odd;
      for (int k = 0; k < kBlock; ++k) {
        const auto north = difference(load(rows.a[lane + k] + index), load(rows.b[lane + k] + index));
        const auto south = difference(load(rows.c[lane + k] + index), load(rows.d[lane + k] + index));
        even.row[k] = sum(north, south);
        odd.row[k] = difference(north, south);
      }
      transpose(even);
      transpose(odd);
      for (int k = 0; k < kBlock; ++k) {
        float* const to = place_of(planes, width, index + k) + lane;
        store(even.row[k], to);
        store(odd.row[k], to + kRingLanes);
      }
    }
  }
  for (int index = whole; index < floats; ++index) {
    float* const to = place_of(planes, width, index);
    for (int lane = 0; lane < kRingLanes; ++lane) {
      const float north = rows.a[lane][index] - rows.b[lane][index];
      const float south = rows.c[lane][index] - rows.d[lane][index];
      to[lane] = north + south;
      to[lane + kRingLanes] = north - south;
    }
  }
}

void store_rings(const float* red, const float* green, const float* blue, int width, const RingRows& rows) {
  constexpr int texels = kBlock / 4;  // of a row that are transposed together
  const int whole = width - width % texels;
  for (int half = 0; half < 2; ++half) {
    float* const* const to = half == 0 ? rows.north : rows.south;
    for (int column = 0; column < whole; column += texels) {
      for (int lane = 0; lane < kRingLanes; lane += kBlock) {
        Block block;
        for (int t = 0; t < texels; ++t) {
          const std::ptrdiff_t at = std::ptrdiff_t{kComplexFloats} * (column + t) + half * kRingLanes + lane;
          block.row[4 * t] = load(red + at);
          block.row[4 * t + 1] = load(green + at);
          block.row[4 * t + 2] = load(blue + at);
          block.row[4 * t + 3] = zero();
        }
        transpose(block);
        for (int k = 0; k < kBlock; ++k) {
          if (to[lane + k] != nullptr) store_row(block.row[k], to[lane + k] + std::ptrdiff_t{4} * column);
        }
      }
    }
    for (int column = whole; column < width; ++column) {
      for (int lane = 0; lane < kRingLanes; ++lane) {
        if (to[lane] == nullptr) continue;
        const std::ptrdiff_t at = std::ptrdiff_t{kComplexFloats} * column + half * kRingLanes + lane;
        float* const texel = to[lane] + std::ptrdiff_t{4} * column;
        texel[0] = red[at];
        texel[1] = green[at];
        texel[2] = blue[at];
        texel[3] = 0.0F;
      }
    }
  }
}

}  // namespace welkin::simd::WELKIN_ISA
