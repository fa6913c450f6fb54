#include "tools/info_command.h"

#include <memory>
#include <string>

#include "tools/help_text.h"
#include "tools/info_report.h"
#include "tools/options.h"
#include "tools/output.h"
#include "tools/progress_bar.h"
#include "welkin/control.h"
#include "welkin/environment_file.h"

namespace welkin::tool {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::string file;
};

InfoReport make_report(const InfoOptions& options) {
  ProgressBar bar;
  return {inspect_environment(options.file, options.common.read),
          measure_environment(options.file, options.common.read, bar.control())};
}

void run(const InfoOptions& options) {
  std::string text;
  run_with_threads(options.common.threads, [&] {
    const InfoReport report = make_report(options);
    text = options.common.json ? info_json(report) : info_table(report);
  });
  print_result(text);
}

}  // namespace

void add_info_command(CLI::App& program) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App& command = *program.add_subcommand("info", "Tell what is in an environment file");
  command.footer(std::string(kInfoFooter));
  CLI::Option* file = command
                          .add_option("FILE", options->file,
                                      "An OpenEXR, Radiance .hdr, PFM or PNG file, or one of six (or their directory)")
                          ->required()
                          ->type_name("");
  add_json_option(command, options->common);
  add_read_options(command, options->common, file);
  add_threads_option(command, options->common);
  command.callback([options] { run(*options); });
}

}  // namespace welkin::tool
