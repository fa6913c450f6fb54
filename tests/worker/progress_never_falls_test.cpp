// Promise: a job's progress goes from 0 to 1 and never falls, whatever the request reports, from any thread.
#include <tbb/parallel_for.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {

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

TEST_CASE("progress is 1 once there is a result, reported or not", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([](const Control&) { return 1; });
  CHECK(outcome(job) == "result");
  CHECK(job.progress() == 1.0);
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

TEST_CASE("progress of a real projection never falls", "[worker]") {
  Worker worker(options_with(3));
  for (int repetition = 0; repetition < 5; ++repetition) {
    auto job = worker.post(ProjectCubemap{CubemapImage{256, make_cubemap(Content::random, 256, 3, 1).pixels}});
    double before = 0.0;
    bool fell = false;
    while (!job.ready()) {
      const double now = job.progress();
      fell = fell || now < before || now > 1.0;
      before = now;
    }
    CHECK_FALSE(fell);
    CHECK(job.progress() == 1.0);
    CHECK(outcome(job) == "result");
  }
}

TEST_CASE("progress reported from many threads at once never falls", "[worker]") {
  Worker worker(options_with(3));
  auto job = worker.post([](const Control& control) {
    tbb::parallel_for(0, 10000, [&](int k) { control.progress(static_cast<double>(k % 100) / 100.0); });
  });
  double before = 0.0;
  bool fell = false;
  while (!job.ready()) {
    const double now = job.progress();
    fell = fell || now < before;
    before = now;
  }
  CHECK_FALSE(fell);
  CHECK(job.progress() == 1.0);
}

}  // namespace welkin::test
