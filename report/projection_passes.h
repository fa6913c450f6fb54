// Radiance to spherical harmonics: from cubemaps, in every format, from lat-longs, from files.
#pragma once

#include <span>
#include <vector>

#include "report/pass_context.h"
#include "welkin/cubemap_chain.h"
#include "welkin/projection.h"

namespace welkin::report {

/// One way to a smaller size.
struct ProjectionWay {
  const char* name;
  Quadrature quadrature;
  bool from_chain;  ///< of plain boxes of four, as engines make them
};

[[nodiscard]] std::span<const ProjectionWay> projection_ways() noexcept;

/// Three bands of `chain`'s level 0 by each way at each target (0: full size), way after way: `method` is the way's
/// name, `setting` "target 64" or "full size". Peers are not among them.
[[nodiscard]] std::vector<Measurement> projections_by_target(const CubemapChain& chain, std::span<const int> targets,
                                                             const SphericalHarmonics& truth,
                                                             const Stopwatch& stopwatch);

[[nodiscard]] std::vector<PassRunner> projection_passes();

}  // namespace welkin::report
