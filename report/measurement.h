// What a report is made of: one setting of one method, its error and its time.
#pragma once

#include <string>
#include <vector>

namespace welkin::report {

/// One setting of one method of one pass.
struct Measurement {
  std::string pass;            ///< `Pass::id`
  std::string method;          ///< "exact", "sampled", ...
  std::string setting;         ///< "target 64", "256 taps", ...: with pass, method and peer it names the measurement
  double error_rms = 0.0;      ///< relative, 0.01 is 1 %: as `Pass::error_meaning` says
  double error_maximum = 0.0;  ///< likewise
  double seconds = 0.0;        ///< of one call, by `Machine::clock`: the least of several runs
  std::string truth;           ///< what the error is measured against
  std::string peer{};          ///< the other program's name and version; empty: Welkin itself

  friend bool operator==(const Measurement&, const Measurement&) = default;
};

/// A task that several methods can do: they share a plot, a table and a front.
struct Pass {
  std::string id;             ///< "project-cubemap"; lower case and hyphens
  std::string title;          ///< "Cubemap to harmonics"
  std::string task;           ///< what is timed, on which data
  std::string error_meaning;  ///< what rms and maximum are

  friend bool operator==(const Pass&, const Pass&) = default;
};

/// Where and when the times were taken.
struct Machine {
  std::string processor;
  std::string compiler;
  std::string instruction_set;
  std::string welkin;  ///< version
  std::string clock;   ///< "processor time" or "wall time"
  std::string date;    ///< UTC, ISO 8601
  int threads = 1;     ///< that timed calls worked with

  friend bool operator==(const Machine&, const Machine&) = default;
};

struct Report {
  Machine machine;
  std::string scale;        ///< `Scale::name`
  std::string environment;  ///< what light was measured on
  std::vector<Pass> passes;
  std::vector<Measurement> measurements;
  std::vector<std::string> notes;  ///< peers that were not there and the like

  friend bool operator==(const Report&, const Report&) = default;
};

/// The measurements of a pass, in their order.
[[nodiscard]] std::vector<Measurement> of_pass(const Report& report, const std::string& pass);

/// "exact, target 64"; of a peer with its name before it.
[[nodiscard]] std::string label(const Measurement& measurement);

}  // namespace welkin::report
