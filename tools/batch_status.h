// How far a batch is, by its reports.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/batch_plan.h"
#include "tools/batch_report.h"
#include "tools/json.h"

namespace welkin::tool {

/// Of some of the jobs.
struct BatchCounts {
  std::size_t done = 0;    ///< their results are there
  std::size_t failed = 0;  ///< the last time; there is no result
  std::size_t left = 0;
  double seconds_left = 0.0;  ///< of one core, for those that are left
};

struct BatchStatus {
  std::size_t jobs = 0;
  BatchCounts all;
  int shards = 0;                                ///< of the newest report; 0: there is none
  std::map<std::size_t, BatchCounts> of_shards;  ///< by their numbers from 1; those that have jobs
  std::vector<JobRecord> troubles;               ///< failed jobs and results that differed, in the order of the plan
  std::vector<std::string> notes;                ///< reports that cannot be read
};

/// A result that no report names counts as left: a run that is killed has not reported its last second. How long the
/// rest takes is predicted by the plan, corrected by how long jobs have taken.
[[nodiscard]] BatchStatus status_of(const BatchPlan& plan, const std::filesystem::path& results);

[[nodiscard]] Json status_json(const BatchStatus& status);
[[nodiscard]] std::string status_text(const BatchStatus& status);

}  // namespace welkin::tool
