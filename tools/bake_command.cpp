#include "tools/bake_command.h"

#include <memory>
#include <string>

#include "tools/bake_files.h"
#include "tools/bake_inputs.h"
#include "tools/bake_manifest.h"
#include "tools/bake_options.h"
#include "tools/help_text.h"
#include "tools/needs_file.h"
#include "tools/output.h"
#include "tools/output_folder.h"
#include "tools/progress_bar.h"
#include "tools/text_file.h"
#include "tools/turn_chain.h"

namespace welkin::tool {
namespace {

constexpr double kBaked = 0.6;  // of the progress; the rest is writing

/// What can be refused is refused before there is a folder, and before any work.
void check(const BakeCommandOptions& options) {
  const BakeOptions bake = library_options(options);
  static_cast<void>(faces_of(options.turn.to));
  check_output_folder(options.directory);
  check_input_is_kept(options, bake);
}

std::string planned(const BakeCommandOptions& options) {
  ProgressBar bar;
  const Plan plan = plan_ahead(options, bar.control());
  return options.common.json ? json_text(plan_json(plan)) : plan_text(plan);
}

void run(const BakeCommandOptions& options) {
  std::string text;
  run_with_threads(options.common.threads,
                   [&] { text = options.scene.plan_only ? planned(options) : bake_to_folder(options); });
  print_result(text);
}

}  // namespace

std::string bake_to_folder(const BakeCommandOptions& options) {
  check(options);
  ProgressBar bar;
  const Control control = bar.control();
  Baked baked = bake_source(options, part_of(control, 0.0, kBaked));
  OutputFolder folder(options.directory);
  const ToneMap tone_map = tone_map_of(baked);
  write_bake(baked, options, folder, part_of(control, kBaked, 1.0));
  const std::string manifest = bake_manifest(baked, options, folder, tone_map);
  write_text_file(folder.place(kManifestName), manifest);
  return options.common.json ? manifest : bake_table(baked, options, folder);
}

void add_bake_command(CLI::App& program) {
  const auto options = std::make_shared<BakeCommandOptions>();
  CLI::App& command = *program.add_subcommand("bake", "Bake all that a physically based renderer loads");
  command.footer(std::string(kBakeFooter));
  add_bake_options(command, *options);
  command.callback([options] { run(*options); });
}

}  // namespace welkin::tool
