#include "tools/command.h"

#include "places.h"
#include "support/catch.h"

namespace welkin::test {

CommandResult run_welkin(const std::string& arguments, const std::string& environment) {
  return run_program(WELKIN_COMMAND, arguments, environment);
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

void write_pfm(const std::filesystem::path& path, int width, int height, const std::vector<float>& rgb) {
  std::ofstream file(path, std::ios::binary);
  file << "PF\n" << width << ' ' << height << "\n-1.0\n";
  const std::size_t row_values = static_cast<std::size_t>(width) * 3;
  for (int row = height - 1; row >= 0; --row) {
    const float* values = rgb.data() + static_cast<std::size_t>(row) * row_values;
    file.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(row_values * sizeof(float)));
  }
}

std::vector<float> grey_picture(int width, int height, float value) {
  return std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, value);
}

}  // namespace welkin::test
