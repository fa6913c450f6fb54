// Which job of a shard runs when, and on how many threads.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

namespace welkin::tool {

/// What is known of a job before it runs.
struct JobSize {
  double seconds = 0.0;      ///< on one core
  std::uint64_t memory = 0;  ///< bytes
};

/// Jobs in the order in which they are given out, as long as there are threads and memory for them. Most run on one
/// thread, side by side, which wastes none. One that is more than its share of all that is left, or beside which no
/// others have room, gets more, so that no thread is idle at the end. Thread-safe.
class BatchSchedule {
 public:
  /// `jobs`: costliest first. `threads` > 0.
  BatchSchedule(std::vector<JobSize> jobs, int threads, std::uint64_t memory);

  struct Turn {
    std::size_t job;  ///< its place in the list
    int threads;
  };

  /// The next job; waits until there are threads and memory for it. A job that is alone may take more memory than there
  /// should be: its bake refuses that. Nothing when all are given out, or after `stop`.
  [[nodiscard]] std::optional<Turn> next();
  void finished(const Turn& turn);

  /// No more are given out.
  void stop();

 private:
  [[nodiscard]] int threads_wanted(const JobSize& job) const;

  std::vector<JobSize> jobs_;
  const int threads_;
  const std::uint64_t memory_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;
  double seconds_left_ = 0.0;  ///< of jobs that are not given out
  int threads_busy_ = 0;
  std::uint64_t memory_busy_ = 0;
  std::size_t running_ = 0;
  bool stopped_ = false;
};

}  // namespace welkin::tool
