#pragma once

#include <vector>

namespace welkin::perf {

/// CancelRunning/REQUEST/SIZE/THREADS: from `cancel()` of a running job, at moments spread over its whole length, to
/// its future being ready. Beside it, from calls alone on one thread, what bounds it: `tile_us` and `longest_tile_us`,
/// the median and the longest time between two tiles' ends; `first_tile_us`, from the call to the first tile's end
/// (opening a file, tables); `last_us`, from the last tile's end to the call's; and `whole_ms`. `worst_at` is the
/// moment of the cancel that took longest, as a share of the job's length.
void add_cancel_latency(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
