// Limits of grids of probes, and checks of the arguments of calls about them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "jobs/tiles.h"
#include "welkin/probes.h"

namespace welkin::probes {

inline constexpr int kMaxBands = 4;
inline constexpr double kFarthest = 1e15;       ///< of positions and origins: floats square it without an overflow
inline constexpr std::uint8_t kUnfilled = 255;  ///< in `BakedProbes::passes`
inline constexpr std::uint8_t kLastPass = 254;  ///< in `BakedProbes::passes`, of that pass and all later ones

[[nodiscard]] inline std::size_t squared(int edge) noexcept {
  return static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
}

/// Floats of a probe's map of distances.
[[nodiscard]] inline std::size_t distance_floats(const BakedProbes& probes) noexcept {
  return 2 * squared(probes.distance_edge());
}

/// Throws `Error` (invalid_argument).
[[noreturn]] inline void refuse(const std::string& what) { throw Error(ErrorCode::invalid_argument, what); }

/// The text of probe_sampling.glsl.
extern const char* const kProbeSampling;

/// Throws `Error` (invalid_argument) unless the grid is one.
void check_grid(const ProbeGrid& grid);

/// Throws `Error` (invalid_argument) for options that no grid can be baked with.
void check_options(const ProbeOptions& options, bool with_depths);

/// Throws `Error` (invalid_argument) unless each array has the length that grid, bands and sizes give it.
void check_arrays(const BakedProbes& probes);

/// Calls work(probe) for all, for cheap work: in tiles of many.
template <class Work>
void for_each_probe(std::size_t count, std::int64_t cost_in_texels, const Control& control, const Work& work) {
  constexpr int kProbesPerTile = 256;
  const auto placement = jobs::placement_for(static_cast<std::int64_t>(count) * cost_in_texels);
  jobs::run_rows(static_cast<int>(count), kProbesPerTile, placement, jobs::worker_count(placement), control,
                 [&](int probe, std::size_t /*worker*/) { work(static_cast<std::size_t>(probe)); });
}

}  // namespace welkin::probes
