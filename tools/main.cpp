// The `welkin` command: reads the command line, runs a subcommand, turns errors into exit codes.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <string>

#include "tools/bake_command.h"
#include "tools/convert_command.h"
#include "tools/exit_code.h"
#include "tools/help_formatter.h"
#include "tools/help_text.h"
#include "tools/info_command.h"
#include "tools/output.h"
#include "tools/report_command.h"
#include "tools/sh_command.h"
#include "tools/sky_command.h"
#include "tools/testmap_command.h"
#include "welkin/error.h"
#include "welkin/instruction_set.h"
#include "welkin/version.h"

namespace welkin::tool {
namespace {

std::string version_text() {
  std::string text = "welkin " WELKIN_VERSION_STRING "\ninstruction sets here:";
  for (const InstructionSet set : available_instruction_sets()) text += std::string(" ") + name(set);
  return text + " (in use: " + name(active_instruction_set()) + ")";
}

ExitCode complain(ExitCode code, const std::string& message) {
  std::cerr << "welkin: " << message << '\n';
  return code;
}

/// CLI11 reports a request for help or the version as an exception too.
ExitCode answer(const CLI::App& program, const CLI::ParseError& request) {
  if (dynamic_cast<const CLI::CallForVersion*>(&request) != nullptr) {
    print_result(std::string(request.what()) + '\n');
    return ExitCode::success;
  }
  const auto chosen = program.get_subcommands();
  if (request.get_exit_code() == 0) {
    print_result(chosen.empty() ? program.help() : chosen.front()->help("welkin"));
    return ExitCode::success;
  }
  const std::string help = chosen.empty() ? "welkin --help" : "welkin " + chosen.front()->get_name() + " --help";
  return complain(ExitCode::bad_usage, std::string(request.what()) + "\n'" + help + "' tells what can be asked for.");
}

ExitCode run(int argument_count, char** arguments) {
  CLI::App program{std::string(kProgramDescription), "welkin"};
  program.footer(std::string(kProgramFooter));
  program.set_version_flag("--version", version_text, "Print the version and the instruction sets that run here");
  program.formatter(std::make_shared<HelpFormatter>());
  program.require_subcommand(0, 1);
  try {
    add_bake_command(program);
    add_sh_command(program);
    add_sky_command(program);
    add_info_command(program);
    add_convert_command(program);
    add_testmap_command(program);
    add_report_command(program);
    program.parse(argument_count, arguments);
    if (!program.get_subcommands().empty()) return ExitCode::success;
    return complain(ExitCode::bad_usage, "nothing to do\n'welkin --help' tells what can be asked for.");
  } catch (const CLI::ParseError& request) {
    return answer(program, request);
  }
}

/// Runs the command line and turns whatever goes wrong into an exit code.
ExitCode run_guarded(int argument_count, char** arguments) {
  try {
    return run(argument_count, arguments);
  } catch (const Error& error) {
    const bool usage = error.code() == ErrorCode::invalid_argument;
    return complain(usage ? ExitCode::bad_usage : ExitCode::bad_input, error.what());
  } catch (const std::bad_alloc&) {
    return complain(ExitCode::bad_input, "not enough memory; --memory-limit refuses such files before they are read");
  } catch (const std::exception& error) {
    return complain(ExitCode::bad_input, error.what());
  }
}

}  // namespace
}  // namespace welkin::tool

int main(int argument_count, char** arguments) { return welkin::tool::run_guarded(argument_count, arguments); }
