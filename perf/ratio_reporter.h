// Ratios between benchmarks of one run: what a shared, noisy machine can honestly be asked for.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace welkin::perf {

/// Prints the usual table and, when all has run, how each projection's time compares with ReadBandwidth's
/// for the same bytes, those passes' rates that read and write with
/// CopyBandwidth's, and two threads' times with one's. Of repetitions the fastest counts.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  using ConsoleReporter::ConsoleReporter;

  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override;

 private:
  std::map<std::string, double> fastest_seconds_;  ///< by Subject/variant/size/threads
  std::map<std::string, double> largest_rate_;     ///< bytes a second, likewise
};

}  // namespace welkin::perf
