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

}  // namespace welkin::test
