// `welkin sky --tables FILE`: made once, used again if they are what is asked for, never trusted blindly.
#include <filesystem>
#include <fstream>

#include "tools/baked_folder.h"
#include "tools/sky_command.h"
#include "tools/temporary_folder.h"

using namespace welkin;
using namespace welkin::test;

namespace {

std::string tables_action(const nlohmann::json& document) {
  for (const auto& pass : document.at("diagnostics").at("passes")) {
    if (pass.at("name") == "tables") return pass.at("action").get<std::string>();
  }
  return "none";
}

}  // namespace

TEST_CASE("sky: tables are saved, and used again for any sun and height", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "earth.sky";
  const std::string tables = "--tables " + quoted(file);
  const nlohmann::json first = sky_json("--sun-elevation 20 " + tables);
  CHECK(tables_action(first) == "run");
  REQUIRE(std::filesystem::exists(file));
  const std::string stored = file_text(file);
  const nlohmann::json again = sky_json("--sun-elevation 20 " + tables);
  CHECK(tables_action(again) == "reuse");
  CHECK(again.at("radiance") == first.at("radiance"));
  CHECK(again.at("sun") == first.at("sun"));
  CHECK(tables_action(sky_json("--sun-elevation -3 --altitude 5000 --memory-limit 1GB " + tables)) == "reuse");
  CHECK(sky_json("--sun-elevation -3 " + tables).at("radiance") == sky_json("--sun-elevation -3").at("radiance"));
  CHECK((file_text(file) == stored));
  CHECK(names_in(folder.path()) == std::vector<std::string>{"earth.sky"});
}

TEST_CASE("sky: tables of another sky are made anew, and replace those in the file", "[tools][sky]") {
  const TemporaryFolder folder;
  const std::string tables = "--sun-elevation 20 --tables " + quoted(folder.path() / "some.sky");
  sky_json(tables);
  for (const char* other : {"--ground-albedo 0.5 ", "--preset mars ", "--until-change 0.5 ", "--layout compact ", ""}) {
    INFO(other);
    const nlohmann::json made = sky_json(other + tables);
    CHECK(tables_action(made) == "run");
    CHECK(made.at("radiance") == sky_json(std::string(other) + "--sun-elevation 20").at("radiance"));
    CHECK(tables_action(sky_json(other + tables)) == "reuse");
  }
}

TEST_CASE("sky: a file that holds no sound tables is named and left as it is", "[tools][sky]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "broken.sky";
  const std::string tables = kSmallSky + "--tables " + quoted(file);
  std::ofstream(file) << "my holiday pictures\n";
  CHECK(contains(sky_failure(tables, 1), "broken.sky"));
  CHECK(file_text(file) == "my holiday pictures\n");
  std::filesystem::remove(file);

  sky_json("--tables " + quoted(file));
  const std::string sound = file_text(file);
  std::string damaged = sound;
  damaged[sound.size() / 2] = static_cast<char>(damaged[sound.size() / 2] ^ 1);
  std::ofstream(file, std::ios::binary) << damaged;
  CHECK(contains(sky_failure(tables, 1), "broken.sky"));
  std::ofstream(file, std::ios::binary) << sound.substr(0, sound.size() - 5);
  CHECK(contains(sky_failure(tables, 1), "broken.sky"));
  CHECK(contains(sky_failure(kSmallSky + "--tables " + quoted(folder.path() / "no" / "folder.sky"), 1), "folder.sky"));
  CHECK(contains(sky_failure(kSmallSky + "--tables " + quoted(folder.path()), 1), folder.path().filename().string()));
}
