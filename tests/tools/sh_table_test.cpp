// `welkin sh` without --json: a table that says what its numbers are.
#include <algorithm>
#include <sstream>
#include <string>

#include "support/catch.h"
#include "tools/command.h"

using namespace welkin::test;

TEST_CASE("sh: the table says source, convention, terms and diagnostics", "[tools]") {
  const CommandResult result = run_welkin("sh");
  CHECK(result.exit_code == 0);
  CHECK(result.errors.empty());
  for (const char* part : {"built-in sky: 1024 x 512 lat-long", "without Condon-Shortley phase", "3zz - 1", "xx - yy",
                           "radiance r, g, b", "irradiance r, g, b", "Babylon.js", "Average colour", "524,288 texels",
                           "no pixel value had to be replaced", "no clamp was asked for", "relative error"}) {
    INFO(part);
    CHECK(contains(result.output, part));
  }
}

TEST_CASE("sh: one row a coefficient", "[tools]") {
  for (const int bands : {1, 4, 6}) {
    std::istringstream lines(run_welkin("sh --bands " + std::to_string(bands)).output);
    int rows = 0;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      int l = 0;
      int m = 0;
      if (words >> l >> m) ++rows;
    }
    CHECK(rows == bands * bands);
  }
}

TEST_CASE("sh: the table tells what a clamp took away", "[tools]") {
  CHECK(contains(run_welkin("sh --clamp 1.5").output, "% of the light"));
  CHECK(contains(run_welkin("sh --clamp 1e9").output, "changed no texel"));
}

TEST_CASE("sh: nothing but results without a terminal", "[tools]") {
  const CommandResult result = run_welkin("sh --bands 16");
  CHECK(result.errors.empty());
  const bool printable = std::all_of(result.output.begin(), result.output.end(),
                                     [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
  CHECK(printable);
}
