// What the worker's benchmarks share.
#pragma once

#include <atomic>
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

/// A request that keeps a thread busy, and awake, until `released`.
struct BusyUntil {
  const std::atomic<bool>* released;

  void operator()(const Control& /*control*/) const {
    while (!released->load(std::memory_order_acquire)) {
    }
  }
};

/// Sources with different numbers are not equal, though their pixels are the same: they stay in the caches, as those
/// of the synchronous call do. The pixels belong to `noise_cubemap`.
[[nodiscard]] CubemapSource numbered_source(int size, int number);

/// As long as an engine computes a frame: the caller's processor stays awake, the worker's threads do not.
void stay_busy(std::chrono::nanoseconds time);

}  // namespace welkin::perf
