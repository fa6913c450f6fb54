// `welkin batch`: its plan (jobs.json), the folder of results, and what is made of them. docs/guides/farm.md has the
// files' formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/bake_options.h"
#include "tools/json.h"
#include "welkin/core.h"
#include "welkin/result_cache.h"

namespace welkin::tool {

// ---- The plan

/// One input and what is to be made of it.
struct BatchJob {
  std::string name{};                  ///< no other job has it
  std::string input{};                 ///< relative to the folder of the plan, where that is possible
  std::vector<std::string> options{};  ///< of `welkin bake`; files that they name are relative as the input is
  double seconds = 0.0;                ///< predicted, on one core
  std::uint64_t size = 0;              ///< of the input's file, in bytes
  std::uint64_t memory = 0;            ///< predicted, in bytes: the most that its bake holds
  std::string error{};                 ///< why its input could not be read when this was planned; empty: it could
};

struct BatchPlan {
  std::filesystem::path file;    ///< of the plan; where that is a link, its target
  std::filesystem::path folder;  ///< in which the file is, without links: paths in the plan are relative to it
  std::vector<BatchJob> jobs;

  [[nodiscard]] double seconds() const noexcept;
  /// Returns the default folder of results: beside the plan, by its name with ".results".
  [[nodiscard]] std::filesystem::path default_results() const;
};

struct BatchRequest {
  std::vector<std::string> inputs;  ///< files, folders and patterns (*, ?, **)
  std::optional<std::string> list;  ///< a file of JSON lines; its inputs may be on other machines alone
  GivenOptions options;             ///< of all jobs; those of their lines replace them
};

/// Whether the name has the ending of a file that Welkin reads as an environment.
[[nodiscard]] bool is_image_name(const std::filesystem::path& path);

/// Whether the text has one of the signs of a pattern.
[[nodiscard]] bool is_pattern(const std::string& text) noexcept;

/// Returns the options of `welkin bake` that say what comes out. `bake` must outlive them.
[[nodiscard]] Options job_options(BakeCommandOptions& bake);

/// Reads every input's header. An input that cannot be read is a job with an error, unless it stands in `inputs` and is
/// not there or is no image. Throws `Error`: file_access for that, and if `file` is there and no plan, or cannot be;
/// invalid_argument for options that `welkin bake` would refuse, for a pattern without a match and if there is nothing
/// to do; what reading the list does (`for_each_line`).
[[nodiscard]] BatchPlan plan_batch(const BatchRequest& request, const std::filesystem::path& file);

void write_batch_plan(const BatchPlan& plan);

/// Throws `Error`: file_access, limit_exceeded; corrupt_file for what is no plan of this version.
[[nodiscard]] BatchPlan read_batch_plan(const std::filesystem::path& file);

/// Returns what `welkin bake` would have to do for a job. Throws `Error`: invalid_argument; file_access for a file of
/// its options that is no regular one, because a batch reads it more than once.
[[nodiscard]] BakeCommandOptions bake_options_of(const BatchPlan& plan, const BatchJob& job);

/// The part `number` (from 1) of `count`.
struct Shard {
  int number = 1;
  int count = 1;
};
inline constexpr int kMaxShards = 1'000'000;

/// Returns the jobs of each shard, costliest first. In the order of cost every job goes to the shard that has least to
/// do by then; of several to the one with the fewest jobs, and of those to the first. It follows from the plan alone.
[[nodiscard]] std::vector<std::vector<std::size_t>> cut_batch(const BatchPlan& plan, int shards);

// ---- Results: each a folder of what `welkin bake` writes, and result.json; whole or absent

struct ResultFile {
  std::string name;
  std::uint64_t bytes = 0;
  ContentHash hash;

  friend bool operator==(const ResultFile&, const ResultFile&) = default;
};
/// Of a result; in the order of their names.
using ResultFiles = std::vector<ResultFile>;

enum class JobState {
  computed,
  present,   ///< its result was there
  failed,    ///< there is no result, and why is said
  verified,  ///< computed once more: the files have the hashes that are listed
  differs    ///< or others
};
[[nodiscard]] const char* name(JobState state) noexcept;

/// What result.json says.
struct JobResult {
  JobState state = JobState::failed;  ///< computed, failed or differs
  ContentHash key;                    ///< `bake_key`
  ResultFiles files;                  ///< of one that is not failed
  std::string error_code;             ///< of one that is
  std::string error;
  double seconds = 0.0;  ///< that it took
  int threads = 1;       ///< that it had
  std::string host;
  double start = 0.0;  ///< in seconds since 1970, by the clock of the host
};

/// Returns the hash of input and options as the plan has them, by which the folder of a job's result is named.
[[nodiscard]] ContentHash hash_of(const BatchJob& job);

/// Returns nothing if there is no sound result.json.
[[nodiscard]] std::optional<JobResult> read_result(const std::filesystem::path& folder);

/// Returns whether a result is there for the folder's job: one that did not fail or differ, with all of its files in
/// their sizes. Their bytes are not read.
[[nodiscard]] bool is_done(const std::filesystem::path& folder, const std::optional<JobResult>& result);

/// Returns all files in the folder but result.json.
[[nodiscard]] ResultFiles hash_files_in(const std::filesystem::path& folder);

/// Returns ", "-separated names of files that are in one list alone, or have other bytes.
[[nodiscard]] std::string differing(const ResultFiles& listed, const ResultFiles& found);

void write_result(const std::filesystem::path& folder, const JobResult& result);

// ---- Running

struct BatchRun {
  std::filesystem::path results;
  std::string cache;  ///< the folder of a `ResultCache`; empty: there is none
  Shard shard;
  int threads = 1;
  std::uint64_t memory = 0;  ///< that bakes may hold at a time, by prediction
  double verify = 0.0;       ///< the share of results that is computed once more
};

struct BatchOutcome {
  std::size_t jobs = 0;
  std::map<JobState, std::size_t> counts;       ///< one that is verified is of another shard
  std::map<std::size_t, std::string> troubles;  ///< of failed and different ones, by their numbers in the plan
  double seconds = 0.0;
};

/// Bakes what is not there, many at a time, with progress on a terminal. Throws `Error`: cancelled after a signal,
/// file_access if results cannot be written.
[[nodiscard]] BatchOutcome run_batch(const BatchPlan& plan, const BatchRun& run);

// ---- Status and merge

/// Prints how far a shard of the batch is. Throws `Error` (corrupt_file) if a job has failed or differs.
void show_status(const BatchPlan& plan, const std::filesystem::path& results, const Shard& shard, bool as_json);

/// Hashes every input and every file of its result, and writes index.json and index.html to `folder`. Throws `Error`:
/// corrupt_file if results are damaged, or missing where `allow_missing` does not permit that; file_access; cancelled.
void merge_batch(const BatchPlan& plan, const std::filesystem::path& results, const std::filesystem::path& folder,
                 int threads, bool allow_missing, bool as_json);

}  // namespace welkin::tool
