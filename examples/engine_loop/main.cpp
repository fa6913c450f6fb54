// engine_loop: frame times without baking, with baking inside the frame, and with baking on a worker.
//
//   scripts/engine-loop                                     # ten seconds of each, a table and a plot
//   scripts/engine-loop --setup own-idle,own-normal,lent    # ways to set the worker up
//
// One concept a file: the loop (loop.h), the engine's work (frame_work.h), its requests (schedule.h), who does it
// (no_baker.h, synchronous_baker.h, worker_baker.h), how the worker is set up (worker_setup.h).
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "environments.h"
#include "frame_csv.h"
#include "frame_work.h"
#include "loop.h"
#include "no_baker.h"
#include "options.h"
#include "plot.h"
#include "real_time.h"
#include "same_light.h"
#include "schedule.h"
#include "statistics.h"
#include "synchronous_baker.h"
#include "worker_baker.h"
#include "worker_setup.h"

namespace engine_loop {
namespace {

std::vector<std::filesystem::path> files_to_stream(const Options& options) {
  if (!options.environments.empty()) {
    auto files = environments_in(options.environments);
    if (!files.empty()) return files;
    std::cerr << "engine_loop: no .exr or .hdr file in " << options.environments.string() << '\n';
  }
  return write_environments(options.output / "environments", 2 * options.sky_size);
}

std::vector<Run> run_all(const Options& options, const ScheduleOptions& wishes, tbb::task_arena& arena,
                         FrameWork& work) {
  std::vector<Run> runs;
  const auto run = [&](const std::string& name, Baker&& baker) {
    std::cerr << "engine_loop: " << name << ", " << options.seconds << " s\n";
    runs.push_back(run_loop(name, wishes.frames, work, Schedule(wishes), baker));
  };
  run("no baking", NoBaker());
  run("synchronous", SynchronousBaker(arena));
  for (const std::string& name : options.setups) {
    const WorkerSetup setup = worker_setup(name, options.threads, arena);
    run(name, WorkerBaker(setup.options));
  }
  return runs;
}

/// Whether all of the workers' runs gave the synchronous one's light; says which did not.
bool light_is_the_same(const std::vector<Run>& runs) {
  bool same = true;
  for (std::size_t run = 2; run < runs.size(); ++run) {
    const std::string problem = difference(runs[1], runs[run]);
    if (problem.empty()) continue;
    std::cerr << "engine_loop: " << runs[run].name << ": " << problem << '\n';
    same = false;
  }
  return same;
}

void write_pictures(const Options& options, const std::vector<Run>& runs) {
  const std::filesystem::path csv = options.output / "frames.csv";
  write_csv(csv, runs);
  std::cout << "frames: " << csv.string() << '\n';
  if (options.no_plot) return;
  const std::filesystem::path png = options.output / "frames.png";
  if (draw_plot(csv, png, runs)) {
    std::cout << "plot: " << png.string() << '\n';
  } else {
    std::cerr << "engine_loop: no plot was drawn; that takes gnuplot\n";
  }
}

int run(const Options& options) {
  std::filesystem::create_directories(options.output);
  const ScheduleOptions wishes{options.frames(), options.sky_size, options.level_size, files_to_stream(options)};
  tbb::task_arena arena(tbb::info::default_concurrency());
  std::optional<RealTime> real_time;
  if (options.real_time) real_time.emplace(arena);
  FrameWork work = FrameWork::that_takes(options.work_ms, arena);
  std::cout << work.characters() << " characters, " << work.objects() << " objects, " << wishes.files.size()
            << " files, on " << tbb::info::default_concurrency() << " processors\n\n";
  if (real_time && real_time->refused()) std::cerr << "engine_loop: the system does not allow --real-time\n";
  const std::vector<Run> runs = run_all(options, wishes, arena, work);
  std::cout << table(runs) << '\n';
  write_pictures(options, runs);
  const bool same = light_is_the_same(runs);
  if (same) std::cout << "Every worker's light is the synchronous calls' light, bit by bit.\n";
  return same ? 0 : 1;
}

}  // namespace
}  // namespace engine_loop

int main(int argument_count, char** arguments) {
  int exit_code = 0;
  const auto options = engine_loop::parse_options(argument_count, arguments, exit_code);
  if (!options) return exit_code;
  try {
    return engine_loop::run(*options);
  } catch (const std::exception& error) {
    std::cerr << "engine_loop: " << error.what() << '\n';
    return 1;
  }
}
