// Weighted sums over patches of a picture.
//
// Four texels of a row are the 16 logical lanes. What is left of a patch, spread over them, is folded for several
// points at once where registers are wide enough.
#include "simd/four_texels.h"
#include "simd/kernel_functions.h"

namespace welkin::simd::WELKIN_ISA {
namespace {

/// A patch before its last sums: over the four columns of a group.
struct Spread {
  Texels total;
  Texels differences;  ///< which bits differ between its texels
};

WELKIN_INLINE bool uniform(const Spread& spread) {
  const Lanes* const part = spread.differences.part;
#if defined(__AVX512F__)
  const __m512i bits = _mm512_castps_si512(part[0]);
  return _mm512_test_epi32_mask(bits, bits) == 0;
#elif defined(__AVX2__)
  const __m256i bits = _mm256_castps_si256(part[0] | part[1]);
  return _mm256_testz_si256(bits, bits) != 0;
#else
  const __m128 bits = (part[0] | part[1]) | (part[2] | part[3]);
  return _mm_movemask_epi8(_mm_cmpeq_epi32(_mm_castps_si128(bits), _mm_setzero_si128())) == 0xFFFF;
#endif
}

/// One texel in all four places.
WELKIN_INLINE Texels repeated(const float* texel) {
  Texels result;
#if defined(__AVX512F__)
  result.part[0] = Lanes(_mm512_broadcast_f32x4(_mm_loadu_ps(texel)));
#elif defined(__AVX2__)
  result.part[0] = result.part[1] = Lanes(_mm256_broadcast_ps(reinterpret_cast<const __m128*>(texel)));
#else
  for (Lanes& part : result.part) part = Lanes(_mm_loadu_ps(texel));
#endif
  return result;
}

template <bool mirrored>
WELKIN_INLINE const float* first_texel(const PatchRun& run, int point) {
  const int column = mirrored ? run.base - run.columns[point] - 4 * run.patch_groups : run.base + run.columns[point];
  return run.origin + run.rows[point] * run.row_stride + 4 * static_cast<std::ptrdiff_t>(column);
}

/// `product`: there are row weights. `known_rows`: of a patch of one group; 0 if the run knows.
template <bool mirrored, bool product, int known_rows>
WELKIN_INLINE Spread spread_value(const PatchRun& run, int point) {
  const int rows = known_rows > 0 ? known_rows : run.patch_rows;
  const int groups = known_rows > 0 ? 1 : run.patch_groups;
  const float* const texels = first_texel<mirrored>(run, point);
  const float* const weights = run.weights + 4 * static_cast<std::ptrdiff_t>(point) * groups * (product ? 1 : rows);
  const float* const row_weights = product ? run.row_weights + static_cast<std::ptrdiff_t>(point) * rows : nullptr;
  const Texels first = repeated(texels);
  Spread spread;
  for (int group = 0; group < groups; ++group) {
    const int weight_group = mirrored ? groups - 1 - group : group;
    Texels column;
    for (int row = 0; row < rows; ++row) {
      const Texels here = load_texels(texels + row * run.row_stride + 16 * static_cast<std::ptrdiff_t>(group));
      const Texels part = product ? weighted_ring(here, row_weights[row])
                                  : weighted_columns<mirrored>(here, weights + 4 * (row * groups + weight_group));
      column = row == 0 ? part : sum(column, part);
      for (int k = 0; k < kParts; ++k) {
        const Lanes difference = here.part[k] ^ first.part[k];
        Lanes& all = spread.differences.part[k];
        all = row == 0 && group == 0 ? difference : all | difference;
      }
    }
    if (product) column = weighted_columns<mirrored>(column, weights + 4 * static_cast<std::ptrdiff_t>(weight_group));
    spread.total = group == 0 ? column : sum(spread.total, column);
  }
  return spread;
}

template <bool mirrored, bool product, int known_rows>
WELKIN_INLINE void sample_one(const PatchRun& run, int point, float* rgb) {
  const Spread spread = spread_value<mirrored, product, known_rows>(run, point);
  const __m128 value = uniform(spread) ? _mm_loadu_ps(first_texel<mirrored>(run, point)) : folded(spread.total);
  float* const target = rgb + point * run.rgb_step;
  _mm_storel_pi(reinterpret_cast<__m64*>(target), value);
  _mm_store_ss(target + 2, _mm_movehl_ps(value, value));
}

#if defined(__AVX512F__)

/// Points `point` to `point` + 3, next to each other or not.
template <bool mirrored, bool product, int known_rows>
WELKIN_INLINE void sample_four(const PatchRun& run, int point, float* rgb) {
  // The next line of tiles will want the row beyond this one's.
  const std::ptrdiff_t rows = known_rows > 0 ? known_rows : run.patch_rows;
  fetch_line(reinterpret_cast<const char*>(first_texel<mirrored>(run, point) + rows * run.row_stride), 0);
  Spread spread[4];
  for (int k = 0; k < 4; ++k) spread[k] = spread_value<mirrored, product, known_rows>(run, point + k);
  __m512 rgba = folded(spread[0].total, spread[1].total, spread[2].total, spread[3].total);
  if (uniform(spread[0]) || uniform(spread[1]) || uniform(spread[2]) || uniform(spread[3])) {
    for (int k = 0; k < 4; ++k) {
      const auto place = static_cast<__mmask16>(uniform(spread[k]) ? 0xF << 4 * k : 0);
      rgba = _mm512_mask_broadcast_f32x4(rgba, place, _mm_loadu_ps(first_texel<mirrored>(run, point + k)));
    }
  }
  // Next to each other: the unused fourth values squeezed out.
  if (run.rgb_step == 3) {
    const __m512i order = _mm512_setr_epi32(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, 3, 7, 11, 15);
    _mm512_mask_storeu_ps(rgb + 3 * static_cast<std::ptrdiff_t>(point), 0x0FFF, _mm512_permutexvar_ps(order, rgba));
  } else if (run.rgb_step == -3) {
    const __m512i order = _mm512_setr_epi32(12, 13, 14, 8, 9, 10, 4, 5, 6, 0, 1, 2, 3, 7, 11, 15);
    _mm512_mask_storeu_ps(rgb - 3 * (static_cast<std::ptrdiff_t>(point) + 3), 0x0FFF,
                          _mm512_permutexvar_ps(order, rgba));
  } else {
    float* const target = rgb + point * run.rgb_step;
    _mm_mask_storeu_ps(target, 0x7, _mm512_castps512_ps128(rgba));
    _mm_mask_storeu_ps(target + run.rgb_step, 0x7, _mm512_extractf32x4_ps(rgba, 1));
    _mm_mask_storeu_ps(target + 2 * run.rgb_step, 0x7, _mm512_extractf32x4_ps(rgba, 2));
    _mm_mask_storeu_ps(target + 3 * run.rgb_step, 0x7, _mm512_extractf32x4_ps(rgba, 3));
  }
}

#endif

template <bool mirrored, bool product, int known_rows>
void sample_each(const PatchRun& the_run, float* rgb) {
  const PatchRun run = the_run;  // a copy of its own, which no store to rgb can change
  int point = 0;
#if defined(__AVX512F__)
  for (; point + 4 <= run.count; point += 4) sample_four<mirrored, product, known_rows>(run, point, rgb);
#endif
  for (; point < run.count; ++point) sample_one<mirrored, product, known_rows>(run, point, rgb);
}

template <bool mirrored, bool product>
WELKIN_INLINE void sample_all(const PatchRun& run, float* rgb) {
  if (run.patch_groups != 1) return sample_each<mirrored, product, 0>(run, rgb);
  switch (run.patch_rows) {
    case 2: return sample_each<mirrored, product, 2>(run, rgb);
    case 3: return sample_each<mirrored, product, 3>(run, rgb);
    case 4: return sample_each<mirrored, product, 4>(run, rgb);
    case 5: return sample_each<mirrored, product, 5>(run, rgb);
    default: return sample_each<mirrored, product, 0>(run, rgb);
  }
}

}  // namespace

void sample_patches(const PatchRun& run, float* rgb) {
  if (run.row_weights != nullptr)
    return run.mirrored ? sample_all<true, true>(run, rgb) : sample_all<false, true>(run, rgb);
  return run.mirrored ? sample_all<true, false>(run, rgb) : sample_all<false, false>(run, rgb);
}

}  // namespace welkin::simd::WELKIN_ISA
