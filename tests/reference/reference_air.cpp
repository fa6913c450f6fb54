#include "reference/reference_air.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <string>

#include "platform/text.h"
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
  const std::vector<double>& own = atmosphere.aerosol_asymmetries;
  if (!own.empty()) {
    drawn_asymmetry_ = std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size());
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

/// Breaks, and between two of them steps that grow with the distance from either, in scale heights: an exponential is
/// resolved where it is large, however thin its layer is in all that air.
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
  const std::vector<double>& own = atmosphere_.aerosol_asymmetries;
  const double g = own.empty() ? atmosphere_.aerosol_asymmetry : own[wavelength];
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

/// sun_slope(s) + sqrt(square(s)) = elevation R: with c = elevation R - sun_slope, (c - s nu)^2 = square + s (2 slope +
/// s), where c - s nu is not negative. (What is found on its other branch cuts a piece where none need be: harmless.)
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

void check_direction(const char* what, const glm::dvec3& direction) {
  if (std::abs(glm::length(direction) - 1.0) <= 1e-6) return;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is (" + platform::number_text(direction.x) + ", " +
                                               platform::number_text(direction.y) + ", " +
                                               platform::number_text(direction.z) +
                                               "); it must be of length 1 (normalise it)");
}

}  // namespace welkin::sky
