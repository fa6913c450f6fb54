#include "tools/options.h"

namespace welkin::tool {
namespace {

constexpr int kMaximumThreads = 1024;

/// "512MiB", "2GB", "4096" to bytes. CLI11 alone would let "-1" wrap around to the largest number.
CLI::Validator size_in_bytes() {
  return {[](std::string& text) {
            if (text.find('-') != std::string::npos) return text + " is not a size";
            return CLI::AsSizeValue(true)(text);
          },
          ""};
}

}  // namespace

void add_json_option(CLI::App& command, CommonOptions& options) {
  command.add_flag("--json", options.json, "JSON on standard output instead of a table");
}

void add_threads_option(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--threads", options.threads,
                  "Threads to work with; 0, the default: all that this process may use. Results do not depend on it")
      ->check(CLI::Range(0, kMaximumThreads).description(""))
      ->type_name("N");
}

void add_read_options(CLI::App& command, CommonOptions& options, CLI::Option* input) {
  add_choice<Layout>(command, "--layout", options.read.layout,
                     {{name(Layout::automatic), Layout::automatic},
                      {name(Layout::lat_long), Layout::lat_long},
                      {name(Layout::vertical_strip), Layout::vertical_strip}},
                     "How the picture holds the sphere; by default its header or shape tells")
      ->needs(input);
  command
      .add_option("--memory-limit", options.read.memory_limit_bytes,
                  "The most memory that pixels may take, such as 512MiB or 2GB (default 8GiB); a file that would need "
                  "more is refused before it is read")
      ->transform(size_in_bytes())
      ->type_name("SIZE")
      ->needs(input);
}

int thread_count(const CommonOptions& options) { return options.threads > 0 ? options.threads : available_threads(); }

}  // namespace welkin::tool
