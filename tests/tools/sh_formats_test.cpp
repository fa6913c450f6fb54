// `welkin sh --format`: text and C header carry the JSON's numbers.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <glm/vec3.hpp>
#include <sstream>
#include <string>

#include "support/catch.h"
#include "tools/command.h"
#include "tools/pfm_file.h"
#include "tools/temporary_folder.h"

using namespace welkin::test;

namespace {

glm::dvec3 triple(const nlohmann::json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

// The line "NAME r g b" of a text.
glm::dvec3 numbers_behind(const std::string& name, const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string first;
    glm::dvec3 rgb{};
    if (words >> first >> rgb.x >> rgb.y >> rgb.z && first == name) return rgb;
  }
  FAIL("no line " << name << " in\n" << text);
  return {};
}

bool run_shell(const std::string& command) { return std::system(command.c_str()) == 0; }

// What a C program that includes the header prints for `expression`s, one a line.
std::string printed_by_c(const std::string& header, const std::string& expressions) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "light.h") << header;
  std::ofstream(folder.path() / "main.c") << "#include \"light.h\"\n#include \"light.h\"\n#include <stdio.h>\n"
                                          << "int main(void) {\n"
                                          << expressions << "  return 0;\n}\n";
  const std::string in_folder = "cd " + quoted(folder.path()) + " && ";
  REQUIRE(run_shell(in_folder + "cc -std=c99 -pedantic -Wall -Wno-unused-const-variable -Wno-unused-variable -Werror "
                                "-o main main.c && ./main > printed"));
  std::ifstream printed(folder.path() / "printed");
  std::stringstream text;
  text << printed.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("sh: text has a line a coefficient, every digit", "[tools]") {
  const nlohmann::json json = run_sh_json("--bands 4");
  const CommandResult result = run_welkin("sh --bands 4 --format text");
  CHECK(result.exit_code == 0);
  CHECK(result.errors.empty());
  for (int l = 0; l < 4; ++l) {
    for (int m = -l; m <= l; ++m) {
      const std::string place = '[' + std::to_string(l) + ',' + std::to_string(m) + ']';
      const std::size_t index = static_cast<std::size_t>(l * (l + 1) + m);
      CHECK(numbers_behind("radiance" + place, result.output) == triple(json.at("radiance").at(index)));
      CHECK(numbers_behind("irradiance" + place, result.output) == triple(json.at("irradiance").at(index)));
    }
  }
}

TEST_CASE("sh: an engine's text has the engine's terms and its formula", "[tools]") {
  const nlohmann::json json = run_sh_json("--for unity");
  const CommandResult result = run_welkin("sh --for unity --format text");
  CHECK(contains(result.output, "# "));
  CHECK(contains(result.output, json.at("engine").at("form").get<std::string>()));
  for (const auto& [name, rgb] : json.at("engine").at("terms").items()) {
    CHECK(numbers_behind(name, result.output) == triple(rgb));
  }
  const nlohmann::json& vectors = json.at("engine").at("vectors");
  CHECK(vectors.size() == 7);
  for (const auto& [name, value] : vectors.items()) {
    CHECK(numbers_behind(name, result.output) == triple(value));
    CHECK(contains(run_welkin("sh --for unity").output, name));
  }
}

TEST_CASE("sh: a C header has Unity's shader vectors, four numbers each", "[tools]") {
  const nlohmann::json vectors = run_sh_json("--for unity").at("engine").at("vectors");
  const CommandResult result = run_welkin("sh --format c --for unity");
  REQUIRE(result.exit_code == 0);
  const std::string printed = printed_by_c(result.output,
                                           "  const float (*v)[4] = built_in_sky_unity_vectors;\n"
                                           "  for (int i = 0; i < 7; ++i) printf(\"xyz%d %.9g %.9g %.9g\\nw%d %.9g 0 "
                                           "0\\n\", i, v[i][0], v[i][1], v[i][2], i, "
                                           "v[i][3]);\n");
  const char* const names[] = {"unity_SHAr", "unity_SHAg", "unity_SHAb", "unity_SHBr",
                               "unity_SHBg", "unity_SHBb", "unity_SHC"};
  for (int i = 0; i < 7; ++i) {
    const nlohmann::json& expected = vectors.at(names[i]);
    CHECK(glm::vec3(numbers_behind("xyz" + std::to_string(i), printed)) == glm::vec3(triple(expected)));
    CHECK(static_cast<float>(numbers_behind("w" + std::to_string(i), printed).x) == expected.at(3).get<float>());
  }
}

TEST_CASE("sh: the C header compiles as C99 and holds the numbers", "[tools]") {
  const nlohmann::json json = run_sh_json("");
  const CommandResult result = run_welkin("sh --format c");
  REQUIRE(result.exit_code == 0);
  const std::string printed = printed_by_c(
      result.output,
      "  for (int i = 0; i < 9; ++i) printf(\"radiance%d %.9g %.9g %.9g\\n\", i, built_in_sky_radiance[i][0], "
      "built_in_sky_radiance[i][1], built_in_sky_radiance[i][2]);\n");
  for (std::size_t i = 0; i < 9; ++i) {
    const glm::dvec3 expected = triple(json.at("radiance").at(i));
    const glm::dvec3 found = numbers_behind("radiance" + std::to_string(i), printed);
    for (int channel = 0; channel < 3; ++channel) {
      CHECK(static_cast<float>(found[channel]) == static_cast<float>(expected[channel]));
    }
  }
}

TEST_CASE("sh: a C header for an engine, of a file with an odd name", "[tools]") {
  const TemporaryFolder folder;
  const auto path = folder.path() / "7 a*-b*.pfm";
  write_pfm(path, 8, 4, grey_picture(8, 4, 0.5F));
  const CommandResult result = run_welkin("sh --format c --for babylon --take-out-sun " + quoted(path));
  REQUIRE(result.exit_code == 0);
  const std::string printed =
      printed_by_c(result.output, "  printf(\"first %.9g 0 0\\n\", environment_7_a__b__babylon[0][0]);\n");
  CHECK(std::isfinite(numbers_behind("first", printed).x));
}
