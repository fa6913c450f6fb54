
#include "tools/command.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/image.h"

using namespace welkin;
using namespace welkin::test;

// `welkin bake` with a scene's needs: what is left out is not in the folder, what is left is as it was, and the plan
// says why.

namespace {

constexpr const char* kSmall = " --size 16 --irradiance 8 --brdf 16 --formats ktx2 --preview-size 16 ";

std::filesystem::path needs_file(const TemporaryDirectory& folder, const std::string& text) {
  std::ofstream(folder.path() / "needs.json") << text;
  return folder.path() / "needs.json";
}

bool has(const std::filesystem::path& folder, const std::string& name) {
  return std::filesystem::exists(folder / name);
}

}  // namespace

TEST_CASE("A bake leaves out what the scene does not need and keeps the rest", "[command][plan][slow]") {
  const TemporaryDirectory folder;
  bake_into(folder.path() / "all", small_image() + kSmall);
  const std::filesystem::path needs = needs_file(folder, R"({"glossy": null, "diffuse_bands": 3})");
  const nlohmann::json manifest =
      bake_into(folder.path() / "some", small_image() + kSmall + "--needs " + quoted(needs));
  for (const char* name : {"background.ktx2", "sh.json"}) {
    INFO(name);
    CHECK(file_text(folder.path() / "some" / name) == file_text(folder.path() / "all" / name));
  }
  // Irradiance with a chain shares its transform: it differs by less than the last digit of half floats.
  const Cubemap alone = read_texture(folder.path() / "some" / "irradiance.ktx2").cubemap;
  const Cubemap beside = read_texture(folder.path() / "all" / "irradiance.ktx2").cubemap;
  REQUIRE(alone.pixels().size() == beside.pixels().size());
  for (std::size_t i = 0; i < alone.pixels().size(); ++i) {
    REQUIRE(alone.pixels()[i] == Approx(beside.pixels()[i]).epsilon(1.0 / 1024.0));
  }
  for (const char* name : {"specular.ktx2", "brdf.ktx2", "preview_mips.png"}) {
    INFO(name);
    CHECK(has(folder.path() / "all", name));
    CHECK(!has(folder.path() / "some", name));
  }
  CHECK(names_in(folder.path() / "some") == names_of(manifest));
  CHECK(manifest.at("needs").at("glossy").is_null());
}

TEST_CASE("Mips beyond the materials' roughness are not baked", "[command][plan][slow]") {
  const TemporaryDirectory folder;
  const std::string bake = "--sky --size 32 --roughness 0,0.3,0.6,1 --formats ktx2 --no-previews";
  const nlohmann::json all = bake_into(folder.path() / "all", bake);
  const nlohmann::json some = bake_into(folder.path() / "some", bake + " --glossy 0.6,1");
  REQUIRE(some.at("specular").size() == 2);
  CHECK(some.at("specular")[0].at("mean") == all.at("specular")[2].at("mean"));
  CHECK(file_of(some, "specular.ktx2").at("size") == 8);
  CHECK(file_of(some, "background.ktx2").at("size") == 32);
  // three.js finds mips by their number: it would take 0.6 for 0.
  const nlohmann::json three =
      bake_into(folder.path() / "three", "--sky --size 32 --for three --no-previews --glossy 0.6,1");
  CHECK(three.at("specular")[0].at("roughness") == 0.0);
  CHECK(contains(three.at("notes").dump(), "none is left out"));
}

TEST_CASE("A bake explains itself", "[command][plan][slow]") {
  const TemporaryDirectory folder;
  const std::string bake = "bake " + small_image() + kSmall + "--no-glossy -o " + quoted(folder.path() / "out");
  const CommandResult ahead = run_welkin(bake + " --plan-only");
  CHECK(ahead.exit_code == 0);
  CHECK(contains(ahead.output, "no glossy materials"));
  CHECK(!std::filesystem::exists(folder.path() / "out"));
  const nlohmann::json plan = json_of(run_welkin(bake + " --plan-only --json").output);
  CHECK(plan.at("passes").size() == 8);
  const CommandResult after = run_welkin(bake + " --explain");
  INFO(after.errors);
  CHECK(after.exit_code == 0);
  CHECK(contains(after.errors, "Plan for"));  // printed before the bake begins
  CHECK(!contains(after.errors, "measured ms"));
  CHECK(contains(after.output, "measured ms"));
  const CommandResult json = run_welkin(bake + " --explain --json");
  CHECK(json_of(json.output).at("plan").at("passes").size() == 8);
}

TEST_CASE("An error budget sets bounds and bands", "[command][plan][slow]") {
  const TemporaryDirectory folder;
  const auto options_of = [&](const std::string& budget) {
    return bake_into(folder.path() / "out", small_image() + kSmall + "--error-budget " + budget).at("options");
  };
  for (const auto& [budget, bands] : {std::pair("0.09", 3), std::pair("0.03", 7), std::pair("0.01", 15)}) {
    INFO(budget);
    const nlohmann::json options = options_of(budget);
    CHECK(options.at("bands") == bands);
    CHECK(options.at("rms_error") == std::stod(budget));
  }
}

TEST_CASE("Bad needs are refused by the key's name", "[command][plan]") {
  const TemporaryDirectory folder;
  const auto refused = [&](const std::string& text, const std::string& key) {
    const std::filesystem::path needs = needs_file(folder, text);
    const CommandResult result =
        run_welkin("bake --sky --needs " + quoted(needs) + " --plan-only -o " + quoted(folder.path() / "out"));
    INFO(text << "\n" << result.errors);
    return result.exit_code != 0 && result.output.empty() && contains(result.errors, "needs.json") &&
           contains(result.errors, key);
  };
  CHECK(refused(R"({"difuse_bands": 3})", "difuse_bands"));
  CHECK(refused(R"({"diffuse_bands": 2.5})", "needs.diffuse_bands"));
  CHECK(refused(R"({"diffuse_bands": 99})", "needs.diffuse_bands"));
  CHECK(refused(R"({"background": "yes"})", "needs.background"));
  CHECK(refused(R"({"glossy": {"minimum": 0.9, "maximum": 0.1}})", "needs.glossy"));
  CHECK(refused(R"({"glossy": {"smallest": 0.1}})", "smallest"));
  CHECK(refused(R"({"error_budget": 0.01})", "error_budget"));
  CHECK(refused("[1]", "not a JSON object"));
  CHECK(refused("{", "JSON"));
}

// `--cache`: the second run's files equal those of the first, and state that they were not made again.

namespace {

constexpr const char* kSmallKept = " --size 64 --irradiance 8 --brdf 8 --no-previews --formats ktx2,env ";

std::string with_cache(const TemporaryDirectory& folder) { return "--cache " + quoted(folder.path() / "cache") + ' '; }

std::string action_of(const nlohmann::json& passes, const std::string& name) {
  for (const auto& pass : passes) {
    if (pass.at("name") == name) return pass.at("action").get<std::string>();
  }
  return "none";
}

/// Compares all files of two folders except times and notes.
void check_same_folders(const std::filesystem::path& a, const std::filesystem::path& b) {
  check_same_files(a, b);
  nlohmann::json first = manifest_of(a);
  nlohmann::json second = manifest_of(b);
  for (nlohmann::json* manifest : {&first, &second}) {
    manifest->erase("times");
    manifest->erase("notes");
  }
  CHECK(first == second);
}

bool notes_say(const nlohmann::json& report, const std::string& part) {
  for (const auto& note : report.at("notes")) {
    if (contains(note.get<std::string>(), part)) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("A bake with a cache gives the same files, and the second time makes none of them",
          "[command][cache][slow]") {
  const TemporaryDirectory folder;
  const std::string bake = small_image() + kSmallKept;
  const nlohmann::json without = bake_into(folder.path() / "without", bake);
  const nlohmann::json first = bake_into(folder.path() / "first", bake + with_cache(folder));
  const nlohmann::json second = bake_into(folder.path() / "second", bake + with_cache(folder));
  check_same_folders(folder.path() / "without", folder.path() / "first");
  check_same_folders(folder.path() / "without", folder.path() / "second");
  CHECK(second.at("times").size() == 1);
  CHECK(action_of(second.at("times"), "cache") == "reuse");
  CHECK(second.at("notes") == without.at("notes"));

  // An explained bake looks up each pass.
  REQUIRE(
      run_welkin("bake " + bake + with_cache(folder) + " --explain -o " + quoted(folder.path() / "third")).exit_code ==
      0);
  const nlohmann::json third = manifest_of(folder.path() / "third");
  for (const char* pass : {"background", "background mips", "specular", "project", "irradiance", "specular mip 1"}) {
    INFO(pass);
    CHECK(action_of(third.at("times"), pass) == "reuse");
  }
  CHECK(action_of(first.at("times"), "specular") == "run");
  CHECK(action_of(first.at("times"), "specular mip 1") == "run");
}

TEST_CASE("A cache that cannot be written fails nothing, and is said", "[command][cache][slow]") {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "cache") << "a file, where a folder should be";
  bake_into(folder.path() / "without", small_image() + kSmallKept);
  const nlohmann::json manifest = bake_into(folder.path() / "with", small_image() + kSmallKept + with_cache(folder));
  check_same_folders(folder.path() / "without", folder.path() / "with");
  CHECK(notes_say(manifest, "the cache could not keep all results"));
  CHECK(notes_say(run_sh_json(small_image() + ' ' + with_cache(folder)).at("source"),
                  "the cache could not keep all results"));
}
