// Cancelling jobs, alone or with their worker, and the progress of jobs that run to their end.
#include <tbb/parallel_for.h>

#include "jobs/tiles.h"
#include "support/catch.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: a job can be cancelled once, at any time and on any thread; it stops within a tile, and the worker goes on.

namespace {

void expect_usable(Worker& worker) {
  CHECK(worker.post([](const Control&) { return 5; }).get() == 5);
}

}  // namespace

TEST_CASE("a waiting job is given up at once and never runs", "[worker]") {
  Worker worker(options_with(1));
  bool ran = false;
  Hold hold(worker);
  auto job = worker.post([&](const Control&) { ran = true; });
  CHECK(worker.load().waiting == 1);
  CHECK(job.cancel());
  CHECK(job.ready());
  CHECK(worker.load().waiting == 0);
  CHECK(worker.load().jobs == 1);
  CHECK_FALSE(job.cancel());
  CHECK(outcome(job) == "cancelled");
  hold.let_go();
  worker.wait_until_idle();
  CHECK_FALSE(ran);
  expect_usable(worker);
}

TEST_CASE("a running job's token is stopped, and whatever it then does its error is cancelled", "[worker]") {
  Worker worker(options_with(1));
  for (const std::string after : {"returns", "throws", "throws an Error", "throws an int"}) {
    std::atomic<bool> inside{false};
    auto job = worker.post([&](const Control& control) {
      inside = true;
      run_until_stopped(control);
      if (after == "throws") throw std::runtime_error("something else");
      if (after == "throws an Error") throw Error(ErrorCode::corrupt_file, "something else");
      if (after == "throws an int") throw 1;
      return 1;
    });
    CHECK(eventually([&] { return inside.load(); }));
    CHECK(job.cancel());
    CHECK_FALSE(job.cancel());
    CHECK(outcome(job) == "cancelled");
    expect_usable(worker);
  }
}

TEST_CASE("a cancelled job's future waits until nothing runs any more", "[worker]") {
  Worker worker(options_with(1));
  Gate gate;
  auto job = worker.post([&](const Control&) { gate.pass(); });
  gate.wait_for_arrivals(1);
  CHECK(job.cancel());
  CHECK_FALSE(job.ready());
  gate.open();
  CHECK(outcome(job) == "cancelled");
}

TEST_CASE("no tile starts after a cancel but those that other threads were about to start", "[worker]") {
  for (const int threads : {1, 3}) {
    Worker worker(options_with(threads));
    for (const int last : {0, 10, 500}) {
      std::optional<JobHandle> handle;
      std::atomic<bool> has_handle{false};
      std::atomic<int> tiles{0};
      std::atomic<int> tiles_at_cancel{-1};
      auto job = worker.post([&](const Control& control) {
        while (!has_handle) std::this_thread::yield();
        jobs::run_tiles(1000, jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena), control,
                        [&](std::size_t, std::size_t) {
                          if (tiles++ == last) {
                            handle->cancel();
                            tiles_at_cancel = tiles.load();
                          }
                        });
      });
      handle = job;
      has_handle = true;
      CHECK(outcome(job) == "cancelled");
      REQUIRE(tiles_at_cancel >= 0);
      CHECK(tiles - tiles_at_cancel <= threads - 1);
      expect_usable(worker);
    }
  }
}

TEST_CASE("of many who cancel a job one did it", "[worker]") {
  Worker worker(options_with(1));
  for (int repetition = 0; repetition < 100; ++repetition) {
    auto job = worker.post([](const Control&) { return 3; });
    std::atomic<int> did_it{0};
    on_threads(3, [&did_it, handle = JobHandle(job)](std::size_t) {
      if (handle.cancel()) ++did_it;
    });
    const std::string end = outcome(job);
    CHECK(did_it == (end == "cancelled" ? 1 : 0));
    CHECK((end == "cancelled" || end == "result"));
  }
}

TEST_CASE("jobs can be given up from requests, continuations and callbacks", "[worker]") {
  Worker worker(options_with(1));
  Hold hold(worker);
  auto first = worker.post([](const Control&) { return 1; });
  auto second = worker.post([](const Control&) { return 2; });
  auto third = worker.post([](const Control&) { return 3; });
  std::vector<bool> did_it;
  // The jobs of the handles wait; the jobs that cancel them run first.
  auto from_request = worker.post([handle = JobHandle(first)](const Control&) { return handle.cancel(); },
                                  {.priority = TaskPriority::high});
  auto from_continuation =
      worker.post([](const Control&) {}, {.priority = TaskPriority::high}).then([handle = JobHandle(second)] {
        return handle.cancel();
      });
  auto given_up = worker.post([](const Control&) {});
  given_up.cancel();
  bool from_callback = false;
  std::move(given_up).on_drain([&](Job<void>) { from_callback = third.cancel(); });
  CHECK(worker.drain() == 1);
  CHECK(from_callback);
  hold.let_go();
  CHECK(from_request.get());
  CHECK(from_continuation.get());
  CHECK(outcome(first) == "cancelled");
  CHECK(outcome(second) == "cancelled");
  CHECK(outcome(third) == "cancelled");
}

TEST_CASE("who gives up a continuation gives up the job that it follows", "[worker]") {
  Worker worker(options_with(1));
  bool ran = false;
  Hold hold(worker);
  auto first = worker.post([&](const Control&) { ran = true; });
  const JobHandle first_handle = first;
  auto second = std::move(first).then([&] { ran = true; });
  const JobHandle second_handle = second;
  auto third = std::move(second).then([&] { ran = true; });
  CHECK(third.cancel());
  CHECK_FALSE(third.cancel());
  CHECK_FALSE(second_handle.cancel());
  CHECK_FALSE(first_handle.cancel());
  CHECK(first_handle.ready());  // it waited
  hold.let_go();
  CHECK(outcome(third) == "cancelled");
  CHECK(eventually([&] { return second_handle.ready(); }));
  CHECK_FALSE(ran);
  expect_usable(worker);
}

TEST_CASE("who gives up a continuation stops the job that it follows", "[worker]") {
  Worker worker(options_with(1));
  bool followed = false;
  auto job = running_job(worker).then([&](int) { followed = true; });
  CHECK(job.cancel());
  CHECK(outcome(job) == "cancelled");
  worker.wait_until_idle();
  CHECK_FALSE(followed);
  expect_usable(worker);
}

TEST_CASE("a running continuation is told to stop", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<bool> inside{false};
  auto job = worker.post([](const Control&) { return 1; }).then([&](int, const Control& control) {
    inside = true;
    run_until_stopped(control);
    return 2;
  });
  CHECK(eventually([&] { return inside.load(); }));
  CHECK(job.cancel());
  CHECK(outcome(job) == "cancelled");
}

// Promise: a job's progress goes from 0 to 1 and never falls, whatever the request reports, from any thread.

TEST_CASE("progress is seen while a job runs, and only rises", "[worker]") {
  Worker worker(options_with(1));
  Hold hold(worker);
  Gate early;
  Gate late;
  auto job = worker.post([&](const Control& control) {
    early.pass();
    control.progress(0.5);
    control.progress(0.25);
    control.progress(-1.0);
    control.progress(std::numeric_limits<double>::quiet_NaN());
    late.pass();
    control.progress(7.0);
  });
  CHECK(job.progress() == 0.0);
  hold.let_go();
  early.wait_for_arrivals(1);
  CHECK(job.progress() == 0.0);
  CHECK_FALSE(job.ready());
  early.open();
  late.wait_for_arrivals(1);
  CHECK(job.progress() == 0.5);
  late.open();
  CHECK(outcome(job) == "result");
  CHECK(job.progress() == 1.0);
  CHECK(eventually([&] { return job.ready(); }));  // a moment after its future
}

TEST_CASE("progress of a job that fails stays where it was", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([](const Control& control) {
    control.progress(0.25);
    throw std::runtime_error("enough");
  });
  CHECK(outcome(job) == "enough");
  CHECK(job.progress() == 0.25);
}

// Promise: `terminate()` and the destructor leave no thread, no task and no broken promise, wherever they are called.

namespace {

/// The number of threads at construction; reports whether there are more now.
class ThreadCount {
 public:
  ThreadCount() {
    // From here on oneTBB's pool has its threads, which last as long as the process.
    tbb::parallel_for(0, 100, [](int) {});
    { const Worker worker(options_with(1)); }
    if (!eventually([] { return named("welkin").empty(); })) give_up("an empty worker");
    before_ = process_threads();
  }

  [[nodiscard]] std::size_t more() const { return threads_since(before_).size(); }
  /// The system lists a thread a moment longer than it can be joined.
  [[nodiscard]] bool comes_back() const {
    return eventually([&] { return more() == 0; });
  }

 private:
  static std::set<int> named(const std::string& name) {
    std::set<int> threads;
    for (const int thread : process_threads()) {
      if (thread_name(thread).rfind(name + ' ', 0) == 0) threads.insert(thread);
    }
    return threads;
  }

  std::set<int> before_;
};

/// Jobs in every state: one runs, some wait, some are followed.
struct Jobs {
  std::vector<Job<int>> all;

  void post(Worker& worker) {
    all.push_back(running_job(worker));
    for (int k = 0; k < 10; ++k) {
      all.push_back(worker.post([k](const Control&) { return k; }));
      all.push_back(worker.post([k](const Control&) { return k; }).then([](int value) { return value; }));
    }
  }

  void expect_all_stopped() {
    for (auto& job : all) CHECK(outcome(job) == "stopped");
  }
};

}  // namespace

TEST_CASE("terminate gives up all jobs and ends all threads", "[worker]") {
  const ThreadCount threads;
  Jobs jobs;
  Worker worker(options_with(1));
  CHECK(threads.more() >= 1);
  jobs.post(worker);
  worker.terminate();
  for (const auto& job : jobs.all) CHECK(job.ready());
  jobs.expect_all_stopped();
  CHECK(threads.comes_back());
  const WorkerLoad load = worker.load();
  CHECK(load.waiting == 0);
  CHECK(load.running == 0);
  CHECK(load.jobs == 0);
  CHECK(load.bytes == 0);

  worker.terminate();
  CHECK(outcome(worker.post([](const Control&) { return 1; })) == "stopped");
  worker.wait_until_idle();
}

TEST_CASE("the destructor gives up all jobs and ends all threads", "[worker]") {
  const ThreadCount threads;
  for (const int count : {1, 2, 7}) {
    Jobs jobs;
    {
      Worker worker(options_with(count));
      jobs.post(worker);
    }
    for (auto& job : jobs.all) {
      const std::string end = outcome(job);
      CHECK((end == "stopped" || (count > 1 && end == "result")));
    }
    CHECK(threads.comes_back());
  }
}

TEST_CASE("terminate from several threads at once", "[worker]") {
  for (int repetition = 0; repetition < 20; ++repetition) {
    Worker worker(options_with(2));
    std::vector<Job<int>> jobs;
    for (int k = 0; k < 20; ++k) jobs.push_back(worker.post([k](const Control&) { return k; }));
    std::atomic<int> unready{0};
    on_threads(3, [&](std::size_t) {
      worker.terminate();
      for (const auto& job : jobs) unready += job.ready() ? 0 : 1;
    });
    CHECK(unready == 0);
  }
}

TEST_CASE("a worker can be ended from a callback", "[worker]") {
  const ThreadCount threads;
  for (const bool destroys : {false, true}) {
    auto worker = std::make_unique<Worker>(options_with(1));
    Worker& alias = *worker;
    Jobs jobs;
    int later_calls = 0;
    alias.post([](const Control&) { return 1; }).on_drain([&](Job<int>) {
      if (destroys) {
        worker.reset();
      } else {
        alias.terminate();
      }
    });
    alias.post([](const Control&) { return 2; }).on_drain([&](Job<int>) { ++later_calls; });
    alias.wait_until_idle();
    jobs.post(alias);
    const std::size_t called = alias.drain();
    CHECK(called == (destroys ? 1 : 2));
    CHECK(later_calls == (destroys ? 0 : 1));
    jobs.expect_all_stopped();
    CHECK(threads.comes_back());
  }
}

TEST_CASE("a worker can be ended from a request", "[worker]") {
  const ThreadCount threads;
  for (const bool destroys : {false, true}) {
    for (const int count : {1, 3}) {
      auto worker = std::make_shared<Worker>(options_with(count));
      const std::weak_ptr<Worker> weak = worker;
      const auto gate = std::make_shared<Gate>();
      std::vector<Job<int>> jobs;
      auto ending = worker->post([worker, gate, destroys](const Control&) mutable {
        gate->pass();
        if (destroys) {
          worker.reset();  // the last reference: the test releases its own before the gate opens
        } else {
          worker->terminate();
        }
        return 1;
      });
      gate->wait_for_arrivals(1);
      for (int k = 0; k < 10; ++k) jobs.push_back(worker->post([k](const Control&) { return k; }));
      std::shared_ptr<Worker> kept = destroys ? nullptr : worker;
      worker.reset();
      gate->open();
      CHECK(outcome(ending) == "stopped");
      for (auto& job : jobs) {
        const std::string end = outcome(job);
        CHECK((end == "stopped" || (count > 1 && end == "result")));
      }
      if (kept) {
        kept->terminate();  // waits now
        kept.reset();
      }
      CHECK(eventually([&] { return weak.expired(); }));
      CHECK(threads.comes_back());
    }
  }
}

TEST_CASE("requests that go on posting end with their worker", "[worker]") {
  const ThreadCount threads;
  std::atomic<int> unposted{0};
  {
    Worker worker(options_with(2));
    // Each request posts the next one; the last post ends as stopped.
    std::function<void(const Control&)> next = [&](const Control&) {
      auto job = worker.post(std::function<void(const Control&)>(next));
      if (job.ready()) ++unposted;
    };
    for (int k = 0; k < 4; ++k) worker.post(std::function<void(const Control&)>(next));
    for (int k = 0; k < 50; ++k)
      CHECK(worker.post([k](const Control&) { return k; }, {.priority = TaskPriority::high}).get() == k);
    worker.terminate();
  }
  CHECK(threads.comes_back());
}

TEST_CASE("wait_until_idle waits for all that was posted, not for callbacks", "[worker]") {
  Worker worker(options_with(2));
  worker.wait_until_idle();
  std::atomic<int> runs{0};
  for (int k = 0; k < 100; ++k) {
    worker.post([&, k](const Control&) { runs += k >= 0 ? 1 : 0; })
        .then([&] {
          ++runs;
          worker.post([&, again = 1](const Control&) { runs += again; });
        })
        .on_drain([&](Job<void>) { ++runs; });
  }
  worker.wait_until_idle();
  CHECK(runs == 300);
  CHECK(worker.load().running == 0);
  CHECK(worker.load().jobs == 0);
  CHECK(worker.drain() == 100);
}

TEST_CASE("what would wait for itself returns at once on a worker's own thread", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([&](const Control&) {
    worker.wait_until_idle();
    return 1;
  });
  CHECK(take(job) == 1);
  auto ending = worker.post([&](const Control&) {
    worker.terminate();
    worker.wait_until_idle();
    worker.terminate();
    return 1;
  });
  CHECK(outcome(ending) == "stopped");
}

}  // namespace welkin::test
