// Every photograph that the project shares goes through the command.
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "places.h"
#include "support/catch.h"
#include "tools/command.h"

using namespace welkin::test;

namespace {

std::vector<std::filesystem::path> shared_files() {
  std::vector<std::filesystem::path> files;
  const auto folder = std::filesystem::path(WELKIN_SHARED) / "hdr" / "env";
  if (!std::filesystem::exists(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  return files;
}

}  // namespace

TEST_CASE("command: sh and info agree on the light of real environments", "[tools]") {
  const auto files = shared_files();
  if (files.empty()) WARN("no shared environments here");
  for (const auto& file : files) {
    INFO(file.string());
    const nlohmann::json light = run_sh_json(quoted(file));
    const CommandResult info = run_welkin("info --json " + quoted(file));
    REQUIRE(info.exit_code == 0);
    const nlohmann::json content = nlohmann::json::parse(info.output);
    CHECK(content.at("source") == light.at("source"));
    // c(0,0) is the flux divided by sqrt(4 pi); files with values to replace would differ.
    if (light.at("diagnostics").at("replaced") != 0) continue;
    const double constant = light.at("radiance").at(0).at(1).get<double>();
    const double flux = content.at("pixels").at("flux").at(1).get<double>();
    CHECK(std::abs(constant * std::sqrt(4.0 * std::numbers::pi) - flux) <= 1e-6 * std::abs(flux));
  }
}
