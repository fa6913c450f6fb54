// Promise: `terminate()` and the destructor leave no thread, no task and no broken promise, wherever they are called.
#include <tbb/parallel_for.h>

#include "support/catch.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "support/trials.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

/// The threads that there were when it was made, and whether more are there now.
class ThreadCount {
 public:
  ThreadCount() {
    // oneTBB's pool has its threads from now on: they are the process's, and stay.
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

TEST_CASE("terminate waits for what runs", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<bool> running{false};
  auto job = worker.post([&](const Control& control) {
    running = true;
    run_until_stopped(control);
    for (int k = 0; k < 1000; ++k) std::this_thread::yield();
    running = false;
  });
  CHECK(eventually([&] { return running.load(); }));
  worker.terminate();
  CHECK_FALSE(running);
  CHECK(job.ready());
  CHECK(outcome(job) == "stopped");
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
          worker.reset();  // the last one who has it: the test lets go before the gate opens
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

TEST_CASE("posts that race the end get a result or are stopped", "[worker]") {
  const ThreadCount threads;
  const int repetitions = kSanitized ? 10 : 50;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    Worker worker(options_with(1 + repetition % 3));
    constexpr int kPosters = 3;
    std::vector<std::vector<Job<int>>> jobs(kPosters);
    std::atomic<int> posting{0};
    std::vector<std::thread> posters;
    for (auto& own : jobs) {
      posters.emplace_back([&] {
        ++posting;
        for (int k = 0; k < 200; ++k) {
          auto job = worker.post([k](const Control&) { return k; });
          own.push_back(k % 2 == 0 ? std::move(job) : std::move(job).then([](int value) { return value; }));
        }
      });
    }
    while (posting < kPosters) std::this_thread::yield();
    worker.terminate();
    for (std::thread& poster : posters) poster.join();
    for (auto& own : jobs) {
      for (std::size_t k = 0; k < own.size(); ++k) {
        CHECK(own[k].ready());
        auto value = static_cast<int>(k);
        const std::string end = outcome_of([&] { value = take(own[k]); });
        CHECK(value == static_cast<int>(k));
        CHECK((end == "result" || end == "stopped"));
      }
    }
  }
  CHECK(threads.comes_back());
}

TEST_CASE("requests that go on posting end with their worker", "[worker]") {
  const ThreadCount threads;
  std::atomic<int> unposted{0};
  {
    Worker worker(options_with(2));
    // Each request posts the next one; the last is told that it is stopped.
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
