#include "reference/sky_reference.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "jobs/tiles.h"
#include "reference/reference_air.h"
#include "reference/reference_quadrature.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"
#include "sky/sky_projection.h"

namespace welkin {
namespace {

using sky::AirRay;
using sky::ReferenceAir;
using Radiances = sky::ReferenceQuadrature<96>;  // the maximum number of wavelengths

constexpr double kDepthError = 1e-10;

/// Light that is scattered once along one ray.
class SingleScattering {
 public:
  SingleScattering(const ReferenceAir& air, const AirRay& ray, double sun_slope, double sun_cosine, double error)
      : air_(air), ray_(ray), sun_slope_(sun_slope), sun_cosine_(sun_cosine), error_(error) {
    ends_ = air.ends(ray);
    cut_at_shadow();
    cut_at_extinction();
    ReferenceAir::Columns sum{};
    columns_.push_back(sum);
    for (std::size_t i = 1; i < ends_.size(); ++i) {
      const ReferenceAir::Columns part = air.columns(ray, {}, ends_[i - 1], ends_[i], column_error());
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += part[k];
      columns_.push_back(sum);
    }
    for (const ReferenceAir::Matter& matter : air.matter()) {
      for (std::size_t i = 0; i < air.wavelengths(); ++i) phases_.push_back(air.phase(matter, i, sun_cosine));
    }
  }

  Radiances::Values scattered() const {
    Radiances integral(air_.wavelengths(), error_);
    return integral(ends_, [this](double s, Radiances::Values& values) { source(s, values); });
  }

  /// Adds sunlight that the ground at the ray's end scatters.
  void add_ground(Radiances::Values& radiance) const {
    const double slope = sun_slope_ + ray_.length * sun_cosine_;
    const double cosine = slope / air_.radius();
    if (!(cosine > 0.0)) return;
    const double share = air_.visible_share(air_.sun_elevation(0.0, slope));
    const ReferenceAir::Columns sun = air_.columns(air_.sun_ray(0.0, slope), column_error());
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      const double depth = air_.optical_depth(columns_.back(), i) + air_.optical_depth(sun, i);
      radiance[i] += air_.atmosphere().ground_albedo[i] / std::numbers::pi * cosine * share *
                     air_.atmosphere().solar_irradiance[i] * std::exp(-depth);
    }
  }

 private:
  [[nodiscard]] double column_error() const { return std::max(1e-12, 1e-3 * error_); }

  void cut_at_shadow() {
    const std::vector<double> shadow = air_.shadow_ends(ray_, sun_slope_, sun_cosine_);
    ends_.insert(ends_.end(), shadow.begin(), shadow.end());
    sort();
  }

  /// Adds pieces that shrink towards the eye until they are clear: dense air is seen no farther than a few free paths.
  void cut_at_extinction() {
    double densest = 0.0;
    for (const ReferenceAir::Matter& matter : air_.matter()) {
      densest += *std::max_element(matter.extinction.begin(), matter.extinction.end());
    }
    for (double s = 0.25 * ray_.length; s * densest > 0.1; s *= 0.25) ends_.push_back(s);
    sort();
  }

  void sort() {
    std::sort(ends_.begin(), ends_.end());
    ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
  }

  [[nodiscard]] ReferenceAir::Columns columns_before(double s) const {
    const auto after = std::upper_bound(ends_.begin(), ends_.end(), s) - ends_.begin();
    const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0));
    ReferenceAir::Columns sum = columns_[i];
    const ReferenceAir::Columns part = air_.columns(ray_, {}, ends_[i], s, column_error());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += part[k];
    return sum;
  }

  /// Computes the sunlight scattered towards the eye at a position, per metre, as much of it as arrives.
  void source(double s, Radiances::Values& values) const {
    const double square = ray_.square + s * (2.0 * ray_.slope + s);
    const double slope = sun_slope_ + s * sun_cosine_;
    const double share = air_.visible_share(air_.sun_elevation(square, slope));
    const std::size_t count = air_.wavelengths();
    if (!(share > 0.0)) {
      std::fill_n(values.begin(), count, 0.0);
      return;
    }
    const ReferenceAir::Columns view = columns_before(s);
    const ReferenceAir::Columns sun = air_.columns(air_.sun_ray(square, slope), column_error());
    const double altitude = air_.altitude_of(square);
    ReferenceAir::Columns densities{};
    for (std::size_t k = 0; k < air_.matter().size(); ++k) {
      densities[k] = sky::density(air_.matter()[k].density, altitude);
    }
    for (std::size_t i = 0; i < count; ++i) {
      double scattering = 0.0;
      for (std::size_t k = 0; k < air_.matter().size(); ++k) {
        scattering += share * phases_[k * count + i] * densities[k] * air_.matter()[k].scattering[i];
      }
      const double depth = air_.optical_depth(view, i) + air_.optical_depth(sun, i);
      values[i] = air_.atmosphere().solar_irradiance[i] * scattering * std::exp(-depth);
    }
  }

  const ReferenceAir& air_;
  AirRay ray_;
  double sun_slope_;
  double sun_cosine_;
  double error_;
  std::vector<double> ends_;
  std::vector<ReferenceAir::Columns> columns_;  ///< from the eye to each end
  std::vector<double> phases_;                  ///< [matter][wavelengths]
};

double horizontal(const glm::dvec3& direction) {
  return std::sqrt(direction.x * direction.x + direction.z * direction.z);
}

/// Returns the horizontal direction towards the sun, or +z for a sun in the zenith or nadir.
glm::dvec3 ahead_of(const glm::dvec3& sun) {
  const double length = horizontal(sun);
  return length > 0.0 ? glm::dvec3(sun.x / length, 0.0, sun.z / length) : glm::dvec3(0.0, 0.0, 1.0);
}

}  // namespace

std::vector<double> reference_transmittance(const Atmosphere& atmosphere, double altitude_m, double zenith_cosine) {
  const ReferenceAir air(atmosphere);
  const double sine = std::sqrt((1.0 - zenith_cosine) * (1.0 + zenith_cosine));
  const AirRay ray = air.ray(altitude_m, zenith_cosine, sine);
  if (ray.ground) return std::vector<double>(air.wavelengths());
  const ReferenceAir::Columns columns = air.columns(ray, kDepthError);
  std::vector<double> result(air.wavelengths());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = std::exp(-air.optical_depth(columns, i));
  return result;
}

std::vector<double> reference_sky_radiance(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& direction,
                                           const glm::dvec3& sun, const ReferenceSkyOptions& options) {
  const ReferenceAir air(atmosphere);
  double skipped = 0.0;
  const AirRay ray = air.ray(altitude_m, direction.y, horizontal(direction), &skipped);
  const double sun_cosine = std::clamp(glm::dot(direction, sun), -1.0, 1.0);
  const double sun_slope = (air.radius() + altitude_m) * sun.y + skipped * sun_cosine;
  const SingleScattering light(air, ray, sun_slope, sun_cosine, options.relative_error);
  Radiances::Values radiance = light.scattered();
  if (ray.ground && options.ground) light.add_ground(radiance);
  return {radiance.begin(), radiance.begin() + static_cast<std::ptrdiff_t>(air.wavelengths())};
}

std::vector<double> reference_sun_irradiance(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& sun) {
  const ReferenceAir air(atmosphere);
  const double square = air.square_of(altitude_m);
  const double slope = (air.radius() + altitude_m) * sun.y;
  const double elevation = air.sun_elevation(square, slope);
  const double share = air.visible_share(elevation);
  // From space the sun may shine through the air or past it.
  AirRay ray = air.sun_ray(square, slope);
  if (altitude_m > air.thickness()) {
    const double radius = air.radius() + altitude_m;
    const bool below = elevation < 0.0;
    const double sine = below ? air.radius() / radius : horizontal(sun);
    ray = air.ray(altitude_m, below ? -std::sqrt(square) / radius : sun.y, sine);
    if (ray.ground) ray = air.ray_to_top(ray.square, -std::sqrt(ray.square));  // by rounding: it grazes the ground
  }
  const ReferenceAir::Columns columns = air.columns(ray, kDepthError);
  std::vector<double> result(air.wavelengths());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = share * air.atmosphere().solar_irradiance[i] * std::exp(-air.optical_depth(columns, i));
  }
  return result;
}

SphericalHarmonics reference_sky_harmonics(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& sun,
                                           const ReferenceHarmonicsOptions& options) {
  const SkyHarmonicsOptions quadrature{options.bands, SkyQuadrature::gauss_split, options.zeniths, options.azimuths};
  const double radius = atmosphere.bottom_radius_m;
  const double horizon = sky::horizon_cosine(radius, altitude_m);
  // From space the highest ring that has any light is the air's upper edge.
  const double above = altitude_m - (atmosphere.top_radius_m - radius);
  const double top = above > 0.0 ? sky::horizon_cosine(atmosphere.top_radius_m, above) : 1.0;
  double sharpest = atmosphere.aerosol_asymmetry;
  for (const double g : atmosphere.aerosol_asymmetries) {
    if (std::abs(g) > std::abs(sharpest)) sharpest = g;
  }
  const sky::SkyRule rule = sky::sky_rule(quadrature, horizon, top, sharpest);
  const std::size_t above_horizon = rule.above.cosines.size();
  const glm::dvec3 ahead = ahead_of(sun);
  const glm::dvec3 aside(ahead.z, 0.0, -ahead.x);
  const auto count = static_cast<std::size_t>(options.bands * options.bands);
  std::vector<SphericalHarmonics> sums(above_horizon + rule.below.cosines.size(), SphericalHarmonics(options.bands));
  const jobs::Placement placement = jobs::Placement::arena;
  jobs::run_tiles(sums.size(), placement, jobs::worker_count(placement), {}, [&](std::size_t k, std::size_t) {
    const sky::RingRule& side = k < above_horizon ? rule.above : rule.below;
    const std::size_t ring = k < above_horizon ? k : k - above_horizon;
    std::vector<double> basis(count);
    for (std::size_t i = 0; i < rule.azimuths.cosines.size(); ++i) {
      const double sine = std::sqrt(rule.azimuths.from_sun[i] * rule.azimuths.from_opposite[i]);
      const glm::dvec3 along =
          glm::dvec3(0.0, side.cosines[ring], 0.0) + side.sines[ring] * rule.azimuths.cosines[i] * ahead;
      const glm::dvec3 across = side.sines[ring] * sine * aside;
      const std::vector<double> light =
          reference_sky_radiance(atmosphere, altitude_m, along + across, sun, options.radiance);
      const double weight = 0.5 * side.weights[ring] * rule.azimuths.weights[i];
      for (const glm::dvec3& direction : {along + across, along - across}) {
        evaluate_basis(direction, options.bands, basis);
        for (std::size_t c = 0; c < count; ++c) {
          sums[k].coefficients()[c] += weight * basis[c] * glm::dvec3(light[0], light[1], light[2]);
        }
      }
    }
  });
  SphericalHarmonics total(options.bands);
  for (const SphericalHarmonics& sum : sums) {
    for (std::size_t c = 0; c < count; ++c) total.coefficients()[c] += sum.coefficients()[c];
  }
  return total;
}

}  // namespace welkin
