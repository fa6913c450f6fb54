// The `welkin` command.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "embedded_texts.h"
#include "tools/arguments.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace welkin::tool {
namespace {

constexpr const char* kReport = "report";

/// Lists the command; another program gets the words after its name.
Command report_command() {
  Command command{kReport, "Error against run time of every method and setting", ""};
  command.run = [](const Given& /*given*/) { become("welkin-report", {}); };
  return command;
}

Program welkin_program();

/// Prints, for packages and people, a shell's completion or the manual page.
Command completion_command() {
  using Writer = std::string (*)(const Program&);
  const auto writer = std::make_shared<Writer>(bash_completion);
  Command command{"completion", "Print a script for bash or zsh, or the manual page", ""};
  Option what =
      choice<Writer>("WHAT", *writer, {{"bash", bash_completion}, {"zsh", zsh_completion}, {"manual", manual_page}},
                     "bash or zsh for a script that completes commands, options and their words, manual for welkin(1)");
  what.required = true;
  command.options.push_back(std::move(what));
  command.run = [writer](const Given& /*given*/) { print_result((*writer)(welkin_program())); };
  return command;
}

Program welkin_program() {
  return {
      "Welkin turns environments (photographed skies and rooms, computed skies) into light.",
      embedded_text("help/welkin.txt"),
      {bake_command(), batch_command(), sh_command(), sky_command(), info_command(), check_command(), convert_command(),
       testmap_command(), sample_command(), importance_command(), report_command(), completion_command()}};
}

/// Reports come from a separate program, which is no part of this one's build.
ExitCode run_report(const std::vector<std::string>& arguments) {
  return run_guarded([&]() -> ExitCode { become("welkin-report", arguments); });
}

}  // namespace
}  // namespace welkin::tool

int main(int count, char** words) {
  using welkin::tool::kReport, welkin::tool::program_arguments, welkin::tool::run_program, welkin::tool::run_report,
      welkin::tool::welkin_program, welkin::tool::with_command_first, welkin::tool::without_help_command;
  const welkin::tool::Program program = welkin_program();
  const std::vector<std::string> arguments =
      with_command_first(program, without_help_command(program_arguments(count, words)));
  if (!arguments.empty() && arguments.front() == kReport) return run_report({arguments.begin() + 1, arguments.end()});
  return run_program(program, arguments);
}
