// The light of a whole map and its brightest texel.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "image/geometry.h"

namespace welkin::projection {

/// Rec. 709 luminance of linear RGB.
[[nodiscard]] inline double luminance(const glm::dvec3& rgb) noexcept {
  return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
}

/// Whether all three channels are numbers.
[[nodiscard]] inline bool is_finite(const float* rgb) noexcept {
  return std::isfinite(rgb[0]) && std::isfinite(rgb[1]) && std::isfinite(rgb[2]);
}

/// A texel's RGB in double.
[[nodiscard]] inline glm::dvec3 radiance_of(const float* rgb) noexcept { return {rgb[0], rgb[1], rgb[2]}; }

/// Sums over the finite texels of a map, and which of them is the brightest. Cut into tiles by the map's shape, each
/// with a slot of its own, so that the same bits come out for any number of threads.
class MapTotals {
 public:
  /// Reads all pixels (RGB floats in the order of the grid), in the caller's arena. They must outlive this object.
  MapTotals(const image::TexelGrid& grid, const float* pixels);

  /// Reads again the tiles in which these texels lie: afterwards all is as if the map had been read anew.
  void update(std::span<const std::int64_t> changed_texels);

  /// Integral of radiance over the sphere.
  [[nodiscard]] glm::dvec3 total_radiance() const noexcept;

  /// Steradians of the finite texels.
  [[nodiscard]] double solid_angle() const noexcept;

  /// Of finite texels the one of the largest luminance, the first of several. -1 if no texel is finite.
  [[nodiscard]] std::int64_t brightest() const noexcept;

 private:
  struct Tile {
    glm::dvec3 total_radiance{};
    double solid_angle = 0.0;
    double brightest_luminance = 0.0;
    std::int64_t brightest = -1;
  };

  void read_tile(std::size_t tile, std::span<double> steradians);
  void read_row(int row, std::span<const double> steradians, Tile& sums) const;

  image::TexelGrid grid_;
  const float* pixels_;
  int classes_per_tile_;
  std::vector<Tile> tiles_;
};

// A bright spot of a map and the ring of texels around it.

struct BrightRegion {
  std::vector<std::int64_t> spot;  ///< its texels, rising
  std::vector<std::int64_t> rim;   ///< finite texels that touch the spot, rising: its edge may cover a part of them
  std::vector<std::int64_t> ring;  ///< finite texels within two more steps, rising
};

/// All finite texels that are at least as bright as `least_luminance` and joined to `seed` by such texels. None if they
/// are no spot of this radius (0 to 90 degrees): if one of them is farther than that from the mean of their directions,
/// weighted by luminance, and no neighbour of the seed. Gives up as soon as one is farther than twice the radius from
/// the seed. Takes a bit a texel of the map, and time in proportion to the spot's texels.
[[nodiscard]] std::optional<BrightRegion> find_bright_region(const image::TexelGrid& grid, const float* pixels,
                                                             std::int64_t seed, double least_luminance,
                                                             double maximum_radius_degrees);

/// The median of the ring's texels, channel by channel (of an even number the lower one of the middle two), not below
/// zero. The ring must not be empty.
[[nodiscard]] glm::vec3 radiance_around(const BrightRegion& region, const float* pixels);

}  // namespace welkin::projection
