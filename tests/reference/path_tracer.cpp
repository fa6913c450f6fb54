#include "reference/path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "reference/path_sampling.h"
#include "reference/path_shells.h"
#include "reference/reference_air.h"
#include "sky/sky_geometry.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

using sky::AirRay;
using sky::PathRandom;
using sky::PathShells;
using sky::ReferenceAir;
using sky::ShellWalk;

/// One path of light through air and over ground, followed backwards from the eye, at all wavelengths at once.
class PathTracer {
 public:
  static constexpr std::size_t kMaxWavelengths = 96;
  using Spectrum = std::array<double, kMaxWavelengths>;

  PathTracer(const ReferenceAir& air, double altitude, const glm::dvec3& sun, int lowest_order, int highest_order);

  /// An estimate of the light of those orders that arrives from a direction.
  void trace(const glm::dvec3& direction, PathRandom& random, Spectrum& radiance) const;

 private:
  struct Path;

  [[nodiscard]] bool fly(Path& path, PathRandom& random) const;
  [[nodiscard]] bool collide(Path& path, std::size_t shell, double square, PathRandom& random) const;
  void advance(Path& path, double distance) const;
  void add_sun_on_air(Path& path, Spectrum& radiance) const;
  void add_sun_on_ground(Path& path, Spectrum& radiance) const;
  [[nodiscard]] bool scatter(Path& path, PathRandom& random) const;
  [[nodiscard]] bool reflect(Path& path, PathRandom& random) const;
  [[nodiscard]] bool survives(Path& path, PathRandom& random) const;
  [[nodiscard]] double sunlight(const Path& path, Spectrum& transmittance) const;

  const ReferenceAir& air_;
  PathShells shells_;
  double altitude_;
  glm::dvec3 sun_;
  int lowest_order_;
  int highest_order_;
  std::array<const ReferenceAir::Matter*, 2> scatterers_{};  ///< Rayleigh's, the aerosol: where there are
  std::array<std::size_t, 2> scatterer_indices_{};
};

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
      s -= math::logarithm(1.0 - random.number()) / majorant;
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
    transmittance[i] = math::exponential(-air_.optical_depth(columns, i));
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
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      const double part = share * air_.phase(*scatterers_[kind], i, cosine) * path.densities[scatterer_indices_[kind]];
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
  const double cosine = rayleigh ? sky::draw_rayleigh(random)
                                 : sky::draw_aerosol(atmosphere.aerosol_phase, air_.drawn_asymmetry(), random);
  double density = 0.0;
  for (std::size_t kind = 0; kind < scatterers_.size(); ++kind) {
    if (scatterers_[kind] == nullptr) continue;
    density += chance[kind] / all * air_.drawn_phase(*scatterers_[kind], cosine);
  }
  for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
    double scattered = 0.0;
    for (std::size_t kind = 0; kind < scatterers_.size(); ++kind) {
      if (scatterers_[kind] == nullptr) continue;
      scattered += air_.phase(*scatterers_[kind], i, cosine) * path.densities[scatterer_indices_[kind]] *
                   scatterers_[kind]->scattering[i];
    }
    path.weight[i] *= scattered / density;
  }
  path.direction = sky::turned(path.direction, cosine, random);
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
  path.direction = sky::turned(path.up, std::sqrt(random.number()), random);
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

constexpr std::int64_t kMaxPaths = 1'000'000'000'000;
constexpr std::int64_t kPathsOfTile = 4096;
constexpr std::int64_t kFewTiles = 64;  // even of few paths: errors are told from how tiles differ
constexpr std::size_t kTilesOfBatch = 256;
constexpr std::size_t kMaxCoefficients = std::size_t{kMaximumBands} * kMaximumBands;

void require(const char* what, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is " + std::to_string(value) + "; it must be from " +
                                               std::to_string(low) + " to " + std::to_string(high));
}

void check_options(int bands, const PathTracingOptions& options) {
  require("the number of bands", bands, 1, kMaximumBands);
  require("the lowest order", options.lowest_order, 1, 64);
  require("the highest order", options.highest_order, options.lowest_order, 64);
  require("the number of paths", options.paths, 2, kMaxPaths);
}

/// Paths [first, last) of a tile: their coefficients' sum, [wavelength][coefficient].
class TileOfPaths {
 public:
  TileOfPaths(const PathTracer& tracer, std::uint64_t seed, int bands, std::size_t wavelengths)
      : tracer_(tracer), seed_(seed), bands_(bands), wavelengths_(wavelengths) {}

  /// First directions are spread over the sphere as a Fibonacci spiral, jittered and turned at random as a whole: each
  /// is anywhere alike, and together they are more even than chance.
  void operator()(std::int64_t first, std::int64_t last, std::span<double> sums) const {
    const std::size_t coefficients = static_cast<std::size_t>(bands_) * static_cast<std::size_t>(bands_);
    std::fill(sums.begin(), sums.end(), 0.0);
    PathRandom tile(~seed_, static_cast<std::uint64_t>(first));
    const double turn = tile.number();
    const auto paths = static_cast<double>(last - first);
    std::array<double, kMaxCoefficients> basis;
    PathTracer::Spectrum radiance;
    for (std::int64_t path = first; path < last; ++path) {
      PathRandom random(seed_, static_cast<std::uint64_t>(path));
      const auto index = static_cast<double>(path - first);
      const double y = 1.0 - 2.0 * (index + random.number()) / paths;
      const double turns = turn + index * (std::numbers::phi - 1.0);
      const math::SineCosine azimuth = math::sine_cosine_of_turns(turns - std::floor(turns));
      const double level = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
      const glm::dvec3 direction(level * azimuth.sine, y, level * azimuth.cosine);
      tracer_.trace(direction, random, radiance);
      evaluate_basis(direction, bands_, {basis.data(), coefficients});
      for (std::size_t w = 0; w < wavelengths_; ++w) {
        for (std::size_t k = 0; k < coefficients; ++k) sums[w * coefficients + k] += radiance[w] * basis[k];
      }
    }
  }

 private:
  const PathTracer& tracer_;
  std::uint64_t seed_;
  int bands_;
  std::size_t wavelengths_;
};

/// Means and their errors from the tiles' sums, in their order: each is an estimate of its own, and the spread of
/// their means tells that of the whole mean.
class Estimates {
 public:
  explicit Estimates(std::size_t values) : sum_(values), squares_(values) {}

  void add(std::span<const double> sums, double paths) {
    ++tiles_;
    for (std::size_t k = 0; k < sum_.size(); ++k) {
      sum_[k] += sums[k];
      squares_[k] += sums[k] / paths * sums[k];
    }
    paths_ += paths;
  }

  /// Directions are drawn with density 1 / (4 pi).
  [[nodiscard]] double mean(std::size_t k) const { return 4.0 * std::numbers::pi * sum_[k] / paths_; }
  [[nodiscard]] double standard_error(std::size_t k) const {
    const double variance = squares_[k] / paths_ - sum_[k] / paths_ * (sum_[k] / paths_);
    return 4.0 * std::numbers::pi * std::sqrt(std::max(0.0, variance) / static_cast<double>(tiles_ - 1));
  }

 private:
  std::vector<double> sum_;
  std::vector<double> squares_;
  double paths_ = 0.0;
  std::int64_t tiles_ = 0;
};

/// Paths cut into tiles: how many there are depends on the paths alone.
struct Cut {
  explicit Cut(std::int64_t all) : paths(all), tiles(std::max(std::min(all / 2, kFewTiles), all / kPathsOfTile)) {}

  [[nodiscard]] std::int64_t first(std::int64_t tile) const {
    return paths / tiles * tile + std::min(tile, paths % tiles);
  }

  std::int64_t paths;
  std::int64_t tiles;
};

/// All tiles, some hundreds at a time: memory does not grow with the paths.
Estimates run(const Cut& cut, const TileOfPaths& tile, std::size_t values, const Control& control) {
  Estimates estimates(values);
  std::vector<double> sums(kTilesOfBatch * values);
  const jobs::Placement placement = jobs::Placement::arena;
  for (std::int64_t done = 0; done < cut.tiles; done += static_cast<std::int64_t>(kTilesOfBatch)) {
    const std::int64_t batch = std::min(cut.tiles - done, static_cast<std::int64_t>(kTilesOfBatch));
    const auto share = [&](std::int64_t tiles) { return static_cast<double>(tiles) / static_cast<double>(cut.tiles); };
    const Control part = jobs::part_of(control, share(done), share(done + batch));
    jobs::run_tiles(static_cast<std::size_t>(batch), placement, jobs::worker_count(placement), part,
                    [&](std::size_t t, std::size_t) {
                      const std::int64_t index = done + static_cast<std::int64_t>(t);
                      tile(cut.first(index), cut.first(index + 1), {sums.data() + t * values, values});
                    });
    for (std::int64_t t = 0; t < batch; ++t) {
      estimates.add({sums.data() + static_cast<std::size_t>(t) * values, values},
                    static_cast<double>(cut.first(done + t + 1) - cut.first(done + t)));
    }
  }
  return estimates;
}

TracedHarmonics harmonics_of(const Estimates& estimates, int bands, std::size_t wavelengths) {
  const std::size_t coefficients = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  TracedHarmonics result{bands, {}, {}};
  for (std::size_t w = 0; w < wavelengths; ++w) {
    result.radiance.emplace_back(coefficients);
    result.standard_error.emplace_back(coefficients);
    for (std::size_t k = 0; k < coefficients; ++k) {
      result.radiance[w][k] = estimates.mean(w * coefficients + k);
      result.standard_error[w][k] = estimates.standard_error(w * coefficients + k);
    }
  }
  return result;
}

}  // namespace

TracedHarmonics trace_sky_harmonics(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& sun, int bands,
                                    const PathTracingOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const ReferenceAir air(atmosphere);
  sky::check_altitude(altitude_m);
  sky::check_direction("the sun's direction", sun);
  check_options(bands, options);
  const PathTracer tracer(air, altitude_m, sun, options.lowest_order, options.highest_order);
  const TileOfPaths tile(tracer, options.seed, bands, air.wavelengths());
  const std::size_t values = air.wavelengths() * static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  return harmonics_of(run(Cut(options.paths), tile, values, control), bands, air.wavelengths());
}

}  // namespace welkin
