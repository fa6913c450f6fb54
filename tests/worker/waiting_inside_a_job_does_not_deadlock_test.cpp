// Promise: a job may wait for another job of its worker, however few threads there are: somebody runs that one.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/same_bits.h"
#include "support/sanitized.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

Job<int> post(Worker& worker, int value, Priority priority = Priority::normal) {
  return worker.post([value](const Control&) { return value; }, {.priority = priority});
}

/// The value, through a plain future, which knows nothing of the worker, or through the job, which does.
int wait_for(Job<int> job, bool plainly) { return plainly ? job.future().get() : job.get(); }

/// A request that waits for one that waits for one ...: `depth` of them.
int nest(Worker& worker, int depth, bool plainly) {
  if (depth == 0) return 1;
  return 1 +
         wait_for(worker.post([&worker, depth, plainly](const Control&) { return nest(worker, depth - 1, plainly); }),
                  plainly);
}

}  // namespace

TEST_CASE("the only thread may wait for another job", "[worker]") {
  Worker worker(options_with(1));
  for (const bool plainly : {true, false}) {
    auto job = worker.post([&](const Control&) { return wait_for(post(worker, 7), plainly); });
    CHECK(take(job.future()) == 7);
  }
}

TEST_CASE("waiting jobs may be nested", "[worker]") {
  for (const int threads : {1, 2}) {
    Worker worker(options_with(threads));
    for (const bool plainly : {true, false}) {
      for (const int depth : {3, 8}) {
        auto job = worker.post([&worker, depth, plainly](const Control&) { return nest(worker, depth, plainly); });
        CHECK(take(job.future()) == depth + 1);
      }
    }
  }
}

TEST_CASE("a job of the lowest priority behind many others may be waited for", "[worker]") {
  Worker worker(options_with(1));
  for (const bool plainly : {true, false}) {
    auto job = worker.post([&](const Control&) {
      for (int k = 0; k < 50; ++k) post(worker, k, Priority::high);
      return wait_for(post(worker, 7, Priority::low), plainly);
    });
    CHECK(take(job.future()) == 7);
  }
}

TEST_CASE("all threads may wait at once", "[worker]") {
  for (const int threads : {1, 2, 4}) {
    Worker worker(options_with(threads));
    for (const bool plainly : {true, false}) {
      std::vector<Job<int>> jobs;
      for (int k = 0; k < 3 * threads; ++k) {
        jobs.push_back(
            worker.post([&worker, k, plainly](const Control&) { return wait_for(post(worker, k), plainly); }));
      }
      for (int k = 0; k < 3 * threads; ++k) CHECK(take(jobs[static_cast<std::size_t>(k)].future()) == k);
    }
  }
}

TEST_CASE("two jobs may wait for what a third party posts later", "[worker]") {
  Worker worker(options_with(2));
  std::array<std::promise<std::future<int>>, 2> later;
  std::vector<Job<int>> jobs;
  for (auto& promise : later) {
    jobs.push_back(worker.post([&promise](const Control&) { return promise.get_future().get().get(); }));
  }
  CHECK(eventually([&] { return worker.load().running == 2; }));
  for (auto& promise : later) promise.set_value(post(worker, 4).future());
  for (auto& job : jobs) CHECK(take(job.future()) == 4);
}

TEST_CASE("a future may be waited for inside a TBB task of the worker's arena", "[worker]") {
  for (const int threads : {1, 2, 3}) {
    Worker worker(options_with(threads));
    for (const bool plainly : {true, false}) {
      auto job = worker.post([&](const Control&) {
        std::atomic<int> sum{0};
        tbb::parallel_for(0, 20, [&](int k) { sum += wait_for(post(worker, k), plainly); });
        return sum.load();
      });
      CHECK(take(job.future()) == 190);
    }
  }
}

TEST_CASE("real work may be waited for inside a TBB task", "[worker]") {
  const TestCubemap cubemap =
      make_cubemap(Content::special_values, 200, 3, 1);  // large enough for TBB tasks of its own
  const Projection expected = project(cubemap.view());
  for (const int threads : {1, 2}) {
    Worker worker(options_with(threads));
    auto job = worker.post([&](const Control&) {
      std::atomic<int> wrong{0};
      tbb::parallel_for(0, 6, [&](int k) {
        auto inner = worker.post(ProjectCubemap{CubemapImage{200, cubemap.pixels}});
        if (!same_bits(k % 2 == 0 ? inner.get() : inner.future().get(), expected)) ++wrong;
      });
      return wrong.load();
    });
    CHECK(take(job.future()) == 0);
  }
}

TEST_CASE("tasks of one job may wait for another job whose tasks run beside them", "[worker]") {
  // Who waits for its own tasks must not pick up one that waits for it.
  Worker worker(options_with(3));
  for (int round = 0; round < (kSanitized ? 20 : 100); ++round) {
    auto waited_for = worker.post([round](const Control&) {
      tbb::parallel_for(0, 12, [](int) {
        for (int k = 0; k < 20; ++k) std::this_thread::yield();
      });
      return round;
    });
    const std::shared_future<int> future = waited_for.future().share();
    auto waiting = worker.post([future](const Control&) {
      std::atomic<int> sum{0};
      tbb::parallel_for(0, 12, [&](int) { sum += future.get(); });
      return sum.load();
    });
    CHECK(take(waiting.future()) == 12 * round);
  }
}

TEST_CASE("the arena's own futures may be waited for beside TBB's groups", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([&](const Control&) {
    tbb::task_group group;
    std::atomic<int> sum{0};
    for (int k = 0; k < 10; ++k) {
      group.run([&, k] { sum += wait_for(post(worker, k), k % 2 == 0); });
    }
    group.wait();
    return sum.load();
  });
  CHECK(take(job.future()) == 45);
}

TEST_CASE("continuations, and those who wait for them, need no further thread", "[worker]") {
  Worker worker(options_with(1));
  for (const bool plainly : {true, false}) {
    auto job = worker.post([&](const Control&) {
      return wait_for(post(worker, 3).then([&](int value) { return value + wait_for(post(worker, 4), plainly); }),
                      plainly);
    });
    CHECK(take(job.future()) == 7);
    auto follower = post(worker, 1).then([&](int value) { return value + wait_for(post(worker, 10), plainly); });
    CHECK(take(follower.future()) == 11);
  }
}

TEST_CASE("a job may wait for one that was posted before it", "[worker]") {
  Worker worker(options_with(1));
  for (const bool plainly : {true, false}) {
    std::optional<Hold> hold(std::in_place, worker);
    auto first = post(worker, 6, Priority::low);
    auto second =
        worker.post([&](const Control&) { return wait_for(std::move(first), plainly); }, {.priority = Priority::high});
    hold->let_go();
    CHECK(take(second.future()) == 6);
  }
}

TEST_CASE("a waiting job can be given up by ending the worker", "[worker]") {
  std::string inner_end;
  std::future<void> outer;
  {
    Worker worker(options_with(1));
    Gate gate;
    auto job = worker.post([&](const Control&) {
      auto inner = worker.post([&](const Control& control) {
        gate.pass();
        while (!control.stop.stop_requested()) std::this_thread::yield();
      });
      inner_end = outcome_of([&] { inner.future().get(); });
    });
    gate.wait_for_arrivals(1);
    gate.open();
    outer = job.future();
    worker.terminate();
  }
  CHECK(outcome(std::move(outer)) == "stopped");
  CHECK(inner_end == "stopped");
}

TEST_CASE("a lent arena whose only thread waits in a TBB task goes on", "[worker]") {
  for (const bool plainly : {true, false}) {
    tbb::task_arena arena(1);
    WorkerOptions options;
    options.lent_arena = [&arena](std::function<void()> task) { arena.enqueue(std::move(task)); };
    Worker worker(options);
    auto job = worker.post([&](const Control&) {
      std::atomic<int> sum{0};
      tbb::parallel_for(0, 5, [&](int k) { sum += wait_for(post(worker, k), plainly); });
      return sum.load();
    });
    CHECK(take(job.future()) == 10);
    auto nested = worker.post([&](const Control&) { return nest(worker, 3, plainly); });
    CHECK(take(nested.future()) == 4);
  }
}

TEST_CASE("a coroutine may wait for another job inside the worker", "[worker]") {
  Worker worker(options_with(1));
  for (const bool plainly : {true, false}) {
    // The follow-up stands in for a coroutine's next step: it runs where that would.
    auto job = post(worker, 1).then([&](int value) { return value + nest(worker, 2, plainly); }).then([&](int value) {
      return value + nest(worker, 2, plainly);
    });
    CHECK(take(job.future()) == 7);
  }
}

}  // namespace welkin::test
