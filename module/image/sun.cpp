// The sun found in a map and taken out of it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "image/bright_region.h"
#include "image/map_flux.h"
#include "image/texel_grid.h"
#include "tables/trigonometry.h"
#include "welkin/directional_light.h"
#include "welkin/error.h"

namespace welkin {
namespace image {
namespace {

void require_range(const char* name, double value, double low, double high, const char* range) {
  if (value >= low && value <= high) return;
  throw Error(ErrorCode::invalid_argument,
              "SunOptions::" + std::string(name) + " is " + std::to_string(value) + "; it must be " + range);
}

void check_options(const SunOptions& options) {
  constexpr double least = 1e-9;
  require_range("relative_threshold", options.relative_threshold, least, 1.0, "above 0 and at most 1");
  require_range("maximum_radius_degrees", options.maximum_radius_degrees, 0.0, 90.0, "from 0 to 90");
  require_range("minimum_contrast", options.minimum_contrast, 1.0, 1e300, "at least 1");
  require_range("minimum_share", options.minimum_share, 0.0, 1.0, "from 0 to 1");
}

void check_shape(int columns, int rows, int largest_columns, int largest_rows, std::size_t values, const char* what) {
  const bool in_range = columns >= 1 && columns <= largest_columns && rows >= 1 && rows <= largest_rows;
  if (in_range && values == std::size_t{3} * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) return;
  throw Error(ErrorCode::invalid_argument,
              std::string(what) + " of " + std::to_string(columns) + " x " + std::to_string(rows) + " texels with " +
                  std::to_string(values) + " floats is none: it takes 3 floats a texel, and from 1 x 1 to " +
                  std::to_string(largest_columns) + " x " + std::to_string(largest_rows) + " texels");
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

/// What these changes take away.
Sun sum_up(const TexelGrid& grid, const float* pixels, const BrightRegion& region,
           const std::vector<Replacement>& changes) {
  Sun sun;
  glm::dvec3 moment{};
  const std::vector<double> steradians = solid_angles_of(grid, texels_of(changes));
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const auto& [texel, after] = changes[i];
    const glm::dvec3 taken = steradians[i] * (radiance_of(pixels + 3 * texel) - glm::dvec3(after));
    sun.irradiance += taken;
    moment += luminance(taken) * grid.direction(texel);
  }
  const double length = std::sqrt(glm::dot(moment, moment));
  if (length > 0.0) sun.direction = moment / length;
  for (const double angle : solid_angles_of(grid, region.spot)) sun.solid_angle += angle;
  sun.radiance = sun.irradiance / sun.solid_angle;
  sun.texels = changes.size();
  // A disc of radius a has 2 pi (1 - cos a) = 4 pi sin^2(a/2) steradians.
  const double half_sine = std::sqrt(std::min(1.0, sun.solid_angle / (4.0 * std::numbers::pi)));
  sun.angular_radius_degrees = 2.0 * tables::arc_sine(half_sine) * (180.0 / std::numbers::pi);
  return sun;
}

std::optional<Sun> take_out(const TexelGrid& grid, float* pixels, const SunOptions& options) {
  MapFlux map(grid, pixels);
  const std::int64_t brightest = map.brightest();
  if (brightest < 0) return std::nullopt;
  const double peak = luminance(radiance_of(pixels + 3 * brightest));
  const glm::dvec3 flux = map.flux();
  const double mean = luminance(flux) / map.solid_angle();
  if (!(peak > 0.0) || peak < options.minimum_contrast * mean) return std::nullopt;

  const auto region =
      find_bright_region(grid, pixels, brightest, options.relative_threshold * peak, options.maximum_radius_degrees);
  if (!region || region->ring.empty()) return std::nullopt;

  const std::vector<Replacement> changes = replacements(*region, pixels);
  Sun sun = sum_up(grid, pixels, *region, changes);
  const double taken = luminance(sun.irradiance);
  if (!(taken > 0.0) || taken < options.minimum_share * luminance(flux)) return std::nullopt;

  for (const Replacement& change : changes) {
    float* rgb = pixels + 3 * change.texel;
    for (int channel = 0; channel < 3; ++channel) rgb[channel] = change.radiance[channel];
  }
  map.update(texels_of(changes));
  sun.flux_before = flux;
  sun.flux_after = map.flux();
  return sun;
}

}  // namespace
}  // namespace image

std::optional<Sun> take_out_sun(LatLongImage& image, const SunOptions& options) {
  image::check_options(options);
  image::check_shape(image.width, image.height, 65536, 32768, image.pixels.size(), "a lat-long");
  return image::take_out(image::TexelGrid::lat_long(image.width, image.height), image.pixels.data(), options);
}

std::optional<Sun> take_out_sun(CubemapImage& image, const SunOptions& options) {
  image::check_options(options);
  const int size = std::clamp(image.size, 0, 16385);  // six times anything larger might not be an int
  image::check_shape(size, 6 * size, 16384, 6 * 16384, image.pixels.size(),
                     "a cubemap, its faces one below the other,");
  return image::take_out(image::TexelGrid::cubemap(size), image.pixels.data(), options);
}

}  // namespace welkin
