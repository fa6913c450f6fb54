#include "image/bright_region.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "image/map_flux.h"
#include "tables/trigonometry.h"

namespace welkin::image {
namespace {

constexpr int kRingSteps = 2;  // one step is not enough to have a median where lossy compression has left ripples

/// Appends to `found` the texel's neighbours that `wanted` wants and that were not seen before.
template <class Wanted>
void append_neighbours(const TexelGrid& grid, std::int64_t texel, std::vector<bool>& seen,
                       std::vector<std::int64_t>& found, const Wanted& wanted) {
  for (const std::int64_t neighbour : grid.neighbours(texel)) {
    if (seen[static_cast<std::size_t>(neighbour)] || !wanted(neighbour)) continue;
    seen[static_cast<std::size_t>(neighbour)] = true;
    found.push_back(neighbour);
  }
}

/// The texels that touch `texels` and were not seen before, rising.
std::vector<std::int64_t> texels_around(const TexelGrid& grid, const std::vector<std::int64_t>& texels,
                                        std::vector<bool>& seen) {
  std::vector<std::int64_t> found;
  for (const std::int64_t texel : texels) {
    append_neighbours(grid, texel, seen, found, [](std::int64_t) { return true; });
  }
  std::sort(found.begin(), found.end());
  return found;
}

void add_surroundings(const TexelGrid& grid, const float* pixels, std::vector<bool>& seen, BrightRegion& region) {
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

double cosine_of_degrees(double degrees) { return tables::sine_cosine_of_turns(degrees / 360.0).cosine; }

glm::dvec3 mean_direction(const TexelGrid& grid, const float* pixels, const std::vector<std::int64_t>& texels) {
  const std::vector<double> steradians = solid_angles_of(grid, texels);
  glm::dvec3 sum{};
  for (std::size_t i = 0; i < texels.size(); ++i) {
    sum += steradians[i] * luminance(radiance_of(pixels + 3 * texels[i])) * grid.direction(texels[i]);
  }
  return sum / std::sqrt(glm::dot(sum, sum));
}

}  // namespace

std::optional<BrightRegion> find_bright_region(const TexelGrid& grid, const float* pixels, std::int64_t seed,
                                               double least_luminance, double maximum_radius_degrees) {
  const glm::dvec3 start = grid.direction(seed);
  const double least_cosine_to_start = cosine_of_degrees(2.0 * maximum_radius_degrees);
  const TexelGrid::Neighbours beside = grid.neighbours(seed);
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

glm::vec3 radiance_around(const BrightRegion& region, const float* pixels) {
  glm::vec3 median{};
  std::vector<float> values(region.ring.size());
  for (int channel = 0; channel < 3; ++channel) {
    std::transform(region.ring.begin(), region.ring.end(), values.begin(),
                   [&](std::int64_t texel) { return pixels[3 * texel + channel]; });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[channel] = std::max(0.0F, *middle);
  }
  return median;
}

}  // namespace welkin::image
