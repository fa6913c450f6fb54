// Lobes of single lights, and the quadrature of spectra.
#include "reflections/lobe_kernels.h"

#include "reflections/near_kernels.h"
#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::DoubleLanes, simd::kDoubleWidth, simd::kWidth, simd::Lanes;

/// Lights added to one register of texels.
struct Sums {
  Lanes red = Lanes(0.0F), green = Lanes(0.0F), blue = Lanes(0.0F);
};

struct Directions {
  Lanes x, y, z;
};

WELKIN_INLINE Directions directions_of(const LobeBlock& texels, int first) {
  const Lanes u = Lanes::load_unaligned(texels.u + first);
  const Lanes v = Lanes::load_unaligned(texels.v + first);
  const Lanes x = Lanes(texels.normal[0]) + u * Lanes(texels.along[0]) + v * Lanes(texels.down[0]);
  const Lanes y = Lanes(texels.normal[1]) + u * Lanes(texels.along[1]) + v * Lanes(texels.down[1]);
  const Lanes z = Lanes(texels.normal[2]) + u * Lanes(texels.along[2]) + v * Lanes(texels.down[2]);
  const Lanes inverse = Lanes(1.0F) / xsimd::sqrt(x * x + y * y + z * z);
  return {x * inverse, y * inverse, z * inverse};
}

/// |n - s|^2 = 2 (1 - c): it has its digits where the lobe is sharp.
WELKIN_INLINE Lanes chord_of(const Directions& texel, const LobeLight& light) {
  const Lanes x = texel.x - Lanes(light.x);
  const Lanes y = texel.y - Lanes(light.y);
  const Lanes z = texel.z - Lanes(light.z);
  return x * x + y * y + z * z;
}

/// The share of the lobe that is in its far part, x = (q + s) / end.
WELKIN_INLINE Lanes far_share(Lanes x) {
  const Lanes one(1.0F);
  if (!xsimd::any(x < one)) return one;
  const Lanes inside = xsimd::min(x, one);
  return inside * inside * far_polynomial(inside);
}

WELKIN_INLINE void store(const Sums& all, float* sums, int count) {
  (Lanes::load_unaligned(sums) + all.red).store_unaligned(sums);
  (Lanes::load_unaligned(sums + count) + all.green).store_unaligned(sums + count);
  (Lanes::load_unaligned(sums + 2 * count) + all.blue).store_unaligned(sums + 2 * count);
}

/// Calls `value` with texels' directions and each light, adds that times its colour.
template <class Light, class Value>
WELKIN_INLINE void sum_each(const LobeBlock& texels, const Light* lights, const LobeRun* runs, int run_count,
                            float* sums, const Value& value) {
  for (int first = 0; first < texels.count; first += kWidth) {
    const Directions texel = directions_of(texels, first);
    Sums all;
    for (int run = 0; run < run_count; ++run) {
      const Light* const end = lights + runs[run].first + runs[run].count;
      for (const Light* light = lights + runs[run].first; light != end; ++light) value(texel, *light, all);
    }
    store(all, sums + first, texels.count);
  }
}

WELKIN_INLINE void add_light(const LobeLight& light, Lanes value, Sums& sums) {
  sums.red = sums.red + value * Lanes(light.red);
  sums.green = sums.green + value * Lanes(light.green);
  sums.blue = sums.blue + value * Lanes(light.blue);
}

/// GGX over its cosine.
WELKIN_INLINE Lanes ggx(const LobeBlock& texels, Lanes cosine, Lanes chord) {
  const Lanes width = Lanes(texels.alpha_squared) + chord * Lanes(texels.half_slope);
  return cosine / (width * width);
}

WELKIN_INLINE auto is_seen(const LobeBlock& texels, Lanes chord) {
  return (chord >= Lanes(texels.nearest)) & (chord <= Lanes(texels.farthest));
}

/// The kernel of a table.
WELKIN_INLINE Lanes looked_up(const LobeBlock& texels, Lanes chord) {
  const Lanes from_axis = Lanes(0.5F * texels.cells_of_s) * xsimd::sqrt(chord);
  const Lanes position = xsimd::max(from_axis - Lanes(texels.first_cell), Lanes(0.0F));
  const simd::Integers cell = xsimd::min(xsimd::to_int(position), simd::Integers(texels.cells - 1));
  const simd::Pairs line = simd::load_pairs(texels.lines, cell);
  return xsimd::select(is_seen(texels, chord), line.first + (position - xsimd::to_float(cell)) * line.second,
                       Lanes(0.0F));
}

void sum_lobes(const LobeBlock& texels, const LobeLight* lights, const LobeRun* runs, int run_count, float* sums) {
  if (texels.lines != nullptr) {
    sum_each(texels, lights, runs, run_count, sums,
             [&](const Directions& texel, const LobeLight& light, Sums& all) WELKIN_INLINE_LAMBDA {
               const Lanes chord = chord_of(texel, light);
               if (xsimd::any(is_seen(texels, chord))) add_light(light, looked_up(texels, chord), all);
             });
    return;
  }
  sum_each(texels, lights, runs, run_count, sums,
           [&](const Directions& texel, const LobeLight& light, Sums& all) WELKIN_INLINE_LAMBDA {
             const Lanes chord = chord_of(texel, light);
             Lanes cosine = xsimd::max(Lanes(1.0F) - Lanes(0.5F) * chord, Lanes(0.0F));
             if (texels.far_scale > 0.0F) {
               const Lanes width = Lanes(texels.alpha_squared) + chord * Lanes(texels.half_slope);
               cosine = cosine * far_share(width * Lanes(texels.far_scale));
             }
             add_light(light, ggx(texels, cosine, chord), all);
           });
}

WELKIN_INLINE Lanes along(const Directions& texel, const float* axis) {
  return texel.x * Lanes(axis[0]) + texel.y * Lanes(axis[1]) + texel.z * Lanes(axis[2]);
}

/// max(x, 0)^3
WELKIN_INLINE Lanes cube_above(Lanes x) {
  const Lanes above = xsimd::max(x, Lanes(0.0F));
  return above * above * above;
}

/// Mean of max(c + a s + b t, 0) over -1 < s, t < 1: with F(x) = max(x, 0)^3 / 6
///   (F(c + a + b) - F(c + a - b) - F(c - a + b) + F(c - a - b)) / (4 a b),
/// c where all is above, 0 where nothing is. a and b are not below `least`, so that the differences keep their digits.
WELKIN_INLINE Lanes mean_above(Lanes c, Lanes a, Lanes b, Lanes least) {
  const Lanes high = xsimd::max(xsimd::abs(a), least);
  const Lanes wide = xsimd::max(xsimd::abs(b), least);
  const Lanes both = high + wide;
  const Lanes one = high - wide;
  const Lanes differences = (cube_above(c + both) - cube_above(c + one)) - (cube_above(c - one) - cube_above(c - both));
  const Lanes cut = xsimd::max(differences / (Lanes(24.0F) * high * wide), Lanes(0.0F));
  return xsimd::select(c > both, c, xsimd::select(c > Lanes(0.0F) - both, cut, Lanes(0.0F)));
}

WELKIN_INLINE Lanes mean_cosine(const Directions& texel, const CutLight& light, Lanes chord) {
  return mean_above(Lanes(1.0F) - Lanes(0.5F) * chord, along(texel, light.along), along(texel, light.down),
                    Lanes(light.least));
}

WELKIN_INLINE float square_of(const float* axis) { return axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]; }

/// A kernel's Int (c - x) k(x) dx up to c.
WELKIN_INLINE Lanes twice_integrated(const LobeBlock& texels, Lanes c) {
  const Lanes position = xsimd::max(c, Lanes(0.0F)) * Lanes(texels.cells_of_c);
  const simd::Integers cell = xsimd::min(xsimd::to_int(position), simd::Integers(texels.cosine_cells - 1));
  const Lanes t = position - xsimd::to_float(cell);
  const simd::Pairs low = simd::load_pairs(texels.twice_integrated, cell + cell);
  const simd::Pairs high = simd::load_pairs(texels.twice_integrated, cell + cell + simd::Integers(1));
  return low.first + t * (low.second + t * (high.first + t * high.second));
}

/// A light as one texel's kernel sees it: the cosine is c + a s + b t over -1 < s, t < 1, divided by the length of the
/// direction there.
struct SeenLight {
  Lanes c, a, b;
  float along_square, down_square;

  /// Mean of the length less 1: sqrt(1 + s^2 along^2 + t^2 down^2) is 1 + (s^2 along^2 + t^2 down^2) / 2, s^2 has 1/3.
  [[nodiscard]] WELKIN_INLINE float longer() const { return (along_square + down_square) / 6.0F; }
};

/// Mean of a kernel that meets its horizon there, by its second integral as in `mean_above`.
WELKIN_INLINE Lanes mean_at_horizon(const LobeBlock& texels, const SeenLight& seen, Lanes least) {
  const Lanes high = xsimd::max(xsimd::abs(seen.a), least);
  const Lanes wide = xsimd::max(xsimd::abs(seen.b), least);
  const Lanes both = high + wide;
  const Lanes one = high - wide;
  const Lanes c = seen.c * Lanes(1.0F - seen.longer());
  const Lanes differences = (twice_integrated(texels, c + both) - twice_integrated(texels, c + one)) -
                            (twice_integrated(texels, c - one) - twice_integrated(texels, c - both));
  return differences / (Lanes(4.0F) * high * wide);
}

/// Returns the mean of a kernel by Gauss' rule of `points` points along an edge.
template <int points>
WELKIN_INLINE Lanes mean_of_points(const LobeBlock& texels, const SeenLight& seen) {
  constexpr float node = points == 2 ? 0.577350269F : 0.774596669F;
  constexpr float end = points == 2 ? 0.5F : 5.0F / 18.0F;
  constexpr float middle = 4.0F / 9.0F;
  Lanes sum(0.0F);
  for (int j = 0; j < points; ++j) {
    const bool across = points == 3 && j == 1;
    const float t = across ? 0.0F : (j == 0 ? -node : node);
    for (int i = 0; i < points; ++i) {
      const bool central = points == 3 && i == 1;
      const float s = central ? 0.0F : (i == 0 ? -node : node);
      const float longer = 0.5F * (s * s * seen.along_square + t * t * seen.down_square);
      const Lanes cosine = (seen.c + seen.a * Lanes(s) + seen.b * Lanes(t)) * Lanes(1.0F - longer);
      const float weight = (central ? middle : end) * (across ? middle : end);
      const Lanes chord = xsimd::max(Lanes(2.0F) - Lanes(2.0F) * cosine, Lanes(0.0F));
      sum = sum + Lanes(weight) * looked_up(texels, chord);
    }
  }
  return sum;
}

/// Mean of a kernel that changes evenly with the cosine: by three cosines that have the light's own moments up to the
/// fifth. For s and t even in (-1, 1), a s + b t has the second moment (a^2 + b^2) / 3, the fourth (a^4 + b^4) / 5 +
/// 6 a^2 b^2 / 9 and no odd ones. Weights w, 1 - 2 w and w at -x, 0 and x have 2 w x^2 and 2 w x^4: x^2 is the fourth
/// over the second (`square`), w = second / (2 x^2) (`share`). The chord's square is 2 - 2 c, so it moves by 2 x.
WELKIN_INLINE Lanes mean_of_cosines(const LobeBlock& texels, const SeenLight& seen, Lanes chord, Lanes least) {
  const Lanes a = xsimd::max(seen.a * seen.a, least * least);
  const Lanes b = xsimd::max(seen.b * seen.b, least * least);
  const Lanes second = (a + b) * Lanes(1.0F / 3.0F);
  const Lanes fourth = (a * a + b * b) * Lanes(0.2F) + a * b * Lanes(2.0F / 3.0F);
  const Lanes square = fourth / second;
  const Lanes share = second / (square + square);
  const Lanes away = Lanes(2.0F) * xsimd::sqrt(square);
  const Lanes middle = chord + seen.c * Lanes(2.0F * seen.longer());
  const Lanes ends = looked_up(texels, xsimd::max(middle - away, Lanes(0.0F))) + looked_up(texels, middle + away);
  return looked_up(texels, middle) + share * (ends - Lanes(2.0F) * looked_up(texels, middle));
}

/// Mean of a table's kernel over a light.
WELKIN_INLINE Lanes mean_looked_up(const LobeBlock& texels, const Directions& texel, const CutLight& light) {
  const Lanes chord = chord_of(texel, light.light);
  const SeenLight seen{Lanes(1.0F) - Lanes(0.5F) * chord, along(texel, light.along), along(texel, light.down),
                       square_of(light.along), square_of(light.down)};
  const Lanes least(light.least);
  const Lanes both = xsimd::max(xsimd::abs(seen.a), least) + xsimd::max(xsimd::abs(seen.b), least);
  const Lanes nearest(1.0F - 0.5F * texels.nearest);
  if (!xsimd::any((seen.c > Lanes(0.0F) - both) & (seen.c - both < nearest))) return Lanes(0.0F);
  const auto above = seen.c > both;
  Lanes sum(0.0F);
  if (xsimd::any(above)) {
    if (texels.annular) {
      sum = mean_of_cosines(texels, seen, chord, least);
    } else {
      sum = light.least <= texels.small ? mean_of_points<2>(texels, seen) : mean_of_points<3>(texels, seen);
    }
  }
  if (xsimd::all(above)) return sum;
  return xsimd::select(above, sum, mean_at_horizon(texels, seen, least));
}

void sum_cut_lobes(const LobeBlock& texels, const CutLight* lights, const LobeRun* runs, int run_count, float* sums) {
  if (texels.lines != nullptr) {
    sum_each(texels, lights, runs, run_count, sums,
             [&](const Directions& texel, const CutLight& light, Sums& all)
                 WELKIN_INLINE_LAMBDA { add_light(light.light, mean_looked_up(texels, texel, light), all); });
    return;
  }
  sum_each(texels, lights, runs, run_count, sums,
           [&](const Directions& texel, const CutLight& light, Sums& all) WELKIN_INLINE_LAMBDA {
             const Lanes chord = chord_of(texel, light.light);
             add_light(light.light, ggx(texels, mean_cosine(texel, light, chord), chord), all);
           });
}

/// Blocks `first` to `first` + count - 1, side by side: one's additions wait for nothing of another's.
template <int count>
WELKIN_INLINE void sum_moments_of(const MomentRun& run, int first, double* sums) {
  constexpr int parts = kMomentLanes / kDoubleWidth;
  DoubleLanes distance[count][parts];
  DoubleLanes weight[count][parts];
  DoubleLanes value[count][parts];
  DoubleLanes step[count][parts];
  for (int block = 0; block < count; ++block) {
    for (int part = 0; part < parts; ++part) {
      const int at = (first + block) * kMomentLanes + part * kDoubleWidth;
      distance[block][part] = DoubleLanes::load_unaligned(run.distances + at);
      weight[block][part] = DoubleLanes::load_unaligned(run.weights + at);
      value[block][part] = DoubleLanes(1.0);
      step[block][part] = DoubleLanes(0.0);
    }
  }
  for (int l = 0; l < run.bands; ++l, sums += kMomentLanes) {
    const DoubleLanes before(run.factors[2 * l]);
    const DoubleLanes here(run.factors[2 * l + 1]);
    for (int part = 0; part < parts; ++part) {
      DoubleLanes sum = DoubleLanes::load_unaligned(sums + part * kDoubleWidth);
      for (int block = 0; block < count; ++block) {
        DoubleLanes& at = value[block][part];
        sum = sum + weight[block][part] * at;
        step[block][part] = before * step[block][part] - here * distance[block][part] * at;
        at = at + step[block][part];
      }
      sum.store_unaligned(sums + part * kDoubleWidth);
    }
  }
}

void sum_moments(const MomentRun& run, double* sums) {
  constexpr int kTogether = kDoubleWidth / 2 > 0 ? kDoubleWidth / 2 : 1;  // as many as the registers hold
  int block = 0;
  for (; block + kTogether <= run.blocks; block += kTogether) sum_moments_of<kTogether>(run, block, sums);
  for (; block < run.blocks; ++block) sum_moments_of<1>(run, block, sums);
}

}  // namespace

const LobeKernels lobe_kernels_table = {
    .sum_lobes = sum_lobes,
    .sum_cut_lobes = sum_cut_lobes,
    .sum_moments = sum_moments,
};

}  // namespace welkin::reflections::WELKIN_ISA
