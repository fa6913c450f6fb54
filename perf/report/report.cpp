#include "perf/report/measuring.h"
#include "welkin/core.h"

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

namespace {

std::string key(const Measurement& one) {
  return one.pass + '\n' + one.method + '\n' + one.setting + '\n' + one.peer.substr(0, one.peer.find(' '));
}

/// after / before, both at least `floor`. What became no number is infinitely worse.
double ratio(double before, double after, double floor) {
  if (std::isnan(after)) return std::isnan(before) ? 1.0 : HUGE_VAL;
  if (std::isnan(before)) return 0.0;
  return std::max(after, floor) / std::max(before, floor);
}

std::string why_not_times(const Machine& before, const Machine& after) {
  if (before.processor != after.processor) return "the processors differ";
  if (before.instruction_set != after.instruction_set) return "the instruction sets differ";
  if (before.threads != after.threads || before.clock != after.clock) return "threads or clocks differ";
  return "";
}

void require_comparable(const Report& before, const Report& after, const ComparisonOptions& options) {
  if (before.scale != after.scale || before.environment != after.environment) {
    throw Error(ErrorCode::invalid_argument, "the older report is of scale '" + before.scale + "' on " +
                                                 before.environment + ", this one of scale '" + after.scale + "' on " +
                                                 after.environment + "; compare equal ones");
  }
  if (options.error_factor < 1.0 || options.time_factor < 1.0) {
    throw Error(ErrorCode::invalid_argument, "a factor below 1 would call every setting worse");
  }
}

void sort_by(std::vector<Change>& changes, const std::function<double(const Change&)>& worth) {
  std::stable_sort(changes.begin(), changes.end(),
                   [&](const Change& a, const Change& b) { return worth(a) > worth(b); });
}

void file_under(Comparison& result, const Change& change, const ComparisonOptions& options) {
  ++result.compared;
  if (!change.after.peer.empty()) return;
  if (change.worst_ratio > options.error_factor) {
    result.worse_error.push_back(change);
  } else if (change.best_ratio < 1.0 / options.error_factor) {
    result.better_error.push_back(change);
  }
  if (change.time_ratio > options.time_factor) result.slower.push_back(change);
  if (change.time_ratio < 1.0 / options.time_factor) result.faster.push_back(change);
}

std::string error_line(const Change& change) {
  return "  " + change.after.pass + ": " + label(change.after) + ": rms " + percent(change.before.error_rms) + " -> " +
         percent(change.after.error_rms) + ", maximum " + percent(change.before.error_maximum) + " -> " +
         percent(change.after.error_maximum) + '\n';
}

std::string time_line(const Change& change) {
  return "  " + change.after.pass + ": " + label(change.after) + ": " + duration(change.before.seconds) + " -> " +
         duration(change.after.seconds) + '\n';
}

std::string lines(const char* title, const std::vector<Change>& changes, std::string (*line)(const Change&)) {
  if (changes.empty()) return "";
  std::string text = std::string(title) + " (" + std::to_string(changes.size()) + "):\n";
  for (const Change& change : changes) text += line(change);
  return text;
}

std::string lines(const char* title, const std::vector<Measurement>& measurements) {
  if (measurements.empty()) return "";
  std::string text = std::string(title) + " (" + std::to_string(measurements.size()) + "):\n";
  for (const Measurement& one : measurements) text += "  " + one.pass + ": " + label(one) + '\n';
  return text;
}

}  // namespace

Comparison compare(const Report& before, const Report& after, const ComparisonOptions& options) {
  require_comparable(before, after, options);
  Comparison result;
  result.times_refused = why_not_times(before.machine, after.machine);
  std::map<std::string, Measurement> old;
  std::set<std::string> old_passes;
  std::set<std::string> new_passes;
  for (const Measurement& one : before.measurements) {
    old.emplace(key(one), one);
    old_passes.insert(one.pass);
  }
  for (const Measurement& one : after.measurements) {
    new_passes.insert(one.pass);
    const auto found = old.find(key(one));
    if (found == old.end()) {
      if (old_passes.contains(one.pass)) result.added.push_back(one);
      continue;
    }
    Change change{found->second, one};
    const double rms = ratio(change.before.error_rms, one.error_rms, options.least_error);
    const double maximum = ratio(change.before.error_maximum, one.error_maximum, options.least_error);
    change.worst_ratio = std::max(rms, maximum);
    change.best_ratio = std::min(rms, maximum);
    if (result.times_refused.empty()) change.time_ratio = ratio(change.before.seconds, one.seconds, 1e-9);
    file_under(result, change, options);
    old.erase(found);
  }
  for (const Measurement& one : before.measurements) {
    if (old.contains(key(one)) && new_passes.contains(one.pass)) result.gone.push_back(one);
  }
  sort_by(result.worse_error, [](const Change& change) { return change.worst_ratio; });
  sort_by(result.better_error, [](const Change& change) { return -change.best_ratio; });
  sort_by(result.slower, [](const Change& change) { return change.time_ratio; });
  sort_by(result.faster, [](const Change& change) { return -change.time_ratio; });
  return result;
}

std::string to_text(const Comparison& comparison) {
  std::string text =
      lines("Larger error", comparison.worse_error, error_line) + lines("Slower", comparison.slower, time_line) +
      lines("Smaller error", comparison.better_error, error_line) + lines("Faster", comparison.faster, time_line) +
      lines("No longer measured", comparison.gone) + lines("New", comparison.added);
  if (!comparison.times_refused.empty()) text += "Times are not compared: " + comparison.times_refused + ".\n";
  return text + std::to_string(comparison.compared) + " settings compared: " +
         (comparison.regressed() ? "some are worse than before.\n" : "none is worse than before.\n");
}

}  // namespace welkin::report
