#include <nlohmann/json.hpp>

#include "places.h"
#include "support/catch.h"
#include "tools/command.h"

using namespace welkin::test;

// `welkin report`: pages and figures from the command line.

namespace {

/// Small enough for a test: one pass at the tests' scale.
const std::string kTiny = "report --scale tiny --no-peers --passes irradiance ";

}  // namespace

TEST_CASE("report: a page and figures", "[tools][report][slow]") {
  const TemporaryDirectory folder;
  const std::string base = (folder.path() / "r").string();
  const std::string said = printed_by(kTiny + "-o " + base + ".html --json " + base + ".json --csv " + base + ".csv");
  CHECK(contains(said, "Which setting to take"));
  CHECK(contains(said, base + ".html"));
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
  const TemporaryFile csv("r.csv");
  printed_by("report --scale tiny --no-peers --passes prefilter-cube --csv " + quoted(csv));
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
  printed_by(kTiny + "--json " + old);
  CHECK(contains(failure("report --quick --against " + old, 2), "--scale tiny"));
  auto elsewhere = json_of(read_text(folder.path() / "old.json"));
  elsewhere["environment"] = "a hall";
  std::ofstream(folder.path() / "elsewhere.json") << elsewhere;
  CHECK(contains(failure(kTiny + "--against " + quoted(folder.path() / "elsewhere.json"), 2), "a report on a hall"));
  const std::string again =
      printed_by(kTiny + "--threads 2 -o " + quoted(folder.path() / "new.html") + " --against " + old);
  CHECK(contains(again, "none is worse"));
  CHECK(contains(again, "threads or clocks differ"));
  CHECK(contains(read_text(folder.path() / "new.html"), "Against the older report"));

  auto figures = json_of(read_text(folder.path() / "old.json"));
  for (auto& one : figures.at("measurements")) {
    if (one.at("setting") == "2 bands") one["error_rms"] = 0.5 * one.at("error_rms").get<double>();
  }
  std::ofstream(folder.path() / "better.json") << figures;
  const std::string worse = printed_by(kTiny + "--threads 2 -o " + quoted(folder.path() / "worse.html") +
                                       " --against " + quoted(folder.path() / "better.json"));
  CHECK(contains(worse, "Larger error"));
  CHECK(contains(worse, "harmonics, 2 bands"));
  CHECK(contains(worse, "some are worse"));
}

TEST_CASE("report: what cannot be done is refused before any work", "[tools][report]") {
  const TemporaryDirectory folder;
  CHECK(contains(failure("report --scale huge", 2), "--scale"));
  CHECK(contains(failure("report --quick --scale tiny", 2), "--scale"));
  CHECK(contains(failure("report --passes nonsense", 2), "nonsense"));
  CHECK(contains(failure("report --threads -1", 2), "--threads"));
  CHECK(contains(failure("report --error-factor 2", 2), "--against"));
  CHECK(contains(failure("report --against old.json --time-factor 0.5", 2), "--time-factor"));
  CHECK(contains(failure("report --against " + quoted(folder.path() / "none.json"), 1), "none.json"));
  CHECK(contains(failure("report -o " + quoted(folder.path() / "none" / "page.html"), 1), "there is no folder"));
  CHECK(contains(failure("report -o " + quoted(folder.path()), 1), "is a directory"));
  CHECK(contains(failure("report --json -", 2), "is no file"));
  std::ofstream(folder.path() / "cut.json") << "{\"format\": \"welkin report\", \"version\": 1";
  CHECK(contains(failure("report --against " + quoted(folder.path() / "cut.json"), 1), "cut.json"));
  const std::string csv = " --csv " + quoted(folder.path() / "c");
  CHECK(contains(failure(kTiny + "--environment " + quoted(folder.path() / "none.exr") + csv, 1), "none.exr"));
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
