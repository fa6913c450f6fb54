
#include "places.h"
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

// The command says by its exit code who is to blame, and says why on standard error alone.

TEST_CASE("command: bad usage exits with 2", "[tools]") {
  CHECK(contains(failure("", 2), "nothing to do"));
  CHECK(contains(failure("", 2), "\n  convert     Write an environment in another format"));
  CHECK(contains(failure("frobnicate", 2), "frobnicate"));
  CHECK(contains(failure("sh --frobnicate", 2), "--frobnicate"));
  CHECK(contains(failure("sh one.exr two.exr", 2), "two.exr"));
  CHECK(contains(failure("sh --bands 0", 2), "--bands"));
  CHECK(contains(failure("sh --bands 17", 2), "--bands"));
  CHECK(contains(failure("sh --bands many", 2), "--bands"));
  CHECK(contains(failure("sh --quadrature 1", 2), "--quadrature"));
  CHECK(contains(failure("sh --target-size -1", 2), "--target-size"));
  CHECK(contains(failure("sh --clamp 0", 2), "--clamp"));
  CHECK(contains(failure("sh --clamp nan", 2), "--clamp"));
  CHECK(contains(failure("sh --clamp inf", 2), "--clamp"));
  CHECK(contains(failure("sh --threads -1", 2), "--threads"));
  CHECK(contains(failure("sh --yaw nan", 2), "--yaw"));
  CHECK(contains(failure("sh --extract-sun --sun-share nan", 2), "--sun-share"));
  CHECK(contains(failure("sh --nan keep", 2), "--nan"));
  CHECK(contains(failure("sh file.exr --layout cross", 2), "--layout"));
  CHECK(contains(failure("sh file.exr --memory-limit -1", 2), "--memory-limit"));
  CHECK(contains(failure("sh file.exr --memory-limit 5XB", 2), "--memory-limit"));
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
  std::ofstream(text) << "this is no picture\n";
  CHECK(contains(failure("sh " + quoted(text), 1), "text.exr"));
  CHECK(contains(failure("info " + quoted(text), 1), "text.exr"));

  const auto odd = folder.path() / "odd.pfm";
  write_pfm(odd, 7, 5, grey_picture(7, 5, 1.0F));
  CHECK(contains(failure("sh " + quoted(odd), 1), "--layout"));
  CHECK(contains(failure("sh --layout vertical-strip " + quoted(odd), 1), "odd.pfm"));
  CHECK(run_welkin("sh --layout lat-long " + quoted(odd)).exit_code == 0);

  const auto strip = folder.path() / "strip.pfm";
  write_pfm(strip, 64, 384, grey_picture(64, 384, 1.0F));
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
