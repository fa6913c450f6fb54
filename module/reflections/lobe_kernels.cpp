// GGX lobes of single lights.
#include "reflections/lobe_kernels.h"

#include "simd/vec.h"

namespace welkin::reflections::WELKIN_ISA {
namespace {

using simd::kWidth, simd::Lanes;

/// 0, 1, 2, ...
WELKIN_INLINE Lanes counting() {
  alignas(64) float steps[kWidth];
  for (int k = 0; k < kWidth; ++k) steps[k] = static_cast<float>(k);
  return Lanes::load_aligned(steps);
}

/// Lights added to one register of texels.
struct Sums {
  Lanes red = Lanes(0.0F), green = Lanes(0.0F), blue = Lanes(0.0F);
};

/// With x = 1 - c taken from the chord, |n - s|^2 / 2, so that it has its digits where the lobe is sharp:
/// k = (1 - x) alpha^2 / (pi (alpha^2 + x (1 - alpha^2) / 2)^2), the constants being in the light's colour.
/// For max(c, 0) the mean of max(c + t, 0) over -w < t < w, w the light's half width: (c + w)^2 / (4 w) where |c| < w.
WELKIN_INLINE Sums lobes_at(const LobeRow& row, const LobeLight* lights, int count, Lanes x, Lanes y, Lanes z) {
  Sums sums;
  const Lanes half_slope(row.half_slope);
  const Lanes square(row.alpha_squared);
  for (int i = 0; i < count; ++i) {
    const LobeLight& light = lights[i];
    const Lanes dx = x - Lanes(light.x);
    const Lanes dy = y - Lanes(light.y);
    const Lanes dz = z - Lanes(light.z);
    const Lanes chord = dx * dx + dy * dy + dz * dz;  // 2 x
    const Lanes half_width(light.half_width);
    const Lanes above = xsimd::max(Lanes(1.0F) - Lanes(0.5F) * chord + half_width, Lanes(0.0F));
    const Lanes rising = xsimd::min(above, half_width + half_width);
    const Lanes cosine = rising * rising * Lanes(light.half_slope) + (above - rising);
    const Lanes width = square + chord * half_slope;
    const Lanes value = cosine / (width * width);
    sums.red = sums.red + value * Lanes(light.red);
    sums.green = sums.green + value * Lanes(light.green);
    sums.blue = sums.blue + value * Lanes(light.blue);
  }
  return sums;
}

void add_lobes(const LobeRow& row, const LobeLight* lights, int count, float* rgb) {
  const Lanes twice = counting() + counting();
  for (int first = 0; first < row.count; first += kWidth) {
    // u of the texels' centres: whole numbers times the step, rounded alike at any width
    const Lanes u = (Lanes(static_cast<float>(2 * first + 1)) + twice) * Lanes(row.step) - Lanes(1.0F);
    const Lanes px = Lanes(row.base[0]) + u * Lanes(row.along[0]);
    const Lanes py = Lanes(row.base[1]) + u * Lanes(row.along[1]);
    const Lanes pz = Lanes(row.base[2]) + u * Lanes(row.along[2]);
    const Lanes length = xsimd::sqrt(px * px + py * py + pz * pz);
    const Lanes inverse = Lanes(1.0F) / length;
    const Sums sums = lobes_at(row, lights, count, px * inverse, py * inverse, pz * inverse);
    alignas(64) float red[kWidth];
    alignas(64) float green[kWidth];
    alignas(64) float blue[kWidth];
    sums.red.store_aligned(red);
    sums.green.store_aligned(green);
    sums.blue.store_aligned(blue);
    const int texels = row.count - first < kWidth ? row.count - first : kWidth;
    for (int k = 0; k < texels; ++k) {
      float* const texel = rgb + 3 * (first + k);
      texel[0] += red[k];
      texel[1] += green[k];
      texel[2] += blue[k];
    }
  }
}

}  // namespace

const LobeKernels lobe_kernels_table = {
    .add_lobes = add_lobes,
};

}  // namespace welkin::reflections::WELKIN_ISA
