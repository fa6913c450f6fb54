// A grid looked up by the code that shaders use.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "platform/float_environment.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
namespace probes {
namespace {

using glm::abs;
using glm::dot;
using glm::floor;
using glm::length;
using glm::max;
using glm::min;

/// What the shaders' code reads, and the code.
class Lookup {
 public:
  using vec2 = glm::vec<2, float, glm::packed_highp>;
  using vec3 = glm::vec<3, float, glm::packed_highp>;
  using ivec3 = glm::vec<3, int, glm::packed_highp>;

  explicit Lookup(const BakedProbes& probes) : probes_(probes) {}

#include "probes/probe_sampling.glsl"

 private:
  [[nodiscard]] vec3 probe_coefficient(int probe, int index) const {
    return vec3(probes_.coefficients[static_cast<std::size_t>(probe) * squared(probes_.bands) +
                                     static_cast<std::size_t>(index)]);
  }
  [[nodiscard]] vec2 probe_distance(int probe, int column, int row) const {
    const int edge = probes_.distance_edge();
    const float* texel = probes_.distances.data() + static_cast<std::size_t>(probe) * distance_floats(probes_) +
                         2 * static_cast<std::size_t>(row * edge + column);
    return {texel[0], texel[1]};
  }
  [[nodiscard]] float probe_share(int probe) const {
    return welkin::probe_share(probes_.passes[static_cast<std::size_t>(probe)]);
  }

  const BakedProbes& probes_;
};

/// The shaders' code makes indices of what it computes: a NaN would lead out of all arrays.
void check_lookup(const dvec3& position, const dvec3& normal, const ProbeSampling& sampling) {
  bool is_good = std::abs(sampling.normal_bias) <= 1e3;
  for (int axis = 0; axis < 3; ++axis) {
    is_good = is_good && std::abs(position[axis]) <= kFarthest && std::abs(normal[axis]) <= 1.0 + 1e-6;
  }
  if (is_good) return;
  throw Error(
      ErrorCode::invalid_argument,
      "probe_irradiance: a position must be within 1e15 of the origin, a normal of unit length, and normal_bias "
      "at most 1000");
}

}  // namespace
}  // namespace probes

dvec3 probe_irradiance(const BakedProbes& probes, const dvec3& position, const dvec3& normal,
                       const ProbeSampling& sampling) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  probes::check_lookup(position, normal, sampling);
  const double spacing = std::min({probes.grid.spacing.x, probes.grid.spacing.y, probes.grid.spacing.z});
  probes::Lookup lookup(probes);
  const probes::Lookup::ProbeVolume volume{
      .origin = vec3(probes.grid.origin),
      .spacing = vec3(probes.grid.spacing),
      .counts = {probes.grid.counts[0], probes.grid.counts[1], probes.grid.counts[2]},
      .bands = probes.bands,
      .distance_edge = probes.distance_edge(),
      .normal_bias = static_cast<float>(sampling.normal_bias * spacing),
      .visibility = sampling.visibility && probes.distance_size > 0 ? 1 : 0,
      .facing = sampling.facing ? 1 : 0,
      .validity = sampling.validity ? 1 : 0,
  };
  return lookup.probe_volume_light(volume, vec3(position), vec3(normal));
}

}  // namespace welkin
