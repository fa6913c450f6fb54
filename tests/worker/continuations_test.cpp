// Follow-ups of a job: callbacks in `drain()`, continuations in the worker.
#include "support/catch.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: callbacks run inside `drain()`, nowhere else, in the order in which jobs finished and within the budget.

namespace {

/// Posts a job whose callback records a number.
void note(Worker& worker, std::vector<int>& notes, int number, TaskPriority priority = TaskPriority::normal) {
  worker.post([number](const Control&) { return number; }, {.priority = priority}).on_drain([&notes](Job<int> job) {
    notes.push_back(job.get());
  });
}

void spend(std::chrono::microseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < end) {
  }
}

}  // namespace

TEST_CASE("callbacks run on the thread that drains, inside the call", "[worker]") {
  Worker worker(options_with(2));
  std::atomic<bool> inside_drain{false};
  std::atomic<int> astray{0};
  std::atomic<int> called{0};
  for (int k = 0; k < 50; ++k) {
    worker.post([k](const Control&) { return k; }).on_drain([&, thread = std::this_thread::get_id()](Job<int> job) {
      if (!inside_drain || std::this_thread::get_id() != thread) ++astray;
      if (!job.ready()) ++astray;
      ++called;
    });
  }
  worker.wait_until_idle();
  CHECK(called == 0);
  CHECK(worker.load().undrained == 50);
  inside_drain = true;
  CHECK(worker.drain() == 50);
  inside_drain = false;
  CHECK(called == 50);
  CHECK(astray == 0);
  CHECK(worker.load().undrained == 0);
  CHECK(worker.drain() == 0);
}

TEST_CASE("callbacks come in the order in which their jobs finished", "[worker]") {
  Worker worker(options_with(1));
  std::vector<int> notes;
  {
    Hold hold(worker);
    note(worker, notes, 4, TaskPriority::low);
    note(worker, notes, 2, TaskPriority::normal);
    note(worker, notes, 3, TaskPriority::normal);
    note(worker, notes, 1, TaskPriority::high);
    auto given_up = worker.post([](const Control&) { return 0; });
    const JobHandle handle = given_up;
    std::move(given_up).on_drain([&](Job<int> job) {
      CHECK(outcome(job) == "cancelled");
      notes.push_back(0);
    });
    CHECK(handle.cancel());
  }
  worker.wait_until_idle();
  CHECK(worker.drain() == 5);
  CHECK(notes == std::vector<int>{0, 1, 2, 3, 4});
}

TEST_CASE("a budget of nothing runs one callback", "[worker]") {
  Worker worker(options_with(1));
  std::vector<int> notes;
  for (int k = 0; k < 5; ++k) note(worker, notes, k);
  worker.wait_until_idle();
  for (std::size_t k = 1; k <= 5; ++k) {
    // `drain()` calls nothing if the worker's thread holds the mutex and is not scheduled.
    std::size_t called = 0;
    CHECK(eventually([&] { return (called = worker.drain(std::chrono::nanoseconds(0))) > 0; }));
    CHECK(called == 1);
    CHECK(notes.size() == k);
  }
  CHECK(worker.drain(std::chrono::nanoseconds(0)) == 0);
  CHECK(notes == std::vector<int>{0, 1, 2, 3, 4});
}

TEST_CASE("draining ends when its budget is spent", "[worker]") {
  Worker worker(options_with(1));
  for (int k = 0; k < 20; ++k) {
    worker.post([](const Control&) {}).on_drain([](Job<void>) { spend(std::chrono::milliseconds(2)); });
  }
  worker.wait_until_idle();
  // Each callback takes 2 ms or more: the third starts after 4 ms at least.
  const std::size_t called = worker.drain(std::chrono::milliseconds(3));
  CHECK(called >= 1);
  CHECK(called <= 2);
  CHECK(worker.drain(std::chrono::microseconds(1)) == 1);
  CHECK(worker.drain() == 20 - 1 - called);
}

TEST_CASE("what a callback throws comes out, and the others wait", "[worker]") {
  Worker worker(options_with(1));
  std::vector<int> notes;
  note(worker, notes, 1);
  worker.post([](const Control&) {}).on_drain([](Job<void>) { throw std::runtime_error("callback"); });
  worker.post([](const Control&) { throw std::runtime_error("request"); }).on_drain([](Job<void> job) { job.get(); });
  note(worker, notes, 2);
  worker.wait_until_idle();
  CHECK(outcome_of([&] { worker.drain(); }) == "callback");
  CHECK(notes == std::vector<int>{1});
  CHECK(outcome_of([&] { worker.drain(); }) == "request");
  CHECK(notes == std::vector<int>{1});
  CHECK(worker.drain() == 1);
  CHECK(notes == std::vector<int>{1, 2});
}

TEST_CASE("a callback may drain", "[worker]") {
  Worker worker(options_with(1));
  std::vector<int> notes;
  std::size_t inner = 0;
  worker.post([](const Control&) {}).on_drain([&](Job<void>) {
    inner = worker.drain();
    notes.push_back(0);
  });
  for (int k = 1; k <= 3; ++k) note(worker, notes, k);
  worker.wait_until_idle();
  CHECK(worker.drain() + inner >= 4);
  CHECK(inner == 3);
  CHECK(notes == std::vector<int>{1, 2, 3, 0});
}

TEST_CASE("threads that drain at once call every callback once", "[worker]") {
  Worker worker(options_with(2));
  constexpr int kJobs = 400;
  std::vector<std::atomic<int>> calls(kJobs);
  std::atomic<bool> posted{false};
  std::atomic<std::size_t> drained{0};
  std::vector<std::thread> drainers;
  for (int t = 0; t < 3; ++t) {
    drainers.emplace_back([&] {
      while (!posted || drained < kJobs) {
        drained += worker.drain(std::chrono::microseconds(20));
        std::this_thread::yield();
      }
    });
  }
  for (int k = 0; k < kJobs; ++k) {
    worker.post([k](const Control&) { return k; }).on_drain([&](Job<int> job) {
      ++calls[static_cast<std::size_t>(job.get())];
    });
  }
  posted = true;
  for (std::thread& drainer : drainers) drainer.join();
  CHECK(drained == kJobs);
  for (const auto& called : calls) CHECK(called == 1);
}

TEST_CASE("a callback may post, follow and give up", "[worker]") {
  Worker worker(options_with(1));
  std::vector<int> notes;
  Hold hold(worker);
  auto victim = worker.post([](const Control&) { return 1; });
  auto first = worker.post([](const Control&) { return 2; });
  first.cancel();
  std::move(first).on_drain([&](Job<int>) {
    CHECK(victim.cancel());
    note(worker, notes, 3);
    worker.post([](const Control&) { return 4; }).then([](int value) { return value; }).on_drain([&](auto job) {
      notes.push_back(job.get());
    });
  });
  CHECK(worker.drain() == 1);
  CHECK(outcome(victim) == "cancelled");
  hold.let_go();
  worker.wait_until_idle();
  CHECK(worker.drain() == 2);
  CHECK(notes == std::vector<int>{3, 4});
}

TEST_CASE("callbacks can be drained after terminate", "[worker]") {
  Worker worker(options_with(1));
  std::vector<std::string> ends;
  const auto note_end = [&](Job<int> job) { ends.push_back(outcome(job)); };
  post_value(worker, 1).on_drain(note_end);
  worker.wait_until_idle();
  running_job(worker).on_drain(note_end);
  post_value(worker, 2).on_drain(note_end);
  worker.terminate();
  post_value(worker, 3).on_drain(note_end);
  CHECK(ends.empty());
  CHECK(worker.drain() == 4);
  CHECK(std::count(ends.begin(), ends.end(), "result") == 1);
  CHECK(ends.front() == "result");
  CHECK(std::count(ends.begin(), ends.end(), "stopped") == 3);
  CHECK(worker.load().jobs == 0);
}

// Promise: what follows a job runs in the worker once its result is there; an error skips it and goes on.

TEST_CASE("continuations are chained, and run on the worker's threads", "[worker]") {
  Worker worker(options_with(2, {.name = "chain"}));
  auto job = post_value(worker, 2).then([](int value) { return value + 0.5; }).then([](double value) {
    return std::to_string(value) + " on " + this_threads_name();
  });
  const std::string end = job.get();
  CHECK(end.rfind("2.500000 on chain", 0) == 0);
}

TEST_CASE("nothing can be followed by nothing", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<int> steps{0};
  worker.post([&](const Control&) { ++steps; })
      .then([&] { ++steps; })
      .then([&](const Control&) { ++steps; })
      .then([&] { return ++steps; })
      .then([&](int so_far) { steps = so_far + 10; })
      .get();
  CHECK(steps == 14);
}

TEST_CASE("an error skips what follows", "[worker]") {
  Worker worker(options_with(1));
  int called = 0;
  auto job = post_value(worker, 2)
                 .then([](int) -> int { throw Error(ErrorCode::unsupported_file, "not this one"); })
                 .then([&](int value) {
                   ++called;
                   return value;
                 })
                 .then([&](int) { ++called; });
  CHECK(outcome(job) == "unsupported_file");
  CHECK(called == 0);
}

TEST_CASE("a job that is ready can be followed", "[worker]") {
  Worker worker(options_with(1));
  auto job = post_value(worker, 2);
  CHECK(eventually([&] { return job.ready(); }));
  CHECK(std::move(job).then([](int value) { return value + 1; }).get() == 3);

  auto failed = worker.post([](const Control&) { throw std::runtime_error("enough"); });
  CHECK(eventually([&] { return failed.ready(); }));
  CHECK(outcome(std::move(failed).then([] { return 1; })) == "enough");
}

TEST_CASE("a long chain neither overflows nor reorders", "[worker]") {
  Worker worker(options_with(2));
  auto job = post_value(worker, 0);
  for (int k = 0; k < 5000; ++k) {
    job = std::move(job).then([k](int value) { return value == k ? value + 1 : -1000000; });
  }
  CHECK(take(job) == 5000);

  // A chain that is cancelled at its end, or fails at its beginning, does not overflow the stack either.
  for (const bool cancels : {true, false}) {
    Hold hold(worker, 2);
    job = worker.post([](const Control&) -> int { throw std::runtime_error("enough"); });
    for (int k = 0; k < 5000; ++k) job = std::move(job).then([](int value) { return value; });
    if (cancels) CHECK(job.cancel());
    hold.let_go();
    CHECK(outcome(job) == (cancels ? "cancelled" : "enough"));
  }
}

TEST_CASE("a very long chain ends with its worker", "[worker][slow]") {
  Worker worker(options_with(1));
  auto job = running_job(worker);
  auto waiting = post_value(worker, 0);
  for (int k = 0; k < 100'000; ++k) {
    job = std::move(job).then([](int value) { return value; });
    waiting = std::move(waiting).then([](int value) { return value; });
  }
  worker.terminate();
  CHECK(outcome(job) == "stopped");
  CHECK(outcome(waiting) == "stopped");
}

// Coroutines that await jobs.

// Promise: `co_await` on a job gives its result or throws its error, in the worker or in `drain()`; no coroutine is
// ever lost.

namespace {

/// Where and how a coroutine resumed.
struct End {
  std::string outcome;
  std::string thread;
  std::thread::id thread_id;
};

/// Awaits the job, in `drain()` if `drained`, and reports the outcome to `ended`.
template <class Result>
Detached await_job(Job<Result> job, std::shared_ptr<std::promise<End>> ended, bool drained = false) {
  std::string outcome = "result";
  try {
    if (drained) {
      static_cast<void>(co_await std::move(job).drained());
    } else {
      static_cast<void>(co_await std::move(job));
    }
  } catch (const Error& error) {
    outcome = name(error.code());
  } catch (const std::exception& exception) {
    outcome = exception.what();
  }
  ended->set_value({outcome, this_threads_name(), std::this_thread::get_id()});
}

/// A promise that can be shared with coroutines, and its future.
struct Ended {
  std::shared_ptr<std::promise<End>> promise = std::make_shared<std::promise<End>>();
  std::future<End> future = promise->get_future();

  [[nodiscard]] bool there() const { return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
  End get() { return take(std::move(future)); }
};

void no_coroutine_is_left() {
  CHECK(eventually([] { return Detached::alive == 0; }));
}

}  // namespace

TEST_CASE("a coroutine goes on in the worker with the result", "[worker]") {
  Worker worker(options_with(1, {.name = "await"}));
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
  Worker worker(options_with(1, {.name = "await"}));
  auto job = worker.post([](const Control&) { return 1; });
  CHECK(eventually([&] { return job.ready(); }));
  Ended ended;
  await_job(std::move(job), ended.promise);
  CHECK(ended.there());
  CHECK(ended.get().thread_id == std::this_thread::get_id());
  no_coroutine_is_left();
}

TEST_CASE("a coroutine can ask to go on in drain", "[worker]") {
  Worker worker(options_with(1, {.name = "await"}));
  auto ready = worker.post([](const Control&) { return 1; });
  CHECK(eventually([&] { return ready.ready(); }));
  Ended first;
  await_job(std::move(ready), first.promise, true);
  CHECK_FALSE(first.there());
  Ended second;
  await_job(worker.post([](const Control&) -> int { throw std::runtime_error("enough"); }), second.promise, true);
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
  Ended running;
  await_job(running_job(worker), running.promise);
  Ended waiting;
  await_job(worker.post([](const Control&) { return 1; }), waiting.promise);
  Ended following;
  await_job(worker.post([](const Control&) { return 1; }).then([](int value) { return value; }), following.promise);
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
    await_job(post_value(worker, 1), done.promise, true);
    worker.wait_until_idle();
    Hold hold(worker);
    await_job(post_value(worker, 1), stopped.promise, true);
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

/// Awaits each job in `drain()`, or on the current thread once nothing drains any more.
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
    Worker worker(options_with(1, {.max_jobs = 2 * kJobs}));
    Hold hold(worker);  // its thread does not contend for the queue with each post
    for (int k = 0; k < kJobs; ++k) jobs.push_back(worker.post([k](const Control&) { return k >= 0 ? 1 : 0; }));
    hold.let_go();
    worker.wait_until_idle();
  }
  await_all_drained(std::move(jobs), sum);
  CHECK(take(sum->get_future()) == kJobs);
  no_coroutine_is_left();
}

}  // namespace welkin::test
