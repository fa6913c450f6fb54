#include "tools/sky_command.h"

#include <memory>
#include <string>

#include "tools/atmosphere_file.h"
#include "tools/bake_command.h"
#include "tools/help_text.h"
#include "tools/output.h"
#include "tools/progress_bar.h"
#include "tools/sh_command.h"
#include "tools/sky_measure.h"
#include "tools/sky_options.h"

namespace welkin::tool {
namespace {

std::string sweep(const SkyOptions& options) {
  ProgressBar bar;
  return write_sweep(options.sky, options.sweep, bar.control());
}

/// The sky as a picture, and all else from that.
std::string bake_sky(const SkyOptions& options) {
  constexpr double kTables = 0.9;
  BakeCommandOptions bake = options.bake;
  bake.compute = [&options](const Control& control) {
    const Sky sky = make_sky(options.sky, part_of(control, 0.0, kTables));
    return sky_picture(sky, options.picture_height, options.sun_disc, part_of(control, kTables, 1.0));
  };
  return bake_to_folder(bake);
}

std::string answer(const SkyOptions& options) {
  if (options.print_atmosphere) {
    return json_text(atmosphere_json(chosen_atmosphere(options.sky.atmosphere, options.sky.tables.colour)));
  }
  if (!options.sweep.path.empty()) return sweep(options);
  if (options.wants_folder) return bake_sky(options);
  return sh_formatted(measure_sky(options), options.sh.format);
}

void run(SkyOptions& options, const CLI::App& command) {
  settle(options, command);
  std::string text;
  run_with_threads(options.sh.common.threads, [&] { text = answer(options); });
  print_result(text);
}

}  // namespace

void add_sky_command(CLI::App& program) {
  const auto options = std::make_shared<SkyOptions>();
  CLI::App& command = *program.add_subcommand("sky", "The light of a computed sky");
  command.footer(std::string(kSkyFooter));
  add_sky_options(command, *options);
  command.callback([options, &command] { run(*options, command); });
}

}  // namespace welkin::tool
