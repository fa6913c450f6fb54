// Promise: a worker can do its work in an arena of the engine's, whatever that does with the tasks that it is given.
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/process_threads.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

WorkerOptions lent(std::function<void(std::function<void()>)> enqueue) {
  WorkerOptions options;
  options.lent_arena = std::move(enqueue);
  return options;
}

/// An engine that runs tasks when the test says so.
class LateArena {
 public:
  [[nodiscard]] WorkerOptions options() {
    return lent([this](std::function<void()> task) {
      const std::scoped_lock lock(mutex_);
      tasks_.push_back(std::move(task));
    });
  }

  /// Runs what is there and what comes while it does.
  void run_all() {
    while (auto task = next()) task();
  }

  std::size_t size() {
    const std::scoped_lock lock(mutex_);
    return tasks_.size();
  }

 private:
  std::function<void()> next() {
    const std::scoped_lock lock(mutex_);
    if (tasks_.empty()) return {};
    auto task = std::move(tasks_.front());
    tasks_.pop_front();
    return task;
  }

  std::mutex mutex_;
  std::deque<std::function<void()>> tasks_;
};

}  // namespace

TEST_CASE("a lent arena does the work", "[worker]") {
  for (const int slots : {1, 3}) {
    tbb::task_arena arena(slots);
    Worker worker(lent([&arena](std::function<void()> task) { arena.enqueue(std::move(task)); }));
    CHECK(worker.threads() == 0);
    auto width = worker.post([](const Control&) { return tbb::this_task_arena::max_concurrency(); });
    CHECK(take(width.future()) == std::max(slots, 2));  // oneTBB gives one for enqueued tasks to an arena of one

    const TestCubemap cubemap = make_cubemap(Content::random, 200, 3, 1);
    const Projection expected = project(cubemap.view());
    std::vector<Job<Projection>> jobs;
    for (int k = 0; k < 20; ++k) jobs.push_back(worker.post(ProjectCubemap{CubemapImage{200, cubemap.pixels}}));
    for (auto& job : jobs) CHECK(same_bits(take(job.future()), expected));

    auto chain = worker.post([](const Control&) { return 1; }).then([](int value) { return value + 1; });
    CHECK(take(chain.future()) == 2);
    int drained = 0;
    worker.post([](const Control&) { return 3; }).on_drain([&](std::future<int> future) { drained = future.get(); });
    worker.wait_until_idle();
    CHECK(worker.drain() == 1);
    CHECK(drained == 3);
  }
}

TEST_CASE("jobs in a lent arena can be given up, and the worker ended", "[worker]") {
  tbb::task_arena arena(1);
  std::vector<Job<int>> jobs;
  {
    Worker worker(lent([&arena](std::function<void()> task) { arena.enqueue(std::move(task)); }));
    auto gate = std::make_shared<Gate>();
    jobs.push_back(worker.post([gate](const Control& control) {
      gate->pass();
      while (!control.stop.stop_requested()) std::this_thread::yield();
      return 1;
    }));
    gate->wait_for_arrivals(1);
    for (int k = 0; k < 20; ++k) jobs.push_back(worker.post([k](const Control&) { return k; }));
    CHECK(jobs[5].cancel());
    CHECK(outcome(jobs[5]) == "cancelled");
    jobs.erase(jobs.begin() + 5);
    gate->open();
  }
  for (auto& job : jobs) CHECK(outcome(job) == "stopped");
}

TEST_CASE("a worker in a lent arena can be ended from its own jobs", "[worker]") {
  tbb::task_arena arena(2);
  for (const bool destroys : {false, true}) {
    auto worker =
        std::make_shared<Worker>(lent([&arena](std::function<void()> task) { arena.enqueue(std::move(task)); }));
    const std::weak_ptr<Worker> weak = worker;
    const auto gate = std::make_shared<Gate>();
    auto job = worker->post([worker, gate, destroys](const Control&) mutable {
      gate->pass();
      if (!destroys) worker->terminate();
      worker.reset();
    });
    gate->wait_for_arrivals(1);
    if (destroys) worker.reset();
    gate->open();
    CHECK(outcome(job) == "stopped");
    worker.reset();
    CHECK(eventually([&] { return weak.expired(); }));
  }
}

TEST_CASE("tasks may be called late", "[worker]") {
  LateArena arena;
  Worker worker(arena.options());
  std::vector<Job<int>> jobs;
  for (int k = 0; k < 10; ++k) jobs.push_back(worker.post([k](const Control&) { return k; }));
  CHECK(arena.size() >= 1);
  for (const auto& job : jobs) CHECK_FALSE(job.ready());
  CHECK(jobs[3].cancel());
  arena.run_all();
  for (int k = 0; k < 10; ++k) {
    auto& job = jobs[static_cast<std::size_t>(k)];
    REQUIRE(job.ready());
    if (k == 3) {
      CHECK(outcome(job) == "cancelled");
    } else {
      CHECK(job.get() == k);
    }
  }
  CHECK(worker.load().jobs == 0);
}

TEST_CASE("tasks that are called after the worker is gone do nothing", "[worker]") {
  LateArena arena;
  { const Worker first(arena.options()); }
  const std::set<int> before = process_threads();
  std::vector<Job<int>> jobs;
  std::atomic<int> runs{0};
  {
    Worker worker(arena.options());
    for (int k = 0; k < 10; ++k) {
      jobs.push_back(worker.post([&runs, k](const Control&) {
        ++runs;
        return k;
      }));
    }
  }
  for (auto& job : jobs) CHECK(outcome(job) == "stopped");
  arena.run_all();
  CHECK(runs == 0);
  CHECK(eventually([&] { return threads_since(before).empty(); }));
}

TEST_CASE("terminate does not wait for tasks that nobody calls", "[worker]") {
  LateArena arena;
  Worker worker(arena.options());
  auto job = worker.post([](const Control&) { return 1; });
  worker.terminate();
  CHECK(outcome(job) == "stopped");
  arena.run_all();
  CHECK(outcome(worker.post([](const Control&) { return 1; })) == "stopped");
}

TEST_CASE("a task may be called inside the call that lends it", "[worker]") {
  Worker worker(lent([](const std::function<void()>& task) { task(); }));
  for (int k = 0; k < 10; ++k) {
    auto job = worker.post([k](const Control&) { return k; }).then([](int value) { return value + 1; });
    CHECK(take(job.future()) == k + 1);
  }
}

TEST_CASE("a task may be called by any thread, several at once", "[worker]") {
  LateArena arena;
  Worker worker(arena.options());
  std::vector<Job<int>> jobs;
  for (int k = 0; k < 200; ++k) jobs.push_back(worker.post([k](const Control&) { return k; }));
  std::atomic<bool> done{false};
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&] {
      while (!done) {
        arena.run_all();
        std::this_thread::yield();
      }
    });
  }
  for (int k = 0; k < 200; ++k) CHECK(take(jobs[static_cast<std::size_t>(k)].future()) == k);
  done = true;
  for (std::thread& thread : threads) thread.join();
}

TEST_CASE("an arena that refuses a task now and then loses no job", "[worker]") {
  LateArena arena;
  std::atomic<int> calls{0};
  const auto enqueue = arena.options().lent_arena;
  Worker worker(lent([&](std::function<void()> task) {
    if (++calls % 2 == 1) throw std::runtime_error("the arena is full");
    enqueue(std::move(task));
  }));
  int refused = 0;
  std::vector<Job<int>> jobs;
  for (int k = 0; k < 20; ++k) {
    // Whether it is post that tells, or the future, or nobody because the task is offered again: no job hangs.
    const std::string end = outcome_of([&] { jobs.push_back(worker.post([k](const Control&) { return k; })); });
    if (end != "result") {
      CHECK(end == "the arena is full");
      ++refused;
    }
  }
  CHECK(eventually([&] {
    arena.run_all();
    return worker.load().jobs == 0;
  }));
  int results = 0;
  for (auto& job : jobs) {
    const std::string end = outcome(job);
    CHECK((end == "result" || end == "the arena is full"));
    results += end == "result" ? 1 : 0;
  }
  CHECK(results >= 1);
  CHECK(results + refused <= 20);
}

}  // namespace welkin::test
