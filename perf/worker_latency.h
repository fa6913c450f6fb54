#pragma once

#include <vector>

namespace welkin::perf {

/// PostToStart/STATE/empty/THREADS: from the call of `post` to the request's first instruction on a worker's thread;
/// the worker has just finished a job (warm) or has been asleep for a while. Without a priority in the name, threads
/// are of normal priority.
///
/// PostToResult/HOW/SIZE/THREADS: from the call of `post` with a cubemap of SIZE texels an edge to its result in the
/// caller's hands, which waits on the future or polls; back to back, or after a frame's pause. Beside it `sync_us`, the
/// call of `project` in an arena of as many threads, in turn with the posts, and `overhead_us`, what posting takes
/// longer: medians, and the fastest of each. Large cubemaps vary by more than that from call to call: `outside_us` is
/// the part of each post that is not in the request, `to_start_us` before and `to_caller_us` after it (medians).
void add_worker_latency(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
