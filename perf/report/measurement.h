// What a report is made of: one setting of one method, its error and its time; and which settings are worth having.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace welkin::report {

/// One setting of one method of one pass.
struct Measurement {
  std::string pass;            ///< `Pass::id`
  std::string method;          ///< "exact", "spectral", ...
  std::string setting;         ///< "target 64", "256 samples", ...: with pass, method and peer it names the measurement
  double error_rms = 0.0;      ///< relative, 0.01 is 1 %: as `Pass::error_meaning` says
  double error_maximum = 0.0;  ///< likewise
  double seconds = 0.0;        ///< of one call, by `Machine::clock`: the least of several runs
  std::string truth;           ///< what the error is measured against
  std::string peer{};  ///< the other program's name and version, another method's code, or "first call of a process";
                       ///< empty: Welkin, warm

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

/// Errors that a setting is recommended for.
inline constexpr double kErrorTargets[] = {0.001, 0.005, 0.01, 0.05};

/// Indices of the measurements on the Pareto front of rms error and time, by rising time. Of equal ones the first is on
/// it. Peers are left out: the front is of what can be chosen here. Errors or times that are no numbers are never on
/// it.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Measurement> measurements);

/// Index of the setting to take for an rms error of at most `target`: the fastest, but of those within `tolerance` of
/// the fastest's time, which noise cannot tell apart, the most exact one; it is on the front. None if no setting of
/// Welkin's reaches the target.
[[nodiscard]] std::optional<std::size_t> recommend(std::span<const Measurement> measurements, double target,
                                                   double tolerance = 0.05);

struct Recommendation {
  std::string pass;
  double target = 0.0;  ///< rms error
  std::optional<Measurement> setting;
};

/// For each pass and each of `kErrorTargets`.
[[nodiscard]] std::vector<Recommendation> recommendations(const Report& report);

}  // namespace welkin::report
