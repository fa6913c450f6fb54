#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "places.h"
#include "support/catch.h"
#include "tools/command.h"
#include "welkin/core.h"

using namespace welkin::test;
using namespace welkin;

// --help-all teaches: what the command does, examples that run, units and exit codes.

TEST_CASE("command: --help-all teaches", "[tools]") {
  for (const char* arguments : {"--help-all", "bake --help-all", "sh --help-all", "sky --help-all", "info --help-all",
                                "convert --help-all", "testmap --help-all", "sample --help-all", "report --help-all"}) {
    const CommandResult result = run_welkin(arguments);
    INFO("welkin " << arguments);
    CHECK(result.exit_code == 0);
    CHECK(result.errors.empty());
    CHECK(contains(result.output, "Usage: welkin"));
    CHECK(contains(result.output, "Examples:"));
    CHECK(contains(result.output, "Units:"));
    CHECK(contains(result.output, "Exit codes:"));
  }
}

TEST_CASE("command: --version tells version and instruction sets", "[tools]") {
  const CommandResult result = run_welkin("--version");
  CHECK(result.exit_code == 0);
  CHECK(contains(result.output, "welkin " WELKIN_VERSION_STRING));
  for (const auto set : welkin::available_instruction_sets()) CHECK(contains(result.output, welkin::name(set)));
  const std::string narrowest = welkin::name(welkin::available_instruction_sets().front());
  CHECK(contains(run_welkin("--version", "WELKIN_ISA=" + narrowest).output, "in use: " + narrowest));
}

// The command says by its exit code who is to blame, and says why on standard error alone.

namespace {

void require_failure(const std::string& arguments, int exit_code, const std::string& message_part) {
  const CommandResult result = run_welkin(arguments);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  CHECK(result.exit_code == exit_code);
  CHECK(result.output.empty());
  CHECK(result.errors.rfind("welkin: ", 0) == 0);
  CHECK(contains(result.errors, message_part));
}

}  // namespace

TEST_CASE("command: bad usage exits with 2", "[tools]") {
  require_failure("", 2, "nothing to do");
  require_failure("", 2, "\n  convert     Write an environment in another format");
  require_failure("frobnicate", 2, "frobnicate");
  require_failure("sh --frobnicate", 2, "--frobnicate");
  require_failure("sh one.exr two.exr", 2, "two.exr");
  require_failure("sh --bands 0", 2, "--bands");
  require_failure("sh --bands 17", 2, "--bands");
  require_failure("sh --bands many", 2, "--bands");
  require_failure("sh --quadrature 1", 2, "--quadrature");
  require_failure("sh --target-size -1", 2, "--target-size");
  require_failure("sh --clamp 0", 2, "--clamp");
  require_failure("sh --clamp nan", 2, "--clamp");
  require_failure("sh --clamp inf", 2, "--clamp");
  require_failure("sh --threads -1", 2, "--threads");
  require_failure("sh --nan keep", 2, "--nan");
  require_failure("sh file.exr --layout cross", 2, "--layout");
  require_failure("sh file.exr --memory-limit -1", 2, "--memory-limit");
  require_failure("sh file.exr --memory-limit 5XB", 2, "--memory-limit");
  require_failure("sh --layout lat-long", 2, "INPUT");
  require_failure("sh", 2, "--sky");
  require_failure("sh --json", 2, "INPUT");
  require_failure("sh ''", 2, "INPUT");
  require_failure("sh one.exr --sky", 2, "--sky");
  require_failure("info", 2, "FILE");
  require_failure("info --bands 3 file.exr", 2, "--bands");
}

TEST_CASE("command: a wrong number is answered with what the option takes", "[tools]") {
  for (const char* wrong : {"1.5", "nan", "1e-320", "abc", "0", "9999"}) {
    require_failure("bake city.hdr -o o --size " + std::string(wrong), 2,
                    "--size: " + std::string(wrong) + " is not a whole number from 1 to 8192");
  }
  require_failure("sh city.hdr --bands 2.5", 2, "--bands: 2.5 is not a whole number from 1 to 16");
  require_failure("bake city.hdr -o o --yaw x", 2, "--yaw: x is not a number from -1000000 to 1000000\n");
  require_failure("bake city.hdr -o o --error-budget nan", 2, "--error-budget: nan is not a number from 1e-06 to 1\n");
}

TEST_CASE("command: sizes beyond 64 bits and an empty folder of a cache are refused", "[tools]") {
  for (const char* size : {"18446744073709551616", "99999999999999999999", "99999999999999999999kB"}) {
    require_failure("sh city.hdr --memory-limit " + std::string(size), 2, "is more than the largest size");
  }
  require_failure("info city.hdr --memory-limit 18446744073709551615", 1, "city.hdr");
  require_failure("bake city.hdr -o o --cache=", 2, "--cache: ");
  require_failure("bake city.hdr -o o --cache ''", 2, "--cache: names no folder");
}

TEST_CASE("command: bad input exits with 1 and names the file", "[tools]") {
  const TemporaryFolder folder;
  const auto missing = folder.path() / "missing.exr";
  require_failure("sh " + quoted(missing), 1, "missing.exr");
  require_failure("sh --json " + quoted(missing), 1, "missing.exr");
  require_failure("info " + quoted(missing), 1, "missing.exr");
  require_failure("sh " + quoted(folder.path()), 1, folder.path().filename().string());

  const auto text = folder.path() / "text.exr";
  std::ofstream(text) << "this is no picture\n";
  require_failure("sh " + quoted(text), 1, "text.exr");
  require_failure("info " + quoted(text), 1, "text.exr");

  const auto odd = folder.path() / "odd.pfm";
  write_pfm(odd, 7, 5, grey_picture(7, 5, 1.0F));
  require_failure("sh " + quoted(odd), 1, "--layout");
  require_failure("sh --layout vertical-strip " + quoted(odd), 1, "odd.pfm");
  CHECK(run_welkin("sh --layout lat-long " + quoted(odd)).exit_code == 0);

  const auto strip = folder.path() / "strip.pfm";
  write_pfm(strip, 64, 384, grey_picture(64, 384, 1.0F));
  require_failure("sh --memory-limit 10KiB " + quoted(strip), 1, "strip.pfm");
}

TEST_CASE("command: a rejected pixel exits with 1 and is named", "[tools]") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "nan.pfm";
  std::vector<float> rgb = grey_picture(8, 4, 1.0F);
  rgb[(2 * 8 + 5) * 3 + 1] = std::numeric_limits<float>::quiet_NaN();
  rgb[(3 * 8 + 1) * 3] = -1.0F;
  write_pfm(file, 8, 4, rgb);
  require_failure("sh --nan reject " + quoted(file), 1, "row 2");
  require_failure("sh --negative reject " + quoted(file), 1, "row 3");
  CHECK(run_welkin("sh --infinity reject " + quoted(file)).exit_code == 0);
}

TEST_CASE("command: an unknown WELKIN_ISA exits with 2 and is named", "[tools]") {
  for (const char* arguments : {"sh --sky", "sh --sky --json", "--version"}) {
    const CommandResult result = run_welkin(arguments, "WELKIN_ISA=nonsense");
    INFO("welkin " << arguments << "\nstandard error: " << result.errors);
    CHECK(result.exit_code == 2);
    CHECK(result.output.empty());
    CHECK(contains(result.errors, "nonsense"));
  }
}

TEST_CASE("command: a full device exits with 1", "[tools][posix]") {
  for (const char* arguments : {"sh --sky >/dev/full", "sh --help >/dev/full", "--version >/dev/full"}) {
    const CommandResult result = run_welkin(arguments);
    CHECK(result.exit_code == 1);
    CHECK(contains(result.errors, "standard output"));
  }
}
