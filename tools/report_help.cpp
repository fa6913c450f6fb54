#include "tools/help_text.h"

namespace welkin::tool {

constexpr std::string_view kReportFooter =
    R"(What it does:
  Measures error and time of every method and setting of every pass on this
  machine, on a built-in light (or --environment), and writes one page with plots and
  tables: error over time, the Pareto front, and which setting to take for an
  error of 0.1, 0.5, 1 or 5 %. The page needs no network and prints well. Errors are
  against the truth in double precision, and the same on every run; times are the
  least of several calls.

  Peers stand on the same axes where the machine has them: Filament's cmgen
  (Debian: libfilament-tools) as a process on a file, its start, reading and
  writing included; Babylon.js and three.js in Node.js (--node-modules), called
  with their data in memory. None is needed.

Examples:
  welkin report                               report.html, minutes
  welkin report --quick -o quick.html         under a minute on two cores
  welkin report --quick --json new.json --against old.json
  welkin report --passes prefilter,brdf --csv figures.csv
  welkin report --environment city.hdr --plots plots
  welkin report --stability                   extreme cases against their promises
  welkin report --calibrate -o costs.json     for welkin bake --costs costs.json
  welkin report --node-modules build/release/tests/engine

Units: errors are relative, 0.01 is 1 %; what rms and maximum are stands below
  each table. Times are seconds in JSON and CSV.

Exit codes: 0 done, regressions or not; 1 a file is bad; 2 the command line is.)";

}  // namespace welkin::tool
