#include "perf/report/report.h"

#include "jobs/control.h"
#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::report {

std::vector<Measurement> of_pass(const Report& report, const std::string& pass) {
  std::vector<Measurement> found;
  std::copy_if(report.measurements.begin(), report.measurements.end(), std::back_inserter(found),
               [&](const Measurement& measurement) { return measurement.pass == pass; });
  return found;
}

std::string label(const Measurement& measurement) {
  const std::string name = measurement.method + ", " + measurement.setting;
  return measurement.peer.empty() ? name : measurement.peer + ": " + name;
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
  // Along the front the error decreases: the last setting near the fastest is the most exact of them.
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

/// Returns after / before, both at least `floor`. A value that became NaN is infinitely worse.
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

// Measuring a report.

namespace {

SkyTableOptions sized(int heights, int views, int suns, int angles, ScatteringLayout layout = ScatteringLayout::full) {
  SkyTableOptions options;
  options.layout = layout;
  options.heights = heights;
  options.view_zeniths = views;
  options.sun_zeniths = suns;
  options.sun_angles = angles;
  options.orders = 1;
  return options;
}

std::array<Scale, 3> scales() {
  const std::vector<SkyTableOptions> some{sized(8, 16, 16, 4), sized(16, 32, 16, 4),
                                          sized(32, 64, 32, 8, ScatteringLayout::compact), sized(16, 32, 32, 8),
                                          sized(16, 64, 64, 8)};
  std::vector<SkyTableOptions> all = some;
  all.insert(all.end(), {sized(32, 128, 64, 8), sized(32, 64, 64, 8)});
  const std::vector<double> suns{90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0};
  const std::vector<SkyTableOptions> small{sized(4, 16, 8, 4), sized(8, 16, 16, 4)};
  // Budget; width, cube, chain; probes, samples, bands; tables of the BRDF; suns, zeniths, azimuths, tables of the sky.
  return {{{"tiny", 0.01, 128, 32, 32, 40, 256, 5, 32, 48, {40.0, 2.0}, 8, 8, small, false},
           {"quick", 0.03, 512, 256, 128, 120, 1024, 7, 128, 160, {60.0, 20.0, 2.0, -4.0}, 20, 16, some},
           {"full", 0.4, 1024, 1024, 256, 240, 4096, 9, 256, 384, suns, 40, 32, all}}};
}

}  // namespace

const Scale& scale(const std::string& name) {
  static const std::array<Scale, 3> all = scales();
  for (const Scale& one : all) {
    if (one.name == name) return one;
  }
  throw Error(ErrorCode::invalid_argument, "\"" + name + "\" is not a scale of a report; use tiny, quick or full");
}

Measurement measurement(const std::string& method, const std::string& setting, const ErrorNorms& errors, double seconds,
                        const std::string& truth, const std::string& peer) {
  return {"", method, setting, errors.rms, errors.maximum, seconds, truth, peer};
}

std::vector<std::string> scale_names() { return {"tiny", "quick", "full"}; }

void progress(const PassContext& context, std::size_t done, std::size_t of) {
  if (context.control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "the report was cancelled");
  if (context.control.progress) context.control.progress(static_cast<double>(done) / static_cast<double>(of));
}

namespace {

std::vector<PassRunner> all_passes() {
  std::vector<PassRunner> all;
  for (const auto& make :
       {projection_passes, prefilter_passes, lookup_passes, irradiance_passes, brdf_passes, block_passes, sky_passes}) {
    for (PassRunner& runner : make()) all.push_back(std::move(runner));
  }
  return all;
}

bool begins(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

[[noreturn]] void refuse(const std::string& start) {
  std::string names;
  for (const std::string& id : pass_ids()) names.append(names.empty() ? "" : ", ").append(id);
  throw Error(ErrorCode::invalid_argument, "\"" + start + "\" begins the name of no pass; there are " + names);
}

std::vector<PassRunner> chosen_passes(const std::vector<std::string>& wanted) {
  std::vector<PassRunner> all = all_passes();
  for (const std::string& start : wanted) {
    if (std::any_of(all.begin(), all.end(), [&](const PassRunner& runner) { return begins(runner.pass.id, start); })) {
      continue;
    }
    refuse(start);
  }
  if (wanted.empty()) return all;
  std::erase_if(all, [&](const PassRunner& runner) {
    return std::none_of(wanted.begin(), wanted.end(),
                        [&](const std::string& start) { return begins(runner.pass.id, start); });
  });
  return all;
}

void require_threads(int threads) {
  if (threads < 0 || threads > 1024) throw Error(ErrorCode::invalid_argument, "threads must be from 0 to 1024");
}

ReportEnvironment environment_of(const ReportOptions& options) {
  const int width = scale(options.scale).lat_long_width;
  return options.environment.empty() ? built_in_environment(width) : environment_from(options.environment, width);
}

}  // namespace

std::string environment_name(const ReportOptions& options) { return environment_of(options).name; }

std::vector<std::string> pass_ids() {
  std::vector<std::string> ids;
  for (const PassRunner& runner : all_passes()) ids.push_back(runner.pass.id);
  return ids;
}

Report run_report(const ReportOptions& options, const Control& control) {
  require_threads(options.threads);
  const Scale& size = scale(options.scale);
  const std::vector<PassRunner> runners = chosen_passes(options.passes);
  const Stopwatch stopwatch{options.threads > 0 ? options.threads : available_threads(),
                            options.budget_seconds < 0.0 ? size.budget_seconds : options.budget_seconds};
  const ReportEnvironment environment = environment_of(options);
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "environment.hdr";
  write_environment(file, environment.image.view());
  Peers peers;
  if (options.peers && size.peers)
    peers = Peers::find(options.node_modules, options.program.parent_path(), folder.path(), stopwatch);

  Report report{this_machine(stopwatch), size.name, environment.name, {}, {}, peers.notes()};
  double whole = 0.0;
  for (const PassRunner& runner : runners) whole += runner.cost;
  double before = 0.0;
  for (const PassRunner& runner : runners) {
    if (options.begins) options.begins(runner.pass.id);
    const Control part = jobs::part_of(control, before / whole, (before + runner.cost) / whole);
    const PassContext context{size, stopwatch, environment, file, folder.path(), peers, part, options.program};
    for (Measurement& one : runner.measure(context)) {
      one.pass = runner.pass.id;
      report.measurements.push_back(std::move(one));
    }
    progress(context, 1, 1);
    report.passes.push_back(runner.pass);
    before += runner.cost;
  }
  return report;
}

}  // namespace welkin::report
