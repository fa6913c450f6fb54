#include "perf/report/stopwatch.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "perf/report/process.h"
#include "welkin/core.h"

namespace welkin::report {
namespace {

constexpr double kShortestSample = 2e-4;  // a hundred times what reading the clock costs, and more than its step

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double now(Clock clock) {
  if (clock == Clock::wall) return wall_seconds();
  return processor_seconds();
}

}  // namespace

const char* name(Clock clock) noexcept { return clock == Clock::processor ? "processor time" : "wall time"; }

double Stopwatch::seconds(const std::function<void()>& work) const {
  double fastest = 0.0;
  run_with_threads(threads, [&] {
    const Clock by = clock();
    const auto sample = [&](int calls) {
      const double start = now(by);
      for (int call = 0; call < calls; ++call) work();
      return (now(by) - start) / calls;
    };
    const double end = wall_seconds() + budget_seconds;
    fastest = sample(1);
    const int calls = static_cast<int>(std::clamp(std::ceil(kShortestSample / std::max(fastest, 1e-9)), 1.0, 1e5));
    double warm = HUGE_VAL;
    // The second run does not wait for the wall clock to allow it: a busy machine may have taken the budget away.
    for (int run = 1; run < most_runs && (wall_seconds() < end || (run == 1 && fastest < budget_seconds)); ++run) {
      warm = std::min(warm, sample(calls));
    }
    if (warm < HUGE_VAL) fastest = warm;
  });
  return fastest;
}

}  // namespace welkin::report
