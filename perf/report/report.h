// A report: settings of methods with their error and time, recommended settings, comparison with another report, and
// files.
#pragma once

#include "standard_headers.h"
#include "welkin/core.h"

namespace welkin::report {

/// One setting of one method of one pass.
struct Measurement {
  std::string pass;            ///< `Pass::id`
  std::string method;          ///< "exact", "spectral", ...
  std::string setting;         ///< "target 64", "256 samples", ...: unique within pass, method and peer
  double error_rms = 0.0;      ///< relative, 0.01 is 1 %: described by `Pass::error_meaning`
  double error_maximum = 0.0;  ///< relative
  double seconds = 0.0;        ///< of one call, by `Machine::clock`: the minimum of several runs
  std::string truth;           ///< the reference of the error
  std::string peer{};  ///< the other program's name and version, another method's code, or "first call of a process";
                       ///< empty: Welkin, warm

  friend bool operator==(const Measurement&, const Measurement&) = default;
};

/// A task of several methods, which share a plot, a table and a front.
struct Pass {
  std::string id;             ///< "project-cubemap"; lower case and hyphens
  std::string title;          ///< "Cubemap to harmonics"
  std::string task;           ///< the timed work, and its data
  std::string error_meaning;  ///< the meaning of rms and maximum

  friend bool operator==(const Pass&, const Pass&) = default;
};

/// The machine and the date of the times.
struct Machine {
  std::string processor;
  std::string compiler;
  std::string instruction_set;
  std::string welkin;  ///< version
  std::string clock;   ///< "CPU time" or "wall time"
  std::string date;    ///< UTC, ISO 8601
  int threads = 1;     ///< used by timed calls

  friend bool operator==(const Machine&, const Machine&) = default;
};

struct Report {
  Machine machine;
  std::string scale;        ///< `Scale::name`
  std::string environment;  ///< the light of the measurements
  std::vector<Pass> passes;
  std::vector<Measurement> measurements;
  std::vector<std::string> notes;  ///< missing peers and the like

  friend bool operator==(const Report&, const Report&) = default;
};

/// Returns the measurements of a pass, in their order.
[[nodiscard]] std::vector<Measurement> of_pass(const Report& report, const std::string& pass);

/// Returns "exact, target 64"; for a peer with its name in front.
[[nodiscard]] std::string label(const Measurement& measurement);

/// Errors for which a setting is recommended.
inline constexpr double kErrorTargets[] = {0.001, 0.005, 0.01, 0.05};

/// Returns the indices of the measurements on the Pareto front of rms error and time, by increasing time. Of equal ones
/// the first is on it. Peers are left out: the front is of Welkin's settings. NaN errors or times are never on it.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Measurement> measurements);

/// Returns the index of the setting for an rms error of at most `target`: the fastest, but of those within `tolerance`
/// of its time, which noise cannot distinguish, the most exact one; it is on the front. None if no setting of Welkin's
/// reaches the target.
[[nodiscard]] std::optional<std::size_t> recommend(std::span<const Measurement> measurements, double target,
                                                   double tolerance = 0.05);

struct Recommendation {
  std::string pass;
  double target = 0.0;  ///< rms error
  std::optional<Measurement> setting;
};

/// Returns a recommendation for each pass and each of `kErrorTargets`.
[[nodiscard]] std::vector<Recommendation> recommendations(const Report& report);

struct ComparisonOptions {
  double error_factor = 1.05;  ///< errors are deterministic except for other programs' last bits
  double time_factor = 1.5;    ///< for times on a machine with other load
  double least_error = 1e-6;   ///< errors below this are rounding and are not compared
};

/// A setting that both reports have.
struct Change {
  Measurement before;
  Measurement after;
  double worst_ratio = 1.0;  ///< of errors, after / before: the larger of rms and maximum
  double best_ratio = 1.0;   ///< and the smaller
  double time_ratio = 1.0;   ///< 1 where times cannot be compared
};

struct Comparison {
  /// By the options' factors, the largest first. An increase of rms or maximum makes it worse, whatever the other did.
  std::vector<Change> worse_error, better_error, slower, faster;
  std::vector<Measurement> gone, added;  ///< settings of only one report, within common passes
  std::size_t compared = 0;
  std::string times_refused;  ///< the reason for not comparing times; empty: compared

  [[nodiscard]] bool regressed() const noexcept { return !worse_error.empty() || !slower.empty(); }
};

/// Compares measurements with the same pass, method, setting and peer (by its first word, so that a newer version of a
/// peer still matches). Errors are compared only between reports of the same scale and environment, which is required;
/// times only for the same processor, instruction set, clock and threads. Peers' changes do not count as regressions.
/// Throws `Error` (invalid_argument) if scales or environments differ, and for factors below 1.
[[nodiscard]] Comparison compare(const Report& before, const Report& after, const ComparisonOptions& options = {});

/// Returns text for a terminal: one line per change, and a sum of them.
[[nodiscard]] std::string to_text(const Comparison& comparison);

/// Returns {"format": "welkin report", "version": 1, "machine", "scale", "environment", "notes", "passes",
/// "measurements": [{pass, method, setting, error_rms, error_maximum, seconds, `truth`, peer, on_front}],
/// "recommendations": [{pass, target, method, setting} (null, null where none reaches it)]}. One line per measurement.
/// A NaN is null.
[[nodiscard]] std::string to_json(const Report& report);

/// Reads the text of `to_json`; fronts and recommendations are recomputed, not read. `name`: of the text in messages.
/// Throws `Error`: corrupt_file (no JSON, or a member that is missing or of another type, named), unsupported_file
/// (another format or version).
[[nodiscard]] Report from_json(const std::string& text, const std::string& name);

/// Reads a file. Throws the errors of `from_json`, and file_access; limit_exceeded for a file above 64 MiB.
[[nodiscard]] Report read_report(const std::filesystem::path& path);

/// Returns `pass,method,setting,peer,error_rms,error_maximum,seconds,on_front,truth`: a header line, then one line per
/// measurement (RFC 4180).
[[nodiscard]] std::string to_csv(const Report& report);

/// Returns one self-contained HTML file: plots as inline SVG, tables, style and script inside, nothing from a network
/// or another file. Without script it is complete except for the highlighting; printing includes everything.
[[nodiscard]] std::string to_html(const Report& report, const std::optional<Comparison>& comparison = std::nullopt);

struct ReportOptions {
  std::string scale = "full";            ///< `scale_names()`
  std::vector<std::string> passes{};     ///< prefixes of the ids to measure; empty: all
  int threads = 1;                       ///< of timed calls; 0: all that the process may use
  std::filesystem::path environment{};   ///< a file; empty: the built-in test light
  std::filesystem::path node_modules{};  ///< for Babylon.js and three.js; empty: without them
  std::filesystem::path program{};  ///< welkin-report, whose processes measure first calls; empty: none are measured
  bool peers = true;
  std::function<void(const std::string& pass)> begins{};  ///< called with the id of each pass before its measurement
  double budget_seconds = -1.0;  ///< for repeats of a measurement; below 0: the scale's; 0: one run, for errors alone
};

/// Returns the ids that `passes` can name.
[[nodiscard]] std::vector<std::string> pass_ids();

/// Returns the name of the light that it would measure on. Throws the errors of `run_report`.
[[nodiscard]] std::string environment_name(const ReportOptions& options);

/// Measures a report. References are computed in the caller's arena; timed calls have their own arenas. Errors are the
/// same on every run; times are not. Throws `Error`: invalid_argument (scale, a prefix of no pass, threads), cancelled,
/// and the errors of reading the environment.
[[nodiscard]] Report run_report(const ReportOptions& options, const Control& control = {});

}  // namespace welkin::report
