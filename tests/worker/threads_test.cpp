// A worker's threads: its own, or those of a lent arena.
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include "support/catch.h"
#include "support/heap.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "welkin/worker.h"
#include "worker/scheduler.h"

namespace welkin::test {

// Promise: a worker has the requested number of threads with the requested name and priority, and shares none of them:
// the engine's threads stay out of its work, and its threads out of theirs.

namespace {

int this_thread_number() { return static_cast<int>(syscall(SYS_gettid)); }

/// The worker's own threads: its name, then a number.
std::set<int> threads_named(const std::string& name) {
  std::set<int> threads;
  for (const int thread : process_threads()) {
    const std::string full = thread_name(thread);
    if (full.rfind(name, 0) != 0 || full.size() == name.size()) continue;
    const std::string rest = full.substr(name.size());
    if (std::all_of(rest.begin(), rest.end(), [](unsigned char c) { return std::isdigit(c) != 0 || c == ' '; })) {
      threads.insert(thread);
    }
  }
  return threads;
}

/// Waits, because threads set their names once they run.
bool has_threads(const std::string& name, std::size_t count) {
  return eventually([&] { return threads_named(name).size() == count; });
}

/// Returns one number per thread on which a request runs, all of them at work at once.
std::set<int> threads_at_work(Worker& worker, int count) {
  Gate gate;
  std::vector<Job<int>> jobs;
  for (int k = 0; k < count; ++k) {
    jobs.push_back(worker.post([&gate](const Control&) {
      gate.pass();
      return this_thread_number();
    }));
  }
  gate.wait_for_arrivals(count);
  gate.open();
  std::set<int> threads;
  for (auto& job : jobs) threads.insert(take(job));
  return threads;
}

struct Seven {
  int operator()(const Control&) const { return 7; }
};

Detached await_seven(Worker& worker, std::atomic<int>& sum) {
  auto job = worker.post(Seven{});
  sum += co_await std::move(job).drained();
}

/// Posts jobs of all kinds from this thread, drains them on it, and keeps nothing.
void post_everything(Worker& worker, std::atomic<int>& sum) {
  const std::string key = "a key that is too long to be kept inside a string";
  worker.post([&](const Control&) { ++sum; });
  worker.post([&](const Control&) { ++sum; }, {.key = key});  // replaces the last round's if that still waits
  for (int round = 0; round < 2; ++round) worker.post(Seven{}).on_drain([&](Job<int> job) { sum += job.get(); });
  static_cast<void>(worker.post(Seven{}).then([&](int value) { sum += value; }));
  worker.post(Seven{}).cancel();
  await_seven(worker, sum);
  worker.drain();
}

}  // namespace

// Promise: no thread of the worker frees what a post allocates, so that an engine's allocations never contend in the
// system's allocator with a thread of the worker, which may have been descheduled there.
TEST_CASE("no thread of a worker frees what a posting thread has allocated", "[jobs][worker]") {
  tbb::task_arena arena(2);
  WorkerOptions two_threads{.threads = 2};
  for (const WorkerOptions& options : {two_threads, lent(arena)}) {
    INFO((options.executor ? "an executor" : "threads of its own"));
    std::atomic<int> sum{0};
    Worker worker(options);
    const ForeignFrees foreign;
    for (int round = 0; round < 200; ++round) post_everything(worker, sum);
    worker.wait_until_idle();
    worker.drain();
    CHECK(foreign.count() == 0);
    CHECK(sum > 200 * 4);
  }
}

TEST_CASE("the memory of jobs that is kept has a bound, however often threads meet", "[worker]") {
  detail::give_back_job_memory();
  const HeapWatch heap;
  constexpr std::size_t kBytes = 64;
  constexpr int kPairs = 1'000'000;
  const auto take_and_put = [] {
    for (int pair = 0; pair < kPairs; ++pair) {
      void* const first = detail::allocate_job_memory(kBytes);
      void* const second = detail::allocate_job_memory(kBytes);
      detail::free_job_memory(first, kBytes);
      detail::free_job_memory(second, kBytes);
    }
  };
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread) threads.emplace_back(take_and_put);
  threads.clear();
  constexpr long kMaxKept = 8192;
  constexpr long kWithMallocsOwn = 2 * kBytes;  // a block's, generously
  CHECK(heap.peak_bytes() < (kMaxKept + 1000) * kWithMallocsOwn);
}

TEST_CASE("a worker has as many threads as it was asked for, all at work at once", "[worker]") {
  for (const int count : {1, 2, 5}) {
    Worker worker(options_with(count, {.name = "count"}));
    CHECK(worker.threads() == count);
    CHECK(has_threads("count", static_cast<std::size_t>(count)));
    CHECK(threads_at_work(worker, count) == threads_named("count"));
  }
}

TEST_CASE("threads have the worker's name and a number", "[worker]") {
  const Worker worker(options_with(2, {.name = "sky light"}));
  CHECK(has_threads("sky light", 2));

  // Linux keeps 15 characters: the number must be among them, or threads could not be distinguished.
  const Worker long_named(options_with(2, {.name = "a name longer than fifteen characters"}));
  CHECK(has_threads("a name longer", 2));
  std::set<std::string> names;
  for (const int thread : threads_named("a name longer")) names.insert(thread_name(thread));
  CHECK(names.size() == 2);

  const Worker unnamed;
  CHECK(has_threads("welkin", static_cast<std::size_t>(unnamed.threads())));
}

TEST_CASE("threads have the priority that they were asked to have", "[worker][slow]") {
  CHECK(WorkerOptions().thread_priority == ThreadPriority::below_normal);
  const int own_nice = getpriority(PRIO_PROCESS, static_cast<id_t>(this_thread_number()));
  for (const ThreadPriority priority : {ThreadPriority::idle, ThreadPriority::below_normal, ThreadPriority::normal}) {
    Worker worker({.threads = 2, .thread_priority = priority, .name = "ranked"});
    CHECK(has_threads("ranked", 2));
    for (const int thread : threads_at_work(worker, 2)) {
      const int policy = sched_getscheduler(thread);
      const int nice = getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
      if (priority == ThreadPriority::idle) CHECK(policy == SCHED_IDLE);
      if (priority != ThreadPriority::idle) CHECK(policy == sched_getscheduler(0));
      if (priority == ThreadPriority::below_normal) CHECK(nice == std::min(19, own_nice + 10));
      if (priority == ThreadPriority::normal) CHECK(nice == own_nice);
    }
  }
  CHECK(getpriority(PRIO_PROCESS, static_cast<id_t>(this_thread_number())) == own_nice);
}

TEST_CASE("the engine's threads and the worker's stay out of each other's work", "[worker]") {
  run_with_threads(3, [] {
    Worker worker(options_with(2, {.name = "apart"}));
    CHECK(has_threads("apart", 2));
    const std::set<int> of_worker = threads_named("apart");
    std::mutex mutex;
    std::set<int> in_worker;
    std::set<int> in_engine;
    const auto work_into = [&mutex](std::set<int>& threads) {
      tbb::parallel_for(0, 300, [&](int) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(20);
        while (std::chrono::steady_clock::now() < end) {
        }
        const std::scoped_lock lock(mutex);
        threads.insert(this_thread_number());
      });
    };
    std::vector<Job<void>> jobs;
    for (int k = 0; k < 10; ++k) jobs.push_back(worker.post([&](const Control&) { work_into(in_worker); }));
    while (!jobs.back().ready()) work_into(in_engine);
    for (auto& job : jobs) CHECK(outcome(job) == "result");
    CHECK(std::includes(of_worker.begin(), of_worker.end(), in_worker.begin(), in_worker.end()));
    for (const int thread : in_engine) CHECK(of_worker.count(thread) == 0);
  });
}

TEST_CASE("a worker's threads help with each other's tiles", "[worker]") {
  Worker worker(options_with(2));
  std::atomic<int> inside{0};
  std::atomic<int> most{0};
  auto job = worker.post([&](const Control&) {
    // Ends once two tasks were inside at the same time; with a single helper it would never end.
    tbb::parallel_for(0, 1000, [&](int) {
      const int now = ++inside;
      int before = most;
      while (now > before && !most.compare_exchange_weak(before, now)) {
      }
      const auto end = std::chrono::steady_clock::now() + kPatience;
      while (most < 2 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
      --inside;
    });
  });
  CHECK(outcome(job) == "result");
  CHECK(most >= 2);
}

// Promise: a worker can work on an engine's threads, however these schedule its tasks.

namespace {

/// An engine that runs tasks when the test calls `run_all`.
class LateExecutor final : public Executor {
 public:
  explicit LateExecutor(int concurrency = 3) : concurrency_(concurrency) {}

  [[nodiscard]] int concurrency() const noexcept override { return concurrency_; }
  void enqueue(void (*run)(void* job), void* job) override {
    const std::scoped_lock lock(mutex_);
    tasks_.emplace_back(run, job);
    most_ = std::max(most_, tasks_.size());
  }

  /// Runs all queued tasks, including those that are added meanwhile.
  void run_all() {
    for (;;) {
      std::pair<void (*)(void*), void*> task;
      {
        const std::scoped_lock lock(mutex_);
        if (tasks_.empty()) return;
        task = tasks_.front();
        tasks_.pop_front();
      }
      task.first(task.second);
    }
  }

  /// Returns the largest number of tasks that were queued at once.
  [[nodiscard]] std::size_t most() {
    const std::scoped_lock lock(mutex_);
    return most_;
  }

 private:
  int concurrency_;
  std::mutex mutex_;
  std::deque<std::pair<void (*)(void*), void*>> tasks_;
  std::size_t most_ = 0;
};

/// An executor that calls a function of the test.
class FunctionExecutor final : public Executor {
 public:
  using Function = std::function<void(void (*run)(void*), void* job)>;
  explicit FunctionExecutor(Function function) : function_(std::move(function)) {}

  [[nodiscard]] int concurrency() const noexcept override { return 2; }
  void enqueue(void (*run)(void* job), void* job) override { function_(run, job); }

 private:
  Function function_;
};

}  // namespace

TEST_CASE("a lent arena does the work", "[worker][slow]") {
  for (const int slots : {1, 3}) {
    tbb::task_arena arena(slots);
    const std::set<int> before = process_threads();
    WorkerOptions options = lent(arena);
    options.name = "of the worker";  // oneTBB's threads have the program's name
    Worker worker(options);
    CHECK(worker.threads() == slots);
    auto width = worker.post([](const Control&) { return tbb::this_task_arena::max_concurrency(); });
    CHECK(take(width) == std::max(slots, 2));  // oneTBB gives one for enqueued tasks to an arena of one

    auto chain = worker.post([](const Control&) { return 1; }).then([](int value) { return value + 1; });
    CHECK(take(chain) == 2);
    int drained = 0;
    worker.post([](const Control&) { return 3; }).on_drain([&](Job<int> job) { drained = job.get(); });
    worker.wait_until_idle();
    CHECK(worker.drain() == 1);
    CHECK(drained == 3);
    for (const int thread : threads_since(before)) CHECK(thread_name(thread).rfind("of the worker", 0) != 0);
  }
}

TEST_CASE("a worker ends without the tasks that nobody called, lets go of the executor, and late calls do nothing",
          "[worker]") {
  const auto engine = std::make_shared<LateExecutor>();
  { const Worker first(lent(engine)); }
  const std::set<int> before = process_threads();
  std::vector<Job<int>> jobs;
  std::atomic<int> runs{0};
  {
    Worker worker(lent(engine));
    for (int k = 0; k < 10; ++k) {
      jobs.push_back(worker.post([&runs, k](const Control&) {
        ++runs;
        return k;
      }));
    }
    CHECK(engine.use_count() == 2);
    worker.terminate();
    CHECK(engine.use_count() == 1);
    jobs.push_back(post_value(worker, 1));
  }
  for (auto& job : jobs) CHECK(outcome(job) == "stopped");
  engine->run_all();
  CHECK(runs == 0);
  CHECK(eventually([&] { return threads_since(before).empty(); }));
}

TEST_CASE("a task may be called inside the call that lends it", "[worker]") {
  Worker worker(lent(std::make_shared<FunctionExecutor>([](void (*run)(void*), void* job) { run(job); })));
  for (int k = 0; k < 10; ++k) {
    auto job = worker.post([k](const Control&) { return k; }).then([](int value) { return value + 1; });
    CHECK(take(job) == k + 1);
  }
}

TEST_CASE("a task may be called by any thread, several at once", "[worker]") {
  const auto engine = std::make_shared<LateExecutor>();
  Worker worker(lent(engine));
  std::vector<Job<int>> jobs;
  for (int k = 0; k < 200; ++k) jobs.push_back(worker.post([k](const Control&) { return k; }));
  std::atomic<bool> done{false};
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      while (!done) {
        engine->run_all();
        std::this_thread::yield();
      }
    });
  }
  for (int k = 0; k < 200; ++k) CHECK(take(jobs[static_cast<std::size_t>(k)]) == k);
  done = true;
  for (std::thread& thread : threads) thread.join();
}

TEST_CASE("an engine never has more tasks than it runs at once", "[worker]") {
  for (const int concurrency : {1, 2, 5}) {
    const auto engine = std::make_shared<LateExecutor>(concurrency);
    Worker worker(lent(engine));
    CHECK(worker.threads() == concurrency);
    std::vector<Job<int>> jobs;
    for (int k = 0; k < 20; ++k) {
      jobs.push_back(worker.post([k](const Control&) { return k; }).then([](int value) { return value; }));
    }
    engine->run_all();
    for (int k = 0; k < 20; ++k) CHECK(take(jobs[static_cast<std::size_t>(k)]) == k);
    CHECK(engine->most() == static_cast<std::size_t>(concurrency));
  }
}

TEST_CASE("an engine that refuses tasks leaves no job without a result or an error", "[worker]") {
  const auto engine = std::make_shared<LateExecutor>();
  for (const int accepted : {0, 1, 2}) {  // of three
    INFO(accepted);
    int calls = 0;
    Worker worker(lent(std::make_shared<FunctionExecutor>([&](void (*run)(void*), void* job) {
      if (calls++ % 3 >= accepted) throw std::runtime_error("the engine is full");
      engine->enqueue(run, job);
    })));
    int results = 0;
    for (int round = 0; round < 4; ++round) {
      std::vector<Job<int>> jobs;
      for (int k = 0; k < 5; ++k) {
        jobs.push_back(worker.post([k](const Control&) { return k; }).then([](int value) { return value; }));
      }
      // A coroutine receives no error here and must resume all the same.
      auto resumed = std::make_shared<std::atomic<bool>>(false);
      const auto await = [](Job<int> job, std::shared_ptr<std::atomic<bool>> done) -> Detached {
        try {
          co_await std::move(job);
        } catch (const std::exception&) {
        }
        *done = true;
      };
      auto awaited = worker.post([](const Control&) { return 1; });
      await(std::move(awaited), resumed);
      engine->run_all();
      for (auto& job : jobs) {
        CHECK(job.ready());
        const std::string end = outcome(job);
        CHECK((end == "result" || end == "the engine is full"));
        results += end == "result" ? 1 : 0;
      }
      CHECK(*resumed);
    }
    CHECK((results > 0) == (accepted > 0));
    CHECK(worker.load().jobs == 0);
    CHECK(worker.load().bytes == 0);
  }
}

}  // namespace welkin::test
