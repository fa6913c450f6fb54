// Carries out a shard of a batch: what is not there is baked, many at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/batch_plan.h"
#include "tools/batch_report.h"

namespace welkin::tool {

struct BatchRun {
  std::filesystem::path results;
  Shard shard;
  int threads = 1;
  std::uint64_t memory = 0;  ///< that bakes may hold at a time, by prediction
  double verify = 0.0;       ///< the share of results that is computed once more
};

/// What came of it. A job counts once, but one that is verified is present, too.
struct BatchOutcome {
  std::size_t jobs = 0;
  std::size_t computed = 0;
  std::size_t present = 0;
  std::size_t failed = 0;
  std::size_t verified = 0;
  std::size_t differs = 0;
  double seconds = 0.0;
  std::filesystem::path report;
  std::vector<JobRecord> troubles;  ///< failed and different ones, in the order of the plan

  [[nodiscard]] bool well() const noexcept { return failed == 0 && differs == 0; }
};

/// Runs it, with progress on a terminal. Throws `Error`: cancelled after a signal (no partial result is left, and the
/// report is written), file_access if results or report cannot be written.
[[nodiscard]] BatchOutcome run_batch(const BatchPlan& plan, const BatchRun& run);

}  // namespace welkin::tool
