#include "tools/command.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "places.h"
#include "support/catch.h"
#include "tools/temporary_folder.h"

namespace welkin::test {

CommandResult run_welkin(const std::string& arguments, const std::string& environment) {
  const TemporaryFolder folder;
  const std::filesystem::path errors = folder.path() / "errors";
  const std::string line = environment + " " + quoted(WELKIN_COMMAND) + " " + arguments + " 2>" + quoted(errors);
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

nlohmann::json run_sh_json(const std::string& arguments, const std::string& environment) {
  const CommandResult result = run_welkin("sh --json " + arguments, environment);
  INFO("arguments: " << arguments << "\nstandard error: " << result.errors);
  REQUIRE(result.exit_code == 0);
  REQUIRE(result.errors.empty());
  return nlohmann::json::parse(result.output);
}

nlohmann::json run_sh_json_without_times(const std::string& arguments, const std::string& environment) {
  nlohmann::json document = run_sh_json(arguments, environment);
  for (auto& pass : document.at("diagnostics").at("passes")) pass.erase("ms");
  return document;
}

bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }

std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

}  // namespace welkin::test
