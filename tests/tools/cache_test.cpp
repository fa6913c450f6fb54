// `--cache`: the second run's files are the first one's, and say that they were not made again.
#include <fstream>

#include "tools/baked_folder.h"
#include "tools/temporary_folder.h"

using namespace welkin;
using namespace welkin::test;

namespace {

constexpr const char* kSmall = " --size 64 --irradiance 8 --brdf 8 --no-previews --formats ktx2,env ";

std::string with_cache(const TemporaryFolder& folder) { return "--cache " + quoted(folder.path() / "cache") + ' '; }

std::string action_of(const nlohmann::json& passes, const std::string& name) {
  for (const auto& pass : passes) {
    if (pass.at("name") == name) return pass.at("action").get<std::string>();
  }
  return "none";
}

std::string reason_of(const nlohmann::json& passes, const std::string& name) {
  for (const auto& pass : passes) {
    if (pass.at("name") == name) return pass.at("reason").get<std::string>();
  }
  return "none";
}

/// All that two folders hold, but for times and notes.
bool same_folders(const std::filesystem::path& a, const std::filesystem::path& b) {
  if (names_in(a) != names_in(b)) return false;
  for (const std::string& name : names_in(a)) {
    if (name != "manifest.json" && file_text(a / name) != file_text(b / name)) return false;
  }
  nlohmann::json first = manifest_of(a);
  nlohmann::json second = manifest_of(b);
  for (nlohmann::json* manifest : {&first, &second}) {
    manifest->erase("times");
    manifest->erase("notes");
  }
  return first == second;
}

bool notes_say(const nlohmann::json& report, const std::string& part) {
  for (const auto& note : report.at("notes")) {
    if (contains(note.get<std::string>(), part)) return true;
  }
  return false;
}

/// Written by `testmap`, so that there is a file.
std::filesystem::path environment(const TemporaryFolder& folder) {
  std::filesystem::path path = folder.path() / "map.hdr";
  REQUIRE(run_welkin("testmap -o " + quoted(path)).exit_code == 0);
  return path;
}

std::vector<std::filesystem::path> entries(const TemporaryFolder& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "cache")) paths.push_back(entry.path());
  return paths;
}

}  // namespace

TEST_CASE("A bake with a cache gives the same files, and the second time makes none of them", "[command][cache]") {
  const TemporaryFolder folder;
  const std::string bake = quoted(environment(folder)) + kSmall;
  const nlohmann::json without = bake_into(folder.path() / "without", bake);
  const nlohmann::json first = bake_into(folder.path() / "first", bake + with_cache(folder));
  const nlohmann::json second = bake_into(folder.path() / "second", bake + with_cache(folder));
  CHECK(same_folders(folder.path() / "without", folder.path() / "first"));
  CHECK(same_folders(folder.path() / "without", folder.path() / "second"));
  for (const char* pass : {"background", "background mips", "specular", "project", "irradiance", "specular mip 1"}) {
    INFO(pass);
    CHECK(action_of(second.at("times"), pass) == "reuse");
  }
  CHECK(action_of(first.at("times"), "specular") == "run");
  CHECK(action_of(first.at("times"), "specular mip 1") == "run");
  CHECK(second.at("notes") == without.at("notes"));
}

TEST_CASE("A mip more is one mip's work", "[command][cache]") {
  const TemporaryFolder folder;
  const std::string bake = quoted(environment(folder)) + " --size 64 --no-brdf --no-previews --formats ktx2 ";
  bake_into(folder.path() / "first", bake + "--roughness 0,0.3,0.6 " + with_cache(folder));
  const nlohmann::json more = bake_into(folder.path() / "more", bake + "--roughness 0,0.3,0.6,1 " + with_cache(folder));
  bake_into(folder.path() / "without", bake + "--roughness 0,0.3,0.6,1 ");
  CHECK(same_folders(folder.path() / "more", folder.path() / "without"));
  CHECK(action_of(more.at("times"), "specular mip 2") == "reuse");
  CHECK(action_of(more.at("times"), "specular mip 3") == "run");
  CHECK(action_of(more.at("times"), "specular") == "run");
}

TEST_CASE("What a scene needs is taken from the bake of everything", "[command][cache][plan]") {
  const TemporaryFolder folder;
  const std::string bake =
      quoted(environment(folder)) + " --size 64 --roughness 0,0.3,0.6,1 --formats ktx2 --no-brdf --no-previews ";
  bake_into(folder.path() / "all", bake + with_cache(folder));
  std::ofstream(folder.path() / "needs.json") << R"({"glossy": {"least": 0.6}, "irradiance_cubemap": false})";
  const std::string some = bake + "--needs " + quoted(folder.path() / "needs.json") + ' ';
  const nlohmann::json cached = bake_into(folder.path() / "cached", some + with_cache(folder));
  const nlohmann::json plain = bake_into(folder.path() / "plain", some);
  CHECK(same_folders(folder.path() / "cached", folder.path() / "plain"));
  CHECK(action_of(cached.at("times"), "specular") == "reuse");
  CHECK(action_of(cached.at("times"), "irradiance") == "skip");
  CHECK(reason_of(cached.at("times"), "irradiance") == reason_of(plain.at("times"), "irradiance"));
}

TEST_CASE("A damaged entry is computed anew, and said so", "[command][cache]") {
  const TemporaryFolder folder;
  const std::string bake = quoted(environment(folder)) + kSmall + with_cache(folder);
  bake_into(folder.path() / "first", bake);
  const std::size_t count = entries(folder).size();
  for (const std::filesystem::path& path : entries(folder)) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(100);
    file.put('\x7f');
    file.put('\x11');
  }
  const nlohmann::json second = bake_into(folder.path() / "second", bake);
  CHECK(same_folders(folder.path() / "first", folder.path() / "second"));
  CHECK(notes_say(second, std::to_string(count) + " damaged results computed anew"));
  CHECK(action_of(second.at("times"), "specular") == "run");
  const nlohmann::json third = bake_into(folder.path() / "third", bake);
  CHECK(same_folders(folder.path() / "first", folder.path() / "third"));
  CHECK(!notes_say(third, "damaged"));
  CHECK(action_of(third.at("times"), "specular") == "reuse");
}

TEST_CASE("A cache that cannot be written fails nothing, and is said", "[command][cache]") {
  const TemporaryFolder folder;
  const std::string map = quoted(environment(folder));
  std::ofstream(folder.path() / "cache") << "a file, where a folder should be";
  bake_into(folder.path() / "without", map + kSmall);
  const nlohmann::json manifest = bake_into(folder.path() / "with", map + kSmall + with_cache(folder));
  CHECK(same_folders(folder.path() / "without", folder.path() / "with"));
  CHECK(notes_say(manifest, "the cache could not keep all results"));
  CHECK(notes_say(run_sh_json(map + ' ' + with_cache(folder)).at("source"), "the cache could not keep all results"));
}

TEST_CASE("Coefficients come from the cache the second time", "[command][cache]") {
  const TemporaryFolder folder;
  const std::string map = quoted(environment(folder)) + ' ';
  const auto light = [](nlohmann::json report) {
    report.at("diagnostics").erase("passes");
    return report;
  };
  const nlohmann::json without = run_sh_json(map);
  const nlohmann::json first = run_sh_json(map + with_cache(folder));
  const nlohmann::json second = run_sh_json(map + with_cache(folder));
  CHECK(light(first) == light(without));
  CHECK(light(second) == light(without));
  CHECK(action_of(first.at("diagnostics").at("passes"), "project") == "run");
  CHECK(action_of(second.at("diagnostics").at("passes"), "project") == "reuse");
  CHECK(action_of(second.at("diagnostics").at("passes"), "cache") == "reuse");
}
