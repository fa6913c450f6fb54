// A run in a few numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "loop.h"

namespace engine_loop {

/// The smallest value that at least that share of all are not above (nearest rank). `values` is not empty.
[[nodiscard]] double percentile(std::vector<double> values, double share);

struct FrameStatistics {
  double median_ms = 0.0;
  double percentile_99_ms = 0.0;
  double longest_ms = 0.0;
  std::size_t missed = 0;  ///< frames that took longer than there is time
};

[[nodiscard]] FrameStatistics frame_statistics(const std::vector<Frame>& frames);

struct BakeStatistics {
  std::size_t asked = 0;
  std::size_t replaced = 0;  ///< by a newer one of the same key
  std::uint64_t texels = 0;
  double median_latency_ms = 0.0;
  double longest_latency_ms = 0.0;
};

[[nodiscard]] BakeStatistics bake_statistics(const std::vector<Baked>& baked);

/// The first run is what the others are compared with.
[[nodiscard]] std::string table(const std::vector<Run>& runs);

}  // namespace engine_loop
