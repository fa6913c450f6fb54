// A grid's values between its texels: 4 x 4 texels of four floats for each point.
//
// Four texels of a ring are the 16 logical lanes. Rings are weighted and added first, as ((0 + 1) + (2 + 3)); then the
// columns: with q0 to q3 the four texels' weighted sums, red to blue = (q0 + q2) + (q1 + q3).
#include "image/image_kernels.h"

#include <cstdint>
#include <cstring>
#include <limits>

#include "simd/vec.h"

namespace welkin::image::WELKIN_ISA {
namespace {

using simd::DoubleLanes, simd::fetch_line, simd::kDoubleWidth, simd::kLanes, simd::kParts, simd::kWidth, simd::Lanes,
    simd::load_rgb_texels, simd::Quad, simd::repeated_rgb, simd::store_rgb, simd::Texels, simd::weighted_columns,
    simd::weighted_ring;

/// Returns the four weighted texels of a point, which are still to be added up.
WELKIN_INLINE Texels spread_value(const GridRun& run, int point) {
  const float* const weights = run.ring_weights + 4 * static_cast<std::ptrdiff_t>(point);
  const float* const texels =
      run.origin + run.rings[point] * run.ring_stride + 4 * static_cast<std::ptrdiff_t>(run.columns[point]);
  // The next row of points will read the rings below these.
  fetch_line(reinterpret_cast<const char*>(texels + (point % 2 == 0 ? 4 : 5) * run.ring_stride), 0);
  const Texels upper = sum(weighted_ring(texels, weights[0]), weighted_ring(texels + run.ring_stride, weights[1]));
  const Texels lower = sum(weighted_ring(texels + 2 * run.ring_stride, weights[2]),
                           weighted_ring(texels + 3 * run.ring_stride, weights[3]));
  return weighted_columns(sum(upper, lower), run.column_weights + 4 * static_cast<std::ptrdiff_t>(point));
}

#if defined(WELKIN_VEC_FOLDS_FOUR)

/// Points `point` to `point` + 3: the folds of all four at once, then the unused fourth values squeezed out.
WELKIN_INLINE void sample_four(const GridRun& run, int point, Lanes lowest, float* rgb) {
  const Lanes rgba = folded(spread_value(run, point), spread_value(run, point + 1), spread_value(run, point + 2),
                            spread_value(run, point + 3));
  simd::store_four_rgb(xsimd::max(rgba, lowest), rgb);
}

#endif

void sample_grid(const GridRun& run, float* rgb) {
  constexpr float most_negative = -std::numeric_limits<float>::infinity();
  const float lowest = run.not_negative ? 0.0F : most_negative;
  int point = 0;
#if defined(WELKIN_VEC_FOLDS_FOUR)
  for (; point + 4 <= run.count; point += 4) sample_four(run, point, Lanes(lowest), rgb + 3 * point);
#else
  // Four values are written; the fourth is the next point's red, which comes later.
  for (; point + 1 < run.count; ++point) {
    xsimd::max(folded(spread_value(run, point)), Quad(lowest)).store_unaligned(rgb + 3 * point);
  }
#endif
  for (; point < run.count; ++point) {
    alignas(16) float value[4];
    xsimd::max(folded(spread_value(run, point)), Quad(lowest)).store_aligned(value);
    for (int c = 0; c < 3; ++c) rgb[3 * point + c] = value[c];
  }
}

// Where a cube face's texels lie between the texels of a grid of longitudes and latitudes.

constexpr double kTangentOfPi8 = 0.41421356237309503;  // tan(pi / 8)
constexpr double kPi4 = 0.78539816339744828;
constexpr double kPi2 = 1.5707963267948966;

/// 3/2 x 2^20: adding and subtracting it rounds a number below 2^19 to a multiple of 2^-32.
constexpr double kRoundTo32Bits = 1572864.0;
/// 3/2 x 2^52: the same, to whole numbers.
constexpr double kRoundToWhole = 6755399441055744.0;

/// atan(x) / x as a polynomial of x^2, for |x| <= tan(pi / 8): Chebyshev interpolation (mpmath's chebyfit, 40 digits),
/// relative error 8e-13.
constexpr double kArcTangent[8] = {0x1.fffffffffe56dp-1,  -0x1.5555554ba45bcp-2, 0x1.99999046d1e86p-3,
                                   -0x1.24909144ba082p-3, 0x1.c6cc2f2f6f999p-4,  -0x1.7055c066509b3p-4,
                                   0x1.1da9c35cc3322p-4,  -0x1.34787b1b4ac83p-5};

/// atan(across / along) for 0 <= across <= along: atan(s) with |s| <= tan(pi / 8), or pi/4 + atan(s).
WELKIN_INLINE DoubleLanes angle(DoubleLanes across, DoubleLanes along) {
  const auto beyond = across > along * DoubleLanes(kTangentOfPi8);
  const DoubleLanes numerator = xsimd::select(beyond, across - along, across);
  const DoubleLanes denominator = xsimd::select(beyond, across + along, along);
  const DoubleLanes nothing(1e-300);  // for the origin
  const DoubleLanes s = numerator / xsimd::select(denominator > nothing, denominator, nothing);
  const DoubleLanes s2 = s * s;
  DoubleLanes series(kArcTangent[7]);
  for (int k = 6; k >= 0; --k) series = series * s2 + DoubleLanes(kArcTangent[k]);
  return xsimd::select(beyond, DoubleLanes(kPi4), DoubleLanes(0.0)) + s * series;
}

/// Registers over `count` values; the last one in part, through a copy.
template <class Step>
WELKIN_INLINE void for_each_register(int count, const Step& step) {
  int k = 0;
  for (; k + kDoubleWidth <= count; k += kDoubleWidth) step(k, kDoubleWidth);
  if (k < count) step(k, count - k);
}

WELKIN_INLINE DoubleLanes load_part(const double* values, int count) {
  if (count == kDoubleWidth) return DoubleLanes::load_unaligned(values);
  alignas(64) double part[kDoubleWidth] = {};
  for (int k = 0; k < count; ++k) part[k] = values[k];
  return DoubleLanes::load_aligned(part);
}

WELKIN_INLINE void store_part(DoubleLanes lanes, int count, double* values) {
  if (count == kDoubleWidth) return lanes.store_unaligned(values);
  alignas(64) double part[kDoubleWidth];
  lanes.store_aligned(part);
  for (int k = 0; k < count; ++k) values[k] = part[k];
}

void plane_lengths(const double* u, double v, int count, double* lengths) {
  for_each_register(count, [&](int k, int part) WELKIN_INLINE_LAMBDA {
    const DoubleLanes x = load_part(u + k, part);
    store_part(xsimd::sqrt(x * x + DoubleLanes(v * v)), part, lengths + k);
  });
}

void angle_positions(const double* across, const double* along, int count, double quarter, double offset,
                     double* positions) {
  const double scale = quarter / kPi2;
  for_each_register(count, [&](int k, int part) WELKIN_INLINE_LAMBDA {
    const DoubleLanes x = load_part(along + k, part);
    const DoubleLanes y = load_part(across + k, part);
    const auto steep = y > x;
    const DoubleLanes turned = DoubleLanes(scale) * angle(xsimd::select(steep, x, y), xsimd::select(steep, y, x));
    const DoubleLanes rounded = (turned + DoubleLanes(kRoundTo32Bits)) - DoubleLanes(kRoundTo32Bits);
    const DoubleLanes all = xsimd::select(steep, DoubleLanes(quarter) - rounded, rounded);
    store_part(DoubleLanes(offset) + all, part, positions + k);
  });
}

// With t the share of the way from the second to the third texel, the cubic B-spline weighs them
//   (1 - t)^3 / 6,  2/3 - t^2 + t^3 / 2,  2/3 - (1 - t)^2 + (1 - t)^3 / 2,  t^3 / 6.
// Where the position is a texel's own, t may be 0 or 1: the weights are the same function either way.
void position_taps(const double* positions, int count, bool cubic, std::int32_t* first, float* weights) {
  for (int k = 0; k < count; ++k) {
    const double second = (positions[k] - 0.5 + kRoundToWhole) - kRoundToWhole;
    first[k] = static_cast<std::int32_t>(second) - 1;
    const auto t = static_cast<float>(positions[k] - second);
    const float rest = 1.0F - t;
    const float outer = t * t * t * (1.0F / 6.0F);
    const float rest_outer = rest * rest * rest * (1.0F / 6.0F);
    const float third = 2.0F / 3.0F - rest * rest + 3.0F * rest_outer;
    weights[4 * k] = cubic ? rest_outer : 0.0F;
    weights[4 * k + 1] = cubic ? (1.0F - (outer + rest_outer)) - third : rest;  // so that the sum is 1
    weights[4 * k + 2] = cubic ? third : t;
    weights[4 * k + 3] = cubic ? outer : 0.0F;
  }
}

// Weighted sums over patches of an image.
//
// Four texels of a row, with zeros for fourth values, are the 16 logical lanes. What is left of a patch, spread over
// them, is folded for several points at once where registers are wide enough.

/// A patch before its last sums: over the four columns of a group.
struct Spread {
  Texels total;
  Texels differences;  ///< which bits differ between its texels
};

WELKIN_INLINE bool uniform(const Spread& spread) { return no_bit_set(spread.differences); }

template <bool mirrored>
WELKIN_INLINE const float* first_texel(const PatchRun& run, int point) {
  const int column = mirrored ? run.base - run.columns[point] - 4 * run.patch_groups : run.base + run.columns[point];
  return run.origin + run.rows[point] * run.row_stride + 3 * static_cast<std::ptrdiff_t>(column);
}

/// Prefetches the texels of a patch further on. An image far finer than the cube is read from memory but once, in as
/// many rows at a time as a patch has, which is more than the processor follows by itself.
template <bool mirrored>
WELKIN_INLINE void fetch_patch(const PatchRun& run, int point) {
  if (point >= run.count) return;
  const float* const texels = first_texel<mirrored>(run, point);
  for (int row = 0; row < run.patch_rows; ++row) {
    fetch_line(reinterpret_cast<const char*>(texels + row * run.row_stride), 0);
  }
}

/// Points between the one at work and the one whose texels are fetched.
constexpr int kAhead = 8;

/// `product`: there are row weights. `known_rows`: of a patch of one group; 0 if the run knows.
template <bool mirrored, bool product, int known_rows>
WELKIN_INLINE Spread spread_value(const PatchRun& run, int point) {
  const int rows = known_rows > 0 ? known_rows : run.patch_rows;
  const int groups = known_rows > 0 ? 1 : run.patch_groups;
  const float* const texels = first_texel<mirrored>(run, point);
  const float* const weights = run.weights + 4 * static_cast<std::ptrdiff_t>(point) * groups * (product ? 1 : rows);
  const float* const row_weights = product ? run.row_weights + static_cast<std::ptrdiff_t>(point) * rows : nullptr;
  const Texels first = repeated_rgb(texels);
  Spread spread;
  for (int group = 0; group < groups; ++group) {
    const int weight_group = mirrored ? groups - 1 - group : group;
    Texels column;
    for (int row = 0; row < rows; ++row) {
      const Texels here = load_rgb_texels(texels + row * run.row_stride + 12 * static_cast<std::ptrdiff_t>(group));
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
  if (known_rows == 0) fetch_patch<mirrored>(run, point + kAhead);
  const Spread spread = spread_value<mirrored, product, known_rows>(run, point);
  const Quad value = uniform(spread) ? Quad::load_unaligned(first_texel<mirrored>(run, point)) : folded(spread.total);
  store_rgb(value, rgb + point * run.rgb_step);
}

#if defined(WELKIN_VEC_FOLDS_FOUR)

/// Points `point` to `point` + 3, next to each other or not.
template <bool mirrored, bool product, int known_rows>
WELKIN_INLINE void sample_four(const PatchRun& run, int point, float* rgb) {
  if (known_rows > 0) {
    // The next line of tiles will read the row beyond this one's.
    fetch_line(reinterpret_cast<const char*>(first_texel<mirrored>(run, point) + known_rows * run.row_stride), 0);
  } else {
    for (int k = 0; k < 4; ++k) fetch_patch<mirrored>(run, point + k + kAhead);
  }
  Spread spread[4];
  for (int k = 0; k < 4; ++k) spread[k] = spread_value<mirrored, product, known_rows>(run, point + k);
  Lanes rgba = folded(spread[0].total, spread[1].total, spread[2].total, spread[3].total);
  if (uniform(spread[0]) || uniform(spread[1]) || uniform(spread[2]) || uniform(spread[3])) {
    for (int k = 0; k < 4; ++k) {
      rgba = simd::with_texel(rgba, k, uniform(spread[k]), first_texel<mirrored>(run, point + k));
    }
  }
  // Next to each other: the unused fourth values squeezed out.
  if (run.rgb_step == 3) {
    simd::store_four_rgb(rgba, rgb + 3 * static_cast<std::ptrdiff_t>(point));
  } else if (run.rgb_step == -3) {
    simd::store_four_rgb<true>(rgba, rgb - 3 * (static_cast<std::ptrdiff_t>(point) + 3));
  } else {
    simd::store_four_rgb_apart(rgba, rgb + point * run.rgb_step, run.rgb_step);
  }
}

#endif

template <bool mirrored, bool product, int known_rows>
void sample_each(const PatchRun& the_run, float* rgb) {
  const PatchRun run = the_run;  // a copy of its own, which no store to rgb can change
  int point = 0;
#if defined(WELKIN_VEC_FOLDS_FOUR)
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

void sample_patches(const PatchRun& run, float* rgb) {
  if (run.row_weights != nullptr)
    return run.mirrored ? sample_all<true, true>(run, rgb) : sample_all<false, true>(run, rgb);
  return run.mirrored ? sample_all<true, false>(run, rgb) : sample_all<false, false>(run, rgb);
}

// Two rows of texels to one of half the length.

/// Texels of the result that are worked on at a time: their six kilobytes stay in the first-level cache.
constexpr int kBlock = 64;

// Plain loops: the compiler vectorizes the first, which has most of the work, and the order of additions is that of the
// source in any case.
void reduce_pairs(const float* top, const float* bottom, const float* top_weights, const float* bottom_weights,
                  int count, float* rgb) {
  float columns[6 * kBlock];
  for (int first = 0; first < count; first += kBlock) {
    const int texels = count - first < kBlock ? count - first : kBlock;
    const int from = 6 * first;
    for (int k = 0; k < 6 * texels; ++k) {
      columns[k] = top[from + k] * top_weights[from + k] + bottom[from + k] * bottom_weights[from + k];
    }
    for (int i = 0; i < texels; ++i) {
      for (int c = 0; c < 3; ++c) rgb[3 * (first + i) + c] = columns[6 * i + c] + columns[6 * i + 3 + c];
    }
  }
}

// Weights of a cube's tile over the texels of a lat-long (image/area_weights.h).

/// As much of a cell's share and those of all cells after it as lies before `position`, for the cells from `first` on.
WELKIN_INLINE DoubleLanes integrals_up_to(DoubleLanes position, const CellRow& cells, std::ptrdiff_t first) {
  const DoubleLanes beyond = position - DoubleLanes::load_unaligned(cells.edges + first);
  const DoubleLanes half = DoubleLanes::load_unaligned(cells.half_ramps + first);
  // On the ramp (beyond + half)^2 / (4 half), and from its end on as much as lies beyond.
  const DoubleLanes on_ramp = xsimd::min(xsimd::max(beyond, DoubleLanes(0.0) - half), half) + half;
  return on_ramp * on_ramp * DoubleLanes::load_unaligned(cells.inverses + first) +
         xsimd::max(beyond - half, DoubleLanes(0.0));
}

/// Integrals of single cells' shares: of those of a cell and all after it, less those from the next one on.
struct Shares {
  DoubleLanes from_here, from_next;

  WELKIN_INLINE Shares(double position, const CellRow& cells, std::ptrdiff_t first)
      : from_here(integrals_up_to(DoubleLanes(position), cells, first)),
        from_next(integrals_up_to(DoubleLanes(position), cells, first + 1)) {}

  [[nodiscard]] WELKIN_INLINE DoubleLanes since(const Shares& start) const {
    return (from_here - start.from_here) - (from_next - start.from_next);
  }
};

double weigh_tile(const TileRun& run, float* weights) {
  const double start = run.sides[run.number - 1].longitude * run.columns_per_radian;
  double positions[TileRun::kMaxSides];
  int kept[TileRun::kMaxSides];
  int number = 0;
  double area = 0.0;
  for (int s = 0; s < run.number; ++s) {
    const double position = run.sides[s].longitude * run.columns_per_radian;
    if (position == start || run.sides[s].from == run.sides[s].to) continue;
    area += (position - start) * (run.sides[s].to - run.sides[s].from);
    kept[number] = s;
    positions[number++] = position;
  }
  const std::ptrdiff_t stride = (run.down + 7) / 8 * 8;
  for (int row = 0; row < run.down; row += kDoubleWidth) {
    for (int k = 0; k < number; ++k) {
      const Shares from(run.sides[kept[k]].from, run.rows, row);
      Shares(run.sides[kept[k]].to, run.rows, row).since(from).store_unaligned(run.down_shares + k * stride + row);
    }
  }
  const double scale = 1.0 / area;
  const int across = 4 * run.groups;
  for (int column = 0; column < across; column += kDoubleWidth) {
    const Shares none(start, run.columns, column);
    DoubleLanes shares[TileRun::kMaxSides];
    for (int k = 0; k < number; ++k) shares[k] = Shares(positions[k], run.columns, column).since(none);
    const int count = across - column < kDoubleWidth ? across - column : kDoubleWidth;
    for (int row = 0; row < run.down; ++row) {
      DoubleLanes sum(0.0);
      for (int k = 0; k < number; ++k) sum = sum + DoubleLanes(run.down_shares[k * stride + row]) * shares[k];
      alignas(64) double values[kDoubleWidth];
      xsimd::max(sum * DoubleLanes(scale), DoubleLanes(0.0)).store_aligned(values);
      float* const to = weights + std::ptrdiff_t{across} * row + column;
      for (int lane = 0; lane < count; ++lane) to[lane] = static_cast<float>(values[lane]);
    }
  }
  return area;
}

// Plain loops that the compiler vectorizes: it does only without branches, into which it would move a sum of floats.
// `half_from_float` and `float_from_half` are the same for one value.

std::int32_t bits_of(float value) {
  std::int32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

float float_of(std::int32_t bits) {
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

int halves_of_floats(const float* values, int count, std::uint16_t* halves) {
  constexpr std::int32_t largest = 0x477FE000;       // 65504
  constexpr std::int32_t least_normal = 0x38800000;  // 2^-14
  constexpr std::int32_t bits_of_half = 0x3F000000;  // 0.5, whose last place is the least half
  constexpr std::int32_t infinity = 0x7F800000;
  const auto mask_if_less = [](std::int32_t a, std::int32_t b) { return (a - b) >> 31; };
  int changed = 0;
  for (int k = 0; k < count; ++k) {
    const std::int32_t bits = bits_of(values[k]);
    const std::int32_t whole = bits & 0x7FFFFFFF;
    changed -= mask_if_less(largest, whole);
    const std::int32_t magnitude = largest + ((whole - largest) & mask_if_less(whole, largest));
    const std::int32_t normal = (magnitude - 0x38000000 + 0xFFF + ((magnitude >> 13) & 1)) >> 13;
    const std::int32_t denormal = bits_of(float_of(magnitude) + 0.5F) - bits_of_half;
    const std::int32_t is_denormal = mask_if_less(magnitude, least_normal);
    const std::int32_t half = (denormal & is_denormal) | (normal & ~is_denormal) | ((bits >> 16) & 0x8000);
    halves[k] = static_cast<std::uint16_t>(half & ~mask_if_less(infinity, whole));  // 0 for what is no number
  }
  return changed;
}

void floats_of_halves(const std::uint16_t* halves, int count, float* values) {
  for (int k = 0; k < count; ++k) {
    const std::int32_t magnitude = halves[k] & 0x7FFF;
    const auto sign = static_cast<std::int32_t>((halves[k] & 0x8000U) << 16U);
    const std::int32_t scaled = bits_of(float_of(magnitude << 13) * 0x1p112F);
    const std::int32_t beyond = magnitude > 0x7BFF ? 0x7F800000 : 0;  // infinite, or no number
    values[k] = float_of(sign | beyond | scaled);
  }
}

}  // namespace

const ImageKernels image_kernels_table = {
    .plane_lengths = plane_lengths,
    .angle_positions = angle_positions,
    .position_taps = position_taps,
    .sample_grid = sample_grid,
    .sample_patches = sample_patches,
    .reduce_pairs = reduce_pairs,
    .weigh_tile = weigh_tile,
};

const HalfKernels half_kernels_table = {
    .halves_of_floats = halves_of_floats,
    .floats_of_halves = floats_of_halves,
};

}  // namespace welkin::image::WELKIN_ISA
