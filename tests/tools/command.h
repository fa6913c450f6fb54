// Runs the built `welkin` as a user does: through a shell.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace welkin::test {

struct CommandResult {
  int exit_code = -1;
  std::string output;  ///< standard output
  std::string errors;  ///< standard error
};

/// `arguments` as they would be typed; `environment` such as "WELKIN_ISA=sse2".
CommandResult run_welkin(const std::string& arguments, const std::string& environment = "");

/// Runs `welkin sh --json` with more arguments, requires success and silence, and parses the output.
nlohmann::json run_sh_json(const std::string& arguments, const std::string& environment = "");

/// The same without what no two runs share: the passes' times.
nlohmann::json run_sh_json_without_times(const std::string& arguments, const std::string& environment = "");

bool contains(std::string_view text, std::string_view part);

/// A path in single quotes, for `arguments`.
std::string quoted(const std::filesystem::path& path);

}  // namespace welkin::test
