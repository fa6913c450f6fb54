
#include "places.h"
#include "platform/text.h"
#include "support/catch.h"
#include "tools/command.h"
#include "welkin/core.h"

using namespace welkin::test;
using namespace welkin;

TEST_CASE("command: --version tells version and instruction sets", "[tools]") {
  const CommandResult result = run_welkin("--version");
  CHECK(result.exit_code == 0);
  CHECK(contains(result.output, "welkin " WELKIN_VERSION_STRING));
  for (const auto set : welkin::available_instruction_sets()) CHECK(contains(result.output, welkin::name(set)));
  const std::string narrowest = welkin::name(welkin::available_instruction_sets().front());
  CHECK(contains(run_welkin("--version", "WELKIN_ISA=" + narrowest).output, "in use: " + narrowest));
}

// The exit code states the kind of error; the reason is printed on standard error only.

TEST_CASE("command: bad usage exits with 2", "[tools]") {
  CHECK(contains(failure("", 2), "nothing to do"));
  CHECK(contains(failure("", 2), "\n  convert     Write an environment in another format"));
  CHECK(contains(failure("frobnicate", 2), "frobnicate"));
  CHECK(contains(failure("sh --frobnicate", 2), "--frobnicate"));
  CHECK(contains(failure("sh one.exr two.exr", 2), "two.exr"));
  check_refused("sh", {{"--bands", {"0", "17", "many"}},
                       {"--quadrature", {"1"}},
                       {"--target-size", {"-1"}},
                       {"--clamp", {"0", "nan", "inf"}},
                       {"--threads", {"-1"}},
                       {"--yaw", {"nan"}},
                       {"--nan", {"keep"}}});
  check_refused("sh --extract-sun", {{"--sun-share", {"nan"}}});
  check_refused("sh file.exr", {{"--layout", {"cross"}}, {"--memory-limit", {"-1", "5XB"}}});
  CHECK(contains(failure("sh --layout lat-long", 2), "INPUT"));
  CHECK(contains(failure("sh", 2), "--sky"));
  CHECK(contains(failure("sh --json", 2), "INPUT"));
  CHECK(contains(failure("sh ''", 2), "INPUT"));
  CHECK(contains(failure("sh one.exr --sky", 2), "--sky"));
  CHECK(contains(failure("info", 2), "FILE"));
  CHECK(contains(failure("info --bands 3 file.exr", 2), "--bands"));
}

TEST_CASE("command: bad input exits with 1 and names the file", "[tools]") {
  const TemporaryDirectory folder;
  const auto missing = folder.path() / "missing.exr";
  CHECK(contains(failure("sh " + quoted(missing), 1), "missing.exr"));
  CHECK(contains(failure("sh --json " + quoted(missing), 1), "missing.exr"));
  CHECK(contains(failure("info " + quoted(missing), 1), "missing.exr"));
  CHECK(contains(failure("sh " + quoted(folder.path()), 1), folder.path().filename().string()));

  const auto text = folder.path() / "text.exr";
  std::ofstream(text) << "this is no image\n";
  CHECK(contains(failure("sh " + quoted(text), 1), "text.exr"));
  CHECK(contains(failure("info " + quoted(text), 1), "text.exr"));

  const auto odd = folder.path() / "odd.pfm";
  write_pfm(odd, 7, 5, grey_image(7, 5, 1.0F));
  CHECK(contains(failure("sh " + quoted(odd), 1), "--layout"));
  CHECK(contains(failure("sh --layout vertical-strip " + quoted(odd), 1), "odd.pfm"));
  CHECK(run_welkin("sh --layout lat-long " + quoted(odd)).exit_code == 0);

  const auto strip = folder.path() / "strip.pfm";
  write_pfm(strip, 64, 384, grey_image(64, 384, 1.0F));
  CHECK(contains(failure("sh --memory-limit 10KiB " + quoted(strip), 1), "strip.pfm"));
}

TEST_CASE("command: an unknown WELKIN_ISA exits with 2 and is named", "[tools]") {
  for (const char* arguments : {"sh --sky", "sh --sky --json", "--version", "completion bash"}) {
    CHECK(contains(failure(arguments, 2, "WELKIN_ISA=nonsense"), "nonsense"));
  }
}

TEST_CASE("command: a full device exits with 1", "[tools][posix]") {
  for (const char* arguments : {"sh --sky >/dev/full", "sh --help >/dev/full", "--version >/dev/full"}) {
    const CommandResult result = run_welkin(arguments);
    CHECK(result.exit_code == 1);
    CHECK(contains(result.errors, "standard output"));
  }
}

// The command takes and names files by any characters and of any length, and its output is UTF-8 with the same bytes on
// every system.

TEST_CASE("command: files whose names have characters of any language are written, read and named", "[command][slow]") {
  const TemporaryDirectory folder;
  // Characters of two, three and four bytes in UTF-8; those of four bytes are pairs in UTF-16.
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
