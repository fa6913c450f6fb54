// An arena for programs that have none, as wide as the process may really run.
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "welkin/control.h"
#include "welkin/error.h"

namespace welkin {
namespace {

constexpr int kMostThreads = 1024;  // oneTBB makes room for each, and has no bound of its own

/// Processors that the control group's quota grants (cgroup v2: "QUOTA PERIOD" in microseconds, or "max"),
/// or 0 where there is none. oneTBB counts processors by affinity and knows nothing of quotas.
int quota_processors() {
  std::ifstream file("/sys/fs/cgroup/cpu.max");
  std::string quota;
  double period = 0.0;
  if (!(file >> quota >> period) || quota == "max" || period <= 0.0) return 0;
  try {
    return std::max(1, static_cast<int>(std::ceil(std::stod(quota) / period)));
  } catch (const std::exception&) {
    return 0;
  }
}

}  // namespace

int available_threads() {
  const int processors = std::max(1, tbb::info::default_concurrency());
  const int quota = quota_processors();
  return quota > 0 ? std::min(processors, quota) : processors;
}

void run_with_threads(int threads, const std::function<void()>& work) {
  if (threads < 0 || threads > kMostThreads) {
    throw Error(ErrorCode::invalid_argument,
                "threads is " + std::to_string(threads) + "; it must be from 0 to " + std::to_string(kMostThreads));
  }
  const int count = threads == 0 ? available_threads() : threads;
  // Without this, oneTBB never runs more threads than there are processors, and a test on a small machine
  // could not ask for sixteen.
  const tbb::global_control allowance(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(std::max(count, available_threads())));
  tbb::task_arena arena(count);
  arena.execute(work);
}

}  // namespace welkin
