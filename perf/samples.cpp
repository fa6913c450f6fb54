#include "samples.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace welkin::perf {

std::chrono::nanoseconds Samples::quantile(double share) const {
  std::vector<std::chrono::nanoseconds> sorted = times_;
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

void Samples::report(benchmark::State& state) const {
  state.counters["median_us"] = microseconds(0.5);
  state.counters["p99_us"] = microseconds(0.99);
  state.counters["max_us"] = microseconds(1.0);
}

}  // namespace welkin::perf
