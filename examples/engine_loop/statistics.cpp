#include "statistics.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace engine_loop {
namespace {

constexpr double kTexelMegabytes = 12.0e-6;  // as RGB floats

void add_row(std::ostream& text, const Run& run, double base_99_ms) {
  const FrameStatistics frames = frame_statistics(run.frames);
  const BakeStatistics baked = bake_statistics(run.baked);
  text << std::left << std::setw(14) << run.name << std::right << std::setw(7) << run.frames.size() << std::setw(8)
       << frames.median_ms << std::setw(8) << frames.percentile_99_ms << std::setw(8) << frames.longest_ms
       << std::setw(8) << frames.missed << std::setw(9) << frames.percentile_99_ms / base_99_ms;
  if (baked.asked > 0) {
    text << std::setw(9) << baked.asked - baked.replaced << std::setw(10) << baked.replaced << std::setw(8)
         << static_cast<int>(kTexelMegabytes * static_cast<double>(baked.texels)) << std::setw(9)
         << baked.median_latency_ms << std::setw(9) << baked.longest_latency_ms;
  }
  text << '\n';
}

}  // namespace

double percentile(std::vector<double> values, double share) {
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

FrameStatistics frame_statistics(const std::vector<Frame>& frames) {
  std::vector<double> times;
  for (const Frame& frame : frames) times.push_back(frame.total);
  const auto missed = std::count_if(times.begin(), times.end(), [](double time) { return time > kFrame_ms; });
  return {percentile(times, 0.5), percentile(times, 0.99), percentile(times, 1.0), static_cast<std::size_t>(missed)};
}

BakeStatistics bake_statistics(const std::vector<Baked>& baked) {
  BakeStatistics statistics;
  std::vector<double> latencies;
  for (const Baked& one : baked) {
    ++statistics.asked;
    statistics.texels += one.texels;
    if (one.radiance) {
      latencies.push_back(one.latency_ms);
    } else {
      ++statistics.replaced;
    }
  }
  if (latencies.empty()) return statistics;
  statistics.median_latency_ms = percentile(latencies, 0.5);
  statistics.longest_latency_ms = percentile(latencies, 1.0);
  return statistics;
}

std::string table(const std::vector<Run>& runs) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  text << "               frame time, ms                               light\n"
          "run            frames     50 %    99 %     max  missed  99 % /base  done  replaced      MB  ms 50 %   ms "
          "max\n";
  const double base_99_ms = frame_statistics(runs.front().frames).percentile_99_ms;
  for (const Run& run : runs) add_row(text, run, base_99_ms);
  return text.str();
}

}  // namespace engine_loop
