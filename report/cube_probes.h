// Where a prefiltered cubemap is compared with the truth: at some of its texels, as the truth is slow.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <random>
#include <vector>

#include "report/error_norms.h"
#include "welkin/cubemap_chain.h"

namespace welkin::report {

/// A texel of a level, counted over faces, rows, columns.
struct Probe {
  std::int64_t texel = 0;
  double weight = 0.0;  ///< of its square in the rms: in proportion to the solid angle that it stands for
};

/// All texels of a level, or one of each of `count` equal runs and beside them the eight brightest and darkest, which
/// have no weight in the rms.
[[nodiscard]] std::vector<Probe> probes_of(const CubemapChain& chain, int level, int count, std::mt19937& random);

/// Unit directions of the probes' centres on a level of `size` texels an edge.
[[nodiscard]] std::vector<glm::dvec3> directions_of(const std::vector<Probe>& probes, int size);

struct ProbeErrors {
  ErrorNorms norms;          ///< rms by solid angle over that of the truth; largest |value - truth| / truth
  double truth_there = 0.0;  ///< at the largest: truth over the mean
};

/// `truth` and `mean`: at the probes, and of the whole. Truth below a millionth of the mean counts as that much: what
/// is black is not measured against 0.
[[nodiscard]] ProbeErrors errors_at(const CubemapChain& chain, int level, const std::vector<Probe>& probes,
                                    const std::vector<glm::dvec3>& truth, const glm::dvec3& mean);

}  // namespace welkin::report
