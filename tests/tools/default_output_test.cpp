
#include "support/catch.h"
#include "tools/baked_folder.h"
#include "tools/command.h"

using namespace welkin::test;

// Where results go if -o names nothing: beside nobody else's files.

namespace {

constexpr const char* kSmall = " --size 4 --irradiance 0 --no-brdf --no-previews";

struct Workplace {
  TemporaryDirectory folder;

  Workplace() {
    std::filesystem::create_directory(folder.path() / "hdr");
    write_pfm(folder.path() / "hdr" / "city.pfm", 16, 8, grey_image(16, 8, 1.0F));
  }
  [[nodiscard]] std::string go() const { return "cd " + quoted(folder.path()) + " &&"; }
  /// What is said on standard output.
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
  here.succeed(std::string("bake hdr/city.pfm") + kSmall);  // an empty folder is nobody's
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
