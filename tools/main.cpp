// The `welkin` command.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/arguments.h"
#include "tools/commands.h"
#include "tools/completion.h"
#include "tools/terminal.h"

namespace welkin::tool {
namespace {

constexpr const char* kReport = "report";

constexpr const char* kProgramFooter =
    R"(Examples:
  welkin bake --sky -o out           all that a renderer loads, of a computed sky
  welkin bake studio.hdr -o out      the same of a photograph
  welkin sample -o studio.hdr        a computed room, where there is no photograph
  welkin batch plan hdr/ -o jobs.json
                                     bakes of a folder of them; batch run does it
  welkin sh studio.hdr               spherical harmonics, as a table
  welkin sh studio.hdr --for three   the same as three.js wants them
  welkin sky --sun-elevation 20      those of a computed sky
  welkin info studio.hdr             what is in the file
  welkin report --quick              how good each setting is, and how fast
  welkin convert studio.hdr faces.exr --layout vertical-strip
                                     a lat-long to the faces of a cube
  welkin importance studio.hdr -o tables
                                     tables for path tracers
  welkin testmap -o labels.exr       an environment that shows how it is turned
  welkin sh --help                   all about one command

Files: OpenEXR, Radiance .hdr, PFM, PNG, KTX2, DDS, Babylon.js .env. An
environment is a lat-long picture, or six faces in a strip, a cross or six files;
its header, shape or name tell which.

Units: radiance has the unit of the file, for example W/(m2 sr); irradiance and
total radiance are then in W/m2. Skies are computed in W/(m2 sr nm) or cd/m2.
Directions: y is up, and a lat-long's centre looks along +z.

Results go to standard output, everything else to standard error.
The same input gives the same bits on every machine and number of threads;
WELKIN_ISA=sse2|avx2|avx512|neon in the environment picks an instruction set.)";

/// In the list of commands; what follows its name is for the program that it is.
Command report_command() {
  Command command{kReport, "Error against run time of every method and setting", ""};
  command.run = [](const Given& /*given*/) { become("welkin-report", {}); };
  return command;
}

enum class Told { bash, zsh, manual };

Program welkin_program();

/// For packages and for people: a shell's completion, or the manual page.
Command completion_command() {
  const auto told = std::make_shared<Told>(Told::bash);
  Command command{"completion", "Print a script for bash or zsh, or the manual page", ""};
  Option what =
      choice<Told>("WHAT", *told, {{"bash", Told::bash}, {"zsh", Told::zsh}, {"manual", Told::manual}},
                   "bash or zsh for a script that completes commands, options and their words, manual for welkin(1)");
  what.required = true;
  command.options.push_back(std::move(what));
  command.run = [told](const Given& /*given*/) {
    const Program program = welkin_program();
    switch (*told) {
      case Told::bash: print_result(bash_completion(program)); break;
      case Told::zsh: print_result(zsh_completion(program)); break;
      case Told::manual: print_result(manual_page(program)); break;
    }
  };
  return command;
}

Program welkin_program() {
  return {"Welkin turns environments (photographed skies and rooms, computed skies) into light.",
          kProgramFooter,
          {bake_command(), batch_command(), sh_command(), sky_command(), info_command(), convert_command(),
           testmap_command(), sample_command(), importance_command(), report_command(), completion_command()}};
}

/// Reports are measured by a program of their own, which is no part of this one's build.
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
