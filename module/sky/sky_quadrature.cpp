#include "sky/sky_quadrature.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "math/elementary.h"
#include "math/quadrature.h"
#include "welkin/error.h"

namespace welkin {

const char* name(SkyQuadrature quadrature) noexcept {
  switch (quadrature) {
    case SkyQuadrature::uniform: return "uniform";
    case SkyQuadrature::gauss: return "gauss";
    case SkyQuadrature::gauss_split: return "gauss-split";
  }
  return "unknown";
}

}  // namespace welkin

namespace welkin::sky {
namespace {

void check_range(const char* what, int value, int least, int most) {
  if (value >= least && value <= most) return;
  throw Error(ErrorCode::invalid_argument, "sky harmonics: " + std::to_string(value) + " " + what + "; " +
                                               std::to_string(least) + " to " + std::to_string(most) + " are possible");
}

void check(const SkyHarmonicsOptions& options) {
  check_range("bands", options.bands, 1, kMaximumBands);
  check_range("zeniths", options.zeniths, 2, 128);
  check_range("azimuths", options.azimuths, 2, 256);
  switch (options.quadrature) {
    case SkyQuadrature::uniform:
    case SkyQuadrature::gauss:
    case SkyQuadrature::gauss_split: return;
  }
  throw Error(ErrorCode::invalid_argument, "sky harmonics: quadrature " +
                                               std::to_string(static_cast<int>(options.quadrature)) +
                                               " is none; uniform, gauss and gauss-split are");
}

void add_ring(RingRule& rings, double cosine, double weight) {
  rings.cosines.push_back(cosine);
  rings.sines.push_back(std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))));
  rings.weights.push_back(weight);
}

/// The horizon is where a sky changes fastest: cosine = horizon + (end - horizon) t^2.
RingRule gauss_rings(int count, double horizon, double end) {
  RingRule rings;
  const math::GaussNodes rule = math::gauss_nodes(count);
  for (int k = 0; k < count; ++k) {
    const double t = 0.5 * (1.0 + rule.nodes[static_cast<std::size_t>(k)]);
    const double weight = rule.weights[static_cast<std::size_t>(k)] * t;  // 1/2 of the interval, 2 t of the square
    add_ring(rings, horizon + (end - horizon) * t * t, std::abs(end - horizon) * weight);
  }
  return rings;
}

void add_uniform_rings(SkyRule& rule, int count, double horizon) {
  for (int k = 0; k < count; ++k) {
    const math::SineCosine zenith = math::sine_cosine_of_turns((2.0 * k + 1.0) / (4.0 * count));
    const double weight = zenith.sine * std::numbers::pi / count;
    add_ring(zenith.cosine >= horizon ? rule.above : rule.below, zenith.cosine, weight);
  }
}

/// A in tan(azimuth / 2) = A tan(t / 2). A trapezoid of 2n points errs like exp(-2n b), b the distance from the real
/// axis to the nearest pole in t: the lobe's at azimuth i ln g moves to 2 atanh(tanh(-ln(g) / 2) / A), the map's own is
/// at 2 atanh(A). Equal at A^2 = tanh(-ln(g) / 2); a third more was best in a search at g = 0.8, as the map's pole is
/// met by polynomials of the harmonics' and Rayleigh's degrees. With few points, or a lobe too sharp for them, the
/// map's pole must not come closer than 8 / (2n).
double azimuth_clustering(int count, double asymmetry) {
  const double size = std::abs(asymmetry);
  const double lobe = (1.0 - size) / (1.0 + size);  // tanh(-ln(g) / 2)
  const double steps = 4.0 / count;
  const double least = steps * (1.0 + steps * steps / 15.0) / (1.0 + steps * steps * 0.4);  // tanh, nearly
  const double factor = std::min(1.0, std::max(4.0 / 3.0 * std::sqrt(lobe), std::min(1.0, least)));
  return asymmetry < 0.0 ? 1.0 / factor : factor;
}

/// Midpoints of equal steps in t: as good as with ends, and a whole register's worth.
AzimuthRule azimuth_rule(int count, double clustering) {
  AzimuthRule rule;
  for (int k = 0; k < count; ++k) {
    const math::SineCosine half = math::sine_cosine_of_turns((2.0 * k + 1.0) / (8.0 * count));
    const double towards = half.cosine * half.cosine;
    const double away = clustering * clustering * half.sine * half.sine;
    const double sum = towards + away;
    rule.cosines.push_back((towards - away) / sum);
    rule.from_sun.push_back(2.0 * away / sum);
    rule.from_opposite.push_back(2.0 * towards / sum);
    rule.weights.push_back(2.0 * std::numbers::pi / count * clustering / sum);
  }
  return rule;
}

}  // namespace

SkyRule sky_rule(const SkyHarmonicsOptions& options, double horizon, double top, double asymmetry) {
  check(options);
  SkyRule rule;
  if (options.quadrature == SkyQuadrature::uniform) {
    add_uniform_rings(rule, options.zeniths, horizon);
  } else {
    rule.above = gauss_rings(options.zeniths, horizon, top);
    rule.below = gauss_rings(options.zeniths, horizon, -1.0);
  }
  const bool cluster = options.quadrature == SkyQuadrature::gauss_split;
  rule.azimuths = azimuth_rule(options.azimuths, cluster ? azimuth_clustering(options.azimuths, asymmetry) : 1.0);
  return rule;
}

}  // namespace welkin::sky
