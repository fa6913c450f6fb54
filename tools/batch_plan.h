// A batch's plan, jobs.json: what is to be baked, with which options, at what cost; and how it is cut into shards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/bake_options.h"

namespace welkin::tool {

/// One input and what is to be made of it.
struct BatchJob {
  std::string name;                  ///< no other job has it
  std::string input;                 ///< relative to the folder of the jobs file, where that is possible
  std::vector<std::string> options;  ///< of `welkin bake`; files that they name are relative as the input is
  double seconds = 0.0;              ///< predicted, on one core
  std::uint64_t size = 0;            ///< of the input's file, in bytes
  std::uint64_t memory = 0;          ///< predicted, in bytes: the most that its bake holds
  std::string error;                 ///< why its input could not be looked at when this was planned; empty: it could
};

struct BatchPlan {
  std::filesystem::path file;    ///< of the plan; where that is a link, what it leads to
  std::filesystem::path folder;  ///< in which the file is, without links: what paths in the plan are relative to
  std::vector<BatchJob> jobs;

  [[nodiscard]] double seconds() const noexcept;
  /// Where a path that stands in the plan leads to.
  [[nodiscard]] std::filesystem::path place(const std::string& path) const;
  /// Where results go if nobody says otherwise: beside the plan, by its name with ".results".
  [[nodiscard]] std::filesystem::path default_results() const;
};

/// What is to be planned.
struct BatchRequest {
  std::vector<std::string> inputs;   ///< files, folders and patterns (*, ?, **)
  std::optional<std::string> list;   ///< a file of JSON lines; its inputs may be on other machines alone
  std::vector<std::string> options;  ///< of all jobs; those of their lines replace them
};

/// Looks at every input's header. An input that cannot be read is a job with an error, unless it stands in `inputs` and
/// is not there or is no picture. Throws `Error`: file_access for that, and if `file` is there and no plan, or cannot
/// be; invalid_argument for options that `welkin bake` would refuse, for a pattern without a match and if there is
/// nothing to do; what reading the list does (`for_each_line`).
[[nodiscard]] BatchPlan plan_batch(const BatchRequest& request, const std::filesystem::path& file);

void write_batch_plan(const BatchPlan& plan);

/// Throws `Error`: file_access, limit_exceeded; corrupt_file for what is no plan of this version.
[[nodiscard]] BatchPlan read_batch_plan(const std::filesystem::path& file);

/// Returns for each job a file name that no other job has: the job's own, with _ in place of what separates folders. It
/// follows from the plan alone.
[[nodiscard]] std::vector<std::string> file_names_of(const BatchPlan& plan);

/// The options of one job as `welkin bake` reads them; files that they name are looked for in `plan`'s folder.
/// `settle_files` has been called. Throws `Error` (invalid_argument), and file_access for such a file that is no
/// regular one: a batch reads it more than once.
[[nodiscard]] BakeCommandOptions bake_options_of(const BatchPlan& plan, const std::vector<std::string>& words);

/// The jobs of each shard, costliest first. Costliest first, every job goes to the shard that has least to do by then;
/// of several to the one with the fewest jobs, and of those to the first. It follows from the plan alone.
[[nodiscard]] std::vector<std::vector<std::size_t>> cut_batch(const BatchPlan& plan, int shards);

}  // namespace welkin::tool
