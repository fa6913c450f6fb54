// Many measurements of one thing, where the mean says little.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <vector>

namespace welkin::perf {

[[nodiscard]] inline double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

class Samples {
 public:
  void add(std::chrono::nanoseconds time) { times_.push_back(time); }

  [[nodiscard]] bool empty() const { return times_.empty(); }

  /// The time that `share` of the samples do not exceed: 0.5 is the median, 1 the maximum.
  [[nodiscard]] std::chrono::nanoseconds quantile(double share) const;
  [[nodiscard]] double microseconds(double share) const { return 1e6 * seconds(quantile(share)); }

  /// As the counters median_us, p99_us and max_us.
  void report(benchmark::State& state) const;

 private:
  std::vector<std::chrono::nanoseconds> times_;
};

}  // namespace welkin::perf
