#include "perf/report/measurement.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace welkin::report {

std::vector<Measurement> of_pass(const Report& report, const std::string& pass) {
  std::vector<Measurement> found;
  std::copy_if(report.measurements.begin(), report.measurements.end(), std::back_inserter(found),
               [&](const Measurement& measurement) { return measurement.pass == pass; });
  return found;
}

std::string label(const Measurement& measurement) {
  const std::string own = measurement.method + ", " + measurement.setting;
  return measurement.peer.empty() ? own : measurement.peer + ": " + own;
}

namespace {

bool counts(const Measurement& one) {
  return one.peer.empty() && std::isfinite(one.error_rms) && std::isfinite(one.seconds);
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const Measurement> measurements) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < measurements.size(); ++k) {
    if (counts(measurements[k])) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Measurement& one = measurements[a];
    const Measurement& other = measurements[b];
    return one.seconds < other.seconds || (one.seconds == other.seconds && one.error_rms < other.error_rms);
  });
  std::vector<std::size_t> front;
  for (const std::size_t k : order) {
    if (front.empty() || measurements[k].error_rms < measurements[front.back()].error_rms) front.push_back(k);
  }
  return front;
}

std::optional<std::size_t> recommend(std::span<const Measurement> measurements, double target, double tolerance) {
  double fastest = HUGE_VAL;
  for (const Measurement& one : measurements) {
    if (counts(one) && one.error_rms <= target) fastest = std::min(fastest, one.seconds);
  }
  // Along the front the error falls: the last one in reach of the fastest is the most exact of them.
  std::optional<std::size_t> chosen;
  for (const std::size_t k : pareto_front(measurements)) {
    if (measurements[k].error_rms <= target && measurements[k].seconds <= fastest * (1.0 + tolerance)) chosen = k;
  }
  return chosen;
}

std::vector<Recommendation> recommendations(const Report& report) {
  std::vector<Recommendation> all;
  for (const Pass& pass : report.passes) {
    const std::vector<Measurement> measurements = of_pass(report, pass.id);
    for (const double target : kErrorTargets) {
      Recommendation one{pass.id, target, std::nullopt};
      if (const auto index = recommend(measurements, target)) one.setting = measurements[*index];
      all.push_back(one);
    }
  }
  return all;
}

}  // namespace welkin::report
