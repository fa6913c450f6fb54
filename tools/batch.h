// `welkin batch`: its plan (jobs.json), the folder of results, what runs record of them, and what is made of that.
// docs/guides/farm.md has the files' formats.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "platform/file.h"
#include "tools/bake_options.h"
#include "tools/json.h"
#include "welkin/core.h"
#include "welkin/result_cache.h"

namespace welkin::tool {

// ---- The files that words on a command line stand for

/// Whether the name has the ending of a file that Welkin reads as an environment.
[[nodiscard]] bool is_picture_name(const std::filesystem::path& path);

/// All pictures below the folder, in the order of their paths. Folders and files whose names begin with a dot are left
/// out, and so are folders with a manifest of a bake: those pictures were made by Welkin. Throws `Error` (file_access).
[[nodiscard]] std::vector<std::filesystem::path> pictures_below(const std::filesystem::path& folder);

/// Whether the text has one of the signs of a pattern.
[[nodiscard]] bool is_pattern(const std::string& text) noexcept;

/// Whether a name fits a pattern: `*` stands for any characters, `?` for one.
[[nodiscard]] bool fits(const std::string& name, const std::string& pattern) noexcept;

/// The files that fit, in the order of their paths: pictures where the last part is a pattern. `**` as a folder stands
/// for any number of folders, none too, but for those that a bake has made. A name with a dot in front fits only a
/// pattern with one. Throws `Error` (file_access).
[[nodiscard]] std::vector<std::filesystem::path> files_that_fit(const std::string& pattern);

// ---- The plan

/// One input and what is to be made of it.
struct BatchJob {
  std::string name;                  ///< no other job has it
  std::string input;                 ///< relative to the folder of the plan, where that is possible
  std::vector<std::string> options;  ///< of `welkin bake`; files that they name are relative as the input is
  double seconds = 0.0;              ///< predicted, on one core
  std::uint64_t size = 0;            ///< of the input's file, in bytes
  std::uint64_t memory = 0;          ///< predicted, in bytes: the most that its bake holds
  std::string error;                 ///< why its input could not be read when this was planned; empty: it could
};

struct BatchPlan {
  std::filesystem::path file;    ///< of the plan; where that is a link, its target
  std::filesystem::path folder;  ///< in which the file is, without links: paths in the plan are relative to it
  std::vector<BatchJob> jobs;

  [[nodiscard]] double seconds() const noexcept;
  /// Returns where a path in the plan leads to.
  [[nodiscard]] std::filesystem::path place(const std::string& path) const;
  /// Returns the default folder of results: beside the plan, by its name with ".results".
  [[nodiscard]] std::filesystem::path default_results() const;
};

struct BatchRequest {
  std::vector<std::string> inputs;   ///< files, folders and patterns (*, ?, **)
  std::optional<std::string> list;   ///< a file of JSON lines; its inputs may be on other machines alone
  std::vector<std::string> options;  ///< of all jobs; those of their lines replace them
};

/// Returns the options of `welkin bake` that say what comes out. `bake` must outlive them.
[[nodiscard]] Options job_options(BakeCommandOptions& bake);

/// Returns those of a command's words that are such options with their values, as they were written.
[[nodiscard]] std::vector<std::string> words_for_jobs(const std::vector<std::string>& words);

/// Reads every input's header. An input that cannot be read is a job with an error, unless it stands in `inputs` and is
/// not there or is no picture. Throws `Error`: file_access for that, and if `file` is there and no plan, or cannot be;
/// invalid_argument for options that `welkin bake` would refuse, for a pattern without a match and if there is nothing
/// to do; what reading the list does (`for_each_line`).
[[nodiscard]] BatchPlan plan_batch(const BatchRequest& request, const std::filesystem::path& file);

void write_batch_plan(const BatchPlan& plan);

/// Throws `Error`: file_access, limit_exceeded; corrupt_file for what is no plan of this version.
[[nodiscard]] BatchPlan read_batch_plan(const std::filesystem::path& file);

/// Returns the options of one job as `welkin bake` reads them; `settle_files` has been called. Throws `Error`:
/// invalid_argument; file_access for a file of theirs that is no regular one, because a batch reads it more than once.
[[nodiscard]] BakeCommandOptions bake_options_of(const BatchPlan& plan, const std::vector<std::string>& words);

/// The part `number` (from 1) of `count`.
struct Shard {
  int number = 1;
  int count = 1;
};
inline constexpr int kMostShards = 1'000'000;

/// Returns the jobs of each shard, costliest first. In the order of cost every job goes to the shard that has least to
/// do by then; of several to the one with the fewest jobs, and of those to the first. It follows from the plan alone.
[[nodiscard]] std::vector<std::vector<std::size_t>> cut_batch(const BatchPlan& plan, int shards);

// ---- Results: folders named by what they were made of, whole or absent

struct ResultFile {
  std::string name;
  std::uint64_t bytes = 0;
  ContentHash hash;

  friend bool operator==(const ResultFile&, const ResultFile&) = default;
};
/// Of a result; in the order of their names.
using ResultFiles = std::vector<ResultFile>;

/// Returns the hash over the names and hashes.
[[nodiscard]] ContentHash hash_of(const ResultFiles& files);
[[nodiscard]] Json json_of(const ResultFiles& files);

/// Returns the key of a job's result: over the bytes of its input, how that was understood, the options and what stood
/// in the files that they name, and the version of results. Reads the input, which `options` names. Throws `Error` as
/// `inspect_environment`.
[[nodiscard]] ContentHash result_key_of(const BakeCommandOptions& options, const BatchJob& job);
/// The same; throws invalid_argument for the job's options, too.
[[nodiscard]] ContentHash result_key_of(const BatchPlan& plan, const BatchJob& job);

/// Returns the files that a result's result.json lists; nothing if there is no sound one. Files are not looked at.
[[nodiscard]] std::optional<ResultFiles> listed_in(const std::filesystem::path& result);

/// Returns whether the files that the result lists are there in their sizes. Their bytes are not read.
[[nodiscard]] bool is_whole(const std::filesystem::path& result);

/// Returns ", "-separated names of files that are not there or whose bytes have another hash than is listed.
[[nodiscard]] std::string damaged_files(const std::filesystem::path& result, const ResultFiles& files);

/// The folder takes no more results (file_access): it is full, or cannot be written to any more. The fault of no job.
class ResultStoreError : public Error {
 public:
  explicit ResultStoreError(const std::string& message) : Error(ErrorCode::file_access, message) {}
};

class ResultStore {
 public:
  using Make = std::function<void(const std::filesystem::path& folder)>;

  /// Makes the folder and, in it, one for what this process has at work. Removes what killed processes of this machine
  /// left of theirs. Throws `Error` (file_access).
  explicit ResultStore(std::filesystem::path folder);
  ~ResultStore();
  ResultStore(const ResultStore&) = delete;
  ResultStore& operator=(const ResultStore&) = delete;

  [[nodiscard]] std::filesystem::path place(const ContentHash& key) const { return folder_ / key.text(); }

  /// Has `make` fill a folder, lists its files, and gives it its name. Returns false if another process was first,
  /// whose result stays; a damaged one is replaced. Throws `Error` and what `make` throws, but `ResultStoreError` where
  /// that was file_access and the folder takes no other file either. Then nothing is left. Thread-safe.
  bool add(const ContentHash& key, const Make& make);

  /// Has `make` fill a folder that is removed again, and returns what was in it. Throws likewise. Thread-safe.
  [[nodiscard]] ResultFiles trial(const Make& make);

 private:
  void remove_what_dead_processes_left() const;
  void begin_own_folder();
  [[nodiscard]] std::filesystem::path fresh();
  void fill(const std::filesystem::path& folder, const Make& make) const;

  std::filesystem::path folder_;
  std::filesystem::path own_;  ///< of this process: results that are not whole yet
  std::atomic<unsigned> made_ = 0;
  std::optional<platform::FolderLock> lock_;
};

// ---- Records: a line for each job that a run has done

enum class JobState {
  computed,
  present,   ///< its result was there
  failed,    ///< there is no result, and why is said
  verified,  ///< computed once more: the files have the hashes that are listed
  differs    ///< or others
};

struct JobRecord {
  std::string job;        ///< its `hash_of_job` as text
  std::size_t index = 0;  ///< in the plan
  std::string name;       ///< of the job
  JobState state = JobState::failed;
  std::string result;    ///< its folder's name; empty: it is not known
  double seconds = 0.0;  ///< that it took
  int threads = 1;       ///< that it had
  std::string error_code;
  std::string error;
  std::string host;
  std::int64_t process = 0;
  std::string start;
  std::string end;
};

[[nodiscard]] const char* name(JobState state) noexcept;

/// Returns the hash over what a plan says of a job: its name, input and options. By it a record is known to be of this
/// job, whatever plans share a folder of results, and wherever they have it.
[[nodiscard]] ContentHash hash_of_job(const BatchJob& job);

/// A run's report: a file of its own, to which each record is appended as a line of JSON.
class RunReport {
 public:
  /// Makes the folder of reports. Throws `Error` (file_access).
  RunReport(const std::filesystem::path& results, const Shard& shard);

  /// Thread-safe. Throws `ResultStoreError` if it cannot be written.
  void add(const JobRecord& record);

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

 private:
  std::filesystem::path file_;
  std::mutex mutex_;
  std::ofstream stream_;
};

// ---- Running

struct BatchRun {
  std::filesystem::path results;
  Shard shard;
  int threads = 1;
  std::uint64_t memory = 0;  ///< that bakes may hold at a time, by prediction
  double verify = 0.0;       ///< the share of results that is computed once more
};

struct BatchOutcome {
  std::size_t jobs = 0;
  std::map<JobState, std::size_t> counts;  ///< one that is verified is present, too
  double seconds = 0.0;
  std::filesystem::path report;
  std::vector<JobRecord> troubles;  ///< failed and different ones, in the order of the plan
};

/// Bakes what is not there, many at a time, with progress on a terminal. Throws `Error`: cancelled after a signal (no
/// partial result is left, and the report is written), file_access if results or report cannot be written.
[[nodiscard]] BatchOutcome run_batch(const BatchPlan& plan, const BatchRun& run);

// ---- Status and merge

/// Prints how far a batch is, by its reports. Throws `Error` (corrupt_file) if a job has failed or differs.
void show_status(const BatchPlan& plan, const std::filesystem::path& results, bool as_json);

/// Hashes every input and every file of its result, and writes index.json and index.html to `folder`. Throws `Error`:
/// corrupt_file if results are damaged, or missing where `allow_missing` does not permit that; file_access; cancelled.
void merge_batch(const BatchPlan& plan, const std::filesystem::path& results, const std::filesystem::path& folder,
                 int threads, bool allow_missing, bool as_json);

/// "41 s", "3 min 5 s", "2 h 10 min"
[[nodiscard]] std::string long_duration(double seconds);

}  // namespace welkin::tool
