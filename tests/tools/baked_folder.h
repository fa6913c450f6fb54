// What `welkin bake` left in a folder, for the tests of the command.
#pragma once

#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "tools/command.h"

namespace welkin::test {

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  REQUIRE(stream.good());
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline nlohmann::json manifest_of(const std::filesystem::path& folder) {
  return nlohmann::json::parse(file_text(folder / "manifest.json"));
}

/// Runs `welkin bake ARGUMENTS -o FOLDER`, requires success and silence on standard error; the manifest.
inline nlohmann::json bake_into(const std::filesystem::path& folder, const std::string& arguments,
                                const std::string& environment = "") {
  const CommandResult result = run_welkin("bake " + arguments + " -o " + quoted(folder), environment);
  INFO("welkin bake " << arguments << "\nstandard error: " << result.errors);
  REQUIRE(result.exit_code == 0);
  REQUIRE(result.errors.empty());
  return manifest_of(folder);
}

/// Runs `welkin ARGUMENTS`, expects this exit code and nothing on standard output; what it says on standard error.
inline std::string failure(const std::string& arguments, int exit_code) {
  const CommandResult result = run_welkin(arguments);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  CHECK(result.exit_code == exit_code);
  CHECK(result.output.empty());
  CHECK(result.errors.rfind("welkin: ", 0) == 0);
  return result.errors;
}

inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Those of the manifest, and the manifest itself.
inline std::vector<std::string> names_of(const nlohmann::json& manifest) {
  std::vector<std::string> names = {"manifest.json"};
  for (const auto& file : manifest.at("files")) names.push_back(file.at("name").get<std::string>());
  std::sort(names.begin(), names.end());
  return names;
}

/// The manifest's entry for a file.
inline nlohmann::json file_of(const nlohmann::json& manifest, const std::string& name) {
  for (const auto& file : manifest.at("files")) {
    if (file.at("name") == name) return file;
  }
  FAIL("the manifest has no " << name);
  return {};
}

}  // namespace welkin::test
