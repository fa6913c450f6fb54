// Carries out a shard of a batch: bakes the missing results, several concurrently.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <iostream>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "jobs/control.h"
#include "platform/file.h"
#include "platform/text.h"
#include "tools/bake_cache.h"
#include "tools/batch.h"
#include "tools/commands.h"
#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {

namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double time_now() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

/// A job, and whether to bake or verify it.
struct Task {
  std::size_t job;  ///< in the plan
  bool verifies;    ///< compute an existing result again
};

/// Returns the shard's own jobs, then a fraction of the next shard's, which it verifies. A hash of the job selects
/// them, so that they are the same each time. Each part has the costliest first.
std::vector<Task> tasks_of(const BatchPlan& plan, const BatchRun& run) {
  constexpr double kHashes = 18446744073709551616.0;  // 2^64
  const std::vector<std::vector<std::size_t>> cut = cut_batch(plan, run.shard.count);
  const auto index = static_cast<std::size_t>(run.shard.number - 1);
  std::vector<Task> tasks;
  for (const std::size_t job : cut[index]) tasks.push_back({job, false});
  for (const std::size_t job : cut[(index + 1) % cut.size()]) {
    if (static_cast<double>(hash_of(plan.jobs[job]).high) < run.verify * kHashes) tasks.push_back({job, true});
  }
  return tasks;
}

/// The folder of results cannot be written, which is the fault of no job.
class ResultsError : public Error {
 public:
  explicit ResultsError(const std::string& what) : Error(ErrorCode::file_access, what + "; is the disk full?") {}
};

/// The folder next to a result's own in which the result is made, by one process at a time. It replaces the remains of
/// a killed process.
class Workplace {
 public:
  explicit Workplace(const fs::path& result) : result_(result), path_(result) { path_ += ".work"; }
  ~Workplace() {
    if (!lock_) return;
    std::error_code trouble;
    fs::remove_all(files(), trouble);
    lock_.reset();
    fs::remove(path_, trouble);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  /// Waits until no other process uses it. Throws `Error`: file_access, cancelled.
  void enter(const stop_token& stop) {
    if (lock_) return;
    std::error_code trouble;
    fs::create_directories(path_, trouble);
    if (trouble) throw ResultsError(platform::utf8(path_) + ": cannot be made (" + trouble.message() + ')');
    lock_.emplace(path_);
    while (!lock_->take()) {
      jobs::throw_if_cancelled(stop);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    fs::remove_all(files(), trouble);
    fs::create_directories(files(), trouble);
  }
  /// Removes the remains of a process that was killed after it named its result.
  void clear() {
    std::error_code trouble;
    if (!fs::exists(path_, trouble)) return;
    lock_.emplace(path_);
    if (!lock_->take()) lock_.reset();  // another process uses it
  }
  [[nodiscard]] fs::path files() const { return path_ / "files"; }

  /// Returns whether an error concerns this folder, and thus the results of all jobs.
  [[nodiscard]] bool is_cause_of(const Error& error) const {
    return error.code() == ErrorCode::file_access &&
           std::string_view(error.what()).find(platform::utf8(path_)) != std::string_view::npos;
  }

  /// Turns the files into the result. Throws `Error`.
  void publish(const JobResult& result) const {
    try {
      write_result(files(), result);
    } catch (const Error& error) {
      throw ResultsError(error.what());
    }
    std::error_code trouble;
    fs::remove_all(result_, trouble);
    fs::rename(files(), result_, trouble);
    if (trouble) throw ResultsError(platform::utf8(result_) + ": cannot get its name (" + trouble.message() + ')');
  }

 private:
  fs::path result_;
  fs::path path_;
  std::optional<platform::FolderLock> lock_;
};

/// Runs a shard. Starts tasks in their order while there are threads and memory for them. Most run on one thread each,
/// which wastes none. A task that is more than its fraction of the remaining work, or that leaves no memory for others,
/// gets more threads, so that none is idle at the end.
class ShardRun {
 public:
  ShardRun(const BatchPlan& plan, const BatchRun& run, stop_token stop)
      : plan_(plan), run_(run), tasks_(tasks_of(plan, run)), stop_(std::move(stop)) {}

  /// Throws the error that stopped it.
  BatchOutcome run() {
    const WithoutStages quiet;
    {
      const stop_callback stopping(stop_, [this] { changed_.notify_all(); });
      std::vector<std::thread> workers;
      try {
        for (int i = 1; i < run_.threads; ++i) workers.emplace_back([this] { work(); });
      } catch (const std::system_error&) {  // run with fewer threads
      }
      work();
      for (std::thread& worker : workers) worker.join();
    }
    if (drawn_) std::cerr << kWipeLine << std::flush;
    if (stop_.stop_requested()) {
      throw Error(ErrorCode::cancelled, "stopped; completed results are kept, and the same command continues");
    }
    if (failure_) std::rethrow_exception(failure_);
    outcome_.jobs = static_cast<std::size_t>(std::ranges::count(tasks_, false, &Task::verifies));
    outcome_.seconds = seconds_since(start_);
    return outcome_;
  }

 private:
  struct Turn {
    const Task& task;
    const BatchJob& job;
    int threads;
  };

  [[nodiscard]] double predicted_seconds() const {
    double all = 0.0;
    for (const Task& task : tasks_) all += plan_.jobs[task.job].seconds;
    return all;
  }

  [[nodiscard]] int threads_wanted(const BatchJob& job) const {
    // The job's fraction of the remaining work, itself included.
    const double share = seconds_left_ > 0.0 ? job.seconds / seconds_left_ : 1.0;
    const auto by_share = static_cast<int>(std::lround(share * run_.threads));
    // The number of such jobs that fit in memory together.
    const std::uint64_t fitting = std::max<std::uint64_t>(1, run_.memory / std::max<std::uint64_t>(1, job.memory));
    const auto by_memory = run_.threads / static_cast<int>(std::min<std::uint64_t>(fitting, 1'000'000));
    return std::clamp(std::max(by_share, by_memory), 1, run_.threads);
  }

  /// Waits until there are threads and memory for the next task. A task that runs alone may exceed the memory limit:
  /// its bake refuses that. Returns nothing when all tasks are started, or after a stop.
  std::optional<Turn> next() {
    std::unique_lock lock(mutex_);
    const auto over = [this] { return failure_ || stop_.stop_requested() || next_ == tasks_.size(); };
    const auto fits = [this] {
      const std::uint64_t memory = plan_.jobs[tasks_[next_].job].memory;
      return running_ == 0 ||
             (threads_busy_ < run_.threads && memory_busy_ <= run_.memory && memory <= run_.memory - memory_busy_);
    };
    // A signal may come between the check and the wait.
    while (!over() && !fits()) changed_.wait_for(lock, std::chrono::milliseconds(100));
    if (over()) return std::nullopt;
    const Task& task = tasks_[next_++];
    const BatchJob& job = plan_.jobs[task.job];
    const Turn turn{task, job, std::min(threads_wanted(job), std::max(1, run_.threads - threads_busy_))};
    ++running_;
    threads_busy_ += turn.threads;
    memory_busy_ += job.memory;
    seconds_left_ = std::max(0.0, seconds_left_ - job.seconds);
    return turn;
  }

  void finished(const Turn& turn, std::exception_ptr failure) {
    {
      const std::scoped_lock lock(mutex_);
      --running_;
      threads_busy_ -= turn.threads;
      memory_busy_ -= turn.job.memory;
      if (!failure_) failure_ = std::move(failure);
    }
    changed_.notify_all();
  }

  /// Runs tasks on one thread until none is left. An error of a job goes into its result; an error of the folder of
  /// results ends the run.
  void work() {
    while (const std::optional<Turn> turn = next()) {
      std::exception_ptr failure;
      try {
        run_with_threads(turn->threads, [&] { do_task(*turn); });
      } catch (...) {
        failure = std::current_exception();
      }
      finished(*turn, failure);
    }
  }

  void do_task(const Turn& turn) {
    const fs::path folder = run_.results / hash_of(turn.job).text();
    Workplace workplace(folder);
    JobResult result;
    result.threads = turn.threads;
    result.host = host_name();
    result.start = time_now();
    const Clock::time_point start = Clock::now();
    try {
      BakeCommandOptions options = bake_options_of(plan_, turn.job);
      options.common.read.memory_limit_bytes = run_.memory;
      options.common.memory_option = "--memory";
      options.directory = platform::utf8(workplace.files());
      result.key = bake_key(options);
      const auto is_there = [&] {
        const std::optional<JobResult> there = read_result(folder);
        return is_done(folder, there) && there->key == result.key;
      };
      if (!turn.task.verifies && is_there()) {
        workplace.clear();
        return note(turn, JobState::present, "");
      }
      workplace.enter(stop_);
      if (turn.task.verifies) return verify(turn, folder, options);
      if (is_there()) return note(turn, JobState::present, "");  // from the process that had the lock
      options.common.cache = run_.cache;
      result.files = bake(options, result.key);
      result.state = JobState::computed;
    } catch (const ResultsError&) {
      throw;
    } catch (const Error& error) {
      if (stop_.stop_requested() || turn.task.verifies) return;  // its own shard reports the error
      if (workplace.is_cause_of(error)) throw ResultsError(error.what());
      result.error_code = name(error.code());
      result.error = error.what();
    } catch (const std::bad_alloc&) {
      result.error_code = name(ErrorCode::limit_exceeded);
      result.error = "not enough memory; pass a lower --memory or fewer --threads";
    }
    result.seconds = seconds_since(start);
    workplace.enter(stop_);
    workplace.publish(result);
    note(turn, result.state, result.error);
  }

  [[nodiscard]] ResultFiles bake(const BakeCommandOptions& options, const ContentHash& key) const {
    static_cast<void>(bake_to_folder(options, {stop_, {}}));
    // The inputs must still have the hash from before the bake.
    if (bake_key(options) == key) return hash_files_in(platform::path_of(options.directory));
    throw Error(ErrorCode::file_access, *options.input + ": changed while it was baked; run again");
  }

  /// Compares the files' bytes, not only the list of their hashes.
  void verify(const Turn& turn, const fs::path& folder, const BakeCommandOptions& options) {
    std::optional<JobResult> result = read_result(folder);
    if (!result || result->files.empty()) return;  // there is nothing to verify
    std::string names = differing(result->files, bake(options, bake_key(options)));
    if (names.empty()) names = differing(result->files, hash_files_in(folder));
    if (names.empty()) return note(turn, JobState::verified, "");
    result->state = JobState::differs;
    result->error = "differs when computed again: " + names;
    write_result(folder, *result);
    note(turn, result->state, result->error);
  }

  void note(const Turn& turn, JobState state, const std::string& error) {
    const std::scoped_lock lock(mutex_);
    ++done_;
    seconds_done_ += turn.job.seconds;
    ++outcome_.counts[state];
    if (!error.empty()) outcome_.troubles[turn.task.job] = error;
    if (shows_progress_ && Clock::now() >= next_drawing_) draw();
  }

  void draw() {
    next_drawing_ = Clock::now() + std::chrono::milliseconds(100);
    drawn_ = true;
    const double passed = seconds_since(start_);
    std::string text = std::to_string(done_) + " of " + counted(tasks_.size(), "file");
    if (outcome_.counts.contains(JobState::failed)) {
      text += ", " + std::to_string(outcome_.counts[JobState::failed]) + " failed";
    }
    text += ", " + significant(static_cast<double>(done_) / passed, 3) + " a second";
    const double share = all_seconds_ > 0.0 ? seconds_done_ / all_seconds_ : 0.0;
    if (share > 0.01 && share < 1.0) text += ", " + long_duration(passed * (1.0 - share) / share) + " left";
    std::cerr << kWipeLine << "  " << text << std::flush;
  }

  const BatchPlan& plan_;
  const BatchRun& run_;
  const std::vector<Task> tasks_;
  const stop_token stop_;
  const double all_seconds_ = predicted_seconds();
  const Clock::time_point start_ = Clock::now();
  const bool shows_progress_ = is_terminal(Stream::error) && verbosity() != Verbosity::quiet;

  std::mutex mutex_;  // guards all members below
  std::condition_variable changed_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
  int running_ = 0;
  int threads_busy_ = 0;
  std::uint64_t memory_busy_ = 0;
  double seconds_left_ = all_seconds_;  ///< of tasks that are not started
  double seconds_done_ = 0.0;
  Clock::time_point next_drawing_ = start_ + std::chrono::milliseconds(100);
  bool drawn_ = false;
  BatchOutcome outcome_;
  std::exception_ptr failure_;
};

}  // namespace

BatchOutcome run_batch(const BatchPlan& plan, const BatchRun& run) {
  return ShardRun(plan, run, stop_on_signals()).run();
}

}  // namespace welkin::tool
