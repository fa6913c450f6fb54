#include "reference/reference_air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "reference/reference_quadrature.h"
#include "sky/air.h"

namespace welkin::sky {
namespace {

std::vector<double> or_zeros(const std::vector<double>& values, std::size_t count) {
  return values.empty() ? std::vector<double>(count) : values;
}

void sort_unique(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

ReferenceAir::ReferenceAir(const Atmosphere& atmosphere)
    : atmosphere_(atmosphere),
      thickness_(atmosphere.top_radius_m - atmosphere.bottom_radius_m),
      sun_radius_(atmosphere.sun_angular_radius_degrees * std::numbers::pi / 180.0),
      drawn_asymmetry_(atmosphere.aerosol_asymmetry) {
  check(atmosphere);
  const std::vector<double>& each = atmosphere.aerosol_asymmetries;
  if (!each.empty()) {
    drawn_asymmetry_ = std::accumulate(each.begin(), each.end(), 0.0) / static_cast<double>(each.size());
  }
  atmosphere_.ground_albedo = or_zeros(atmosphere.ground_albedo, wavelengths());
  add_matter(atmosphere.rayleigh, true);
  add_matter(atmosphere.aerosol, false);
  for (const Constituent& absorber : atmosphere.absorbers) add_matter(absorber, false);
  sort_unique(altitudes_);
}

void ReferenceAir::add_matter(const Constituent& constituent, bool rayleigh) {
  Matter matter{constituent.density, or_zeros(constituent.scattering_per_m, wavelengths()),
                or_zeros(constituent.absorption_per_m, wavelengths()), rayleigh};
  double most = 0.0;
  for (std::size_t i = 0; i < wavelengths(); ++i) {
    matter.extinction[i] += matter.scattering[i];
    most = std::max(most, matter.extinction[i]);
  }
  if (matter.density.empty() || most == 0.0) return;
  add_altitudes(matter.density);
  matter_.push_back(std::move(matter));
}

/// Adds the breaks, and between two of them steps that grow with the distance from either, in scale heights. That
/// resolves an exponential where it is large, however thin its layer is.
void ReferenceAir::add_altitudes(std::span<const DensityLayer> layers) {
  std::vector<double> breaks = density_breaks(layers, thickness_);
  altitudes_.insert(altitudes_.end(), breaks.begin(), breaks.end());
  breaks.insert(breaks.begin(), 0.0);
  breaks.push_back(thickness_);
  double bottom = 0.0;
  for (std::size_t i = 0; i < layers.size() && bottom < thickness_; ++i) {
    const double top = i + 1 == layers.size() ? thickness_ : bottom + layers[i].thickness_m;
    const double scale = std::abs(layers[i].exponential_scale_per_m);
    for (std::size_t k = 1; k < breaks.size() && layers[i].exponential_term != 0.0 && scale > 0.0; ++k) {
      if (breaks[k] <= bottom || breaks[k - 1] >= top) continue;
      for (const double steps : {2.0, 8.0, 30.0, 120.0}) {
        const double up = breaks[k - 1] + steps / scale;
        const double down = breaks[k] - steps / scale;
        if (up < breaks[k]) altitudes_.push_back(up);
        if (down > breaks[k - 1]) altitudes_.push_back(down);
      }
    }
    bottom = top;
  }
}

double ReferenceAir::altitude_of(double square) const noexcept {
  if (!(square > 0.0)) return 0.0;
  return square / (radius() + std::sqrt(radius() * radius() + square));
}

AirRay ReferenceAir::ray_to_top(double square, double slope) const noexcept {
  const double left = std::max(0.0, square_of(thickness_) - square);
  const double root = std::sqrt(slope * slope + left);
  return {square, slope, slope > 0.0 ? left / (root + slope) : root - slope, false};
}

AirRay ReferenceAir::ray(double altitude, double cosine, double sine, double* skipped) const noexcept {
  double square = square_of(altitude);
  double slope = (radius() + altitude) * cosine;
  if (skipped != nullptr) *skipped = 0.0;
  if (altitude > thickness_) {
    const double nearest = (radius() + altitude) * sine;
    const double top = radius() + thickness_;
    if (slope >= 0.0 || nearest >= top) return {square, slope, 0.0, false};
    const double entry = -std::sqrt((top - nearest) * (top + nearest));
    if (skipped != nullptr) *skipped = entry - slope;
    slope = entry;
    square = square_of(thickness_);
  }
  const double below = slope * slope - square;
  if (slope < 0.0 && below > 0.0) return {square, slope, square / (std::sqrt(below) - slope), true};
  return ray_to_top(square, slope);
}

std::vector<double> ReferenceAir::ends(const AirRay& ray) const {
  std::vector<double> result{0.0, ray.length};
  const auto add = [&](double s) {
    if (s > 0.0 && s < ray.length) result.push_back(s);
  };
  add(-ray.slope);
  for (const double altitude : altitudes_) {
    const double above = square_of(altitude) - ray.square + ray.slope * ray.slope;
    if (!(above > 0.0)) continue;
    add(-ray.slope - std::sqrt(above));
    add(-ray.slope + std::sqrt(above));
  }
  sort_unique(result);
  return result;
}

ReferenceAir::Columns ReferenceAir::columns(const AirRay& ray, std::span<const double> ends, double from, double to,
                                            double relative_error) const {
  std::vector<double> part{from};
  for (const double s : ends) {
    if (s > from && s < to) part.push_back(s);
  }
  part.push_back(to);
  ReferenceQuadrature<kMaxConstituents> integral(matter_.size(), relative_error);
  return integral(part, [&](double s, Columns& values) {
    const double altitude = altitude_at(ray, s);
    for (std::size_t k = 0; k < matter_.size(); ++k) values[k] = density(matter_[k].density, altitude);
  });
}

ReferenceAir::Columns ReferenceAir::columns(const AirRay& ray, double relative_error) const {
  return columns(ray, ends(ray), 0.0, ray.length, relative_error);
}

double ReferenceAir::optical_depth(const Columns& columns, std::size_t wavelength) const noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < matter_.size(); ++k) sum += columns[k] * matter_[k].extinction[wavelength];
  return sum;
}

double ReferenceAir::phase(const Matter& matter, std::size_t wavelength, double cosine) const noexcept {
  const std::vector<double>& each = atmosphere_.aerosol_asymmetries;
  const double g = each.empty() ? atmosphere_.aerosol_asymmetry : each[wavelength];
  return matter.rayleigh ? rayleigh_phase(cosine) : aerosol_phase(atmosphere_.aerosol_phase, g, cosine);
}

double ReferenceAir::drawn_phase(const Matter& matter, double cosine) const noexcept {
  return matter.rayleigh ? rayleigh_phase(cosine) : aerosol_phase(atmosphere_.aerosol_phase, drawn_asymmetry_, cosine);
}

double ReferenceAir::sun_elevation(double square, double sun_slope) const noexcept {
  return (sun_slope + std::sqrt(std::max(0.0, square))) / radius();  // r mu_h = -sqrt(r^2 - R^2)
}

double ReferenceAir::visible_share(double elevation) const noexcept {
  if (!(sun_radius_ > 0.0)) return elevation > 0.0 ? 1.0 : 0.0;
  const double t = std::clamp(0.5 * (elevation + sun_radius_) / sun_radius_, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

AirRay ReferenceAir::sun_ray(double square, double sun_slope) const noexcept {
  return ray_to_top(square, std::max(sun_slope, -std::sqrt(std::max(0.0, square))));
}

/// Solves sun_slope(s) + sqrt(square(s)) = elevation R. With c = elevation R - sun_slope, (c - s nu)^2 = square + s (2
/// slope + s), where c - s nu is not negative. (A root on the other branch cuts a piece needlessly, which is harmless.)
std::vector<double> ReferenceAir::shadow_ends(const AirRay& ray, double sun_slope, double sun_cosine) const {
  std::vector<double> result;
  const auto add = [&](double s) {
    if (s > 0.0 && s < ray.length) result.push_back(s);
  };
  for (const double elevation : {-sun_radius_, 0.0, sun_radius_}) {
    const double c = elevation * radius() - sun_slope;
    const double a = (1.0 - sun_cosine) * (1.0 + sun_cosine);
    const double half_b = ray.slope + c * sun_cosine;
    const double d = ray.square - c * c;
    const double root = half_b * half_b - a * d;
    if (!(root >= 0.0)) continue;
    const double q = -(half_b + std::copysign(std::sqrt(root), half_b));
    if (a > 0.0) add(q / a);
    if (q != 0.0) add(d / q);
  }
  sort_unique(result);
  return result;
}

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

/// All densities are monotone here, so the extremes are at the ends. (The sum assumes that all matter is densest at the
/// same end: it is never too small.)
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

/// Returns whether an exponential decays here so fast that five nodes would miss it. Added to a constant it may, while
/// the sum changes by a factor of two only.
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
  constexpr std::array<double, 5> nodes{-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                                        0.9061798459386640};
  constexpr std::array<double, 5> weight{0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665,
                                         0.2369268850561891};
  Columns sum{};
  Columns values{};
  const double half = 0.5 * (to - from);
  for (std::size_t p = 0; p < nodes.size(); ++p) {
    const double s = from + half + half * nodes[p];
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
