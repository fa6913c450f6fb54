// Equal requests share a run; of jobs with the same key the latest wins.

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: equal requests in flight are computed once, and nobody who shares can harm the others.

namespace {

/// What the runs of requests leave behind.
struct Log {
  std::atomic<int> runs{0};
  std::atomic<bool> stopped{false};
  Gate gate;
};

/// Equal if `value` is. Waits at the log's gate, looking out for a stop.
struct Square {
  int value = 0;
  Log* log = nullptr;

  int operator()(const Control& control) const {
    control.progress(0.5);
    ++log->runs;  // after the progress, which whoever waits for the run reads
    // As `Gate::pass`, but ends when it is told to.
    while (!log->gate.is_open()) {
      if (control.stop.stop_requested()) {
        log->stopped = true;
        throw Error(ErrorCode::cancelled, "told to stop");
      }
      std::this_thread::yield();
    }
    return value * value;
  }
  bool operator==(const Square& other) const { return value == other.value; }
};

void wait_for_runs(const Log& log, int runs) {
  REQUIRE(eventually([&] { return log.runs == runs; }));
}

}  // namespace

TEST_CASE("equal requests that wait are run once", "[worker]") {
  Worker worker(options_with(1));
  Log log;
  log.gate.open();
  std::vector<Job<int>> threes;
  Hold hold(worker);
  for (int k = 0; k < 5; ++k) threes.push_back(worker.post(Square{3, &log}));
  auto four = worker.post(Square{4, &log});
  CHECK(worker.load().waiting == 2);
  CHECK(worker.load().jobs == 7);  // with the one that holds the thread
  hold.let_go();
  for (auto& three : threes) CHECK(three.get() == 9);
  CHECK(four.get() == 16);
  CHECK(log.runs == 2);
}

TEST_CASE("a request joins an equal one that runs", "[worker]") {
  Worker worker(options_with(2));
  Log log;
  auto first = worker.post(Square{3, &log});
  wait_for_runs(log, 1);
  auto second = worker.post(Square{3, &log});
  CHECK(second.progress() >= 0.5);
  CHECK(first.id() != second.id());
  log.gate.open();
  CHECK(second.get() == 9);
  CHECK(first.get() == 9);
  CHECK(log.runs == 1);
}

TEST_CASE("a request that is done is run again", "[worker]") {
  Worker worker(options_with(1));
  Log log;
  log.gate.open();
  for (int k = 1; k <= 3; ++k) {
    CHECK(worker.post(Square{3, &log}).get() == 9);
    CHECK(log.runs == k);
  }
}

TEST_CASE("one sharer who leaves does not stop the others", "[worker]") {
  Worker worker(options_with(1));
  for (const bool running : {false, true}) {
    Log log;
    auto hold = running ? nullptr : std::make_unique<Hold>(worker);
    auto first = worker.post(Square{3, &log});
    if (running) wait_for_runs(log, 1);
    auto second = worker.post(Square{3, &log});
    auto third = worker.post(Square{3, &log}, {.key = "sky"});
    CHECK(first.cancel());
    CHECK(first.ready());  // at once, running or not
    CHECK(outcome(first) == "cancelled");
    auto replacing = worker.post(Square{4, &log}, {.key = "sky"});
    CHECK(third.ready());
    CHECK(outcome(third) == "replaced");
    if (hold) hold->let_go();
    log.gate.open();
    CHECK(second.get() == 9);
    CHECK(replacing.get() == 16);
    CHECK(log.runs == 2);
    CHECK_FALSE(log.stopped);
  }
}

TEST_CASE("a run stops when the last sharer leaves", "[worker]") {
  Worker worker(options_with(1));
  Log log;
  auto first = worker.post(Square{3, &log});
  wait_for_runs(log, 1);
  auto second = worker.post(Square{3, &log});
  CHECK(second.cancel());
  CHECK(second.ready());
  CHECK(first.cancel());
  CHECK(outcome(first) == "cancelled");
  CHECK(outcome(second) == "cancelled");
  CHECK(log.stopped);

  // A run that is given up is nobody's to join.
  log.gate.open();
  CHECK(worker.post(Square{3, &log}).get() == 9);
  CHECK(log.runs == 2);
}

TEST_CASE("a run that was told to stop is not joined", "[worker]") {
  Worker worker(options_with(1));
  struct Stubborn {
    Log* log;
    int operator()(const Control&) const {
      ++log->runs;
      log->gate.pass();
      return 1;
    }
    bool operator==(const Stubborn&) const = default;
  };
  Log log;
  auto first = worker.post(Stubborn{&log});
  log.gate.wait_for_arrivals(1);
  CHECK(first.cancel());
  auto second = worker.post(Stubborn{&log});
  log.gate.open();
  CHECK(outcome(first) == "cancelled");
  CHECK(outcome(second) == "result");
  CHECK(log.runs == 2);
}

TEST_CASE("a newer equal request of the same key takes the run over", "[worker]") {
  Worker worker(options_with(1));
  Log log;
  auto first = worker.post(Square{3, &log}, {.key = "sky"});
  wait_for_runs(log, 1);
  auto second = worker.post(Square{3, &log}, {.key = "sky"});
  CHECK(eventually([&] { return first.ready(); }));
  CHECK(outcome(first) == "replaced");
  log.gate.open();
  CHECK(second.get() == 9);
  CHECK(log.runs == 1);
}

TEST_CASE("a shared run has the highest priority of its jobs", "[worker]") {
  Worker worker(options_with(1));
  std::vector<int> order;
  struct Noted {
    int value;
    std::vector<int>* order;
    int operator()(const Control&) const {
      order->push_back(value);
      return value;
    }
    bool operator==(const Noted&) const = default;
  };
  {
    Hold hold(worker);
    worker.post(Noted{1, &order}, {.priority = TaskPriority::low});
    worker.post(Noted{2, &order}, {.priority = TaskPriority::normal});
    worker.post(Noted{1, &order}, {.priority = TaskPriority::high});
  }
  worker.wait_until_idle();
  CHECK(order == std::vector<int>{1, 2});

  // It falls back when the job that raised it leaves, or is set lower.
  order.clear();
  {
    Hold hold(worker);
    worker.post(Noted{1, &order}, {.priority = TaskPriority::low});
    worker.post(Noted{2, &order}, {.priority = TaskPriority::normal});
    CHECK(worker.post(Noted{1, &order}, {.priority = TaskPriority::high}).cancel());
    worker.post(Noted{3, &order}, {.priority = TaskPriority::low});
    worker.post(Noted{3, &order}, {.priority = TaskPriority::high}).set_priority(TaskPriority::low);
  }
  worker.wait_until_idle();
  CHECK(order.front() == 2);
  CHECK(order.size() == 3);
}

TEST_CASE("all sharers get the error of their run", "[worker]") {
  struct Failing {
    int operator()(const Control&) const { throw std::runtime_error("no sky today"); }
    bool operator==(const Failing&) const = default;
  };
  Worker worker(options_with(1));
  std::vector<Job<int>> jobs;
  {
    Hold hold(worker);
    for (int k = 0; k < 3; ++k) jobs.push_back(worker.post(Failing{}));
  }
  for (auto& job : jobs) CHECK(outcome(job) == "no sky today");
}

TEST_CASE("a result whose copy throws fails that job alone", "[worker]") {
  struct Brittle {
    Brittle() = default;
    Brittle(const Brittle&) { throw std::runtime_error("cannot be copied today"); }
    Brittle(Brittle&&) noexcept {}
    Brittle& operator=(const Brittle&) = default;
    Brittle& operator=(Brittle&&) noexcept { return *this; }
    ~Brittle() = default;
  };
  struct Request {
    Brittle operator()(const Control&) const { return {}; }
    bool operator==(const Request&) const = default;
  };
  Worker worker(options_with(1));
  std::vector<Job<Brittle>> jobs;
  {
    Hold hold(worker);
    for (int k = 0; k < 3; ++k) jobs.push_back(worker.post(Request{}));
  }
  int results = 0;
  for (auto& job : jobs) {
    const std::string end = outcome(job);
    results += end == "result" ? 1 : 0;
    CHECK((end == "result" || end == "cannot be copied today"));
  }
  CHECK(results == 1);
  CHECK(worker.post([](const Control&) { return 1; }).get() == 1);
}

TEST_CASE("requests without equality, or whose results cannot be copied, are not shared", "[worker]") {
  std::atomic<int> runs{0};
  struct MoveOnlyResult {
    std::atomic<int>* runs;
    std::unique_ptr<int> operator()(const Control&) const {
      ++*runs;
      return std::make_unique<int>(1);
    }
    bool operator==(const MoveOnlyResult&) const = default;
  };
  Worker worker(options_with(1));
  {
    Hold hold(worker);
    for (int k = 0; k < 3; ++k) worker.post(MoveOnlyResult{&runs});
    for (int k = 0; k < 3; ++k) worker.post([&runs](const Control&) { ++runs; });
  }
  worker.wait_until_idle();
  CHECK(runs == 6);
}

namespace {

std::atomic<int> runs_without_captures{0};
void count_run(const Control&) { ++runs_without_captures; }

}  // namespace

TEST_CASE("lambdas and functions are never equal", "[worker]") {
  // A lambda without captures can be compared, by way of its function's address: that is no operator== of its own.
  Worker worker(options_with(1));
  runs_without_captures = 0;
  {
    Hold hold(worker);
    for (int k = 0; k < 3; ++k) worker.post([](const Control&) { ++runs_without_captures; });
    for (int k = 0; k < 3; ++k) worker.post(&count_run);
  }
  worker.wait_until_idle();
  CHECK(runs_without_captures == 6);
}

TEST_CASE("requests of different kinds are not equal", "[worker]") {
  const auto image =
      std::make_shared<const CubemapImage>(CubemapImage{16, make_cubemap(Content::random, 16, 3, 1).pixels});
  Worker worker(options_with(1));
  Hold hold(worker);
  auto same = worker.post(CubemapToCubemap{image, 4});
  auto other = worker.post(ProjectCubemap{image});
  CHECK(worker.load().waiting == 2);
  hold.let_go();
  CHECK(outcome(same) == "result");
  CHECK(outcome(other) == "result");
}

TEST_CASE("equal requests of the library's own share, and give the same bits", "[worker]") {
  const auto image =
      std::make_shared<const CubemapImage>(CubemapImage{64, make_cubemap(Content::special_values, 64, 3, 1).pixels});
  const Projection expected = project(image->view());
  Worker worker(options_with(2));
  std::vector<Job<Projection>> jobs;
  Hold hold(worker, 2);
  for (int k = 0; k < 4; ++k) jobs.push_back(worker.post(ProjectCubemap{image}));
  CHECK(worker.load().waiting == 1);
  hold.let_go();
  for (auto& job : jobs) CHECK(same_bits(take(job), expected));
}

TEST_CASE("each sharer can be followed, drained and awaited for itself", "[worker]") {
  Worker worker(options_with(1));
  Log log;
  log.gate.open();
  int drained = 0;
  Hold hold(worker);
  auto followed = worker.post(Square{5, &log}).then([](int square) { return square + 1; });
  worker.post(Square{5, &log}).on_drain([&](Job<int> job) { drained = job.get(); });
  auto plain = worker.post(Square{5, &log});
  hold.let_go();
  CHECK(followed.get() == 26);
  CHECK(plain.get() == 25);
  CHECK(eventually([&] { return worker.drain() == 1; }));
  CHECK(drained == 25);
  CHECK(log.runs == 1);
}

// Promise: of jobs with the same key the newest wins: it replaces one that waits and stops one that runs.

namespace {

auto value_request(int value) {
  return [value](const Control&) { return value; };
}

/// Runs until it is asked to stop.
}  // namespace

TEST_CASE("a newer job replaces one of its key that waits", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<bool> ran{false};
  Hold hold(worker);
  auto old = worker.post([&](const Control&) { ran = true; }, {.key = "probe 7"});
  auto stranger = worker.post(value_request(1), {.key = "probe 8"});
  auto keyless = worker.post(value_request(2));
  auto newer = worker.post(value_request(3), {.key = "probe 7"});
  CHECK(old.ready());  // at once, with the only thread busy
  CHECK(outcome(old) == "replaced");
  CHECK_FALSE(old.cancel());
  hold.let_go();
  CHECK(stranger.get() == 1);
  CHECK(keyless.get() == 2);
  CHECK(newer.get() == 3);
  CHECK_FALSE(ran);
}

TEST_CASE("a newer job stops one of its key that runs", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<bool> inside{false};
  auto old = worker.post(
      [&](const Control& control) {
        inside = true;
        run_until_stopped(control);
        return 1;
      },
      {.key = "sky"});
  CHECK(eventually([&] { return inside.load(); }));
  auto newer = worker.post(value_request(2), {.key = "sky"});
  CHECK(outcome(old) == "replaced");
  CHECK(newer.get() == 2);
}

TEST_CASE("jobs without a key replace nothing", "[worker]") {
  Worker worker(options_with(1));
  std::vector<Job<int>> jobs;
  {
    Hold hold(worker);
    for (int k = 0; k < 20; ++k) jobs.push_back(worker.post(value_request(k)));
  }
  for (int k = 0; k < 20; ++k) CHECK(jobs[static_cast<std::size_t>(k)].get() == k);
}

TEST_CASE("a job that is done is not replaced", "[worker]") {
  Worker worker(options_with(1));
  auto old = worker.post(value_request(1), {.key = "sky"});
  CHECK(eventually([&] { return old.ready(); }));
  CHECK(worker.post(value_request(2), {.key = "sky"}).get() == 2);
  CHECK(old.get() == 1);
}

TEST_CASE("a key is one worker's own", "[worker]") {
  Worker first(options_with(1));
  Worker second(options_with(1));
  Hold hold(first);
  auto one = first.post(value_request(1), {.key = "sky"});
  CHECK(second.post(value_request(2), {.key = "sky"}).get() == 2);
  hold.let_go();
  CHECK(one.get() == 1);
}

TEST_CASE("of many posts the last one wins", "[worker]") {
  Worker worker(options_with(1));
  std::vector<Job<int>> jobs;
  {
    Hold hold(worker);
    for (int k = 0; k < 200; ++k) jobs.push_back(worker.post(value_request(k), {.key = "sky"}));
  }
  CHECK(jobs.back().get() == 199);
  jobs.pop_back();
  for (auto& job : jobs) CHECK(outcome(job) == "replaced");
}

TEST_CASE("the newest wins when posts race, and always gets its result", "[worker]") {
  Worker worker(options_with(2));
  constexpr int kThreads = 4;
  std::vector<std::vector<Job<int>>> jobs(kThreads);
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int k = 0; k < 300; ++k) {
        jobs[static_cast<std::size_t>(t)].push_back(worker.post(value_request(k), {.key = "sky"}));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::uint64_t newest = 0;
  for (const auto& own : jobs) newest = std::max(newest, own.back().id());
  for (auto& own : jobs) {
    for (int k = 0; k < 300; ++k) {
      auto& job = own[static_cast<std::size_t>(k)];
      const std::uint64_t id = job.id();
      std::string end;
      try {
        end = take(job) == k ? "result" : "wrong";
      } catch (const Error& error) {
        end = name(error.code());
      }
      if (id == newest) CHECK(end == "result");
      CHECK((end == "result" || end == "replaced"));
    }
  }
}

TEST_CASE("what follows a replaced job gets its error", "[worker]") {
  Worker worker(options_with(1));
  Hold hold(worker);
  bool called = false;
  auto follower = worker.post(value_request(1), {.key = "sky"}).then([&](int) { called = true; });
  std::string drained;
  worker.post(value_request(2), {.key = "probe"}).on_drain([&](Job<int> job) { drained = outcome(job); });
  auto newer_sky = worker.post(value_request(3), {.key = "sky"});
  auto newer_probe = worker.post(value_request(4), {.key = "probe"});
  CHECK(worker.drain() == 1);
  CHECK(drained == "replaced");
  hold.let_go();
  CHECK(outcome(follower) == "replaced");
  CHECK_FALSE(called);
  CHECK(newer_sky.get() == 3);
  CHECK(newer_probe.get() == 4);
}

TEST_CASE("a replaced job makes room for the newer one", "[worker]") {
  WorkerOptions options = options_with(1);
  options.max_jobs = 2;
  options.overflow = OverflowPolicy::refuse;
  Worker worker(options);
  Hold hold(worker);
  auto old = worker.post(value_request(1), {.key = "sky"});
  CHECK(outcome(worker.post(value_request(2))) == "queue_full");
  auto newer = worker.post(value_request(3), {.key = "sky"});
  CHECK(outcome(old) == "replaced");
  hold.let_go();
  CHECK(outcome(newer) == "result");
}

TEST_CASE("a job that can never be let in replaces nothing", "[worker]") {
  WorkerOptions options = options_with(1);
  options.max_bytes = 1000;
  Worker worker(options);
  Hold hold(worker);
  auto old = worker.post(value_request(1), {.key = "sky"});
  CHECK(outcome(worker.post(value_request(2), {.key = "sky", .bytes = 1001})) == "limit_exceeded");
  hold.let_go();
  CHECK(outcome(old) == "result");
}

}  // namespace welkin::test
