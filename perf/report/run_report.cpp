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

Scale tiny() {
  Scale scale;
  scale.name = "tiny";
  scale.budget_seconds = 0.01;
  scale.lat_long_width = 128;
  scale.cube_size = 32;
  scale.chain_size = 32;
  scale.probes = 40;
  scale.most_samples = 256;
  scale.most_bands = 5;
  scale.largest_table = 32;
  scale.table_truth = 48;
  scale.sun_elevations = {40.0, 2.0};
  scale.sky_zeniths = 8;
  scale.sky_azimuths = 8;
  scale.sky_tables = {sized(4, 16, 8, 4), sized(8, 16, 16, 4)};
  scale.peers = false;
  return scale;
}

Scale quick() {
  Scale scale;
  scale.name = "quick";
  scale.budget_seconds = 0.03;
  scale.lat_long_width = 512;
  scale.cube_size = 256;
  scale.chain_size = 128;
  scale.probes = 120;
  scale.most_samples = 1024;
  scale.most_bands = 7;
  scale.largest_table = 128;
  scale.table_truth = 160;
  scale.sun_elevations = {60.0, 20.0, 2.0, -4.0};
  scale.sky_zeniths = 20;
  scale.sky_azimuths = 16;
  scale.sky_tables = {sized(8, 16, 16, 4), sized(16, 32, 16, 4), sized(32, 64, 32, 8, ScatteringLayout::compact),
                      sized(16, 32, 32, 8), sized(16, 64, 64, 8)};
  return scale;
}

Scale full() {
  Scale scale = quick();
  scale.name = "full";
  scale.budget_seconds = 0.4;
  scale.lat_long_width = 1024;
  scale.cube_size = 1024;
  scale.chain_size = 256;
  scale.probes = 240;
  scale.most_samples = 4096;
  scale.most_bands = 9;
  scale.largest_table = 256;
  scale.table_truth = 384;
  scale.sun_elevations = {90.0, 60.0, 30.0, 10.0, 5.0, 2.0, 0.0, -2.0, -4.0, -6.0};
  scale.sky_zeniths = 40;
  scale.sky_azimuths = 32;
  scale.sky_tables.push_back(sized(32, 64, 64, 8));
  scale.sky_tables.insert(scale.sky_tables.end() - 1, sized(32, 128, 64, 8));
  return scale;
}

}  // namespace

const Scale& scale(const std::string& name) {
  static const std::array<Scale, 3> all{tiny(), quick(), full()};
  for (const Scale& one : all) {
    if (one.name == name) return one;
  }
  throw Error(ErrorCode::invalid_argument, "\"" + name + "\" is not a scale of a report; use tiny, quick or full");
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

/// A folder that is gone when the report is done.
class WorkFolder {
 public:
  WorkFolder() : path_(make_temporary_folder()) {}
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

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
  const WorkFolder folder;
  const std::filesystem::path file = folder.path() / "environment.hdr";
  write_environment(file, environment.image.view());
  const Peers peers = options.peers && size.peers
                          ? Peers::find(options.node_modules, options.program.parent_path(), stopwatch.threads)
                          : Peers();

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
