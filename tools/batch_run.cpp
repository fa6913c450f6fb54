// Carries out a shard of a batch: what is not there is baked, many at a time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <iomanip>
#include <iostream>
#include <locale>
#include <new>
#include <set>
#include <sstream>
#include <stop_token>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "embedded_texts.h"
#include "jobs/tiles.h"
#include "platform/text.h"
#include "tools/bake_manifest.h"
#include "tools/batch.h"
#include "tools/commands.h"
#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// "2026-11-25T20:45:56.123Z": the time of day everywhere, of the system's clock.
std::string time_now() {
  namespace chrono = std::chrono;
  const auto now = chrono::floor<chrono::milliseconds>(chrono::system_clock::now());
  const auto today = chrono::floor<chrono::days>(now);
  const chrono::year_month_day date(today);
  const chrono::hh_mm_ss time(now - today);
  std::ostringstream text;
  text.imbue(std::locale::classic());
  const auto add = [&](long number, int width, char behind) {
    text << std::setw(width) << std::setfill('0') << number << behind;
  };
  add(static_cast<int>(date.year()), 4, '-');
  add(static_cast<long>(static_cast<unsigned>(date.month())), 2, '-');
  add(static_cast<long>(static_cast<unsigned>(date.day())), 2, 'T');
  add(time.hours().count(), 2, ':');
  add(time.minutes().count(), 2, ':');
  add(time.seconds().count(), 2, '.');
  add(time.subseconds().count(), 3, 'Z');
  return text.str();
}

/// What is done with a job.
struct Task {
  std::size_t job;  ///< in the plan
  bool verifies;    ///< a result that is there is computed once more
};

/// Returns which shard computes a job's result once more, if any does: another than the one that does the job, where
/// there is another. By a hash of what the plan says of the job.
std::optional<std::size_t> verifier_of(const BatchJob& job, std::size_t shard, std::size_t shards, double share) {
  constexpr double kHashes = 18446744073709551616.0;  // 2^64
  const ContentHash hash = hash_of_job(job);
  if (!(static_cast<double>(hash.high) < share * kHashes)) return std::nullopt;
  if (shards == 1) return shard;
  return (shard + 1 + static_cast<std::size_t>(hash.low % (shards - 1))) % shards;
}

/// Returns the shard's own jobs, and then results of others that it verifies. Each costliest first.
std::vector<Task> tasks_of(const BatchPlan& plan, const BatchRun& run) {
  const std::vector<std::vector<std::size_t>> cut = cut_batch(plan, run.shard.count);
  const auto own = static_cast<std::size_t>(run.shard.number - 1);
  std::vector<Task> tasks;
  for (const std::size_t job : cut[own]) tasks.push_back({job, false});
  const auto before = static_cast<std::ptrdiff_t>(tasks.size());
  for (std::size_t shard = 0; shard < cut.size() && run.verify > 0.0; ++shard) {
    for (const std::size_t job : cut[shard]) {
      if (verifier_of(plan.jobs[job], shard, cut.size(), run.verify) == own) tasks.push_back({job, true});
    }
  }
  std::ranges::stable_sort(tasks.begin() + before, tasks.end(), std::ranges::greater{},
                           [&](const Task& task) { return plan.jobs[task.job].seconds; });
  return tasks;
}

/// "specular.ktx2, sh.json": files that are not in both lists, or have other bytes.
std::string differing(const ResultFiles& listed, const ResultFiles& made) {
  std::set<std::string> names;
  for (const auto& [all, others] : {std::pair(&listed, &made), std::pair(&made, &listed)}) {
    for (const ResultFile& file : *all) {
      if (std::ranges::find(*others, file) == others->end()) names.insert(file.name);
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// A shard at work. Tasks are given out in their order, as long as there are threads and memory for them. Most run on
/// one thread, side by side, which wastes none. One that is more than its share of all that is left, or beside which no
/// others have room, gets more, so that no thread is idle at the end.
class ShardRun {
 public:
  ShardRun(const BatchPlan& plan, const BatchRun& run, std::stop_token stop)
      : plan_(plan),
        run_(run),
        tasks_(tasks_of(plan, run)),
        stop_(std::move(stop)),
        store_(run.results),
        report_(run.results, run.shard) {}

  /// Throws what stopped it.
  BatchOutcome run() {
    const WithoutStages quiet;
    {
      const std::stop_callback stopping(stop_, [this] { changed_.notify_all(); });
      std::vector<std::thread> workers;
      try {
        for (int i = 1; i < run_.threads; ++i) workers.emplace_back([this] { work(); });
      } catch (const std::system_error&) {  // there are fewer, then
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
    outcome_.report = report_.file();
    std::ranges::sort(outcome_.troubles, {}, &JobRecord::index);
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
    // Its share of what is left to do, itself included.
    const double share = seconds_left_ > 0.0 ? job.seconds / seconds_left_ : 1.0;
    const auto by_share = static_cast<int>(std::lround(share * run_.threads));
    // Of jobs like this so many fit side by side.
    const std::uint64_t beside = std::max<std::uint64_t>(1, run_.memory / std::max<std::uint64_t>(1, job.memory));
    const auto by_memory = run_.threads / static_cast<int>(std::min<std::uint64_t>(beside, 1'000'000));
    return std::clamp(std::max(by_share, by_memory), 1, run_.threads);
  }

  /// Waits until there are threads and memory for the next task. One that is alone may take more memory than there
  /// should be: its bake refuses that. Nothing when all are given out, or after a stop.
  std::optional<Turn> next() {
    std::unique_lock lock(mutex_);
    const auto over = [this] { return failure_ || stop_.stop_requested() || next_ == tasks_.size(); };
    const auto fits = [this] {
      const std::uint64_t memory = plan_.jobs[tasks_[next_].job].memory;
      return running_ == 0 ||
             (threads_busy_ < run_.threads && memory_busy_ <= run_.memory && memory <= run_.memory - memory_busy_);
    };
    // A signal may come between the look at it and the wait.
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

  /// Of one thread, until there is nothing left. What is wrong with a job is in the report; what is wrong with the
  /// folder of results ends the run.
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
    JobRecord record;
    record.job = hash_of_job(turn.job).text();
    record.index = turn.task.job;
    record.name = turn.job.name;
    record.threads = turn.threads;
    record.host = host_name();
    record.process = platform::process_number();
    record.start = time_now();
    const Clock::time_point start = Clock::now();
    bool is_told = true;
    try {
      BakeCommandOptions options = bake_options_of(plan_, turn.job.options);
      options.common.read.memory_limit_bytes = run_.memory;
      options.common.memory_option = "--memory";
      options.input = platform::utf8(plan_.place(turn.job.input));
      if (turn.task.verifies) {
        is_told = verify_result(turn.job, options, record);
      } else {
        make_result(turn.job, options, record);
      }
    } catch (const ResultStoreError&) {  // which is not the job's fault
      throw;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) return;  // it is not over
      record.error_code = name(error.code());
      record.error = error.what();
    } catch (const std::bad_alloc&) {
      record.error_code = name(ErrorCode::limit_exceeded);
      record.error = "not enough memory; pass a lower --memory or fewer --threads";
    }
    if (!record.error_code.empty()) record.state = JobState::failed;
    record.seconds = seconds_since(start);
    record.end = time_now();
    if (is_told) report_.add(record);
    note(turn.job, record, is_told);
  }

  void make_result(const BatchJob& job, BakeCommandOptions& options, JobRecord& record) {
    const ContentHash key = result_key_of(options, job);
    record.result = key.text();
    record.state = JobState::present;
    if (is_whole(store_.place(key))) return;
    const auto make = [&](const std::filesystem::path& folder) {
      options.directory = platform::utf8(folder);
      bake_files(options, {stop_, {}});
      // What was hashed before must be what was baked.
      if (result_key_of(options, job) == key) return;
      throw Error(ErrorCode::file_access, *options.input + ": changed while it was baked; run again");
    };
    if (store_.add(key, make)) record.state = JobState::computed;
  }

  /// Returns false if there is no result, and so nothing to verify.
  bool verify_result(const BatchJob& job, BakeCommandOptions& options, JobRecord& record) {
    std::filesystem::path result;
    try {
      result = store_.place(result_key_of(options, job));
    } catch (const Error&) {  // which the shard tells that does the job
      return false;
    }
    const std::optional<ResultFiles> listed = listed_in(result);
    if (!listed) return false;
    record.result = platform::utf8(result.filename());
    const ResultFiles made = store_.trial([&](const std::filesystem::path& folder) {
      options.directory = platform::utf8(folder);
      bake_files(options, {stop_, {}});
    });
    // The bytes that are there count, and not what is said of them.
    std::string names = differing(*listed, made);
    if (names.empty()) names = damaged_files(result, *listed);
    record.state = names.empty() ? JobState::verified : JobState::differs;
    if (!names.empty()) record.error = "differs when computed again: " + names;
    return true;
  }

  void note(const BatchJob& job, const JobRecord& record, bool is_told) {
    const std::scoped_lock lock(mutex_);
    ++done_;
    seconds_done_ += job.seconds;
    if (is_told) {
      ++outcome_.counts[record.state];
      if (record.state == JobState::failed || record.state == JobState::differs) outcome_.troubles.push_back(record);
    }
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
  const std::stop_token stop_;
  ResultStore store_;
  RunReport report_;
  const double all_seconds_ = predicted_seconds();
  const Clock::time_point start_ = Clock::now();
  const bool shows_progress_ = is_terminal(Stream::error) && verbosity() != Verbosity::quiet;

  std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::size_t next_ = 0;
  std::size_t done_ = 0;
  int running_ = 0;
  int threads_busy_ = 0;
  std::uint64_t memory_busy_ = 0;
  double seconds_left_ = all_seconds_;  ///< of tasks that are not given out
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

std::string long_duration(double seconds) {
  constexpr long kMinute = 60;
  constexpr long kHour = 60 * kMinute;
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < kMinute) return std::to_string(whole) + " s";
  if (whole < kHour) return std::to_string(whole / kMinute) + " min " + std::to_string(whole % kMinute) + " s";
  return std::to_string(whole / kHour) + " h " + std::to_string(whole % kHour / kMinute) + " min";
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kIndexName = "index.json";
constexpr const char* kPageName = "index.html";
constexpr const char* kIndexSchema = "welkin batch index";

struct Merged {
  fs::path folder;
  ResultFiles files;
  std::string problem;      ///< why the result is not in order; empty: it is
  bool is_missing = false;  ///< it is not there, or its input cannot be read; else a problem is that it is damaged
};

Merged check_job(const BatchPlan& plan, const BatchJob& job, const fs::path& results) {
  Merged merged;
  try {
    const std::string key = result_key_of(plan, job).text();
    merged.folder = results / key;
    std::error_code unknown;
    merged.is_missing = !fs::exists(merged.folder, unknown);
    const std::optional<ResultFiles> files = listed_in(merged.folder);
    if (files) {
      merged.files = *files;
      const std::string names = damaged_files(merged.folder, *files);
      if (!names.empty()) merged.problem = key + ": damaged: " + names + "; remove the folder, and run again";
    } else {
      merged.problem = merged.is_missing ? "missing result " + key : key + ": its result.json is damaged";
    }
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    merged.is_missing = true;
    merged.problem = error.what();
  }
  return merged;
}

std::vector<Merged> check_jobs(const BatchPlan& plan, const fs::path& results, int threads, const Control& control) {
  std::vector<Merged> merged(plan.jobs.size());
  run_with_threads(threads, [&] {
    const jobs::Placement where = jobs::Placement::arena;
    jobs::run_tiles(plan.jobs.size(), where, jobs::worker_count(where), control,
                    [&](std::size_t job, std::size_t) { merged[job] = check_job(plan, plan.jobs[job], results); });
  });
  return merged;
}

/// Returns a path as a link in a file of `folder`.
std::string link_from(const fs::path& folder, const fs::path& to) {
  std::error_code unknown;
  const fs::path from = fs::weakly_canonical(fs::absolute(folder, unknown), unknown);
  const fs::path target = fs::weakly_canonical(fs::absolute(to, unknown), unknown);
  std::string link = platform::utf8(target.lexically_proximate(from));
  if constexpr (fs::path::preferred_separator != '/') {
    std::ranges::replace(link, static_cast<char>(fs::path::preferred_separator), '/');
  }
  return link;
}

/// Adds what the page says of a bake: its source and its mips, as its manifest has them.
void add_figures(const fs::path& result, Json& job) {
  try {
    const Json manifest = read_json_file(result / kManifestName, "");
    if (!manifest.is_object()) return;
    for (const auto& [name, value] : manifest.members()) {
      if (name == "source" || name == "specular") job[name] = value;
    }
  } catch (const Error&) {  // the page does without
  } catch (const Flaw&) {
  }
}

void write_index(const BatchPlan& plan, const std::vector<Merged>& merged, const ContentHash& hash, std::size_t missing,
                 const fs::path& folder) {
  std::error_code trouble;
  fs::create_directories(folder, trouble);
  if (trouble) {
    throw Error(ErrorCode::file_access, platform::utf8(folder) + ": cannot be created (" + trouble.message() +
                                            "); pass a folder that you may write to");
  }
  Json jobs = Json::array();
  Json figures = Json::array();
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    Json job = {{"name", plan.jobs[i].name}, {"input", plan.jobs[i].input}};
    if (merged[i].is_missing) {
      job["missing"] = merged[i].problem;
    } else {
      job["result"] = link_from(folder, merged[i].folder);
      job["hash"] = hash_of(merged[i].files).text();
      job["files"] = json_of(merged[i].files);
    }
    jobs.push_back(job);
    if (!merged[i].is_missing) add_figures(merged[i].folder, job);
    figures.push_back(job);
  }
  Json index = {{"schema", kIndexSchema}, {"version", 1},       {"welkin", WELKIN_VERSION_STRING},
                {"hash", hash.text()},    {"missing", missing}, {"jobs", jobs}};
  write_text_file(folder / kIndexName, json_text(index));
  index["plan"] = platform::utf8(plan.file.filename());
  index["jobs"] = figures;
  std::string safe;  // in a script nothing may look like its end
  for (const char c : index.one_line()) safe += c == '<' ? "\\u003c" : std::string(1, c);
  constexpr std::string_view kPlace = "INDEX";
  std::string page = embedded_text("batch.html");
  write_text_file(folder / kPageName, page.replace(page.find(kPlace), kPlace.size(), safe));
}

}  // namespace

void merge_batch(const BatchPlan& plan, const fs::path& results, const fs::path& folder, int threads,
                 bool allow_missing, bool as_json) {
  require_own(folder / kIndexName, kIndexSchema, "batch merge");
  require_own(folder / kPageName, "<title>Welkin batch</title>", "batch merge");
  std::vector<Merged> merged;
  {
    ProgressBar bar;
    merged = check_jobs(plan, results, threads, bar.control());
  }
  std::vector<ContentHash> hashes;  // of all results in the order of the plan; a missing one has no files
  std::string problems;
  std::size_t missing = 0;
  std::size_t damaged = 0;
  for (std::size_t i = 0; i < merged.size(); ++i) {
    hashes.push_back(hash_of(merged[i].files));
    if (merged[i].problem.empty()) continue;
    ++(merged[i].is_missing ? missing : damaged);
    problems += '\n' + plan.jobs[i].name + ": " + merged[i].problem;
  }
  if (damaged > 0 || (missing > 0 && !allow_missing)) {
    throw Error(ErrorCode::corrupt_file, counted(damaged + missing, "result") + " of " + std::to_string(merged.size()) +
                                             (damaged + missing == 1 ? " is" : " are") + " missing or damaged" +
                                             (damaged == 0 ? "; --allow-missing merges the others" : "") + problems);
  }
  const ContentHash hash = combine(hashes);
  write_index(plan, merged, hash, missing, folder);
  if (as_json) return print_result(json_text({{"jobs", merged.size()}, {"missing", missing}, {"hash", hash.text()}}));
  print_summary(counted(merged.size() - missing, "result") + " in order; the batch's hash is " + hash.text() +
                (missing > 0 ? "\nnote: " + counted(missing, "result") + " missing" + printable_lines(problems) : "") +
                "\nindex: " + platform::utf8(folder / kIndexName) + ", " + platform::utf8(folder / kPageName) + '\n');
}

}  // namespace welkin::tool
