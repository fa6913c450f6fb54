// Jobs that wait for other jobs of their worker.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "support/catch.h"
#include "support/jobs.h"
#include "support/trials.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: a job may wait for another job of its worker by `get()`, however few threads there are: what is waited for
// is run by the thread that waits.

namespace {

/// A request that waits for one that waits for one ...: `depth` of them.
int nest(Worker& worker, int depth) {
  if (depth == 0) return 1;
  return 1 + worker.post([&worker, depth](const Control&) { return nest(worker, depth - 1); }).get();
}

/// Of its own thread, several threads, an arena that is lent.
std::vector<WorkerOptions> kinds_of_workers(tbb::task_arena& arena) {
  return {options_with(1), options_with(2), options_with(4), lent(arena)};
}

}  // namespace

TEST_CASE("waiting jobs may be nested", "[worker]") {
  tbb::task_arena arena(1);
  for (const WorkerOptions& options : kinds_of_workers(arena)) {
    Worker worker(options);
    for (const int depth : {3, 8}) {
      auto job = worker.post([&worker, depth](const Control&) { return nest(worker, depth); });
      CHECK(take(job) == depth + 1);
    }
  }
}

TEST_CASE("a job of the lowest priority behind many others may be waited for", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([&](const Control&) {
    for (int k = 0; k < 50; ++k) post_value(worker, k, {.priority = TaskPriority::high});
    return post_value(worker, 7, {.priority = TaskPriority::low}).get();
  });
  CHECK(take(job) == 7);
}

TEST_CASE("all threads may wait at once", "[worker]") {
  tbb::task_arena arena(1);
  for (const WorkerOptions& options : kinds_of_workers(arena)) {
    Worker worker(options);
    std::vector<Job<int>> jobs;
    for (int k = 0; k < 12; ++k) {
      jobs.push_back(worker.post([&worker, k](const Control&) { return post_value(worker, k).get(); }));
    }
    for (int k = 0; k < 12; ++k) CHECK(take(jobs[static_cast<std::size_t>(k)]) == k);
  }
}

TEST_CASE("a job may be waited for inside a TBB task of the worker's arena", "[worker]") {
  for (const int threads : {1, 2, 3}) {
    Worker worker(options_with(threads));
    auto job = worker.post([&](const Control&) {
      std::atomic<int> sum{0};
      tbb::parallel_for(0, 20, [&](int k) { sum += post_value(worker, k).get(); });
      return sum.load();
    });
    CHECK(take(job) == 190);
  }
}

TEST_CASE("tasks of one job may wait for another job whose tasks run beside them", "[worker][slow]") {
  // Who waits for its own tasks must not pick up one that waits for it.
  Worker worker(options_with(3));
  for (int round = 0; round < (kSanitized ? 20 : 100); ++round) {
    auto waited_for = worker.post([round](const Control&) {
      tbb::parallel_for(0, 12, [](int) {
        for (int k = 0; k < 20; ++k) std::this_thread::yield();
      });
      return round;
    });
    auto waiting = worker.post([&waited_for, round](const Control&) {
      std::atomic<int> sum{0};
      tbb::parallel_for(0, 12, [&](int k) { sum += k == round % 12 ? waited_for.get() : 1; });
      return sum.load();
    });
    CHECK(take(waiting) == 11 + round);
  }
}

TEST_CASE("continuations, and those who wait for them, need no further thread", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([&](const Control&) {
    return post_value(worker, 3).then([&](int value) { return value + post_value(worker, 4).get(); }).get();
  });
  CHECK(take(job) == 7);
  auto follower = post_value(worker, 1).then([&](int value) { return value + post_value(worker, 10).get(); });
  CHECK(take(follower) == 11);
}

TEST_CASE("what follows a running job is run by whoever waits for it, if all threads wait", "[worker]") {
  Worker worker(options_with(2));
  Gate gate;
  auto first = worker.post([&](const Control&) {
    gate.pass();
    return 5;
  });
  gate.wait_for_arrivals(1);
  auto second = std::move(first).then([](int value) { return value + 1; });
  // One waits for the continuation while the first job runs. Once that is done, its thread starts the other, which goes
  // before the continuation for its priority and waits until that has been run: by nobody else than the first waiter.
  std::atomic<bool> taken{false};
  auto waiting = worker.post([&](const Control&) {
    const int value = second.get();
    taken = true;
    return value;
  });
  CHECK(eventually([&] { return worker.load().running == 2; }));
  auto blocking = worker.post([&](const Control&) { return eventually([&] { return taken.load(); }); },
                              {.priority = TaskPriority::high});
  gate.open();
  CHECK(take(waiting) == 6);
  CHECK(take(blocking));
}

TEST_CASE("a waiting job can be given up by ending the worker", "[worker]") {
  std::string inner_end;
  Job<void> outer;
  {
    Worker worker(options_with(1));
    Gate gate;
    outer = worker.post([&](const Control&) {
      auto inner = worker.post([&](const Control& control) {
        gate.pass();
        run_until_stopped(control);
      });
      inner_end = outcome_of([&] { inner.get(); });
    });
    gate.wait_for_arrivals(1);
    gate.open();
    worker.terminate();
  }
  CHECK(outcome(outer) == "stopped");
  CHECK(inner_end == "stopped");
}

TEST_CASE("requests may wait for each other in a row", "[worker]") {
  Worker worker(options_with(3));
  for (int round = 0; round < (kSanitized ? 20 : 200); ++round) {
    auto first = post_value(worker, 1);
    auto second = worker.post([&](const Control&) { return first.get() + 1; });
    auto third = worker.post([&](const Control&) { return second.get() + 1; });
    auto fourth = worker.post([&](const Control&) { return third.get() + 1; });
    CHECK(take(fourth) == 4);
  }
}

}  // namespace welkin::test
