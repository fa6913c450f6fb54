// A report: settings of methods with their error and time, which of them are worth having, two reports beside each
// other, and a report as a file.
#pragma once

#include "standard_headers.h"
#include "welkin/core.h"

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
  std::string clock;   ///< "CPU time" or "wall time"
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

struct ComparisonOptions {
  double error_factor = 1.05;  ///< errors are deterministic but for other programs' last bits
  double time_factor = 1.5;    ///< times are those of a machine that may do other things too
  double least_error = 1e-6;   ///< errors below this are rounding and not compared
};

/// A setting that both reports have.
struct Change {
  Measurement before;
  Measurement after;
  double worst_ratio = 1.0;  ///< of errors, after / before: the larger of rms and maximum,
  double best_ratio = 1.0;   ///< and the smaller
  double time_ratio = 1.0;   ///< 1 where times cannot be compared
};

struct Comparison {
  /// By the options' factors, the largest first. Where rms or maximum grew it is worse, whatever the other did.
  std::vector<Change> worse_error, better_error, slower, faster;
  std::vector<Measurement> gone, added;  ///< settings of one report alone, within common passes
  std::size_t compared = 0;
  std::string times_refused;  ///< why times were not compared; empty: they were

  [[nodiscard]] bool regressed() const noexcept { return !worse_error.empty() || !slower.empty(); }
};

/// Compares what has the same pass, method, setting and peer (by its first word, so that a newer version of a peer is
/// still the same one). Errors are compared only between reports of the same scale and environment, which is demanded;
/// times only for the same processor, instruction set, clock and threads. Peers' changes do not count as regressions.
/// Throws `Error` (invalid_argument) where scales or environments differ, and for factors below 1.
[[nodiscard]] Comparison compare(const Report& before, const Report& after, const ComparisonOptions& options = {});

/// For a terminal: a line a change, and a sum of them.
[[nodiscard]] std::string to_text(const Comparison& comparison);

/// {"format": "welkin report", "version": 1, "machine", "scale", "environment", "notes", "passes", "measurements":
/// [{pass, method, setting, error_rms, error_maximum, seconds, truth, peer, on_front}], "recommendations": [{pass,
/// target, method, setting} (null, null where none reaches it)]}. One line a measurement. A NaN is
/// null.
[[nodiscard]] std::string to_json(const Report& report);

/// Reads what `to_json` wrote; fronts and recommendations are not read, they follow from the rest. `name` is what
/// messages call it. Throws `Error`: corrupt_file (no JSON, or a member that is missing or of another type, named),
/// unsupported_file (another format or version).
[[nodiscard]] Report from_json(const std::string& text, const std::string& name);

/// Reads a file. Throws as `from_json`, and file_access; limit_exceeded for a file above 64 MiB.
[[nodiscard]] Report read_report(const std::filesystem::path& path);

/// pass,method,setting,peer,error_rms,error_maximum,seconds,on_front,truth: a header line, then a line a measurement
/// (RFC 4180).
[[nodiscard]] std::string to_csv(const Report& report);

/// One HTML file that needs nothing else: plots as inline SVG, tables, style and script inside, nothing from a network
/// or another file. Without script it is complete but for the highlighting; printed, it is all there.
[[nodiscard]] std::string to_html(const Report& report, const std::optional<Comparison>& comparison = std::nullopt);

struct ReportOptions {
  std::string scale = "full";            ///< `scale_names()`
  std::vector<std::string> passes{};     ///< beginnings of the ids of those that are measured; empty: all
  int threads = 1;                       ///< of timed calls; 0: all that the process may use
  std::filesystem::path environment{};   ///< a file; empty: the built-in test light
  std::filesystem::path node_modules{};  ///< for Babylon.js and three.js; empty: without
  std::filesystem::path program{};  ///< welkin-report, by whose processes first calls are measured; empty: none are
  bool peers = true;
  std::function<void(const std::string& pass)> begins{};  ///< called with the id of each pass before it is measured
  double budget_seconds = -1.0;  ///< of repeats, a measurement; below 0: the scale's; 0: one run, for errors alone
};

/// The ids that `passes` can name.
[[nodiscard]] std::vector<std::string> pass_ids();

/// Of the light that it would measure on. Throws `Error` as `run_report`.
[[nodiscard]] std::string environment_name(const ReportOptions& options);

/// Measures. Truths are worked out in the caller's arena; timed calls have arenas of their own. Errors are
/// the same on every run; times are not. Throws `Error`: invalid_argument (scale, a beginning that no pass has,
/// threads), cancelled, what reading the environment throws.
[[nodiscard]] Report run_report(const ReportOptions& options, const Control& control = {});

}  // namespace welkin::report
