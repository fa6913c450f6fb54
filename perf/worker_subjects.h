// What the worker's benchmarks share.
#pragma once

#include <chrono>

#include "welkin/core.h"
#include "welkin/requests.h"
#include "welkin/worker.h"

namespace welkin::perf {

using Clock = std::chrono::steady_clock;

/// Threads of normal priority: what is measured is the plumbing, not who else wants the processor.
[[nodiscard]] WorkerOptions worker_options(int threads);

/// A request that does nothing. (It has no ==, so that none stands in for another.)
struct Nothing {
  void operator()(const Control& /*control*/) const {}
};

/// As long as an engine computes a frame: the caller's processor stays awake, the worker's threads do not.
void stay_busy(std::chrono::nanoseconds time);

}  // namespace welkin::perf
