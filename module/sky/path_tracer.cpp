#include "sky/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "sky/path_scattering.h"
#include "tables/exponential.h"
#include "tables/logarithm.h"

namespace welkin::sky {

/// Where a path is, where it goes, and for each wavelength how much of the light found there reaches the eye.
struct PathTracer::Path {
  double square = 0.0;  ///< r^2 - R^2
  glm::dvec3 up{};
  glm::dvec3 direction{};
  AirRay ray{};
  bool on_ground = false;
  Spectrum weight{};
  ReferenceAir::Columns densities{};  ///< where it collided
};

PathTracer::PathTracer(const ReferenceAir& air, double altitude, const glm::dvec3& sun, int lowest_order,
                       int highest_order)
    : air_(air),
      shells_(air),
      altitude_(altitude),
      sun_(sun),
      lowest_order_(lowest_order),
      highest_order_(highest_order) {
  for (std::size_t k = 0; k < air.matter().size(); ++k) {
    const ReferenceAir::Matter& matter = air.matter()[k];
    const bool scatters =
        std::any_of(matter.scattering.begin(), matter.scattering.end(), [](double value) { return value > 0.0; });
    if (!scatters) continue;
    const std::size_t kind = matter.rayleigh ? 0 : 1;
    scatterers_[kind] = &matter;
    scatterer_indices_[kind] = k;
  }
}

void PathTracer::trace(const glm::dvec3& direction, PathRandom& random, Spectrum& radiance) const {
  const std::size_t count = air_.wavelengths();
  std::fill_n(radiance.begin(), count, 0.0);
  const double sine = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  double skipped = 0.0;
  Path path;
  path.direction = direction;
  path.ray = air_.ray(altitude_, direction.y, sine, &skipped);
  if (!(path.ray.length > 0.0) && !path.ray.ground) return;
  const double radius = air_.radius() + altitude_;
  path.up = glm::normalize(glm::dvec3(0.0, radius, 0.0) + skipped * direction);
  path.square = path.ray.square;
  std::fill_n(path.weight.begin(), count, 1.0);
  for (int order = 1; order <= highest_order_; ++order) {
    if (!fly(path, random)) return;
    if (order >= lowest_order_) path.on_ground ? add_sun_on_ground(path, radiance) : add_sun_on_air(path, radiance);
    if (order == highest_order_) return;
    if (!(path.on_ground ? reflect(path, random) : scatter(path, random))) return;
    if (!survives(path, random)) return;
  }
}

/// To the next collision or the ground; false if the path leaves the air. Tentative collisions are as dense as each
/// shell's majorant; whether one is real is drawn by how all wavelengths together would have it, and their weights
/// make up for the difference (Kutz et al. 2017, "Spectral and Decomposition Tracking"): no wavelength's estimate is
/// biased, and none grows without bound.
bool PathTracer::fly(Path& path, PathRandom& random) const {
  double s = 0.0;
  for (ShellWalk walk(shells_, path.ray);; walk.next()) {
    const double majorant = shells_.majorant(walk.shell());
    while (majorant > 0.0) {
      s -= tables::logarithm(1.0 - random.number()) / majorant;
      if (!(s < walk.end())) break;
      const double square = path.ray.square + s * (2.0 * path.ray.slope + s);
      if (!collide(path, walk.shell(), square, random)) continue;
      path.on_ground = false;
      advance(path, s);
      return true;
    }
    s = walk.end();
    if (walk.last()) break;
  }
  if (!path.ray.ground) return false;
  advance(path, path.ray.length);
  path.square = 0.0;
  path.on_ground = true;
  return true;
}

/// A tentative collision: real or not; weights are changed accordingly.
bool PathTracer::collide(Path& path, std::size_t shell, double square, PathRandom& random) const {
  shells_.densities(shell, square, path.densities);
  const double majorant = shells_.majorant(shell);
  Spectrum real;
  double all = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    real[i] = std::min(1.0, air_.optical_depth(path.densities, i) / majorant);
    all += path.weight[i];
    sum += path.weight[i] * real[i];
  }
  const double chance = all > 0.0 ? sum / all : 1.0;
  const bool collided = random.number() < chance;
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    path.weight[i] *= collided ? 1.0 / (majorant * chance) : (1.0 - real[i]) / (1.0 - chance);
  }
  return collided;
}

void PathTracer::advance(Path& path, double distance) const {
  const double radius = std::sqrt(air_.radius() * air_.radius() + path.ray.square);
  path.up = glm::normalize(radius * path.up + distance * path.direction);
  path.square = std::max(0.0, path.ray.square + distance * (2.0 * path.ray.slope + distance));
}

/// The visible share of the sun, and of its light what gets through; transmittance is not set where the share is 0.
double PathTracer::sunlight(const Path& path, Spectrum& transmittance) const {
  const double radius = std::sqrt(air_.radius() * air_.radius() + path.square);
  const double slope = radius * glm::dot(path.up, sun_);
  const double share = air_.visible_share(air_.sun_elevation(path.square, slope));
  if (!(share > 0.0)) return 0.0;
  const PathShells::Columns columns = shells_.columns(air_.sun_ray(path.square, slope));
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    transmittance[i] = tables::exponential(-air_.optical_depth(columns, i));
  }
  return share;
}

void PathTracer::add_sun_on_air(Path& path, Spectrum& radiance) const {
  Spectrum transmittance;
  const double share = sunlight(path, transmittance);
  if (!(share > 0.0)) return;
  const double cosine = std::clamp(glm::dot(path.direction, sun_), -1.0, 1.0);
  for (std::size_t kind = 0; kind < scatterers_.size(); ++kind) {
    if (scatterers_[kind] == nullptr) continue;
    const double part = share * air_.phase(*scatterers_[kind], cosine) * path.densities[scatterer_indices_[kind]];
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      radiance[i] += path.weight[i] * part * scatterers_[kind]->scattering[i] * air_.atmosphere().solar_irradiance[i] *
                     transmittance[i];
    }
  }
}

void PathTracer::add_sun_on_ground(Path& path, Spectrum& radiance) const {
  const double cosine = glm::dot(path.up, sun_);
  if (!(cosine > 0.0)) return;
  Spectrum transmittance;
  const double share = sunlight(path, transmittance);
  if (!(share > 0.0)) return;
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    radiance[i] += path.weight[i] * share * cosine * air_.atmosphere().ground_albedo[i] / std::numbers::pi *
                   air_.atmosphere().solar_irradiance[i] * transmittance[i];
  }
}

/// A new direction, drawn from the mixture of both phase functions; false where nothing scatters.
bool PathTracer::scatter(Path& path, PathRandom& random) const {
  std::array<double, 2> chance{};
  for (std::size_t kind = 0; kind < scatterers_.size(); ++kind) {
    if (scatterers_[kind] == nullptr) continue;
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      chance[kind] += path.weight[i] * scatterers_[kind]->scattering[i] * path.densities[scatterer_indices_[kind]];
    }
  }
  const double all = chance[0] + chance[1];
  if (!(all > 0.0)) return false;
  const Atmosphere& atmosphere = air_.atmosphere();
  const bool rayleigh = random.number() * all < chance[0];
  const double cosine =
      rayleigh ? draw_rayleigh(random) : draw_aerosol(atmosphere.aerosol_phase, atmosphere.aerosol_asymmetry, random);
  std::array<double, 2> phase{};
  double density = 0.0;
  for (std::size_t kind = 0; kind < scatterers_.size(); ++kind) {
    if (scatterers_[kind] == nullptr) continue;
    phase[kind] = air_.phase(*scatterers_[kind], cosine) * path.densities[scatterer_indices_[kind]];
    density += chance[kind] / all * air_.phase(*scatterers_[kind], cosine);
  }
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    double scattered = 0.0;
    for (std::size_t kind = 0; kind < scatterers_.size(); ++kind) {
      if (scatterers_[kind] != nullptr) scattered += phase[kind] * scatterers_[kind]->scattering[i];
    }
    path.weight[i] *= scattered / density;
  }
  path.direction = turned(path.direction, cosine, random);
  const double up = glm::dot(path.up, path.direction);
  const double radius = std::sqrt(air_.radius() * air_.radius() + path.square);
  const double slope = radius * up;
  path.ray = slope < 0.0 && slope * slope > path.square
                 ? AirRay{path.square, slope, path.square / (std::sqrt(slope * slope - path.square) - slope), true}
                 : air_.ray_to_top(path.square, slope);
  return true;
}

/// Up from the ground, by the cosine.
bool PathTracer::reflect(Path& path, PathRandom& random) const {
  double most = 0.0;
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    path.weight[i] *= air_.atmosphere().ground_albedo[i];
    most = std::max(most, path.weight[i]);
  }
  if (!(most > 0.0)) return false;
  path.direction = turned(path.up, std::sqrt(random.number()), random);
  path.ray = air_.ray_to_top(0.0, air_.radius() * std::max(0.0, glm::dot(path.up, path.direction)));
  return true;
}

/// Paths that carry little end, most of them, and the others carry more.
bool PathTracer::survives(Path& path, PathRandom& random) const {
  constexpr double little = 0.1;
  const double most =
      *std::max_element(path.weight.begin(), path.weight.begin() + static_cast<std::ptrdiff_t>(air_.wavelengths()));
  if (!(most > 0.0)) return false;
  if (most >= little) return true;
  const double chance = most / little;
  if (!(random.number() < chance)) return false;
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) path.weight[i] /= chance;
  return true;
}

}  // namespace welkin::sky
