// Made-up captures of a grid of probes.
#pragma once

#include "support/catch.h"
#include "support/images.h"
#include "welkin/image.h"
#include "welkin/probes.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

inline constexpr float kNothing = std::numeric_limits<float>::infinity();

/// The radiance and the distance that a probe sees in the direction of a texel's centre.
using Light = std::function<dvec3(std::size_t probe, const dvec3& direction)>;
using Depth = std::function<float(std::size_t probe, const dvec3& direction)>;

/// Cubemaps and depths, and the views of them.
struct Captures {
  std::vector<Cubemap> images;
  std::vector<std::vector<float>> distances;
  std::vector<CubemapView> cubes;
  std::vector<DepthView> depths;

  Captures() = default;

  Captures(std::size_t count, int size, const Light& light, int depth_size = 0, const Depth& depth = {}) {
    for (std::size_t k = 0; k < count; ++k) {
      images.push_back(cubemap_of(size, [&](const dvec3& direction) { return light(k, direction); }));
      if (depth_size == 0) continue;
      distances.emplace_back();
      for (const dvec3& direction : texel_centres(depth_size)) distances.back().push_back(depth(k, direction));
    }
    for (const Cubemap& image : images) cubes.push_back(image.view());
    for (const std::vector<float>& each : distances) depths.push_back(depth_view(each, depth_size));
  }

  [[nodiscard]] BakedProbes bake(const ProbeGrid& grid, const ProbeOptions& options = {},
                                 const Control& control = {}) const {
    return bake_probes(grid, cubes, depths, options, control);
  }

  static DepthView depth_view(const std::vector<float>& distances, int size) {
    DepthView view{{}, size, 0};
    const auto face = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    for (std::size_t f = 0; f < 6; ++f) view.faces[f] = distances.data() + f * face;
    return view;
  }
};

inline SphericalHarmonics radiance_of(const BakedProbes& probes, std::size_t probe) {
  SphericalHarmonics radiance(probes.bands);
  const std::size_t functions = radiance.coefficients().size();
  std::copy_n(probes.coefficients.begin() + static_cast<std::ptrdiff_t>(probe * functions), functions,
              radiance.coefficients().begin());
  return radiance;
}

/// Returns the distance from a position inside a box with corners `low` and `high` to its walls.
inline double distance_to_walls(const dvec3& position, const dvec3& direction, const dvec3& low, const dvec3& high) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) continue;
    const double wall = direction[axis] > 0.0 ? high[axis] : low[axis];
    nearest = std::min(nearest, (wall - position[axis]) / direction[axis]);
  }
  return nearest;
}

}  // namespace welkin::test
