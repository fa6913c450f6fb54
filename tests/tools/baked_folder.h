// What `welkin bake` left in a folder, for the tests of the command.
#pragma once

#include "tools/command.h"

namespace welkin::test {

/// Requires that the file is there.
std::string file_text(const std::filesystem::path& path);

nlohmann::json manifest_of(const std::filesystem::path& folder);

/// Runs `welkin bake ARGUMENTS -o FOLDER`, requires success and silence on standard error; the manifest.
nlohmann::json bake_into(const std::filesystem::path& folder, const std::string& arguments,
                         const std::string& environment = "");

std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Those of the manifest, and the manifest itself.
std::vector<std::string> names_of(const nlohmann::json& manifest);

/// The manifest's entry for a file.
nlohmann::json file_of(const nlohmann::json& manifest, const std::string& name);

}  // namespace welkin::test
