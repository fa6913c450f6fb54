// engine_loop: frame times without baking, with baking inside the frame, and with baking on a worker.
//
//   scripts/engine-loop                                     # ten seconds of each, a table and a plot
//   scripts/engine-loop --setup own-idle,own-normal,lent    # ways to set the worker up
//
// Worth reading for your own engine: bakers.h. The rest is a stage for it: the engine's work (frame_work.h), its
// requests (schedule.h), its frames (loop.h).
#include <tbb/info.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "loop.h"

namespace engine_loop {
namespace {

struct Options {
  double seconds = 10.0;  ///< of each run
  double work_ms = 6.0;
  std::vector<std::string> setups{"own-idle"};
  int threads = 0;
  bool real_time = false, no_plot = false;
  std::filesystem::path environments;  ///< a folder; empty: none
  std::filesystem::path output = "engine_loop";
  int sky_size = 256, level_size = 1024;
};

constexpr const char* kFooter =
    R"(Set-ups of the worker:
  own-idle     threads of its own that run on processors nothing else wants
  own-below    ... with a tenth of a normal thread's share
  own-normal   ... as the engine's own
  lent         a TBB arena of low priority beside the engine's
  lent-engine  the arena that frames are computed in: how not to do it

Writes frames.csv (one line a frame) and frames.png (by gnuplot, if it is there).
Exit codes: 0 done; 1 light differs between the runs, or a file is bad; 2 the
command line is.)";

void add_options(CLI::App& program, Options& options) {
  const auto range = [](auto least, auto most) { return CLI::Range(least, most).description(""); };
  program.footer(kFooter);
  program.add_option("--seconds", options.seconds, "Length of each run, at 60 frames a second (10)")
      ->check(range(0.1, 3600.0));
  program.add_option("--work", options.work_ms, "The engine's own work in a frame, ms on all processors (6)")
      ->check(range(0.1, 16.0));
  program.add_option("--setup", options.setups, "One or more set-ups of the worker (own-idle); see below")
      ->check(CLI::IsMember(kSetups).description(""))
      ->delimiter(',');
  program
      .add_option("--threads", options.threads,
                  "Of the worker (0: one less than there are processors), or slots of a lent arena (0: all)")
      ->check(range(0, 1024));
  program.add_flag("--real-time", options.real_time, "Rank the engine's threads as real-time ones while in a frame");
  program.add_option("--environments", options.environments,
                     "Folder of .exr and .hdr files to stream in; without any, some are written first");
  program.add_option("-o,--output", options.output, "Folder for what is written (engine_loop)");
  program.add_option("--sky-size", options.sky_size, "Edge of the changing sky's cubemap, texels (256)")
      ->check(range(1, 4096));
  program.add_option("--level-size", options.level_size, "Edge of a level's cubemaps, texels (1024)")
      ->check(range(1, 4096));
  program.add_flag("--no-plot", options.no_plot, "Do not have gnuplot draw the frames");
}

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
    runs.push_back(run_loop(name, work, Schedule(wishes), baker));
  };
  run("no baking", Baker());
  run("synchronous", SynchronousBaker(arena));
  for (const std::string& name : options.setups) {
    std::optional<tbb::task_arena> low;
    run(name, WorkerBaker(worker_options(name, options.threads, arena, low)));
  }
  return runs;
}

/// Returns whether all of the workers' runs gave the synchronous one's light, and says which did not.
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

void write_frames(const Options& options, const std::vector<Run>& runs) {
  const std::filesystem::path csv = options.output / "frames.csv", png = options.output / "frames.png";
  write_csv(csv, runs);
  std::cout << "frames: " << csv.string() << '\n';
  if (options.no_plot) return;
  if (draw_plot(csv, png, runs)) {
    std::cout << "plot: " << png.string() << '\n';
  } else {
    std::cerr << "engine_loop: no plot was drawn; that takes gnuplot\n";
  }
}

int run(const Options& options) {
  std::filesystem::create_directories(options.output);
  const ScheduleOptions wishes{static_cast<int>(60.0 * options.seconds + 0.5), options.sky_size, options.level_size,
                               files_to_stream(options)};
  tbb::task_arena arena(tbb::info::default_concurrency());
  std::optional<RealTime> real_time;
  if (options.real_time) real_time.emplace(arena);
  FrameWork work = FrameWork::that_takes(options.work_ms, arena);
  std::cout << work.characters() << " characters, " << wishes.files.size() << " files, on "
            << tbb::info::default_concurrency() << " processors\n\n";
  if (real_time && real_time->refused()) std::cerr << "engine_loop: the system does not allow --real-time\n";
  const std::vector<Run> runs = run_all(options, wishes, arena, work);
  std::cout << table(runs) << '\n';
  write_frames(options, runs);
  const bool same = light_is_the_same(runs);
  if (same) std::cout << "Every worker's light is the synchronous calls' light, bit by bit.\n";
  return same ? 0 : 1;
}

}  // namespace
}  // namespace engine_loop

int main(int argument_count, char** arguments) {
  engine_loop::Options options;
  CLI::App program{
      R"(A game loop at 60 Hz that bakes the light of streamed files, of a turning sun and
of freshly loaded levels: not at all, inside its frames, and with a worker.)",
      "engine_loop"};
  add_options(program, options);
  try {
    program.parse(argument_count, arguments);
    return engine_loop::run(options);
  } catch (const CLI::ParseError& request) {
    return program.exit(request) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::cerr << "engine_loop: " << error.what() << '\n';
    return 1;
  }
}
