// `welkin batch`: its plan (jobs.json), the folder of results, and their summary. docs/guides/farm.md describes the
// formats of the files.
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

/// One input and the options of its bake.
struct BatchJob {
  std::string name{};                  ///< unique in the plan
  std::string input{};                 ///< relative to the folder of the plan, if possible
  std::vector<std::string> options{};  ///< of `welkin bake`; paths in them are relative as the input is
  double seconds = 0.0;                ///< predicted, on one core
  std::uint64_t size = 0;              ///< of the input's file, in bytes
  std::uint64_t memory = 0;            ///< predicted peak of its bake, in bytes
  std::string error{};                 ///< reason why its input could not be read for the plan; empty: it could
};

struct BatchPlan {
  std::filesystem::path file;    ///< of the plan; the target if that is a link
  std::filesystem::path folder;  ///< in which the file is, without links: paths in the plan are relative to it
  std::vector<BatchJob> jobs;

  [[nodiscard]] double seconds() const noexcept;
  /// Returns the default folder of results: next to the plan, by its name with ".results".
  [[nodiscard]] std::filesystem::path default_results() const;
};

struct BatchRequest {
  std::vector<std::string> inputs;  ///< files, folders and patterns (*, ?, **)
  std::optional<std::string> list;  ///< a file of JSON lines; its inputs may exist on other machines only
  GivenOptions options;             ///< of all jobs; options in their lines replace them
};

/// Returns whether the name has the extension of a file that Welkin reads as an environment.
[[nodiscard]] bool is_image_name(const std::filesystem::path& path);

/// Returns whether the text has one of the signs of a pattern.
[[nodiscard]] bool is_pattern(const std::string& text) noexcept;

/// Returns the options of `welkin bake` that affect its results. `bake` must outlive them.
[[nodiscard]] Options job_options(BakeCommandOptions& bake);

/// Reads every input's header. An input that cannot be read becomes a job with an error, unless it is in `inputs` and
/// does not exist or is no image. Throws `Error`: file_access for such an input, and if `file` exists and is no plan,
/// or cannot be one; invalid_argument for options that `welkin bake` would refuse, for a pattern without a match and if
/// there is nothing to do; and the errors of reading the list (`for_each_line`).
[[nodiscard]] BatchPlan plan_batch(const BatchRequest& request, const std::filesystem::path& file);

void write_batch_plan(const BatchPlan& plan);

/// Reads a plan. Throws `Error`: file_access, limit_exceeded; corrupt_file for anything but a plan of this version.
[[nodiscard]] BatchPlan read_batch_plan(const std::filesystem::path& file);

/// Returns the options of `welkin bake` for a job. Throws `Error`: invalid_argument; file_access for a file of its
/// options that is no regular one, because a batch reads it more than once.
[[nodiscard]] BakeCommandOptions bake_options_of(const BatchPlan& plan, const BatchJob& job);

/// The part `number` (from 1) of `count`.
struct Shard {
  int number = 1;
  int count = 1;
};
inline constexpr int kMaxShards = 1'000'000;

/// Returns the jobs of each shard, costliest first. In the order of cost every job goes to the shard with the least
/// work so far; of several to the one with the smallest number of jobs, then to the first. Depends on the plan alone.
[[nodiscard]] std::vector<std::vector<std::size_t>> cut_batch(const BatchPlan& plan, int shards);

// ---- Results: each a folder with the files of `welkin bake` and result.json; complete or absent

struct ResultFile {
  std::string name;
  std::uint64_t bytes = 0;
  ContentHash hash;

  friend bool operator==(const ResultFile&, const ResultFile&) = default;
};
/// The files of a result, in the order of their names.
using ResultFiles = std::vector<ResultFile>;

enum class JobState {
  computed,
  present,   ///< its result already existed
  failed,    ///< no result, but a reason
  verified,  ///< computed again: the files have the listed hashes
  differs    ///< the files have other hashes
};
[[nodiscard]] const char* name(JobState state) noexcept;

/// The content of result.json.
struct JobResult {
  JobState state = JobState::failed;  ///< computed, failed or differs
  ContentHash key;                    ///< `bake_key`
  ResultFiles files;                  ///< unless it failed
  std::string error_code;             ///< if it failed
  std::string error;
  double seconds = 0.0;  ///< duration
  int threads = 1;       ///< used
  std::string host;
  double start = 0.0;  ///< in seconds since 1970, by the clock of the host
};

/// Returns the hash of the input and options of the plan, which names the folder of a job's result.
[[nodiscard]] ContentHash hash_of(const BatchJob& job);

/// Reads result.json. Returns nothing if it is missing or damaged.
[[nodiscard]] std::optional<JobResult> read_result(const std::filesystem::path& folder);

/// Returns whether the folder has a result of its job that neither failed nor differs, with all files in their sizes.
/// Their bytes are not read.
[[nodiscard]] bool is_done(const std::filesystem::path& folder, const std::optional<JobResult>& result);

/// Returns all files in the folder but result.json.
[[nodiscard]] ResultFiles hash_files_in(const std::filesystem::path& folder);

/// Returns the names, separated by ", ", of files that are in only one list or have other bytes.
[[nodiscard]] std::string differing(const ResultFiles& listed, const ResultFiles& found);

void write_result(const std::filesystem::path& folder, const JobResult& result);

// ---- Running

struct BatchRun {
  std::filesystem::path results;
  std::string cache;  ///< the folder of a `ResultCache`; empty: there is none
  Shard shard;
  int threads = 1;
  std::uint64_t memory = 0;  ///< limit for concurrent bakes, by prediction
  double verify = 0.0;       ///< the fraction of results to compute again
};

struct BatchOutcome {
  std::size_t jobs = 0;
  std::map<JobState, std::size_t> counts;       ///< a verified job is another shard's
  std::map<std::size_t, std::string> troubles;  ///< of failed and differing jobs, by their index in the plan
  double seconds = 0.0;
};

/// Bakes missing results, several concurrently, with progress on a terminal. Throws `Error`: cancelled after a signal,
/// file_access if results cannot be written.
[[nodiscard]] BatchOutcome run_batch(const BatchPlan& plan, const BatchRun& run);

// ---- Status and merge

/// Prints the progress of a shard. Throws `Error` (corrupt_file) if a job has failed or differs.
void show_status(const BatchPlan& plan, const std::filesystem::path& results, const Shard& shard, bool as_json);

/// Hashes every input and every file of its result, and writes index.json and index.html to `folder`. Throws `Error`:
/// corrupt_file if results are damaged, or missing where `allow_missing` does not permit that; file_access; cancelled.
void merge_batch(const BatchPlan& plan, const std::filesystem::path& results, const std::filesystem::path& folder,
                 int threads, bool allow_missing, bool as_json);

}  // namespace welkin::tool
