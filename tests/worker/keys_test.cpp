// Of jobs with the same key the latest wins.

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: of jobs with the same key the newest wins: it replaces one that waits and stops one that runs.

namespace {

auto value_request(int value) {
  return [value](const Control&) { return value; };
}

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
