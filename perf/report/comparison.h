// Two reports beside each other: what has become worse.
#pragma once

#include <string>
#include <vector>

#include "perf/report/measurement.h"

namespace welkin::report {

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

}  // namespace welkin::report
