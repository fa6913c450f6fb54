// GGX lobes of single lights.
#include "reflections/lobe_kernels.h"

#include "reflections/narrow_kernels.h"
#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kWidth, simd::Lanes;

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

WELKIN_INLINE void add_light(const LobeLight& light, Lanes cosine, Lanes chord, const LobeBlock& texels, Sums& sums) {
  const Lanes width = Lanes(texels.alpha_squared) + chord * Lanes(texels.half_slope);
  const Lanes value = cosine / (width * width);
  sums.red = sums.red + value * Lanes(light.red);
  sums.green = sums.green + value * Lanes(light.green);
  sums.blue = sums.blue + value * Lanes(light.blue);
}

WELKIN_INLINE void store(const Sums& all, float* sums, int count) {
  (Lanes::load_unaligned(sums) + all.red).store_unaligned(sums);
  (Lanes::load_unaligned(sums + count) + all.green).store_unaligned(sums + count);
  (Lanes::load_unaligned(sums + 2 * count) + all.blue).store_unaligned(sums + 2 * count);
}

void sum_lobes(const LobeBlock& texels, const LobeLight* lights, const LobeRun* runs, int run_count, float* sums) {
  for (int first = 0; first < texels.count; first += kWidth) {
    const Directions texel = directions_of(texels, first);
    Sums all;
    for (int run = 0; run < run_count; ++run) {
      const LobeLight* const end = lights + runs[run].first + runs[run].count;
      for (const LobeLight* light = lights + runs[run].first; light != end; ++light) {
        const Lanes chord = chord_of(texel, *light);
        Lanes cosine = xsimd::max(Lanes(1.0F) - Lanes(0.5F) * chord, Lanes(0.0F));
        if (texels.far_scale > 0.0F) {
          const Lanes width = Lanes(texels.alpha_squared) + chord * Lanes(texels.half_slope);
          cosine = cosine * far_share(width * Lanes(texels.far_scale));
        }
        add_light(*light, cosine, chord, texels, all);
      }
    }
    store(all, sums + first, texels.count);
  }
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

void sum_cut_lobes(const LobeBlock& texels, const CutLight* lights, const LobeRun* runs, int run_count, float* sums) {
  for (int first = 0; first < texels.count; first += kWidth) {
    const Directions texel = directions_of(texels, first);
    Sums all;
    for (int run = 0; run < run_count; ++run) {
      const CutLight* const end = lights + runs[run].first + runs[run].count;
      for (const CutLight* light = lights + runs[run].first; light != end; ++light) {
        const Lanes chord = chord_of(texel, light->light);
        const Lanes cosine = mean_above(Lanes(1.0F) - Lanes(0.5F) * chord, along(texel, light->along),
                                        along(texel, light->down), Lanes(light->least));
        add_light(light->light, cosine, chord, texels, all);
      }
    }
    store(all, sums + first, texels.count);
  }
}

}  // namespace

const LobeKernels lobe_kernels_table = {
    .sum_lobes = sum_lobes,
    .sum_cut_lobes = sum_cut_lobes,
};

}  // namespace welkin::reflections::WELKIN_ISA
