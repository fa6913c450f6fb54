#include "reference/path_shells.h"

#include <algorithm>
#include <cmath>

#include "sky/air.h"

namespace welkin::sky {
namespace {

constexpr double kLargestRatio = 2.0;
constexpr double kLargestExponent = 3.0;
constexpr double kNegligibleDepth = 1e-7;
constexpr int kMaxHalvings = 40;
constexpr std::size_t kMaxShells = 1024;

const DensityLayer* layer_about(std::span<const DensityLayer> layers, double altitude) {
  std::size_t i = 0;
  double top = layers[0].thickness_m;
  while (i + 1 < layers.size() && altitude >= top) top += layers[++i].thickness_m;
  return &layers[i];
}

/// Returns the altitudes inside layers, rising, at which the density turns from rising to falling or back. The layer's
/// formula is convex or concave, so that its slope a s exp(s h) + l is zero at most once.
std::vector<double> density_turns(std::span<const DensityLayer> layers, double thickness_m) {
  std::vector<double> turns;
  double bottom = 0.0;
  for (std::size_t i = 0; i < layers.size() && bottom < thickness_m; ++i) {
    const DensityLayer& layer = layers[i];
    const double top = i + 1 == layers.size() ? thickness_m : std::min(thickness_m, bottom + layer.thickness_m);
    const double ratio = -layer.linear_term_per_m / (layer.exponential_term * layer.exponential_scale_per_m);
    const double turn = std::log(ratio) / layer.exponential_scale_per_m;  // not finite or outside: monotone
    if (turn > bottom && turn < top) turns.push_back(turn);
    bottom = top;
  }
  return turns;
}

}  // namespace

PathShells::PathShells(const ReferenceAir& air) : air_(air) {
  std::vector<double> bounds{0.0, air.thickness()};
  for (const ReferenceAir::Matter& matter : air.matter()) {
    for (const std::vector<double>& more :
         {density_breaks(matter.density, air.thickness()), density_turns(matter.density, air.thickness())}) {
      bounds.insert(bounds.end(), more.begin(), more.end());
    }
  }
  std::sort(bounds.begin(), bounds.end());
  bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());
  for (std::size_t i = 1; i < bounds.size(); ++i) add_shells(bounds[i - 1], bounds[i], 0);
  bounds_.push_back(air.thickness());
  for (const double bound : bounds_) squares_.push_back(air.square_of(bound));
}

/// All densities are monotone here: the extremes are at the ends. (Matter is added up as if all were densest at the
/// same end: never too little.)
double PathShells::densest(double low, double high, bool thinnest) const {
  double most = 0.0;
  for (std::size_t w = 0; w < air_.wavelengths(); ++w) {
    double sum = 0.0;
    for (const ReferenceAir::Matter& matter : air_.matter()) {
      const DensityLayer* layer = layer_about(matter.density, 0.5 * (low + high));
      const double a = density_of(*layer, low);
      const double b = density_of(*layer, high);
      sum += (thinnest ? std::min(a, b) : std::max(a, b)) * matter.extinction[w];
    }
    most = std::max(most, sum);
  }
  return most;
}

/// Whether an exponential decays here so fast that five places would miss it: beside a constant it may, and change the
/// sum by a factor of two only.
bool PathShells::steep(double low, double high, double most) const {
  for (const ReferenceAir::Matter& matter : air_.matter()) {
    const DensityLayer& layer = *layer_about(matter.density, 0.5 * (low + high));
    const double scale = layer.exponential_scale_per_m;
    if (layer.exponential_term == 0.0 || std::abs(scale) * (high - low) < kLargestExponent) continue;
    if (density_of(layer, low) == density_of(layer, high)) continue;  // 0 or 1 all over
    DensityLayer alone = layer;
    alone.exponential_term = std::abs(layer.exponential_term);
    alone.linear_term_per_m = alone.constant_term = 0.0;
    const double extinction = *std::max_element(matter.extinction.begin(), matter.extinction.end());
    if (extinction * density_of(alone, scale < 0.0 ? low : high) > 1e-3 * most) return true;
  }
  return false;
}

void PathShells::add_shells(double low, double high, int depth) {
  const double most = densest(low, high, false);
  const double chord = 2.0 * std::sqrt((high - low) * (2.0 * air_.radius() + low + high));
  const double middle = 0.5 * (low + high);
  if (depth == kMaxHalvings || bounds_.size() >= kMaxShells || most * chord < kNegligibleDepth ||
      (most <= kLargestRatio * densest(low, high, true) && !steep(low, high, most)) ||
      !(middle > low && middle < high)) {
    add_shell(low, high);
    return;
  }
  add_shells(low, middle, depth + 1);
  add_shells(middle, high, depth + 1);
}

void PathShells::add_shell(double low, double high) {
  bounds_.push_back(low);
  densest_.push_back(densest(low, high, false));
  layers_.emplace_back();
  const std::span<const ReferenceAir::Matter> matter = air_.matter();
  for (std::size_t k = 0; k < matter.size(); ++k) {
    layers_.back()[k] = layer_about(matter[k].density, 0.5 * (low + high));
  }
}

std::size_t PathShells::find(double square) const noexcept {
  const auto after = std::upper_bound(squares_.begin() + 1, squares_.end() - 1, square);
  return static_cast<std::size_t>(after - squares_.begin()) - 1;
}

void PathShells::densities(std::size_t i, double square, Columns& values) const noexcept {
  const double altitude = air_.altitude_of(square);
  for (std::size_t k = 0; k < air_.matter().size(); ++k) values[k] = density_of(*layers_[i][k], altitude);
}

PathShells::Columns PathShells::columns(const AirRay& ray, std::size_t i, double from, double to) const noexcept {
  constexpr std::array<double, 5> place{-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                        0.9061798459386640};
  constexpr std::array<double, 5> weight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                         0.2369268850561891};
  Columns sum{};
  Columns values{};
  const double half = 0.5 * (to - from);
  for (std::size_t p = 0; p < place.size(); ++p) {
    const double s = from + half + half * place[p];
    densities(i, ray.square + s * (2.0 * ray.slope + s), values);
    for (std::size_t k = 0; k < air_.matter().size(); ++k) sum[k] += half * weight[p] * values[k];
  }
  return sum;
}

PathShells::Columns PathShells::columns(const AirRay& ray) const noexcept {
  Columns sum{};
  double from = 0.0;
  for (ShellWalk walk(*this, ray);; walk.next()) {
    if (walk.end() > from && densest_[walk.shell()] > 0.0) {
      const Columns part = columns(ray, walk.shell(), from, walk.end());
      for (std::size_t k = 0; k < air_.matter().size(); ++k) sum[k] += part[k];
    }
    from = walk.end();
    if (walk.last()) return sum;
  }
}

}  // namespace welkin::sky
