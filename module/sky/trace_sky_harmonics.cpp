#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "jobs/floating_point_scope.h"
#include "jobs/tiles.h"
#include "sky/check_sky_arguments.h"
#include "sky/path_random.h"
#include "sky/path_tracer.h"
#include "sky/reference_air.h"
#include "tables/trigonometry.h"
#include "welkin/error.h"
#include "welkin/sky_reference.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

constexpr std::int64_t kMostPaths = 1'000'000'000'000;
constexpr std::int64_t kPathsOfTile = 4096;
constexpr std::int64_t kFewTiles = 64;  // even of few paths: errors are told from how tiles differ
constexpr std::size_t kTilesOfBatch = 256;
constexpr std::size_t kMostCoefficients = std::size_t{kMaximumBands} * kMaximumBands;

void require(const char* what, std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value >= low && value <= high) return;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is " + std::to_string(value) + "; it must be from " +
                                               std::to_string(low) + " to " + std::to_string(high));
}

void check_options(int bands, const PathTracingOptions& options) {
  require("the number of bands", bands, 1, kMaximumBands);
  require("the lowest order", options.lowest_order, 1, 64);
  require("the highest order", options.highest_order, options.lowest_order, 64);
  require("the number of paths", options.paths, 2, kMostPaths);
}

/// Paths [first, last) of a tile: their coefficients' sum, [wavelength][coefficient].
class TileOfPaths {
 public:
  TileOfPaths(const sky::PathTracer& tracer, std::uint64_t seed, int bands, std::size_t wavelengths)
      : tracer_(tracer), seed_(seed), bands_(bands), wavelengths_(wavelengths) {}

  /// First directions are spread over the sphere as a Fibonacci spiral, jittered and turned at random as a whole: each
  /// is anywhere alike, and together they are more even than chance.
  void operator()(std::int64_t first, std::int64_t last, std::span<double> sums) const {
    const std::size_t coefficients = static_cast<std::size_t>(bands_) * static_cast<std::size_t>(bands_);
    std::fill(sums.begin(), sums.end(), 0.0);
    sky::PathRandom tile(~seed_, static_cast<std::uint64_t>(first));
    const double turn = tile.number();
    const auto paths = static_cast<double>(last - first);
    std::array<double, kMostCoefficients> basis;
    sky::PathTracer::Spectrum radiance;
    for (std::int64_t path = first; path < last; ++path) {
      sky::PathRandom random(seed_, static_cast<std::uint64_t>(path));
      const auto index = static_cast<double>(path - first);
      const double y = 1.0 - 2.0 * (index + random.number()) / paths;
      const double turns = turn + index * (std::numbers::phi - 1.0);
      const tables::SineCosine azimuth = tables::sine_cosine_of_turns(turns - std::floor(turns));
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
  const sky::PathTracer& tracer_;
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
  const jobs::FloatingPointScope environment;
  const sky::ReferenceAir air(atmosphere);
  sky::check_altitude(altitude_m);
  sky::check_direction("the sun's direction", sun);
  check_options(bands, options);
  const sky::PathTracer tracer(air, altitude_m, sun, options.lowest_order, options.highest_order);
  const TileOfPaths tile(tracer, options.seed, bands, air.wavelengths());
  const std::size_t values = air.wavelengths() * static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  return harmonics_of(run(Cut(options.paths), tile, values, control), bands, air.wavelengths());
}

}  // namespace welkin
