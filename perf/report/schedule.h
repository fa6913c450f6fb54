// How long traced work would take on any number of cores.
#pragma once

#include <cstddef>
#include <vector>

#include "jobs/trace.h"

namespace welkin::report {

/// Seconds that the work takes on so many workers, at least 1, that take what is ready without delay: the deepest
/// region first, of a graph's passes the one with the longest way to the end first. No scheduler's own time is in it,
/// and memory is as fast to each worker as it was to one: a bound from below, no prediction.
[[nodiscard]] double scheduled_seconds(const jobs::TracedWork& work, int workers);

/// Seconds of the longest chain of work in which each piece waits for the one before: what no number of workers beats.
[[nodiscard]] double critical_path_seconds(const jobs::TracedWork& work);

/// The parts of a region on its longest way, in their order: one tile; of a graph a chain of passes.
[[nodiscard]] std::vector<std::size_t> longest_way(const jobs::TracedRegion& region);

}  // namespace welkin::report
