#pragma once

#include <vector>

namespace welkin::perf {

/// JobThroughput/HOW/64/THREADS, cubemaps of 64 texels an edge, one an iteration:
/// - in-flight-N: posted to a worker of THREADS threads, N or half as many of them in flight, all different;
/// - one-after-another: synchronous calls in an arena of THREADS threads;
/// - side-by-side: synchronous calls by THREADS threads that know nothing of each other.
void add_worker_throughput(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
