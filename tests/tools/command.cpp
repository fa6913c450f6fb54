#include "tools/command.h"

#include "places.h"
#include "support/catch.h"
#include "support/images.h"
#include "support/same_bits.h"

namespace welkin::test {

CommandResult run_welkin(const std::string& arguments, const std::string& environment) {
  return run_program(WELKIN_COMMAND, arguments, environment);
}

CommandResult run_script(const std::string& lines) {
  const TemporaryFile script("script.sh");
  write_text(script, lines);
  return run_program("/bin/sh", quoted(script));
}

nlohmann::json json_of(const std::string& text) { return nlohmann::json::parse(text); }

std::string printed_by(const std::string& arguments, const std::string& environment) {
  const CommandResult result = run_welkin(arguments, environment);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  REQUIRE(result.exit_code == 0);
  REQUIRE(result.errors.empty());
  return result.output;
}

nlohmann::json json_printed_by(const std::string& arguments, const std::string& environment) {
  return json_of(printed_by(arguments, environment));
}

std::string failure(const std::string& arguments, int exit_code, const std::string& environment) {
  const CommandResult result = run_welkin(arguments, environment);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  CHECK(result.exit_code == exit_code);
  CHECK(result.output.empty());
  CHECK(result.errors.rfind("welkin: ", 0) == 0);
  return result.errors;
}

void check_refused(const std::string& start, const BadValues& options) {
  for (const auto& [option, values] : options) {
    for (const std::string& value : values) {
      CHECK(contains(failure(start + ' ' + option + ' ' + value, 2), option));
    }
  }
}

nlohmann::json run_sh_json(const std::string& arguments, const std::string& environment) {
  return json_printed_by("sh --json " + arguments, environment);
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

const std::string& small_image() {
  static const TemporaryDirectory folder;
  static const std::string path = [] {
    const glm::dvec3 lamp = glm::normalize(glm::dvec3(0.5, 0.4, 0.8));
    const LatLongImage light = lat_long_of(64, 32, [&](const glm::dvec3& d) {
      return glm::dvec3(1.5, 1.2, 1.0) + glm::dvec3(4.0, 5.0, 6.0) * std::exp(8.0 * (glm::dot(d, lamp) - 1.0));
    });
    write_pfm(folder.file("light.pfm"), light.width, light.height, light.pixels);
    return quoted(folder.file("light.pfm"));
  }();
  return path;
}

std::vector<float> pixels_in(const std::filesystem::path& file) {
  const Environment read = read_environment(file);
  return {values_of(read).begin(), values_of(read).end()};
}

std::vector<float> grey_image(int width, int height, float value) {
  return std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, value);
}

std::string file_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  REQUIRE(stream.good());
  return {std::istreambuf_iterator<char>(stream), {}};
}

nlohmann::json manifest_of(const std::filesystem::path& folder) { return json_of(file_text(folder / "manifest.json")); }

nlohmann::json bake_into(const std::filesystem::path& folder, const std::string& arguments,
                         const std::string& environment) {
  printed_by("bake " + arguments + " -o " + quoted(folder), environment);
  return manifest_of(folder);
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void check_same_files(const std::filesystem::path& folder, const std::filesystem::path& expected,
                      const std::set<std::string>& left_out) {
  REQUIRE(names_in(folder) == names_in(expected));
  for (const std::string& name : names_in(expected)) {
    INFO(name);
    if (!left_out.contains(name)) CHECK((file_text(folder / name) == file_text(expected / name)));
  }
}

std::vector<std::string> names_of(const nlohmann::json& manifest) {
  std::vector<std::string> names = {"manifest.json"};
  for (const auto& file : manifest.at("files")) names.push_back(file.at("name").get<std::string>());
  std::sort(names.begin(), names.end());
  return names;
}

nlohmann::json file_of(const nlohmann::json& manifest, const std::string& name) {
  for (const auto& file : manifest.at("files")) {
    if (file.at("name") == name) return file;
  }
  FAIL("the manifest has no " << name);
  return {};
}

}  // namespace welkin::test

std::string Catch::StringMaker<nlohmann::json>::convert(const nlohmann::json& value) { return value.dump(); }
