#include "plan/calibration_times.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>

namespace welkin::planning {
namespace {

constexpr int kRuns = 3;
constexpr double kNanosecond = 1e-9;
constexpr double kMillisecond = 1e6;  ///< in nanoseconds

/// In nanoseconds. Where other programs want the processor wall time is too long; where other threads of this one work,
/// its processor time is: the lesser is nearer to what the work takes.
struct Effort {
  double wall = 0.0;
  double processor = 0.0;
  [[nodiscard]] double least() const { return std::min(wall, processor); }
};

Effort effort_of(const std::function<void()>& work) {
  const std::clock_t processor = std::clock();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double, std::nano> wall = std::chrono::steady_clock::now() - start;
  const double seconds = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  return {wall.count(), seconds / kNanosecond};
}

/// Short pieces are repeated until one of them was not disturbed, as a rule.
bool enough(int runs, double nanoseconds) {
  constexpr double kEnough = 30.0 * kMillisecond;
  constexpr int kMostRuns = 50;
  return runs >= kRuns && (nanoseconds >= kEnough || runs >= kMostRuns);
}

/// Passes longer than this lost time to other programs in proportion; shorter ones did or did not.
constexpr double kSlice = 2.0;

void keep_fastest(std::vector<PassRecord>& fastest, const std::vector<PassRecord>& run, const Effort& effort) {
  if (fastest.empty()) fastest = run;
  const double share = effort.least() / effort.wall;
  for (std::size_t pass = 0; pass < fastest.size(); ++pass) {
    const double wall = run[pass].milliseconds;
    const double time = wall < kSlice ? wall : std::max(kSlice, wall * share);
    fastest[pass].milliseconds = std::min(fastest[pass].milliseconds, time);
  }
}

}  // namespace

double fastest_nanoseconds(const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (int runs = 0; !enough(runs, sum); ++runs) {
    const double time = std::max(1.0, effort_of(work).least());
    least = std::min(least, time);
    sum += time;
  }
  return least;
}

std::vector<PassRecord> fastest_passes(const std::function<std::vector<PassRecord>()>& work) {
  std::vector<PassRecord> fastest;
  double sum = 0.0;
  for (int runs = 0; !enough(runs, sum); ++runs) {
    std::vector<PassRecord> passes;
    const Effort effort = effort_of([&] { passes = work(); });
    keep_fastest(fastest, passes, effort);
    sum += effort.least();
  }
  return fastest;
}

double nanoseconds_of(const std::vector<PassRecord>& passes, const std::string& name) {
  double sum = 0.0;
  for (const PassRecord& pass : passes) {
    if (pass.name == name) sum += kMillisecond * pass.milliseconds;
  }
  return sum;
}

}  // namespace welkin::planning
