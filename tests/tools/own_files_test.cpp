// The folders of results, and the files in them that `welkin bake` and `welkin importance` replace and remove: only
// those that they wrote.
#include "tools/command.h"

using namespace welkin;
using namespace welkin::test;

namespace {

constexpr const char* kSmall = " --size 8 --irradiance 4 --brdf 8 --no-previews ";

std::string bake_line(const std::filesystem::path& folder, const std::string& options = "") {
  return "bake " + small_image() + kSmall + options + " -o " + quoted(folder);
}

/// Name and content of all files of a folder.
std::vector<std::string> contents_of(const std::filesystem::path& folder) {
  std::vector<std::string> all;
  for (const std::string& name : names_in(folder)) {
    const bool is_file = std::filesystem::is_regular_file(folder / name);
    all.push_back(name + ": " + (is_file ? file_text(folder / name) : "no file"));
  }
  return all;
}

/// Refused before any work: names the file and what to do, and nothing is changed.
void check_refused(const std::string& line, const std::filesystem::path& folder, const std::string& name) {
  const std::vector<std::string> before = contents_of(folder);
  const std::string message = failure(line, 1);
  INFO(message);
  CHECK(contains(message, name + ": is "));
  CHECK(contains(message, "pass another folder to -o"));
  CHECK(contents_of(folder) == before);
}

}  // namespace

TEST_CASE("bake: a manifest.json of somebody else is refused before any work", "[tools][bake][own_files]") {
  const TemporaryFile folder("web");
  std::filesystem::create_directory(folder);
  for (const char* text : {R"({"name": "My app", "icons": []})", "", "{", R"({"welkin": 1, "files": []})",
                           R"({"name": "welkin", "files": ["a.js"]})"}) {
    write_text(folder / "manifest.json", text);
    check_refused(bake_line(folder), folder, "manifest.json");
    // Refused before any work: the input is not read.
    CHECK(contains(failure("bake missing.hdr -o " + quoted(folder), 1), "m"));
    CHECK(file_text(folder / "manifest.json") == text);
  }
  std::filesystem::remove(folder / "manifest.json");
  std::filesystem::create_directory(folder / "manifest.json");
  check_refused(bake_line(folder), folder, "manifest.json");
}

TEST_CASE("bake: what cannot be replaced is refused before any work", "[tools][bake][own_files][posix][slow]") {
  const TemporaryFile folder("out");
  bake_into(folder, small_image() + kSmall);
  for (const char* name : {"irradiance.ktx2", "sh.json", "manifest.json"}) {
    const std::string was = file_text(folder / name);
    std::filesystem::remove(folder / name);
    std::filesystem::create_directory(folder / name);
    check_refused(bake_line(folder), folder, name);
    std::filesystem::remove(folder / name);
    std::filesystem::create_symlink("/dev/null", folder / name);
    check_refused(bake_line(folder), folder, name);
    std::filesystem::remove(folder / name);
    REQUIRE(run_program("mkfifo", quoted(folder / name)).exit_code == 0);
    check_refused(bake_line(folder), folder, name);
    std::filesystem::remove(folder / name);
    write_text(folder / name, was);
  }
  bake_into(folder, small_image() + kSmall);
  const TemporaryFile others("others");
  std::filesystem::create_directory(others);
  std::filesystem::create_symlink("nowhere", others / "sh.json");
  check_refused(bake_line(others), others, "sh.json");
}

TEST_CASE("bake: a file that no manifest lists is not replaced, and older results are",
          "[tools][bake][own_files][slow]") {
  const TemporaryFile folder("out");
  std::filesystem::create_directory(folder);
  for (const char* name : {"sh.json", "background.ktx2"}) {
    write_text(folder / name, "somebody's");
    check_refused(bake_line(folder), folder, name);
    std::filesystem::remove(folder / name);
  }
  write_text(folder / "notes.txt", "somebody's");
  bake_into(folder, small_image() + kSmall);
  const std::string reflections = file_text(folder / "specular.ktx2");
  write_text(folder / "specular.ktx2", "old");
  std::vector<std::string> names = names_of(bake_into(folder, small_image() + kSmall));
  CHECK(file_text(folder / "specular.ktx2") == reflections);
  names.insert(std::upper_bound(names.begin(), names.end(), "notes.txt"), "notes.txt");
  CHECK(names_in(folder) == names);
  write_text(folder / "specular.dds", "somebody's");
  check_refused(bake_line(folder, "--formats dds"), folder, "specular.dds");
  bake_into(folder, small_image() + kSmall);
  CHECK(file_text(folder / "notes.txt") == "somebody's");
  CHECK(file_text(folder / "specular.dds") == "somebody's");
}

TEST_CASE("bake: after a run that was stopped its files are known", "[tools][bake][own_files][slow]") {
  const TemporaryFile folder("out");
  bake_into(folder, small_image() + " --for unreal" + kSmall);
  // As a killed bake with --formats ktx2 leaves it: with a list of what it replaces, and no manifest.
  const std::string manifest = file_text(folder / "manifest.json");
  nlohmann::json list = {{"welkin", "0"}, {"files", json_of(manifest).at("files")}};
  list["files"].push_back({{"name", "specular.ktx2"}, {"bytes", nullptr}});
  write_text(folder / "unfinished_manifest.json", list.dump());
  std::filesystem::remove(folder / "manifest.json");
  write_text(folder / "specular.ktx2", "half of a bake");
  const auto after = bake_into(folder, small_image() + kSmall);
  CHECK(names_in(folder) == names_of(after));  // neither environment.hdr nor the list
  write_text(folder / "unfinished_manifest.json", "somebody's");
  check_refused(bake_line(folder), folder, "unfinished_manifest.json");
}

TEST_CASE("bake: what an earlier bake wrote and this one does not is removed, if it is as it was",
          "[tools][bake][own_files][slow]") {
  const TemporaryDirectory scratch;
  const auto folder = scratch.path() / "out";
  bake_into(folder, small_image() + kSmall);
  const std::string said = printed_by(bake_line(folder, "--for three"));
  CHECK(names_in(folder) == names_of(manifest_of(folder)));
  CHECK(contains(said, "note: removed, because an earlier 'bake' wrote it and this one does not: background.ktx2"));
  // A file that has changed since stays and is named.
  write_text(folder / "specular.dds", "somebody's now");
  const CommandResult other = run_welkin(bake_line(folder, "--for unreal"));
  CHECK(contains(other.output,
                 "kept next to the new files, because it is read or has changed since an earlier 'bake' wrote it: "
                 "specular.dds"));
  CHECK(file_text(folder / "specular.dds") == "somebody's now");
  // A file that is read stays as well.
  bake_into(folder, quoted(folder / "environment.hdr") + kSmall);
  CHECK(std::filesystem::exists(folder / "environment.hdr"));
  // A cache makes no difference.
  const auto input = scratch.path() / "in.hdr";
  std::filesystem::copy_file(folder / "environment.hdr", input);
  const auto cached = scratch.path() / "cached";
  const std::string cache = kSmall + (" --cache " + quoted(scratch.path() / "cache"));
  bake_into(cached, quoted(input) + cache);
  bake_into(cached, quoted(input) + cache + " --for filament");
  const auto again = bake_into(cached, quoted(input) + cache);
  CHECK(again.at("times").size() == 1);
  CHECK(names_in(cached) == names_of(again));
}

TEST_CASE("bake: a manifest that lies makes it remove nothing that is not a bake's",
          "[tools][bake][own_files][posix]") {
  const TemporaryDirectory scratch;
  const auto folder = scratch.path() / "out";
  const auto outside = scratch.path() / "background.dds";
  std::filesystem::create_directory(folder);
  std::filesystem::create_directory(folder / "phong.dds");
  write_text(outside, "12345");
  for (const char* name : {"notes.txt", "photograph.hdr", "lambert.dds", "specular_mine.dds"})
    write_text(folder / name, "12345");
  std::filesystem::create_symlink(outside, folder / "charlie.dds");
  nlohmann::json files = nlohmann::json::array({5, nullptr, nlohmann::json::object(), {{"name", 3}, {"bytes", 5}}});
  for (const std::string& name :
       {std::string("../background.dds"), outside.string(), std::string("./notes.txt"), std::string("notes.txt"),
        std::string("photograph.hdr"), std::string("specular_mine.dds"), std::string("charlie.dds"),
        std::string("phong.dds"), std::string(".."), std::string(), std::string("manifest.json")}) {
    files.push_back({{"name", name}, {"bytes", 5}});
  }
  files.push_back({{"name", "lambert.dds"}, {"bytes", 6}});
  files.push_back({{"name", "lambert.dds"}, {"bytes", -1}});
  write_text(folder / "manifest.json", nlohmann::json({{"welkin", "0"}, {"files", files}}).dump());
  bake_into(folder, small_image() + kSmall);
  CHECK(file_text(outside) == "12345");
  for (const char* name : {"notes.txt", "photograph.hdr", "lambert.dds", "charlie.dds", "specular_mine.dds"})
    CHECK(file_text(folder / name) == "12345");
  CHECK(std::filesystem::is_symlink(folder / "charlie.dds"));
  CHECK(std::filesystem::is_directory(folder / "phong.dds"));
}

// The folders of results without -o: never among the files of other programs or users.

namespace {

struct Workplace {
  TemporaryDirectory folder;

  Workplace() {
    std::filesystem::create_directory(folder.path() / "hdr");
    write_pfm(folder.path() / "hdr" / "city.pfm", 16, 8, grey_image(16, 8, 1.0F));
  }
  [[nodiscard]] std::string go() const { return "cd " + quoted(folder.path()) + " &&"; }
  /// Returns the standard output.
  std::string succeed(const std::string& arguments) const { return printed_by(arguments, go()); }
  [[nodiscard]] std::string refusal(const std::string& arguments, int code) const {
    return failure(arguments, code, go());
  }
  [[nodiscard]] bool has(const std::string& name) const { return std::filesystem::exists(folder.path() / name); }
};

}  // namespace

TEST_CASE("bake: without -o the folder has the input's name, and is said", "[tools][bake][posix][slow]") {
  const Workplace here;
  CHECK(contains(here.succeed(std::string("bake hdr/city.pfm") + kSmall), "\ncity, axes"));
  CHECK(here.has("city/manifest.json"));
  CHECK(contains(here.succeed(std::string("bake hdr/city.pfm") + kSmall), "\ncity, axes"));  // its own is replaced
  here.succeed(std::string("bake --sky") + kSmall);
  CHECK(here.has("sky/manifest.json"));
  CHECK(contains(here.refusal(std::string("bake - < hdr/city.pfm") + kSmall, 2), "gives the result no name"));
  CHECK(contains(here.refusal(std::string("bake hdr/city.pfm -o \'\'") + kSmall, 1), "-o"));  // an unset variable
}

TEST_CASE("bake: without -o nobody else's folder or file is touched", "[tools][bake][posix][slow]") {
  const Workplace here;
  std::filesystem::create_directory(here.folder.path() / "city");
  here.succeed(std::string("bake hdr/city.pfm") + kSmall);  // an empty folder has no owner
  std::filesystem::remove(here.folder.path() / "city" / "manifest.json");
  const std::string message = here.refusal(std::string("bake hdr/city.pfm") + kSmall, 1);
  CHECK(contains(message, "city: is there and was not written by 'welkin bake'"));
  std::ofstream(here.folder.path() / "city" / "manifest.json") << "{\"name\": \"somebody\'s app\"}";
  CHECK(contains(here.refusal(std::string("bake hdr/city.pfm") + kSmall, 1), "pass another folder to -o"));
  CHECK(file_text(here.folder.path() / "city" / "manifest.json") == "{\"name\": \"somebody\'s app\"}");
  std::ofstream(here.folder.path() / "sky") << "a file";
  CHECK(contains(here.refusal(std::string("bake --sky") + kSmall, 1), "sky: is there"));
  CHECK(file_text(here.folder.path() / "sky") == "a file");
}

TEST_CASE("importance and testmap: without -o results are named, and replace nothing", "[tools][posix]") {
  const Workplace here;
  for (int times = 0; times < 2; ++times) {
    CHECK(contains(here.succeed("importance hdr/city.pfm"), "city_importance: tables of 16 x 8"));
  }
  CHECK(here.has("city_importance/importance.json"));
  std::filesystem::remove(here.folder.path() / "city_importance" / "importance.json");
  CHECK(contains(here.refusal("importance hdr/city.pfm", 1), "was not written by 'welkin importance'"));
  CHECK(contains(here.succeed("testmap --size 8"), "testmap.exr: lat-long"));
  CHECK(contains(here.refusal("testmap --size 8", 1), "'-o testmap.exr' replaces it"));
}
