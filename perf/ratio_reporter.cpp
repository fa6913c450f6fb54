#include "ratio_reporter.h"

#include <algorithm>
#include <iomanip>
#include <ostream>

namespace welkin::perf {
namespace {

/// Google Benchmark appends "/real_time" and, with repetitions, "/repeats:N".
std::string own_name(const std::string& full) {
  const std::size_t end = full.find("/real_time");
  const std::size_t repeats = full.find("/repeats:");
  return full.substr(0, std::min(end, repeats));
}

/// Latencies: their own counters say what is to be compared.
bool is_latency(const std::string& full) { return full.find("/manual_time") != std::string::npos; }

}  // namespace

void RatioReporter::ReportRuns(const std::vector<Run>& runs) {
  ConsoleReporter::ReportRuns(runs);
  for (const Run& run : runs) {
    if (run.run_type != Run::RT_Iteration || run.error_occurred || is_latency(run.benchmark_name())) continue;
    const double seconds = run.real_accumulated_time / static_cast<double>(run.iterations);
    const auto [at, added] = fastest_seconds_.try_emplace(own_name(run.benchmark_name()), seconds);
    if (!added && seconds < at->second) at->second = seconds;
    const auto bytes = run.counters.find("bytes/s");
    if (bytes == run.counters.end()) continue;
    double& rate = largest_rate_[own_name(run.benchmark_name())];
    rate = std::max(rate, bytes->second.value);
  }
}

void RatioReporter::Finalize() {
  std::ostream& out = GetOutputStream();
  out << "\nRatios within this run (fastest repetitions)\n" << std::fixed;
  for (const auto& [name, seconds] : fastest_seconds_) {
    const std::size_t slash = name.find('/');
    const std::string subject = name.substr(0, slash);
    const auto read = fastest_seconds_.find("ReadBandwidth" + name.substr(slash));
    if (subject.starts_with("Project") && read != fastest_seconds_.end()) {
      out << "  " << std::setw(40) << std::left << name << std::right << std::setw(6) << std::setprecision(1)
          << 100.0 * read->second / seconds << " % of ReadBandwidth\n";
    }
    const bool copies = subject == "LatLongToCubemap" || subject == "SampleGrid" || subject == "Mips";
    // "1024x512-256" is as large as 256.
    const std::string size_and_threads = name.substr(name.find_last_of("/-", name.rfind('/') - 1) + 1);
    const auto copying = largest_rate_.find("CopyBandwidth/rgb32f/" + size_and_threads);
    if (copies && copying != largest_rate_.end()) {
      out << "  " << std::setw(40) << std::left << name << std::right << std::setw(6) << std::setprecision(1)
          << 100.0 * largest_rate_[name] / copying->second << " % of CopyBandwidth\n";
    }
    if (!name.ends_with("/2")) continue;
    const auto single = fastest_seconds_.find(name.substr(0, name.size() - 1) + "1");
    if (single == fastest_seconds_.end()) continue;
    out << "  " << std::setw(40) << std::left << name << std::right << std::setw(6) << std::setprecision(2)
        << single->second / seconds << " x as fast as with 1 thread\n";
  }
}

}  // namespace welkin::perf
