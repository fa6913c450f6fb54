#include "tools/batch_run.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "platform/file.h"
#include "platform/text.h"
#include "tools/batch_progress.h"
#include "tools/batch_results.h"
#include "tools/batch_schedule.h"
#include "tools/commands.h"
#include "tools/terminal.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Results that this process computes at the moment: of two jobs with the same result one waits.
class KeysAtWork {
 public:
  class Turn {
   public:
    Turn(KeysAtWork& keys, const ContentHash& key) : keys_(keys), key_(key) {
      std::unique_lock lock(keys_.mutex_);
      keys_.changed_.wait(lock, [&] { return std::ranges::find(keys_.keys_, key_) == keys_.keys_.end(); });
      keys_.keys_.push_back(key_);
    }
    ~Turn() {
      {
        const std::scoped_lock lock(keys_.mutex_);
        std::erase(keys_.keys_, key_);
      }
      keys_.changed_.notify_all();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    KeysAtWork& keys_;
    ContentHash key_;
  };

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<ContentHash> keys_;
};

/// A bake's options are read once for all jobs that have the same.
class OptionsByWords {
 public:
  OptionsByWords(const BatchPlan& plan, std::uint64_t memory) : plan_(plan), memory_(memory) {}

  /// Throws `Error`.
  [[nodiscard]] BakeCommandOptions of(const BatchJob& job) {
    const std::scoped_lock lock(mutex_);
    const auto found = known_.find(job.options);
    if (found != known_.end()) return found->second;
    BakeCommandOptions options = bake_options_of(plan_, job.options);
    options.common.read.memory_limit_bytes = memory_;
    options.common.memory_option = "--memory";
    return known_.emplace(job.options, std::move(options)).first->second;
  }

 private:
  const BatchPlan& plan_;
  std::uint64_t memory_;
  std::mutex mutex_;
  std::map<std::vector<std::string>, BakeCommandOptions> known_;
};

/// What is done with a job.
struct Task {
  std::size_t job;  ///< in the plan
  bool verifies;    ///< a result that is there is computed once more
};

/// Which shard computes a job's result once more, if any does: another than the one that does the job, where there is
/// another. By a hash of what the plan says of the job.
std::optional<std::size_t> verifier_of(const BatchJob& job, std::size_t shard, std::size_t shards, double share) {
  constexpr double kHashes = 18446744073709551616.0;  // 2^64
  const ContentHash hash = hash_of_job(job);
  if (!(static_cast<double>(hash.high) < share * kHashes)) return std::nullopt;
  if (shards == 1) return shard;
  return (shard + 1 + static_cast<std::size_t>(hash.low % (shards - 1))) % shards;
}

/// The shard's own jobs, and then results of others that it verifies. Each costliest first.
std::vector<Task> tasks_of(const BatchPlan& plan, const BatchRun& run) {
  const std::vector<std::vector<std::size_t>> cut = cut_batch(plan, run.shard.count);
  const auto own = static_cast<std::size_t>(run.shard.number - 1);
  std::vector<Task> tasks;
  for (const std::size_t job : cut[own]) tasks.push_back({job, false});
  const std::size_t before = tasks.size();
  for (std::size_t shard = 0; shard < cut.size() && run.verify > 0.0; ++shard) {
    for (const std::size_t job : cut[shard]) {
      if (verifier_of(plan.jobs[job], shard, cut.size(), run.verify) == own) tasks.push_back({job, true});
    }
  }
  std::stable_sort(
      tasks.begin() + static_cast<std::ptrdiff_t>(before), tasks.end(),
      [&](const Task& one, const Task& other) { return plan.jobs[one.job].seconds > plan.jobs[other.job].seconds; });
  return tasks;
}

/// "specular.ktx2, sh.json": files that are not in both lists, or have other bytes.
std::string differing(const ResultFiles& listed, const ResultFiles& made) {
  std::map<std::string, ContentHash> others;
  for (const ResultFile& file : made) others.emplace(file.name, file.hash);
  std::string names;
  const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  for (const ResultFile& file : listed) {
    const auto found = others.find(file.name);
    if (found == others.end() || found->second != file.hash) add(file.name);
    if (found != others.end()) others.erase(found);
  }
  for (const auto& [name, hash] : others) add(name);
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// A shard at work.
class ShardRun {
 public:
  ShardRun(const BatchPlan& plan, const BatchRun& run, std::stop_token stop)
      : plan_(plan),
        names_(file_names_of(plan)),
        tasks_(tasks_of(plan, run)),
        stop_(std::move(stop)),
        store_(run.results),
        report_(run.results, run.shard, stop_),
        options_(plan, run.memory),
        schedule_(sizes(), run.threads, run.memory),
        progress_(tasks_.size(), seconds()),
        host_(host_name()) {}

  /// Throws what stopped it.
  void run(int threads) {
    const WithoutStages quiet;
    const std::stop_callback stopping(stop_, [this] { schedule_.stop(); });
    std::vector<std::thread> workers;
    try {
      for (int i = 1; i < threads; ++i) workers.emplace_back([this] { work(); });
    } catch (const std::system_error&) {  // there are fewer, then
    }
    work();
    for (std::thread& worker : workers) worker.join();
    try {
      report_.write();
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
    }
    if (stop_.stop_requested()) throw_cancelled();
    if (failure_) std::rethrow_exception(failure_);
  }

  /// After `run`.
  [[nodiscard]] BatchOutcome outcome() {
    BatchOutcome outcome = outcome_;
    outcome.jobs = static_cast<std::size_t>(std::ranges::count(tasks_, false, &Task::verifies));
    outcome.report = report_.file();
    std::ranges::sort(outcome.troubles, {}, &JobRecord::index);
    return outcome;
  }

 private:
  [[nodiscard]] std::vector<JobSize> sizes() const {
    std::vector<JobSize> sizes;
    sizes.reserve(tasks_.size());
    for (const Task& task : tasks_) sizes.push_back({plan_.jobs[task.job].seconds, plan_.jobs[task.job].memory});
    return sizes;
  }
  [[nodiscard]] double seconds() const {
    double all = 0.0;
    for (const Task& task : tasks_) all += plan_.jobs[task.job].seconds;
    return all;
  }

  [[noreturn]] static void throw_cancelled() {
    throw Error(ErrorCode::cancelled, "stopped; what is done is there, and the same command goes on from there");
  }

  /// Of one thread, until there is nothing left. What is wrong with a job is in the report; what is wrong with the
  /// folder of results ends the run.
  void work() {
    while (const auto turn = schedule_.next()) {
      try {
        run_with_threads(turn->threads, [&] { do_task(tasks_[turn->job], turn->threads); });
      } catch (...) {
        {
          const std::scoped_lock lock(mutex_);
          if (!failure_) failure_ = std::current_exception();
        }
        schedule_.stop();
      }
      schedule_.finished(*turn);
    }
  }

  void do_task(const Task& task, int threads) {
    const BatchJob& job = plan_.jobs[task.job];
    JobRecord record;
    record.job = hash_of_job(job).text();
    record.index = task.job;
    record.name = job.name;
    record.threads = threads;
    record.host = host_;
    record.process = platform::process_number();
    record.start = time_now();
    const Clock::time_point start = Clock::now();
    try {
      if (task.verifies) {
        if (!verify_result(job, record)) return progress_.add(job.seconds, false);
      } else {
        make_result(task.job, record);
      }
    } catch (const ResultStoreError&) {  // which is not the job's fault
      throw;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) return;  // it is not over
      record.error_code = name(error.code());
      record.error = error.what();
    } catch (const std::bad_alloc&) {
      record.error_code = name(ErrorCode::limit_exceeded);
      record.error = "there was not enough memory; a lower --memory or fewer --threads take less";
    }
    if (!record.error_code.empty()) {
      record.state = JobState::failed;
      if (!task.verifies) store_.remove_name(names_[task.job]);  // a result of what the input was before
    }
    record.seconds = seconds_since(start);
    record.end = time_now();
    note(std::move(record), job.seconds);
  }

  void make_result(std::size_t index, JobRecord& record) {
    const BatchJob& job = plan_.jobs[index];
    BakeCommandOptions options = options_.of(job);
    options.input = platform::utf8(plan_.place(job.input));
    const ContentHash key = result_key_of(options, job.options);
    record.result = key.text();
    const KeysAtWork::Turn turn(keys_, key);
    record.state = JobState::present;
    if (store_.is_whole(key)) return store_.add_name(key, names_[index]);
    const auto make = [&](const std::filesystem::path& folder) {
      options.directory = platform::utf8(folder);
      bake_files(options, {stop_, {}});
      // What was hashed before must be what was baked.
      if (result_key_of(options, job.options) == key) return;
      throw Error(ErrorCode::file_access, *options.input + ": changed while it was baked; run again");
    };
    if (store_.add(key, make)) record.state = JobState::computed;
    store_.add_name(key, names_[index]);
  }

  /// False if there is no result, and so nothing to verify.
  bool verify_result(const BatchJob& job, JobRecord& record) {
    BakeCommandOptions options = options_.of(job);
    options.input = platform::utf8(plan_.place(job.input));
    std::optional<ContentHash> key;
    try {
      key = result_key_of(options, job.options);
    } catch (const Error&) {  // which the shard tells that does the job
      return false;
    }
    const KeysAtWork::Turn turn(keys_, *key);
    const std::optional<ResultFiles> listed = listed_in(store_.place(*key));
    if (!listed) return false;
    record.result = key->text();
    const ResultFiles made = store_.trial(*key, [&](const std::filesystem::path& folder) {
      options.directory = platform::utf8(folder);
      bake_files(options, {stop_, {}});
    });
    // The bytes that are there count, and not what is said of them.
    std::string names = differing(*listed, made);
    if (names.empty()) names = joined(damaged_files(store_.place(*key), *listed));
    record.state = names.empty() ? JobState::verified : JobState::differs;
    if (!names.empty()) record.error = "differs when it is computed once more: " + names;
    return true;
  }

  void note(JobRecord record, double predicted) {
    const bool failed = record.state == JobState::failed;
    {
      const std::scoped_lock lock(mutex_);
      switch (record.state) {
        case JobState::computed: ++outcome_.computed; break;
        case JobState::present: ++outcome_.present; break;
        case JobState::failed: ++outcome_.failed; break;
        case JobState::verified: ++outcome_.verified; break;
        case JobState::differs: ++outcome_.differs; break;
      }
      if (failed || record.state == JobState::differs) outcome_.troubles.push_back(record);
    }
    progress_.add(predicted, failed);
    report_.add(std::move(record));
  }

  const BatchPlan& plan_;
  std::vector<std::string> names_;  ///< of the jobs, for links to their results
  std::vector<Task> tasks_;
  std::stop_token stop_;
  ResultStore store_;
  ShardReport report_;
  OptionsByWords options_;
  BatchSchedule schedule_;
  BatchProgress progress_;
  KeysAtWork keys_;
  std::string host_;
  std::mutex mutex_;
  BatchOutcome outcome_;
  std::exception_ptr failure_;
};

}  // namespace

BatchOutcome run_batch(const BatchPlan& plan, const BatchRun& run) {
  const Clock::time_point start = Clock::now();
  ShardRun shard(plan, run, stop_on_signals());
  shard.run(run.threads);
  BatchOutcome outcome = shard.outcome();
  outcome.seconds = seconds_since(start);
  return outcome;
}

}  // namespace welkin::tool
