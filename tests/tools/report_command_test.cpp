#include <nlohmann/json.hpp>

#include "places.h"
#include "support/catch.h"
#include "tools/command.h"

using namespace welkin::test;

// `welkin report`: pages and figures from the command line.

namespace {

/// Small enough for a test: one pass at the tests' scale.
const std::string kTiny = "report --scale tiny --no-peers --passes irradiance ";

CommandResult run_well(const std::string& arguments) {
  CommandResult result = run_welkin(arguments);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  REQUIRE(result.exit_code == 0);
  CHECK(result.errors.empty());
  return result;
}

void require_refused(const std::string& arguments, int exit_code, const std::string& part) {
  const CommandResult result = run_welkin(arguments);
  INFO("welkin " << arguments << "\nstandard error: " << result.errors);
  CHECK(result.exit_code == exit_code);
  CHECK(result.output.empty());
  CHECK(contains(result.errors, part));
}

}  // namespace

TEST_CASE("report: a page and figures", "[tools][report][slow]") {
  const TemporaryDirectory folder;
  const std::string base = (folder.path() / "r").string();
  const CommandResult result = run_well(kTiny + "-o " + base + ".html --json " + base + ".json --csv " + base + ".csv");
  CHECK(contains(result.output, "Which setting to take"));
  CHECK(contains(result.output, base + ".html"));
  CHECK(contains(read_text(base + ".html"), "<!DOCTYPE html>"));
  CHECK(contains(read_text(base + ".html"), "Irradiance by bands"));
  CHECK(contains(read_text(base + ".csv"), "irradiance,harmonics,3 bands,,"));
  const auto figures = json_of(read_text(base + ".json"));
  CHECK(figures.at("format") == "welkin report");
  CHECK(figures.at("machine").at("threads") == 1);
  REQUIRE(figures.at("measurements").size() > 5);
  for (const auto& one : figures.at("measurements")) {
    CHECK(one.at("pass") == "irradiance");
    CHECK(one.at("seconds") > 0.0);
    CHECK(one.at("error_rms") > 0.0);
  }
}

TEST_CASE("report: reflections from the integral to the loosest bound, in first calls too", "[tools][report][slow]") {
  const TemporaryDirectory folder;
  const std::filesystem::path csv = folder.path() / "r.csv";
  run_well("report --scale tiny --no-peers --passes prefilter-cube --csv " + quoted(csv));
  const std::string figures = read_text(csv);
  for (const char* setting : {"bound 3 %", "bound 0.1 %", "bound 0.01 %"}) {
    CHECK(contains(figures, std::string("prefilter-cube,automatic,") + setting + ",,"));
    CHECK(contains(figures, std::string("prefilter-cube,automatic,") + setting + ",first call of a process,"));
  }
  CHECK(contains(figures, "prefilter-cube,the integral in double,reference,,"));
}

TEST_CASE("report: two reports have the same errors, and are compared", "[tools][report][slow]") {
  const TemporaryDirectory folder;
  const std::string old = quoted(folder.path() / "old.json");
  run_well(kTiny + "--json " + old);
  require_refused("report --quick --against " + old, 2, "--scale tiny");
  auto elsewhere = json_of(read_text(folder.path() / "old.json"));
  elsewhere["environment"] = "a hall";
  std::ofstream(folder.path() / "elsewhere.json") << elsewhere;
  require_refused(kTiny + "--against " + quoted(folder.path() / "elsewhere.json"), 2, "a report on a hall");
  const CommandResult again =
      run_well(kTiny + "--threads 2 -o " + quoted(folder.path() / "new.html") + " --against " + old);
  CHECK(contains(again.output, "none is worse"));
  CHECK(contains(again.output, "threads or clocks differ"));
  CHECK(contains(read_text(folder.path() / "new.html"), "Against the older report"));

  auto figures = json_of(read_text(folder.path() / "old.json"));
  for (auto& one : figures.at("measurements")) {
    if (one.at("setting") == "2 bands") one["error_rms"] = 0.5 * one.at("error_rms").get<double>();
  }
  std::ofstream(folder.path() / "better.json") << figures;
  const CommandResult worse = run_well(kTiny + "--threads 2 -o " + quoted(folder.path() / "worse.html") +
                                       " --against " + quoted(folder.path() / "better.json"));
  CHECK(contains(worse.output, "Larger error"));
  CHECK(contains(worse.output, "harmonics, 2 bands"));
  CHECK(contains(worse.output, "some are worse"));
}

TEST_CASE("report: what cannot be done is refused before any work", "[tools][report]") {
  const TemporaryDirectory folder;
  require_refused("report --scale huge", 2, "--scale");
  require_refused("report --quick --scale tiny", 2, "--scale");
  require_refused("report --passes nonsense", 2, "nonsense");
  require_refused("report --threads -1", 2, "--threads");
  require_refused("report --error-factor 2", 2, "--against");
  require_refused("report --against old.json --time-factor 0.5", 2, "--time-factor");
  require_refused("report --against " + quoted(folder.path() / "none.json"), 1, "none.json");
  require_refused("report -o " + quoted(folder.path() / "none" / "page.html"), 1, "there is no folder");
  require_refused("report -o " + quoted(folder.path()), 1, "is a directory");
  require_refused("report --json -", 2, "is no file");
  std::ofstream(folder.path() / "cut.json") << "{\"format\": \"welkin report\", \"version\": 1";
  require_refused("report --against " + quoted(folder.path() / "cut.json"), 1, "cut.json");
  require_refused(
      kTiny + "--environment " + quoted(folder.path() / "none.exr") + " --csv " + quoted(folder.path() / "c"), 1,
      "none.exr");
}

TEST_CASE("The report's program is found beside the command, then on the PATH; without it the command says so",
          "[command][report]") {
  const TemporaryDirectory folder;
  const std::filesystem::path built = WELKIN_COMMAND;
  const std::filesystem::path copy = folder.path() / "welkin";
  std::filesystem::copy_file(built, copy);
  const CommandResult alone = run_program(copy, "report --quick", "PATH=/nowhere");
  CHECK(alone.exit_code == 1);
  CHECK(alone.output.empty());
  CHECK(contains(alone.errors, "welkin: welkin-report: cannot be run"));
  CHECK(contains(alone.errors, folder.path().string()));

  const CommandResult on_path = run_program(copy, "report --help", "PATH=" + quoted(built.parent_path()));
  CHECK(on_path.exit_code == 0);
  const CommandResult beside = run_program(built, "report --help", "PATH=/nowhere");
  CHECK(beside.exit_code == 0);
  CHECK(contains(beside.output, "Usage: welkin report [OPTIONS]"));
  CHECK(beside.output == on_path.output);
}
