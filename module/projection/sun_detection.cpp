// Finds the sun in a map and extracts it.
#include "projection/sun_detection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "math/elementary.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/kernel_integrals.h"
#include "welkin/core.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::projection {
namespace {

void require_option(const char* name, double value, double low, double high, const char* range) {
  if (value >= low && value <= high) return;
  throw Error(ErrorCode::invalid_argument,
              "SunOptions::" + std::string(name) + " is " + platform::number_text(value) + "; it must be " + range);
}

void check_options(const SunOptions& options) {
  constexpr double least = 1e-9;
  require_option("relative_threshold", options.relative_threshold, least, 1.0, "above 0 and at most 1");
  require_option("maximum_radius_degrees", options.maximum_radius_degrees, 0.0, 90.0, "from 0 to 90");
  require_option("minimum_contrast", options.minimum_contrast, 1.0, 1e300, "at least 1");
  require_option("minimum_share", options.minimum_share, 0.0, 1.0, "from 0 to 1");
}

constexpr int kTexelsPerTile = 32768;  // some 50 microseconds

/// Sums over the finite texels of a map, and which of them is the brightest. Cut into tiles by the map's shape, each
/// with a slot of its own, so that the same bits come out for any number of threads.
class MapTotals {
 public:
  /// Reads all pixels (RGB floats in the order of the grid), in the caller's arena. They must outlive this object.
  MapTotals(const image::TexelGrid& grid, const float* pixels) : grid_(grid), pixels_(pixels) {
    const std::int64_t texels_per_class = std::int64_t{grid.columns()} * grid.rows_of(0).count;
    classes_per_tile_ = static_cast<int>(std::max<std::int64_t>(1, kTexelsPerTile / texels_per_class));
    tiles_.resize(static_cast<std::size_t>((grid.row_classes() + classes_per_tile_ - 1) / classes_per_tile_));

    const jobs::Placement placement = jobs::placement_for(grid.texels());
    const std::size_t workers = jobs::worker_count(placement);
    const auto columns = static_cast<std::size_t>(grid.columns());
    std::vector<double> steradians(workers * columns);
    jobs::run_tiles(tiles_.size(), placement, workers, {}, [&](std::size_t tile, std::size_t worker) {
      read_tile(tile, std::span(steradians).subspan(worker * columns, columns));
    });
  }

  /// Reads again the tiles in which these texels lie: the sums are then as if the whole map had been read again.
  void update(std::span<const std::int64_t> changed_texels) {
    std::vector<bool> stale(tiles_.size());
    for (const std::int64_t texel : changed_texels) {
      const int row_class = grid_.class_of(static_cast<int>(texel / grid_.columns()));
      stale[static_cast<std::size_t>(row_class / classes_per_tile_)] = true;
    }
    std::vector<double> steradians(static_cast<std::size_t>(grid_.columns()));
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) {
      if (stale[tile]) read_tile(tile, steradians);
    }
  }

  /// Integral of radiance over the sphere.
  [[nodiscard]] glm::dvec3 total_radiance() const noexcept {
    glm::dvec3 sum{};
    for (const Tile& tile : tiles_) sum += tile.total_radiance;
    return sum;
  }

  /// Steradians of the finite texels.
  [[nodiscard]] double solid_angle() const noexcept {
    double sum = 0.0;
    for (const Tile& tile : tiles_) sum += tile.solid_angle;
    return sum;
  }

  /// Returns the finite texel of the largest luminance, the first of several; -1 if no texel is finite.
  [[nodiscard]] std::int64_t brightest() const noexcept {
    const Tile* best = nullptr;
    for (const Tile& tile : tiles_) {
      if (tile.brightest < 0) continue;
      const bool better = best == nullptr || tile.brightest_luminance > best->brightest_luminance ||
                          (tile.brightest_luminance == best->brightest_luminance && tile.brightest < best->brightest);
      if (better) best = &tile;
    }
    return best == nullptr ? -1 : best->brightest;
  }

 private:
  struct Tile {
    glm::dvec3 total_radiance{};
    double solid_angle = 0.0;
    double brightest_luminance = 0.0;
    std::int64_t brightest = -1;
  };

  void read_tile(std::size_t tile, std::span<double> steradians) {
    Tile sums;
    const int first = static_cast<int>(tile) * classes_per_tile_;
    const int last = std::min(first + classes_per_tile_, grid_.row_classes());
    for (int row_class = first; row_class < last; ++row_class) {
      grid_.solid_angles(row_class, steradians);
      for (const int row : grid_.rows_of(row_class)) read_row(row, steradians, sums);
    }
    tiles_[tile] = sums;
  }

  void read_row(int row, std::span<const double> steradians, Tile& sums) const {
    const std::int64_t first = std::int64_t{row} * grid_.columns();
    const float* rgb = pixels_ + 3 * first;
    for (std::size_t column = 0; column < steradians.size(); ++column, rgb += 3) {
      if (!is_finite(rgb)) continue;
      const glm::dvec3 radiance = radiance_of(rgb);
      sums.total_radiance += steradians[column] * radiance;
      sums.solid_angle += steradians[column];
      const double brightness = luminance(radiance);
      const std::int64_t texel = first + static_cast<std::int64_t>(column);
      // Rows are read class by class, not in the map's order, so ties take the smaller index: the result is the
      // first of equals whatever the order.
      const bool first_of_equals = brightness == sums.brightest_luminance && texel < sums.brightest;
      if (sums.brightest < 0 || brightness > sums.brightest_luminance || first_of_equals) {
        sums.brightest_luminance = brightness;
        sums.brightest = texel;
      }
    }
  }

  image::TexelGrid grid_;
  const float* pixels_;
  int classes_per_tile_;
  std::vector<Tile> tiles_;
};

/// A bright spot of a map and the ring of texels around it.
struct BrightRegion {
  std::vector<std::int64_t> spot;  ///< its texels, rising
  std::vector<std::int64_t> rim;   ///< finite texels that touch the spot, rising: its edge may cover a part of them
  std::vector<std::int64_t> ring;  ///< finite texels within two more steps, rising
};

/// Returns Int d dw over each texel: near a lat-long's pole, and in a large texel, the light's centroid is not at the
/// centre.
std::vector<glm::dvec3> first_moments_of(const image::TexelGrid& grid, const std::vector<std::int64_t>& texels) {
  const std::unique_ptr<TexelIntegrals> rows = texel_integrals_of(grid);
  TexelRow row(static_cast<std::size_t>(grid.columns()));
  std::vector<glm::dvec3> result;
  std::int64_t known_row = -1;
  for (const std::int64_t texel : texels) {
    if (texel / grid.columns() != known_row) {
      known_row = texel / grid.columns();
      rows->fill(static_cast<int>(known_row), row);
    }
    const auto column = static_cast<std::size_t>(texel % grid.columns());
    result.push_back(row.moment[column] * glm::dvec3(row.x[column], row.y[column], row.z[column]));
  }
  return result;
}

constexpr int kRingSteps = 2;  // one step is not enough to have a median where lossy compression has left ripples

/// Appends to `found` the texel's neighbours that `wanted` wants and that were not seen before.
template <class Wanted>
void append_neighbours(const image::TexelGrid& grid, std::int64_t texel, std::vector<bool>& seen,
                       std::vector<std::int64_t>& found, const Wanted& wanted) {
  for (const std::int64_t neighbour : grid.neighbours(texel)) {
    if (seen[static_cast<std::size_t>(neighbour)] || !wanted(neighbour)) continue;
    seen[static_cast<std::size_t>(neighbour)] = true;
    found.push_back(neighbour);
  }
}

/// The texels that touch `texels` and were not seen before, rising.
std::vector<std::int64_t> texels_around(const image::TexelGrid& grid, const std::vector<std::int64_t>& texels,
                                        std::vector<bool>& seen) {
  std::vector<std::int64_t> found;
  for (const std::int64_t texel : texels) {
    append_neighbours(grid, texel, seen, found, [](std::int64_t) { return true; });
  }
  std::sort(found.begin(), found.end());
  return found;
}

void add_surroundings(const image::TexelGrid& grid, const float* pixels, std::vector<bool>& seen,
                      BrightRegion& region) {
  region.rim = texels_around(grid, region.spot, seen);
  std::vector<std::int64_t> outermost = region.rim;
  for (int step = 0; step < kRingSteps; ++step) {
    outermost = texels_around(grid, outermost, seen);
    region.ring.insert(region.ring.end(), outermost.begin(), outermost.end());
  }
  const auto has_no_value = [&](std::int64_t texel) { return !is_finite(pixels + 3 * texel); };
  std::erase_if(region.rim, has_no_value);
  std::erase_if(region.ring, has_no_value);
  std::sort(region.ring.begin(), region.ring.end());
}

double cosine_of_degrees(double degrees) { return math::sine_cosine_of_turns(degrees / 360.0).cosine; }

glm::dvec3 mean_direction(const image::TexelGrid& grid, const float* pixels, const std::vector<std::int64_t>& texels) {
  const std::vector<glm::dvec3> moments = first_moments_of(grid, texels);
  glm::dvec3 sum{};
  for (std::size_t i = 0; i < texels.size(); ++i) {
    sum += luminance(radiance_of(pixels + 3 * texels[i])) * moments[i];
  }
  return sum / std::sqrt(glm::dot(sum, sum));
}

/// All finite texels that are at least as bright as `least_luminance` and joined to `seed` by such texels. None if they
/// are no spot of this radius (0 to 90 degrees): if one of them is farther than that from the mean of their directions,
/// weighted by luminance, and no neighbour of the seed. Returns as soon as one is farther than twice the radius from
/// the seed. Takes a bit a texel of the map, and time in proportion to the spot's texels.
std::optional<BrightRegion> find_bright_region(const image::TexelGrid& grid, const float* pixels, std::int64_t seed,
                                               double least_luminance, double maximum_radius_degrees) {
  const glm::dvec3 start = grid.direction(seed);
  const double least_cosine_to_start = cosine_of_degrees(2.0 * maximum_radius_degrees);
  const image::TexelGrid::Neighbours beside = grid.neighbours(seed);
  const auto is_beside = [&](std::int64_t texel) {
    return texel == seed || std::find(beside.begin(), beside.end(), texel) != beside.end();
  };
  const auto bright = [&](std::int64_t texel) {
    const float* rgb = pixels + 3 * texel;
    return is_finite(rgb) && luminance(radiance_of(rgb)) >= least_luminance;
  };

  std::vector<bool> seen(static_cast<std::size_t>(grid.texels()));
  seen[static_cast<std::size_t>(seed)] = true;
  BrightRegion region{{seed}, {}, {}};
  for (std::size_t next = 0; next < region.spot.size(); ++next) {
    const std::int64_t texel = region.spot[next];
    // If all texels are within the radius of one centre, any two of them are within twice the radius of each other. So
    // this rejects spots that the second test would refuse, before a bright sky has been walked to its end.
    // Neighbours of the seed are exempt: on a coarse map one step may be more than the radius.
    if (glm::dot(grid.direction(texel), start) < least_cosine_to_start && !is_beside(texel)) return std::nullopt;
    append_neighbours(grid, texel, seen, region.spot, bright);
  }
  std::sort(region.spot.begin(), region.spot.end());

  // A clipped sun is equally bright all over, and the seed then lies on its rim: its size is known from its middle.
  const glm::dvec3 centre = mean_direction(grid, pixels, region.spot);
  const double least_cosine = cosine_of_degrees(maximum_radius_degrees);
  for (const std::int64_t texel : region.spot) {
    if (glm::dot(grid.direction(texel), centre) < least_cosine && !is_beside(texel)) return std::nullopt;
  }
  add_surroundings(grid, pixels, seen, region);
  return region;
}

/// The median of the ring's texels, channel by channel (of an even number the lower one of the middle two), not below
/// zero. The ring must not be empty.
glm::vec3 radiance_around(const BrightRegion& region, const float* pixels) {
  glm::vec3 median{};
  std::vector<float> values(region.ring.size());
  for (int channel = 0; channel < 3; ++channel) {
    std::transform(region.ring.begin(), region.ring.end(), values.begin(),
                   [&](std::int64_t texel) { return pixels[3 * texel + channel]; });
    // The median, not the mean: the ring may hold a few texels of glare or of another light, which must not be spread
    // over the spot.
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[channel] = std::max(0.0F, *middle);
  }
  return median;
}

/// A texel and what it is to be instead.
struct Replacement {
  std::int64_t texel;
  glm::vec3 radiance;
};

/// For the spot and its rim the light around them, but in no channel more than there was.
std::vector<Replacement> replacements(const BrightRegion& region, const float* pixels) {
  const glm::vec3 around = radiance_around(region, pixels);
  std::vector<Replacement> result;
  for (const auto* texels : {&region.spot, &region.rim}) {
    for (const std::int64_t texel : *texels) {
      const float* rgb = pixels + 3 * texel;
      const glm::vec3 after(std::min(rgb[0], around.r), std::min(rgb[1], around.g), std::min(rgb[2], around.b));
      if (after != glm::vec3(rgb[0], rgb[1], rgb[2])) result.push_back({texel, after});
    }
  }
  std::sort(result.begin(), result.end(), [](const Replacement& a, const Replacement& b) { return a.texel < b.texel; });
  return result;
}

std::vector<std::int64_t> texels_of(const std::vector<Replacement>& changes) {
  std::vector<std::int64_t> texels;
  texels.reserve(changes.size());
  for (const Replacement& change : changes) texels.push_back(change.texel);
  return texels;
}

/// The light that these changes remove.
Sun sum_up(const image::TexelGrid& grid, const float* pixels, const BrightRegion& region,
           const std::vector<Replacement>& changes) {
  Sun sun;
  glm::dvec3 moment{};
  const std::vector<double> steradians = image::solid_angles_of(grid, texels_of(changes));
  const std::vector<glm::dvec3> moments = first_moments_of(grid, texels_of(changes));
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto& [texel, after] = changes[i];
    const glm::dvec3 taken = radiance_of(pixels + 3 * texel) - glm::dvec3(after);
    // This is the irradiance on a surface that faces the sun, but for the cosine over the spot: (1 + cos a) / 2 in the
    // mean for a disc of radius a.
    sun.irradiance += steradians[i] * taken;
    // The direction is that of Int L d dw: a texel of constant radiance adds L Int d dw, exactly.
    moment += luminance(taken) * moments[i];
  }
  const double length = std::sqrt(glm::dot(moment, moment));
  if (length > 0.0) sun.direction = moment / length;
  for (const double angle : image::solid_angles_of(grid, region.spot)) sun.solid_angle += angle;
  sun.radiance = sun.irradiance / sun.solid_angle;
  sun.texels = changes.size();
  // The radius is that of a disc with the spot's solid angle.
  // A disc of radius a has 2 pi (1 - cos a) = 4 pi sin^2(a/2) steradians.
  const double half_sine = std::sqrt(std::min(1.0, sun.solid_angle / (4.0 * std::numbers::pi)));
  sun.angular_radius_degrees = 2.0 * math::arc_sine(half_sine) * (180.0 / std::numbers::pi);
  return sun;
}

std::optional<Sun> take_out(const image::TexelGrid& grid, float* pixels, const SunOptions& options) {
  MapTotals map(grid, pixels);
  const std::int64_t brightest = map.brightest();
  if (brightest < 0) return std::nullopt;
  const double peak = luminance(radiance_of(pixels + 3 * brightest));
  const glm::dvec3 total_radiance = map.total_radiance();
  // The mean over the finite texels' solid angle, not over 4 pi: texels without a value count neither as dark nor as
  // bright.
  const double mean = luminance(total_radiance) / map.solid_angle();
  if (!(peak > 0.0) || peak < options.minimum_contrast * mean) return std::nullopt;

  const auto region =
      find_bright_region(grid, pixels, brightest, options.relative_threshold * peak, options.maximum_radius_degrees);
  if (!region || region->ring.empty()) return std::nullopt;

  const std::vector<Replacement> changes = replacements(*region, pixels);
  Sun sun = sum_up(grid, pixels, *region, changes);
  const double taken = luminance(sun.irradiance);
  if (!(taken > 0.0) || taken < options.minimum_share * luminance(total_radiance)) return std::nullopt;

  for (const Replacement& change : changes) {
    float* rgb = pixels + 3 * change.texel;
    for (int channel = 0; channel < 3; ++channel) rgb[channel] = change.radiance[channel];
  }
  map.update(texels_of(changes));
  sun.total_radiance_before = total_radiance;
  sun.total_radiance_after = map.total_radiance();
  return sun;
}

}  // namespace
}  // namespace welkin::projection

namespace welkin {

std::optional<Sun> extract_sun(LatLongImage& image, const SunOptions& options) {
  const platform::FloatingPointScope floating_point;
  projection::check_options(options);
  image::check_lat_long_size(image.width, image.height);
  const std::size_t texels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (image.pixels.size() != 3 * texels) {
    throw Error(ErrorCode::invalid_argument, "a lat-long of " + std::to_string(image.width) + " x " +
                                                 std::to_string(image.height) + " texels takes " +
                                                 std::to_string(3 * texels) + " floats, not " +
                                                 std::to_string(image.pixels.size()));
  }
  return projection::take_out(image::TexelGrid::lat_long(image.width, image.height), image.pixels.data(), options);
}

std::optional<Sun> extract_sun(Cubemap& image, const SunOptions& options) {
  const platform::FloatingPointScope floating_point;
  projection::check_options(options);
  image::check_view(image.view());
  return projection::take_out(image::TexelGrid::cubemap(image.size()), image.face(0), options);
}

}  // namespace welkin
