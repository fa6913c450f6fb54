// Jobs that are given up, and the progress of those that are not.
#include "jobs/tiles.h"
#include "support/catch.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: a job can be given up at any time, from anywhere, once; it stops within a tile, and the worker goes on.

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
  // The handles' own jobs wait behind: those who cancel them run first.
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

}  // namespace welkin::test
