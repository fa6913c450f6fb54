#include <stdlib.h>
#include <sys/wait.h>

#include "support/catch.h"
#include "tools/command.h"

namespace welkin::test {

CommandResult run_program(const std::filesystem::path& program, const std::string& arguments,
                          const std::string& environment) {
  const TemporaryDirectory folder;
  const std::filesystem::path errors = folder.path() / "errors";
  const std::string line = environment + " " + quoted(program) + " " + arguments + " 2>" + quoted(errors);
  FILE* pipe = popen(line.c_str(), "r");
  REQUIRE(pipe != nullptr);
  CommandResult result;
  std::array<char, 4096> block{};
  for (std::size_t read = 0; (read = fread(block.data(), 1, block.size(), pipe)) > 0;) {
    result.output.append(block.data(), read);
  }
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::ifstream stream(errors);
  result.errors.assign(std::istreambuf_iterator<char>(stream), {});
  return result;
}

}  // namespace welkin::test
