#include "tools/options.h"

#include "tools/number_text.h"

namespace welkin::tool {
namespace {

constexpr int kMaximumThreads = 1024;
constexpr int kMaximumLevel = 30;

/// "512MiB", "2GB", "4096" to bytes. CLI11 alone would let "-1" wrap around to the largest number.
CLI::Validator size_in_bytes() {
  return {[](std::string& text) {
            if (text.find('-') != std::string::npos) return text + " is not a size";
            return CLI::AsSizeValue(true)(text);
          },
          ""};
}

}  // namespace

CLI::Validator finite_between(double least, double most) {
  return {[least, most](const std::string& text) {
            double value = 0.0;
            const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return good ? std::string()
                        : text + " is not a number from " + significant(least) + " to " + significant(most);
          },
          ""};
}

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

std::vector<std::pair<std::string, Layout>> layout_choices() {
  std::vector<std::pair<std::string, Layout>> choices;
  for (const Layout layout : {Layout::automatic, Layout::lat_long, Layout::vertical_strip, Layout::horizontal_strip,
                              Layout::horizontal_cross, Layout::vertical_cross, Layout::six_files}) {
    choices.emplace_back(name(layout), layout);
  }
  return choices;
}

void add_read_options(CLI::App& command, CommonOptions& options, CLI::Option* input, const std::string& layout_option) {
  const auto of_input = [input](CLI::Option* option) {
    if (!input->get_required()) option->needs(input);
    return option;
  };
  of_input(add_choice<Layout>(command, layout_option, options.read.layout, layout_choices(),
                              "How the picture holds the sphere; by default its header, shape or name tells"));
  of_input(command.add_option("--part", options.read.part,
                              "Of an OpenEXR file with several parts: which one, by name or by number from 0"))
      ->type_name("NAME");
  of_input(command.add_option("--layer", options.read.layer,
                              "Of an OpenEXR file with layers (env.R, env.G, ...): which one"))
      ->type_name("NAME");
  of_input(command.add_option("--level", options.read.level,
                              "Of a file with a mip chain: which level; 0, the default, is full size"))
      ->check(CLI::Range(0, kMaximumLevel).description(""))
      ->type_name("N");
  of_input(add_choice<Transfer>(
      command, "--transfer", options.read.transfer,
      {{"automatic", Transfer::automatic}, {"srgb", Transfer::srgb}, {"linear", Transfer::linear}},
      "What the numbers in a PNG mean; by default sRGB, linear where the file says that its gamma is 1"));
  of_input(add_choice<Primaries>(command, "--primaries", options.read.primaries,
                                 {{"rec709", Primaries::rec709}, {"as-stored", Primaries::as_stored}},
                                 "Convert colours to Rec. 709 where the file states others (default), or leave them"));
  of_input(add_memory_limit_option(command, options));
}

CLI::Option* add_memory_limit_option(CLI::App& command, CommonOptions& options) {
  return command
      .add_option("--memory-limit", options.read.memory_limit_bytes,
                  "The most memory that pixels may take, such as 512MiB or 2GB (default 8GiB); what would need more is "
                  "refused before it is begun")
      ->transform(size_in_bytes())
      ->type_name("SIZE");
}

int thread_count(const CommonOptions& options) { return options.threads > 0 ? options.threads : available_threads(); }

}  // namespace welkin::tool
