#include "sky/density.h"

#include <algorithm>
#include <cstddef>

#include "tables/exponential.h"
#include "tables/logarithm.h"

namespace welkin::sky {
namespace {

/// The layer's formula before it is clamped. Its terms are bounded by `check`, so that only the exponential can
/// overflow, and infinity is clamped like any large number.
double unclamped(const DensityLayer& layer, double altitude) noexcept {
  double value = layer.linear_term_per_m * altitude + layer.constant_term;
  // A term of 0 is left out: 0 times an overflown exponential is not a number.
  if (layer.exponential_term != 0.0) {
    value += layer.exponential_term * tables::exponential(layer.exponential_scale_per_m * altitude);
  }
  return value;
}

/// Where the formula, monotone between `low` and `high`, passes `level`: by halving, to the last bit.
void add_crossing(const DensityLayer& layer, double level, double low, double high, std::vector<double>& breaks) {
  const double first = unclamped(layer, low);
  const double last = unclamped(layer, high);
  const bool below = first < level;
  if ((last < level) == below || first == level || last == level) return;
  for (int i = 0; i < 1100; ++i) {
    const double middle = low + 0.5 * (high - low);
    if (!(middle > low && middle < high)) break;
    ((unclamped(layer, middle) < level) == below ? low : high) = middle;
  }
  breaks.push_back(high);
}

/// a s exp(s h) + l = 0: the formula is convex or concave, so it turns at most once.
double turning_point(const DensityLayer& layer) {
  const double ratio = -layer.linear_term_per_m / (layer.exponential_term * layer.exponential_scale_per_m);
  return ratio > 1e-300 && ratio < 1e300 ? tables::logarithm(ratio) / layer.exponential_scale_per_m : -1.0;
}

void add_clamps(const DensityLayer& layer, double bottom, double top, std::vector<double>& breaks) {
  const double turn = turning_point(layer);  // not finite or outside: monotone
  const double middle = turn > bottom && turn < top ? turn : top;
  for (const double level : {0.0, 1.0}) {
    add_crossing(layer, level, bottom, middle, breaks);
    if (middle < top) add_crossing(layer, level, middle, top, breaks);
  }
}

}  // namespace

double density(std::span<const DensityLayer> layers, double altitude_m) noexcept {
  if (layers.empty()) return 0.0;
  const double altitude = std::max(altitude_m, 0.0);
  std::size_t layer = 0;
  double top = 0.0;
  while (layer + 1 < layers.size()) {
    top += layers[layer].thickness_m;
    if (altitude < top) break;
    ++layer;
  }
  return density_of(layers[layer], altitude);
}

double density_of(const DensityLayer& layer, double altitude_m) noexcept {
  return std::clamp(unclamped(layer, altitude_m), 0.0, 1.0);
}

std::vector<double> density_breaks(std::span<const DensityLayer> layers, double thickness_m) {
  std::vector<double> breaks;
  double bottom = 0.0;
  for (std::size_t i = 0; i < layers.size() && bottom < thickness_m; ++i) {
    const bool last = i + 1 == layers.size();
    const double top = last ? thickness_m : std::min(thickness_m, bottom + layers[i].thickness_m);
    if (top > bottom) add_clamps(layers[i], bottom, top, breaks);
    if (!last) breaks.push_back(top);
    bottom = top;
  }
  std::sort(breaks.begin(), breaks.end());
  // A formula that reaches 0 or 1 where its layer ends may round to do so just before it.
  const auto same = [](double a, double b) { return b - a <= 1e-12 * b; };
  breaks.erase(std::unique(breaks.begin(), breaks.end(), same), breaks.end());
  std::erase_if(breaks, [&](double h) { return !(h > 0.0) || same(h, thickness_m) || h > thickness_m; });
  return breaks;
}

std::vector<double> density_turns(std::span<const DensityLayer> layers, double thickness_m) {
  std::vector<double> turns;
  double bottom = 0.0;
  for (std::size_t i = 0; i < layers.size() && bottom < thickness_m; ++i) {
    const double top = i + 1 == layers.size() ? thickness_m : std::min(thickness_m, bottom + layers[i].thickness_m);
    const double turn = turning_point(layers[i]);
    if (turn > bottom && turn < top) turns.push_back(turn);
    bottom = top;
  }
  return turns;
}

}  // namespace welkin::sky
