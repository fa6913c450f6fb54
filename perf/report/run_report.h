// From options to a report.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "perf/report/measurement.h"
#include "welkin/core.h"

namespace welkin::report {

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
