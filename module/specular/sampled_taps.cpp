#include "specular/sampled_taps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tables/logarithm.h"
#include "tables/trigonometry.h"

namespace welkin::specular {
namespace {

constexpr double kPi = std::numbers::pi;

/// The bits of `i` mirrored about the point: van der Corput's sequence.
double radical_inverse(std::uint32_t i) noexcept {
  std::uint32_t mirrored = 0;
  for (int bit = 0; bit < 32; ++bit) mirrored |= ((i >> bit) & 1U) << (31 - bit);
  return mirrored * 0x1p-32;
}

}  // namespace

std::vector<Tap> make_taps(double alpha, int samples, int level_size, int levels) {
  const double square = alpha * alpha;
  const double texel = 4.0 * kPi / (6.0 * level_size * level_size);
  std::vector<Tap> taps;
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double share = (i + 0.5) / samples;
    const double denominator = 1.0 + (square - 1.0) * share;
    const double cosine_squared = (1.0 - share) / denominator;  // of the half vector
    const double cosine = 2.0 * cosine_squared - 1.0;
    if (!(cosine > 0.0)) continue;
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const tables::SineCosine turn = tables::sine_cosine_of_turns(radical_inverse(static_cast<std::uint32_t>(i)));
    const double lobe = cosine_squared * (square - 1.0) + 1.0;
    const double density = square / (kPi * lobe * lobe) / 4.0;
    const double level = 0.5 * tables::logarithm(1.0 / (samples * density * texel)) / std::numbers::ln2 + 1.0;
    taps.push_back({static_cast<float>(sine * turn.cosine), static_cast<float>(sine * turn.sine),
                    static_cast<float>(cosine), static_cast<float>(cosine),
                    static_cast<float>(std::clamp(level, 0.0, levels - 1.0))});
    sum += cosine;
  }
  if (taps.empty()) taps.push_back({0.0F, 0.0F, 1.0F, 1.0F, 0.0F});
  if (sum > 0.0) {
    for (Tap& tap : taps) tap.weight = static_cast<float>(static_cast<double>(tap.weight) / sum);
  }
  return taps;
}

}  // namespace welkin::specular
