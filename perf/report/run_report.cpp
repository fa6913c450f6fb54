#include "perf/report/passes.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::report {
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

/// The share that a pass has in all progress.
Control control_of(const Control& control, double from, double to) {
  Control part{control.stop, {}};
  if (control.progress)
    part.progress = [&control, from, to](double done) { control.progress(from + (to - from) * done); };
  return part;
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
    const Control part = control_of(control, before / whole, (before + runner.cost) / whole);
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
