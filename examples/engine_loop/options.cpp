#include "options.h"

#include <CLI/CLI.hpp>

#include "worker_setup.h"

namespace engine_loop {
namespace {

constexpr const char* kDescription =
    R"(A game loop at 60 Hz that bakes the light of streamed files, of a turning sun and
of freshly loaded levels: not at all, inside its frames, and with a worker.)";

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
  program.add_option("--seconds", options.seconds, "Length of each run, at 60 frames a second (10)")
      ->check(CLI::Range(0.1, 3600.0).description(""));
  program.add_option("--work", options.work_ms, "The engine's own work in a frame, ms on all processors (6)")
      ->check(CLI::Range(0.1, 16.0).description(""));
  program.add_option("--setup", options.setups, "One or more set-ups of the worker (own-idle); see below")
      ->check(CLI::IsMember(setup_names()).description(""))
      ->delimiter(',');
  program
      .add_option("--threads", options.threads,
                  "Of the worker (0: one less than there are processors), or slots of a lent arena (0: all)")
      ->check(CLI::Range(0, 1024).description(""));
  program.add_flag("--real-time", options.real_time, "Rank the engine's threads as real-time ones while in a frame");
  program.add_option("--environments", options.environments,
                     "Folder of .exr and .hdr files to stream in; without any, some are written first");
  program.add_option("-o,--output", options.output, "Folder for what is written (engine_loop)");
  program.add_option("--sky-size", options.sky_size, "Edge of the changing sky's cubemap, texels (256)")
      ->check(CLI::Range(1, 4096).description(""));
  program.add_option("--level-size", options.level_size, "Edge of a level's cubemaps, texels (1024)")
      ->check(CLI::Range(1, 4096).description(""));
  program.add_flag("--no-plot", options.no_plot, "Do not have gnuplot draw the frames");
}

}  // namespace

std::optional<Options> parse_options(int argument_count, char** arguments, int& exit_code) {
  Options options;
  CLI::App program{kDescription, "engine_loop"};
  program.footer(kFooter);
  add_options(program, options);
  try {
    program.parse(argument_count, arguments);
  } catch (const CLI::ParseError& request) {
    exit_code = program.exit(request) == 0 ? 0 : 2;
    return std::nullopt;
  }
  return options;
}

}  // namespace engine_loop
