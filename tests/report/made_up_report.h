// A small report whose figures are chosen, not measured.
#pragma once

#include "perf/report/report.h"

namespace welkin::test {

inline report::Measurement point(const std::string& setting, double error, double seconds, const std::string& peer = "",
                                 const std::string& pass = "one") {
  return {pass, "method", setting, error, 3.0 * error, seconds, "the truth", peer};
}

inline report::Report made_up_report() {
  report::Report report;
  report.machine = {"a processor", "a compiler", "avx2", "0.1.0", "CPU time", "2026-11-22T00:00:00Z", 1};
  report.scale = "quick";
  report.environment = "a light";
  report.passes = {{"one", "The first", "What is done.", "What rms is."}, {"two", "The second", "Else.", "Else."}};
  report.measurements = {point("coarse", 2e-2, 1e-6), point("fine", 5e-4, 1e-4), point("bad", 3e-2, 1e-3),
                         point("theirs", 1e-5, 1e-7, "Another 1.2"), point("only", 4e-3, 2.0, "", "two")};
  report.notes = {"A note."};
  return report;
}

}  // namespace welkin::test
