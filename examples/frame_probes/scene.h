// A small scene that changes every frame, and its renderer: stands for an engine's capture of a probe on the GPU.
#pragma once

#include <probes/cube_frames.h>
#include <welkin/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>

namespace frame_probes {

/// A room 8 m by 4 m by 8 m about the origin with walls of different colours, a matte sphere, and a lamp that circles
/// below the ceiling.
class Scene {
 public:
  explicit Scene(int frame) : lamp_(2.5 * std::cos(0.03 * frame), 1.2, 2.5 * std::sin(0.03 * frame)) {}

  /// Returns the radiance that arrives at `from`, inside the room, against the unit vector `direction`.
  [[nodiscard]] welkin::dvec3 radiance(const welkin::dvec3& from, const welkin::dvec3& direction) const {
    if (distance_to_sphere(from, direction, lamp_, 0.25) < kNothing) return {60.0, 50.0, 35.0};
    const double distance = distance_to_sphere(from, direction, kSphere, 0.8);
    if (distance < kNothing) {
      const welkin::dvec3 position = from + distance * direction;
      return shaded(position, glm::normalize(position - kSphere), {0.8, 0.3, 0.2});
    }
    return wall(from, direction);
  }

 private:
  static constexpr double kNothing = std::numeric_limits<double>::infinity();
  static constexpr welkin::dvec3 kSphere{0.5, -1.2, 0.3};
  static constexpr welkin::dvec3 kHalfRoom{4.0, 2.0, 4.0};

  /// Returns the distance to a sphere's front in metres, infinity if the ray misses it.
  static double distance_to_sphere(const welkin::dvec3& from, const welkin::dvec3& direction,
                                   const welkin::dvec3& center, double radius) {
    const welkin::dvec3 to_center = center - from;
    const double nearest = glm::dot(to_center, direction);
    const double discriminant = nearest * nearest - glm::dot(to_center, to_center) + radius * radius;
    return nearest > 0.0 && discriminant > 0.0 ? nearest - std::sqrt(discriminant) : kNothing;
  }

  /// Returns the light that a matte surface reflects from the lamp, without shadows, and from a dim surround.
  [[nodiscard]] welkin::dvec3 shaded(const welkin::dvec3& position, const welkin::dvec3& normal,
                                     const welkin::dvec3& albedo) const {
    const welkin::dvec3 to_lamp = lamp_ - position;
    const double squared = glm::dot(to_lamp, to_lamp);
    const double cosine = std::max(0.0, glm::dot(normal, to_lamp)) / std::sqrt(squared);
    return albedo * (0.1 + 4.0 * cosine / squared);
  }

  [[nodiscard]] welkin::dvec3 wall(const welkin::dvec3& from, const welkin::dvec3& direction) const {
    double distance = kNothing;
    int axis = 0;
    for (int k = 0; k < 3; ++k) {
      if (direction[k] == 0.0) continue;
      const double to_wall = ((direction[k] > 0.0 ? kHalfRoom[k] : -kHalfRoom[k]) - from[k]) / direction[k];
      if (to_wall < distance) {
        distance = to_wall;
        axis = k;
      }
    }
    welkin::dvec3 normal(0.0);
    normal[axis] = direction[axis] > 0.0 ? -1.0 : 1.0;
    welkin::dvec3 albedo(0.7);
    albedo[axis] = normal[axis] > 0.0 ? 0.25 : 0.5;
    return shaded(from + distance * direction, normal, albedo);
  }

  welkin::dvec3 lamp_;
};

/// A texel of a capture: red, green, blue and alpha as half floats, as a GPU renders them.
using HalfTexel = std::array<std::uint16_t, 4>;

/// Renders what a probe at `position` sees into `texels`: six faces of size * size, as `welkin::CubemapView` has them.
inline void capture(const Scene& scene, const welkin::dvec3& position, int size, std::span<HalfTexel> texels) {
  auto texel = texels.begin();
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column, ++texel) {
        const welkin::dvec3 light = scene.radiance(position, cube_frames::direction_of(face, column, row, size));
        for (int channel = 0; channel < 3; ++channel) {
          (*texel)[static_cast<std::size_t>(channel)] = glm::packHalf1x16(static_cast<float>(light[channel]));
        }
        (*texel)[3] = glm::packHalf1x16(1.0F);
      }
    }
  }
}

}  // namespace frame_probes
