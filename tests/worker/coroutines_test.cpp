// Coroutines that await jobs.

#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/detached.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/process_threads.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: `co_await` on a job gives its result or throws its error, in the worker or in `drain()`; no coroutine is
// ever lost.

namespace {

/// Where and how a coroutine went on.
struct End {
  std::string outcome;
  std::string thread;
  std::thread::id thread_id;
};

/// Awaits the job and tells `ended`.
template <class Result>
Detached await_job(Job<Result> job, std::shared_ptr<std::promise<End>> ended) {
  std::string outcome = "result";
  try {
    static_cast<void>(co_await std::move(job));
  } catch (const Error& error) {
    outcome = name(error.code());
  } catch (const std::exception& exception) {
    outcome = exception.what();
  }
  ended->set_value({outcome, this_threads_name(), std::this_thread::get_id()});
}

template <class Result>
Detached await_drained(Job<Result> job, std::shared_ptr<std::promise<End>> ended) {
  std::string outcome = "result";
  try {
    static_cast<void>(co_await std::move(job).drained());
  } catch (const Error& error) {
    outcome = name(error.code());
  } catch (const std::exception& exception) {
    outcome = exception.what();
  }
  ended->set_value({outcome, this_threads_name(), std::this_thread::get_id()});
}

/// A promise that coroutines can be given, and its future.
struct Ended {
  std::shared_ptr<std::promise<End>> promise = std::make_shared<std::promise<End>>();
  std::future<End> future = promise->get_future();

  [[nodiscard]] bool there() const { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
  End get() { return take(std::move(future)); }
};

WorkerOptions named(const std::string& name, int threads = 1) {
  WorkerOptions options = options_with(threads);
  options.name = name;
  return options;
}

void no_coroutine_is_left() {
  CHECK(eventually([] { return Detached::alive == 0; }));
}

}  // namespace

TEST_CASE("a coroutine goes on in the worker with the result", "[worker]") {
  Worker worker(named("await"));
  Hold hold(worker);
  Ended ended;
  await_job(worker.post([](const Control&) { return 1; }), ended.promise);
  Ended failed;
  await_job(worker.post([](const Control&) -> int { throw std::runtime_error("enough"); }), failed.promise);
  Ended nothing;
  await_job(worker.post([](const Control&) {}).then([] { return 2; }), nothing.promise);
  CHECK(Detached::alive == 3);
  hold.let_go();
  const End end = ended.get();
  CHECK(end.outcome == "result");
  CHECK(end.thread.rfind("await", 0) == 0);
  CHECK(failed.get().outcome == "enough");
  CHECK(nothing.get().outcome == "result");
  no_coroutine_is_left();
}

TEST_CASE("a coroutine that awaits a ready job stays where it is", "[worker]") {
  Worker worker(named("await"));
  auto job = worker.post([](const Control&) { return 1; });
  CHECK(eventually([&] { return job.ready(); }));
  Ended ended;
  await_job(std::move(job), ended.promise);
  CHECK(ended.there());
  CHECK(ended.get().thread_id == std::this_thread::get_id());
  no_coroutine_is_left();
}

TEST_CASE("a coroutine can ask to go on in drain", "[worker]") {
  Worker worker(named("await"));
  auto ready = worker.post([](const Control&) { return 1; });
  CHECK(eventually([&] { return ready.ready(); }));
  Ended first;
  await_drained(std::move(ready), first.promise);
  CHECK_FALSE(first.there());
  Ended second;
  await_drained(worker.post([](const Control&) -> int { throw std::runtime_error("enough"); }), second.promise);
  worker.wait_until_idle();
  CHECK_FALSE(second.there());
  CHECK(worker.load().undrained == 2);
  CHECK(worker.drain() == 2);
  CHECK(first.get().thread_id == std::this_thread::get_id());
  const End end = second.get();
  CHECK(end.thread_id == std::this_thread::get_id());
  CHECK(end.outcome == "enough");
  no_coroutine_is_left();
}

namespace {

Detached add_up(Worker& worker, int count, std::shared_ptr<std::promise<int>> sum) {
  int total = 0;
  for (int k = 0; k < count; ++k) {
    // In statements of their own: see the note on `co_await` in worker.h.
    auto job = worker.post([k](const Control&) { return k; });
    auto other = worker.post([](const Control&) {}, {.priority = TaskPriority::high});
    total += co_await std::move(job);
    if (k % 10 == 0) co_await std::move(other);
  }
  sum->set_value(total);
}

}  // namespace

TEST_CASE("a coroutine may await one job after the other", "[worker]") {
  Worker worker(options_with(2));
  std::vector<std::future<int>> sums;
  for (int k = 0; k < 10; ++k) {
    auto sum = std::make_shared<std::promise<int>>();
    sums.push_back(sum->get_future());
    add_up(worker, 100, sum);
  }
  for (auto& sum : sums) CHECK(take(std::move(sum)) == 4950);
  no_coroutine_is_left();
}

TEST_CASE("a coroutine goes on when its job is given up", "[worker]") {
  Worker worker(options_with(1));
  Hold hold(worker);
  auto job = worker.post([](const Control&) { return 1; });
  const JobHandle handle = job;
  Ended ended;
  await_job(std::move(job), ended.promise);
  CHECK(handle.cancel());
  hold.let_go();
  CHECK(ended.get().outcome == "cancelled");
  no_coroutine_is_left();
}

TEST_CASE("terminate goes on with coroutines, which find that they were stopped", "[worker]") {
  Worker worker(options_with(1));
  auto gate = std::make_shared<Gate>();
  Ended running;
  await_job(worker.post([gate](const Control& control) {
    gate->pass();
    while (!control.stop.stop_requested()) std::this_thread::yield();
    return 1;
  }),
            running.promise);
  gate->wait_for_arrivals(1);
  Ended waiting;
  await_job(worker.post([](const Control&) { return 1; }), waiting.promise);
  Ended following;
  await_job(worker.post([](const Control&) { return 1; }).then([](int value) { return value; }), following.promise);
  gate->open();
  worker.terminate();
  CHECK(running.there());
  CHECK(waiting.there());
  CHECK(following.there());
  CHECK(running.get().outcome == "stopped");
  CHECK(waiting.get().outcome == "stopped");
  CHECK(following.get().outcome == "stopped");

  Ended late;
  await_job(worker.post([](const Control&) { return 1; }), late.promise);
  CHECK(late.get().outcome == "stopped");
  no_coroutine_is_left();
}

TEST_CASE("the destructor goes on with coroutines that nobody drained", "[worker]") {
  Ended done;
  Ended stopped;
  {
    Worker worker(options_with(1));
    await_drained(worker.post([](const Control&) { return 1; }), done.promise);
    worker.wait_until_idle();
    Hold hold(worker);
    await_drained(worker.post([](const Control&) { return 1; }), stopped.promise);
    worker.post([](const Control&) {}).on_drain([](Job<void>) { FAIL("a callback is dropped"); });
  }
  CHECK(done.there());
  CHECK(stopped.there());
  CHECK(done.get().outcome == "result");
  const std::string end = stopped.get().outcome;
  CHECK((end == "stopped" || end == "result"));
  no_coroutine_is_left();
}

namespace {

/// Goes on posting until the worker stops it.
Detached post_until_stopped(Worker& worker, std::shared_ptr<std::promise<int>> rounds) {
  int round = 0;
  try {
    for (;; ++round) {
      auto job = worker.post([round](const Control&) { return round; });
      co_await std::move(job);
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::stopped) round = -1;
  }
  rounds->set_value(round);
}

}  // namespace

TEST_CASE("coroutines that keep on posting end with their worker", "[worker]") {
  std::vector<std::future<int>> rounds;
  {
    Worker worker(options_with(2));
    for (int k = 0; k < 4; ++k) {
      auto promise = std::make_shared<std::promise<int>>();
      rounds.push_back(promise->get_future());
      post_until_stopped(worker, promise);
    }
    for (int k = 0; k < 20; ++k) CHECK(worker.post([k](const Control&) { return k; }).get() == k);
  }
  for (auto& round : rounds) CHECK(take(std::move(round)) >= 0);
  no_coroutine_is_left();
}

namespace {

/// Awaits one job; when that is given up, waits for another one, on whichever thread it finds itself.
Detached wait_when_stopped(Job<int> first, Job<int> second, std::shared_ptr<std::promise<std::string>> ended) {
  bool stopped = false;
  try {
    co_await std::move(first);
  } catch (const Error&) {
    stopped = true;
  }
  ended->set_value(stopped ? outcome(second) : "not stopped");
}

/// Awaits each in `drain()`, or where it is when nobody drains any more.
Detached await_all_drained(std::vector<Job<int>> jobs, std::shared_ptr<std::promise<int>> sum) {
  int total = 0;
  for (Job<int>& job : jobs) {
    try {
      total += co_await std::move(job).drained();
    } catch (const Error&) {
      total -= 1;
    }
  }
  sum->set_value(total);
}

}  // namespace

TEST_CASE("a coroutine that is stopped may wait for another job that is", "[worker]") {
  auto gate = std::make_shared<Gate>();
  Worker worker(options_with(1));
  auto held = worker.post([gate](const Control& control) {
    gate->pass();
    while (!control.stop.stop_requested()) std::this_thread::yield();
  });
  gate->wait_for_arrivals(1);
  auto first = worker.post([](const Control&) { return 1; });
  auto between = worker.post([held = 2](const Control&) { return held; });
  auto second = worker.post([held = 3](const Control&) { return held; });
  auto ended = std::make_shared<std::promise<std::string>>();
  wait_when_stopped(std::move(first), std::move(second), ended);
  gate->open();
  worker.terminate();
  CHECK(take(ended->get_future()) == "stopped");
  CHECK(outcome(between) == "stopped");
  CHECK(outcome(held) == "stopped");
  no_coroutine_is_left();
}

TEST_CASE("a coroutine may await many jobs of a worker that is gone", "[worker]") {
  auto sum = std::make_shared<std::promise<int>>();
  constexpr int kJobs = 100'000;
  std::vector<Job<int>> jobs;
  {
    WorkerOptions options = options_with(1);
    options.max_jobs = 2 * kJobs;
    Worker worker(options);
    for (int k = 0; k < kJobs; ++k) jobs.push_back(worker.post([k](const Control&) { return k >= 0 ? 1 : 0; }));
    worker.wait_until_idle();
  }
  await_all_drained(std::move(jobs), sum);
  CHECK(take(sum->get_future()) == kJobs);
  no_coroutine_is_left();
}

TEST_CASE("a coroutine that awaits a job just as it ends goes on once", "[worker]") {
  Worker worker(options_with(2));
  std::vector<Ended> ends(2000);
  for (Ended& ended : ends) await_job(worker.post([](const Control&) { return 1; }), ended.promise);
  int results = 0;
  for (Ended& ended : ends) results += ended.get().outcome == "result" ? 1 : 0;
  CHECK(results == 2000);
  no_coroutine_is_left();
}

}  // namespace welkin::test
