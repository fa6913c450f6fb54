#include "tools/sh_command.h"

#include <memory>
#include <string>

#include "tools/help_text.h"
#include "tools/output.h"
#include "tools/sh_measure.h"
#include "tools/sh_options.h"
#include "welkin/control.h"

namespace welkin::tool {
namespace {

void run(ShOptions options) {
  options.clamp.apply(options.projection);
  std::string text;
  run_with_threads(options.common.threads, [&] { text = sh_formatted(measure_sh(options), options.format); });
  print_result(text);
}

}  // namespace

std::string sh_formatted(const ShReport& report, ShFormat format) {
  switch (format) {
    case ShFormat::json: return sh_json(report);
    case ShFormat::text: return sh_text(report);
    case ShFormat::c_header: return sh_c_header(report);
    case ShFormat::table: break;
  }
  return sh_table(report);
}

void add_sh_command(CLI::App& program) {
  const auto options = std::make_shared<ShOptions>();
  CLI::App& command = *program.add_subcommand("sh", "Project an environment to spherical harmonics");
  command.footer(std::string(kShFooter));
  add_sh_options(command, *options);
  command.callback([options] { run(*options); });
}

}  // namespace welkin::tool
