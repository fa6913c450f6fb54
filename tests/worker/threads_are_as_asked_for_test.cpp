// Promise: a worker's threads are as many as asked for, with the name and the priority that they should have, and
// nobody else's: the engine's threads stay out of its work, and its threads out of theirs.
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/process_threads.h"
#include "welkin/worker.h"

namespace welkin::test {
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

/// Threads give themselves their names once they run.
bool has_threads(const std::string& name, std::size_t count) {
  return eventually([&] { return threads_named(name).size() == count; });
}

/// One number for each thread on which a request runs, all of them at work at once.
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
  for (auto& job : jobs) threads.insert(take(job.future()));
  return threads;
}

}  // namespace

TEST_CASE("a worker has as many threads as it was asked for, all at work at once", "[worker]") {
  for (const int count : {1, 2, 5}) {
    WorkerOptions options = options_with(count);
    options.name = "count";
    Worker worker(options);
    CHECK(worker.threads() == count);
    CHECK(has_threads("count", static_cast<std::size_t>(count)));
    CHECK(threads_at_work(worker, count) == threads_named("count"));
  }
}

TEST_CASE("by default a worker has one thread less than the process may use", "[worker]") {
  const Worker worker;
  CHECK(worker.threads() == std::max(1, available_threads() - 1));
}

TEST_CASE("threads have the worker's name and a number", "[worker]") {
  WorkerOptions options = options_with(2);
  options.name = "sky light";
  const Worker worker(options);
  CHECK(has_threads("sky light", 2));

  // Linux keeps 15 characters: the number must be among them, or the threads could not be told apart.
  options.name = "a name longer than fifteen characters";
  const Worker long_named(options);
  CHECK(has_threads("a name longer", 2));
  std::set<std::string> names;
  for (const int thread : threads_named("a name longer")) names.insert(thread_name(thread));
  CHECK(names.size() == 2);

  const Worker unnamed;
  CHECK(has_threads("welkin", static_cast<std::size_t>(unnamed.threads())));
}

TEST_CASE("threads have the priority that they were asked to have", "[worker]") {
  const int own_nice = getpriority(PRIO_PROCESS, static_cast<id_t>(this_thread_number()));
  for (const ThreadPriority priority : {ThreadPriority::idle, ThreadPriority::below, ThreadPriority::normal}) {
    WorkerOptions options = options_with(2);
    options.thread_priority = priority;
    options.name = "ranked";
    Worker worker(options);
    CHECK(has_threads("ranked", 2));
    for (const int thread : threads_at_work(worker, 2)) {
      const int policy = sched_getscheduler(thread);
      const int nice = getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
      if (priority == ThreadPriority::idle) CHECK(policy == SCHED_IDLE);
      if (priority != ThreadPriority::idle) CHECK(policy == sched_getscheduler(0));
      if (priority == ThreadPriority::below) CHECK(nice == std::min(19, own_nice + 10));
      if (priority == ThreadPriority::normal) CHECK(nice == own_nice);
    }
  }
  CHECK(getpriority(PRIO_PROCESS, static_cast<id_t>(this_thread_number())) == own_nice);
}

TEST_CASE("the engine's threads and the worker's stay out of each other's work", "[worker]") {
  run_with_threads(3, [] {
    WorkerOptions options = options_with(2);
    options.name = "apart";
    Worker worker(options);
    CHECK(has_threads("apart", 2));
    const std::set<int> own = threads_named("apart");
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
    CHECK(std::includes(own.begin(), own.end(), in_worker.begin(), in_worker.end()));
    for (const int thread : in_engine) CHECK(own.count(thread) == 0);
  });
}

TEST_CASE("a worker's threads help with each other's tiles", "[worker]") {
  Worker worker(options_with(2));
  std::atomic<int> inside{0};
  std::atomic<int> most{0};
  auto job = worker.post([&](const Control&) {
    // Ends when two tasks were inside at once: with a sole helper it would go on for ever.
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

}  // namespace welkin::test
