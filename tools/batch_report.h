// What became of a batch's jobs: a report for each shard, to which every run adds.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "welkin/core.h"

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

/// Which part of the jobs a process does: shard `number` (from 1) of `count`.
struct Shard {
  int number = 1;
  int count = 1;
};

/// Reports a shard's jobs in a file that is whole at any time. Other processes may add to it too. Thread-safe.
class ShardReport {
 public:
  /// Makes the folder. Throws `Error` (file_access).
  ShardReport(const std::filesystem::path& results, const Shard& shard);

  /// Notes it, and writes the file if that was a second ago, or longer. Throws `Error` (file_access).
  void add(JobRecord record);

  /// Throws `Error` (file_access).
  void write();

  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

 private:
  void write_locked();

  std::filesystem::path file_;
  Shard shard_;
  std::mutex mutex_;
  std::vector<JobRecord> unwritten_;
  std::optional<std::chrono::steady_clock::time_point> written_;
};

/// The records of a report, oldest first. Throws `Error`: file_access, corrupt_file.
[[nodiscard]] std::vector<JobRecord> read_report(const std::filesystem::path& file);

/// All reports in a folder of results, in the order of their names. Throws likewise.
[[nodiscard]] std::vector<std::filesystem::path> reports_in(const std::filesystem::path& results);

/// The words of an error's kind: "corrupt_file".
[[nodiscard]] const char* name(ErrorCode code) noexcept;

}  // namespace welkin::tool
