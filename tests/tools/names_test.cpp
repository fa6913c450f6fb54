// Promises: the command takes and names files by any characters and of any length, and its output is UTF-8 with the
// same bytes on every system.
#include "platform/text.h"
#include "support/catch.h"
#include "tools/command.h"

namespace welkin::test {

TEST_CASE("command: files whose names have characters of any language are written, read and named", "[command][slow]") {
  const TemporaryDirectory folder;
  // Of two, three and four bytes in UTF-8; the last is a pair in UTF-16.
  for (const char* const name : {"H\xC3\xB6he.pfm", "\xE5\xA4\xA9\xE7\xA9\xBA.pfm", "\xF0\x9F\x8C\x84 sunrise.pfm"}) {
    CAPTURE(name);
    const std::filesystem::path path = folder.path() / platform::path_of(name);
    CHECK(contains(printed_by("testmap --size 8 -o " + quoted(path)), name));
    CHECK(std::filesystem::exists(path));
    const std::string said = printed_by("info " + quoted(path));
    CHECK(contains(said, name));
    CHECK_FALSE(contains(said, "\r"));
    const std::filesystem::path converted = folder.path() / platform::path_of(std::string("2 ") + name);
    CHECK(contains(run_welkin("convert " + quoted(path) + ' ' + quoted(converted)).output, name));
    CHECK(std::filesystem::exists(converted));
    const std::filesystem::path baked = folder.path() / platform::path_of(std::string("baked ") + name);
    const CommandResult bake =
        run_welkin("bake " + quoted(path) + " --size 8 --irradiance 4 --no-brdf --no-previews -o " + quoted(baked));
    CHECK(contains(bake.output, name));
    CHECK(std::filesystem::exists(baked / "manifest.json"));
    const std::filesystem::path tables = folder.path() / platform::path_of(std::string("tables ") + name);
    CHECK(run_welkin("sky --table-size 4,16,8,4 --orders 1 --tables " + quoted(tables)).exit_code == 0);
    CHECK(std::filesystem::exists(tables));
  }
  const CommandResult missing = run_welkin("info " + quoted(folder.path() / platform::path_of("\xE5\xA4\xA9.exr")));
  CHECK(missing.exit_code != 0);
  CHECK(contains(missing.errors, "\xE5\xA4\xA9.exr: there is no such file"));
}

}  // namespace welkin::test
