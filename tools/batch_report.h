// What became of a batch's jobs: a report for each shard, to which every run adds.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <unordered_map>
#include <vector>

#include "platform/file.h"
#include "tools/batch_plan.h"
#include "welkin/core.h"
#include "welkin/result_cache.h"

namespace welkin::tool {

/// How a job ended.
enum class JobState {
  computed,
  present,   ///< its result was there
  failed,    ///< there is no result; why is said
  verified,  ///< computed once more: the files have the hashes that are listed
  differs    ///< or others
};

[[nodiscard]] const char* name(JobState state) noexcept;

/// "2026-11-25T20:45:56.123Z": the time of day everywhere. Of the system's clock.
[[nodiscard]] std::string time_now();

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

/// Over what a plan says of a job: its name, input and options. By it a record is known to be of this job, whatever
/// plans share a folder of results, and wherever they have it.
[[nodiscard]] ContentHash hash_of_job(const BatchJob& job);

/// Which part of the jobs a process does: shard `number` (from 1) of `count`.
struct Shard {
  int number = 1;
  int count = 1;
};

/// Parts that a batch is cut into.
inline constexpr int kMostShards = 1'000'000;

/// A shard's records, oldest first, without what later ones replace: of a job that was found or failed the last time
/// counts, and a verification ends a failure. What was computed and verified stays.
class RecordList {
 public:
  /// Takes about the same time however many there are.
  void add(JobRecord record);

  [[nodiscard]] std::vector<JobRecord> all() const;

 private:
  std::vector<std::optional<JobRecord>> records_;             ///< nothing: it was replaced
  std::unordered_map<std::string, std::size_t> replaceable_;  ///< of a job: where it was found or failed
};

/// Reports a shard's jobs in a file that is whole at any time. Other processes may add to it too. Thread-safe.
class ShardReport {
 public:
  /// Makes the folder. Throws `Error` (file_access).
  ShardReport(const std::filesystem::path& results, const Shard& shard, std::stop_token stop);

  /// Notes it, and writes the file if that was a second ago, or longer: at most a tenth of the time is spent on it.
  /// Throws `Error` (file_access), also if another process keeps the folder of reports locked for half a minute, or for
  /// two seconds after a stop; then nothing waits for it again.
  void add(JobRecord record);

  /// Throws `Error` (file_access).
  void write();

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

 private:
  /// What tells that nobody else has written a file since.
  struct Stamp {
    std::uintmax_t bytes = 0;
    std::filesystem::file_time_type time;

    friend bool operator==(const Stamp&, const Stamp&) = default;
  };

  void write_locked();
  void lock(platform::FolderLock& folder);
  void read_what_others_wrote();
  [[nodiscard]] std::optional<Stamp> stamp() const;

  std::filesystem::path file_;
  Shard shard_;
  std::stop_token stop_;
  std::mutex mutex_;
  RecordList records_;          ///< of the file as it was last read or written
  std::optional<Stamp> stamp_;  ///< of the file then
  std::vector<JobRecord> unwritten_;
  std::optional<std::chrono::steady_clock::time_point> next_write_;
  bool gave_up_ = false;  ///< to lock the folder
};

/// The records of a report, oldest first. Throws `Error`: file_access, corrupt_file.
[[nodiscard]] std::vector<JobRecord> read_report(const std::filesystem::path& file);

/// Of which shard a report is by its name, shard-I-of-N.json. Nothing for other names, and numbers that no run takes.
[[nodiscard]] std::optional<Shard> shard_of_report(const std::filesystem::path& file);

/// All reports in a folder of results, in the order of their names.
[[nodiscard]] std::vector<std::filesystem::path> reports_in(const std::filesystem::path& results);

}  // namespace welkin::tool
