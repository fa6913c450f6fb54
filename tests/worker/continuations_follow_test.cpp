// Promise: what follows a job runs in the worker once its result is there; an error skips it and goes on.
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/process_threads.h"
#include "support/test_environments.h"
#include "welkin/babylon.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

std::string this_threads_name() { return thread_name(static_cast<int>(syscall(SYS_gettid))); }

Job<int> post(Worker& worker, int value) {
  return worker.post([value](const Control&) { return value; });
}

}  // namespace

TEST_CASE("continuations are chained, and run on the worker's threads", "[worker]") {
  WorkerOptions options = options_with(2);
  options.name = "chain";
  Worker worker(options);
  auto job = post(worker, 2).then([](int value) { return value + 0.5; }).then([](double value) {
    return std::to_string(value) + " on " + this_threads_name();
  });
  const std::string end = job.get();
  CHECK(end.rfind("2.500000 on chain", 0) == 0);
}

TEST_CASE("a projection can be followed to an engine's form", "[worker]") {
  Worker worker(options_with(1));
  const TestCubemap cubemap = make_cubemap(Content::smooth, 32, 3, 1);
  auto job = worker.post(ProjectCubemap{CubemapImage{32, cubemap.pixels}}).then([](const Projection& light) {
    return irradiance_from_radiance(light.radiance);
  });
  const SphericalHarmonics expected = irradiance_from_radiance(project(cubemap.view()).radiance);
  CHECK(job.get().at(1, 0) == expected.at(1, 0));
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

TEST_CASE("a continuation may look at its own control", "[worker]") {
  Worker worker(options_with(1));
  Gate gate;
  auto job = post(worker, 2).then([&](int value, const Control& control) {
    control.progress(0.5);
    gate.pass();
    return control.stop.stop_possible() ? value : -1;
  });
  gate.wait_for_arrivals(1);
  CHECK(job.progress() == 0.5);
  CHECK_FALSE(job.ready());
  gate.open();
  CHECK(job.get() == 2);
}

TEST_CASE("an error skips what follows", "[worker]") {
  Worker worker(options_with(1));
  int called = 0;
  auto job = post(worker, 2)
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
  auto job = post(worker, 2);
  CHECK(eventually([&] { return job.ready(); }));
  CHECK(std::move(job).then([](int value) { return value + 1; }).get() == 3);

  auto failed = worker.post([](const Control&) { throw std::runtime_error("enough"); });
  CHECK(eventually([&] { return failed.ready(); }));
  CHECK(outcome(std::move(failed).then([] { return 1; })) == "enough");
}

TEST_CASE("after terminate what follows is stopped", "[worker]") {
  Worker worker(options_with(1));
  auto ready = post(worker, 2);
  CHECK(eventually([&] { return ready.ready(); }));
  worker.terminate();
  bool called = false;
  auto follower = std::move(ready).then([&](int) { called = true; });
  CHECK(follower.ready());
  CHECK(outcome(follower) == "stopped");
  CHECK(outcome(post(worker, 2).then([&](int) { called = true; })) == "stopped");
  CHECK_FALSE(called);
}

TEST_CASE("terminate stops whole chains", "[worker]") {
  Worker worker(options_with(1));
  auto gate = std::make_shared<Gate>();
  bool called = false;
  auto job = worker
                 .post([gate](const Control& control) {
                   gate->pass();
                   while (!control.stop.stop_requested()) std::this_thread::yield();
                 })
                 .then([&] { called = true; })
                 .then([&] { called = true; });
  gate->wait_for_arrivals(1);
  gate->open();
  worker.terminate();
  CHECK(job.ready());
  CHECK(outcome(job) == "stopped");
  CHECK_FALSE(called);
}

TEST_CASE("what follows is freed, called or not", "[worker]") {
  Worker worker(options_with(1));
  const auto token = std::make_shared<int>(0);
  auto job = post(worker, 2).then([token](int) {});
  CHECK(outcome(job) == "result");
  CHECK(eventually([&] { return token.use_count() == 1; }));
  auto failed = worker.post([](const Control&) { throw std::runtime_error("enough"); }).then([token] {});
  CHECK(outcome(failed) == "enough");
  CHECK(eventually([&] { return token.use_count() == 1; }));
  {
    Hold hold(worker);
    auto given_up = post(worker, 2).then([token](int) {});
    CHECK(given_up.cancel());
    hold.let_go();
    CHECK(outcome(given_up) == "cancelled");
    CHECK(eventually([&] { return token.use_count() == 1; }));
  }
}

TEST_CASE("a long chain neither overflows nor reorders", "[worker]") {
  Worker worker(options_with(2));
  auto job = post(worker, 0);
  for (int k = 0; k < 5000; ++k) {
    job = std::move(job).then([k](int value) { return value == k ? value + 1 : -1000000; });
  }
  CHECK(take(job.future()) == 5000);

  // Nor one that is given up at its end, or fails at its beginning.
  for (const bool cancels : {true, false}) {
    Hold hold(worker, 2);
    job = worker.post([](const Control&) -> int { throw std::runtime_error("enough"); });
    for (int k = 0; k < 5000; ++k) job = std::move(job).then([](int value) { return value; });
    if (cancels) CHECK(job.cancel());
    hold.let_go();
    CHECK(outcome(job) == (cancels ? "cancelled" : "enough"));
  }
}

TEST_CASE("a very long chain ends with its worker", "[worker]") {
  auto gate = std::make_shared<Gate>();
  Worker worker(options_with(1));
  auto job = worker.post([gate](const Control& control) {
    gate->pass();
    while (!control.stop.stop_requested()) std::this_thread::yield();
    return 0;
  });
  gate->wait_for_arrivals(1);
  auto waiting = post(worker, 0);
  for (int k = 0; k < 100'000; ++k) {
    job = std::move(job).then([](int value) { return value; });
    waiting = std::move(waiting).then([](int value) { return value; });
  }
  gate->open();
  worker.terminate();
  CHECK(outcome(job) == "stopped");
  CHECK(outcome(waiting) == "stopped");
}

}  // namespace welkin::test
