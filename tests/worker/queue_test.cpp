// The order of jobs: the latest job of a key, otherwise by priority; the limits of a worker; jobs that wait for other
// jobs.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "support/catch.h"
#include "support/jobs.h"
#include "support/process_threads.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: the newest job of a key wins: it replaces one that waits and stops one that runs.

TEST_CASE("a newer job replaces one of its key that waits", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<bool> ran{false};
  Hold hold(worker);
  auto old = worker.post([&](const Control&) { ran = true; }, {.key = "probe 7"});
  auto stranger = post_value(worker, 1, {.key = "probe 8"});
  auto keyless = post_value(worker, 2);
  auto newer = post_value(worker, 3, {.key = "probe 7"});
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
  auto old = running_job(worker, {.key = "sky"});
  auto newer = post_value(worker, 2, {.key = "sky"});
  CHECK(outcome(old) == "replaced");
  CHECK(newer.get() == 2);
}

TEST_CASE("the newest wins when posts race, and always gets its result", "[worker]") {
  Worker worker(options_with(2));
  std::vector<std::vector<Job<int>>> jobs(4);
  on_threads(jobs.size(), [&](std::size_t t) {
    for (int k = 0; k < 300; ++k) jobs[t].push_back(post_value(worker, k, {.key = "sky"}));
  });
  std::uint64_t newest = 0;
  for (const auto& posted : jobs) newest = std::max(newest, posted.back().id());
  for (auto& posted : jobs) {
    for (int k = 0; k < 300; ++k) {
      auto& job = posted[static_cast<std::size_t>(k)];
      const std::uint64_t id = job.id();
      int value = k;
      const std::string end = outcome_of([&] { value = take(job); });
      CHECK(value == k);
      if (id == newest) CHECK(end == "result");
      CHECK((end == "result" || end == "replaced"));
    }
  }
}

TEST_CASE("what follows a replaced job gets its error", "[worker]") {
  Worker worker(options_with(1));
  Hold hold(worker);
  bool called = false;
  auto follower = post_value(worker, 1, {.key = "sky"}).then([&](int) { called = true; });
  std::string drained;
  post_value(worker, 2, {.key = "probe"}).on_drain([&](Job<int> job) { drained = outcome(job); });
  auto newer_sky = post_value(worker, 3, {.key = "sky"});
  auto newer_probe = post_value(worker, 4, {.key = "probe"});
  CHECK(worker.drain() == 1);
  CHECK(drained == "replaced");
  hold.let_go();
  CHECK(outcome(follower) == "replaced");
  CHECK_FALSE(called);
  CHECK(newer_sky.get() == 3);
  CHECK(newer_probe.get() == 4);
}

// The next job to start, and the number of jobs that a worker holds.

// Promise: the waiting job of the highest priority starts next; among equals, the oldest.

namespace {

using Order = std::vector<std::string>;

/// Posts requests that record their names in the order in which they run, once the worker's only thread is released.
class Line {
 public:
  Job<void> post(std::string name, TaskPriority priority) {
    return worker_.post([this, name = std::move(name)](const Control&) { order_.push_back(name); },
                        {.priority = priority});
  }

  /// For continuations.
  auto note(std::string name) {
    return [this, name = std::move(name)] { order_.push_back(name); };
  }

  Order run() {
    hold_.let_go();
    worker_.wait_until_idle();
    return order_;
  }

 private:
  Order order_;
  Worker worker_{options_with(1)};
  Hold hold_{worker_};
};

}  // namespace

TEST_CASE("higher priorities start first, older ones before newer ones", "[worker]") {
  Line line;
  line.post("low 1", TaskPriority::low);
  line.post("normal 1", TaskPriority::normal);
  line.post("high 1", TaskPriority::high);
  line.post("low 2", TaskPriority::low);
  line.post("high 2", TaskPriority::high);
  line.post("normal 2", TaskPriority::normal);
  CHECK(line.run() == Order{"high 1", "high 2", "normal 1", "normal 2", "low 1", "low 2"});
}

TEST_CASE("a waiting job moves to the end of those of its new priority", "[worker]") {
  Line line;
  auto raised = line.post("raised", TaskPriority::low);
  line.post("high", TaskPriority::high);
  auto lowered = line.post("lowered", TaskPriority::normal);
  line.post("normal", TaskPriority::normal);
  line.post("low", TaskPriority::low);
  auto kept = line.post("kept", TaskPriority::low);
  line.post("last", TaskPriority::low);
  CHECK(raised.priority() == TaskPriority::low);
  raised.set_priority(TaskPriority::high);
  lowered.set_priority(TaskPriority::low);
  CHECK(raised.priority() == TaskPriority::high);
  CHECK(lowered.priority() == TaskPriority::low);
  kept.set_priority(TaskPriority::low);  // unchanged: it keeps its position
  CHECK(line.run() == Order{"high", "raised", "normal", "low", "kept", "last", "lowered"});
}

TEST_CASE("a worker's load tells how long the oldest job waits", "[worker]") {
  using Clock = std::chrono::steady_clock;
  Worker worker(options_with(1));
  CHECK(worker.load().oldest_wait.count() == 0);
  Hold hold(worker);
  CHECK(worker.load().oldest_wait.count() == 0);  // the only job runs
  const auto before = Clock::now();
  const JobHandle oldest = worker.post([](const Control&) {}, {.priority = TaskPriority::low});
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const auto between = Clock::now();
  const JobHandle newer = worker.post([](const Control&) {}, {.priority = TaskPriority::high});
  const auto waited = worker.load().oldest_wait;
  CHECK(waited >= std::chrono::milliseconds(2));
  CHECK(waited <= Clock::now() - before);
  oldest.set_priority(TaskPriority::high);  // moves to the end of its new queue and keeps its age
  CHECK(worker.load().oldest_wait >= waited);
  CHECK(oldest.cancel());
  const auto of_newer = worker.load().oldest_wait;
  CHECK(of_newer <= Clock::now() - between);
  hold.let_go();
  worker.wait_until_idle();
  CHECK(worker.load().oldest_wait.count() == 0);
}

TEST_CASE("continuations keep the priority of the job that they follow, and come first in it", "[worker]") {
  Line line;
  auto low = line.post("low", TaskPriority::low).then(line.note("after low"));
  CHECK(low.priority() == TaskPriority::low);
  auto high = line.post("high", TaskPriority::high).then(line.note("after high"));
  CHECK(high.priority() == TaskPriority::high);
  line.post("high 2", TaskPriority::high);
  line.post("normal", TaskPriority::normal);
  line.post("low 2", TaskPriority::low);
  CHECK(line.run() == Order{"high", "after high", "high 2", "normal", "low", "after low", "low 2"});
}

// Promise: a worker never exceeds its limits of jobs and bytes; posts beyond them are refused.

namespace {

Job<int> post(Worker& worker, TaskPriority priority = TaskPriority::normal, std::uint64_t bytes = 0) {
  return worker.post([held = 1](const Control&) { return held; }, {.priority = priority, .bytes = bytes});
}

}  // namespace

TEST_CASE("a full worker refuses requests, which never run and never wait to be moved", "[worker]") {
  Worker worker(options_with(1, {.max_jobs = 3}));  // one of them holds the thread
  Hold hold(worker);
  auto first = post(worker);
  auto second = post(worker);
  std::atomic<bool> ran{false};
  auto third = worker.post([&](const Control&) { ran = true; }, {.priority = TaskPriority::low});
  CHECK(third.ready());
  CHECK_FALSE(third.cancel());
  third.set_priority(TaskPriority::high);
  CHECK(outcome(third) == "queue_full");
  CHECK(worker.load().jobs == 3);

  // A job that ends lets another be posted.
  CHECK(first.cancel());
  auto fourth = post(worker);
  hold.let_go();
  CHECK(outcome(second) == "result");
  CHECK(outcome(fourth) == "result");
  worker.wait_until_idle();
  CHECK(worker.load().jobs == 0);
  CHECK_FALSE(ran);
}

TEST_CASE("bytes are counted: those of the request, or those that are named", "[worker]") {
  constexpr std::uint64_t kMost = 6 * 8 * 8 * 12 + 100;
  Worker worker(options_with(1, {.max_bytes = kMost}));
  const TestCubemap cubemap = make_cubemap(Content::random, 8, 3, 1);
  const auto request = [&] { return Project{Cubemap{8, cubemap.pixels}}; };
  Hold hold(worker);
  auto first = worker.post(request());
  CHECK(worker.load().bytes == 6 * 8 * 8 * 12);
  CHECK(outcome(worker.post(request())) == "queue_full");
  CHECK(outcome(post(worker, TaskPriority::normal, 101)) == "queue_full");
  auto named = post(worker, TaskPriority::normal, 100);
  auto nothing = post(worker);
  auto underrated = worker.post(request(), {.bytes = 0});
  CHECK(worker.load().bytes == kMost);
  hold.let_go();
  CHECK(outcome(first) == "result");
  CHECK(outcome(named) == "result");
  CHECK(outcome(nothing) == "result");
  CHECK(outcome(underrated) == "result");
  worker.wait_until_idle();
  CHECK(worker.load().bytes == 0);
}

TEST_CASE("a request larger than the limit can never be let in, and replaces nothing", "[worker]") {
  Worker worker(options_with(1, {.max_bytes = 100}));
  Hold hold(worker);
  auto bystander = post_value(worker, 1, {.priority = TaskPriority::low, .key = "sky", .bytes = 100});
  auto large = post_value(worker, 2, {.priority = TaskPriority::high, .key = "sky", .bytes = 101});
  CHECK(large.ready());
  CHECK(outcome(large) == "limit_exceeded");
  hold.let_go();
  CHECK(outcome(bystander) == "result");
  CHECK(outcome(post(worker, TaskPriority::normal, 100)) == "result");
}

TEST_CASE("what the worker's own threads post is refused at the limits too", "[worker]") {
  Worker worker(options_with(1, {.max_jobs = 1, .max_bytes = 100}));
  auto job = worker.post(
      [&](const Control&) {
        std::vector<std::string> ends;
        for (int k = 0; k < 3; ++k) ends.push_back(outcome_of([&] { post(worker, TaskPriority::low, 60).get(); }));
        auto followed = post(worker, TaskPriority::normal, 60).then([](int value) { return value + 10; });
        ends.push_back(outcome_of([&] { followed.get(); }));
        return ends;
      },
      {.bytes = 100});
  CHECK(take(job) == std::vector<std::string>(4, "queue_full"));
}

TEST_CASE("continuations are never refused", "[worker]") {
  Worker worker(options_with(1, {.max_jobs = 2}));
  Hold hold(worker);
  auto last = post(worker);
  for (int k = 0; k < 10; ++k) {
    last = std::move(last).then([](int value) { return value + 1; });
  }
  hold.let_go();
  CHECK(take(last) == 11);
}

TEST_CASE("a worker refuses options out of range", "[worker]") {
  for (const int threads : {-1, 1025}) {
    WorkerOptions options{.threads = threads};
    const ThrownError error = thrown_by([&] { const Worker worker(options); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says(std::to_string(threads)));
  }
}

// Promise: a job may wait for another job of its worker by `get()`, however few threads there are: the waiting thread
// runs the other job.

namespace {

/// A chain of `depth` nested requests, each of which waits for the next.
int nest(Worker& worker, int depth) {
  if (depth == 0) return 1;
  return 1 + worker.post([&worker, depth](const Control&) { return nest(worker, depth - 1); }).get();
}

/// Returns options of workers with one thread, with several, and with a lent arena.
std::vector<WorkerOptions> kinds_of_workers(tbb::task_arena& arena) {
  return {options_with(1), options_with(2), options_with(4), lent(arena)};
}

}  // namespace

TEST_CASE("waiting jobs may be nested", "[worker]") {
  tbb::task_arena arena(1);
  for (const WorkerOptions& options : kinds_of_workers(arena)) {
    Worker worker(options);
    for (const int depth : {3, 8}) {
      auto job = worker.post([&worker, depth](const Control&) { return nest(worker, depth); });
      CHECK(take(job) == depth + 1);
    }
  }
}

TEST_CASE("a job of the lowest priority behind many others may be waited for", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([&](const Control&) {
    for (int k = 0; k < 50; ++k) post_value(worker, k, {.priority = TaskPriority::high});
    return post_value(worker, 7, {.priority = TaskPriority::low}).get();
  });
  CHECK(take(job) == 7);
}

TEST_CASE("all threads may wait at once", "[worker]") {
  tbb::task_arena arena(1);
  for (const WorkerOptions& options : kinds_of_workers(arena)) {
    Worker worker(options);
    std::vector<Job<int>> jobs;
    for (int k = 0; k < 12; ++k) {
      jobs.push_back(worker.post([&worker, k](const Control&) { return post_value(worker, k).get(); }));
    }
    for (int k = 0; k < 12; ++k) CHECK(take(jobs[static_cast<std::size_t>(k)]) == k);
  }
}

TEST_CASE("a job may be waited for inside a TBB task of the worker's arena", "[worker]") {
  for (const int threads : {1, 2, 3}) {
    Worker worker(options_with(threads));
    auto job = worker.post([&](const Control&) {
      std::atomic<int> sum{0};
      tbb::parallel_for(0, 20, [&](int k) { sum += post_value(worker, k).get(); });
      return sum.load();
    });
    CHECK(take(job) == 190);
  }
}

TEST_CASE("tasks of one job may wait for another job whose tasks run beside them", "[worker][slow]") {
  // A job that waits for its own tasks must not pick up a job that waits for it.
  Worker worker(options_with(3));
  for (int round = 0; round < (kSanitized ? 20 : 100); ++round) {
    auto waited_for = worker.post([round](const Control&) {
      tbb::parallel_for(0, 12, [](int) {
        for (int k = 0; k < 20; ++k) std::this_thread::yield();
      });
      return round;
    });
    auto waiting = worker.post([&waited_for, round](const Control&) {
      std::atomic<int> sum{0};
      tbb::parallel_for(0, 12, [&](int k) { sum += k == round % 12 ? waited_for.get() : 1; });
      return sum.load();
    });
    CHECK(take(waiting) == 11 + round);
  }
}

TEST_CASE("continuations, and those who wait for them, need no further thread", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([&](const Control&) {
    return post_value(worker, 3).then([&](int value) { return value + post_value(worker, 4).get(); }).get();
  });
  CHECK(take(job) == 7);
  auto follower = post_value(worker, 1).then([&](int value) { return value + post_value(worker, 10).get(); });
  CHECK(take(follower) == 11);
}

TEST_CASE("what follows a running job is run by whoever waits for it, if all threads wait", "[worker]") {
  Worker worker(options_with(2));
  Gate gate;
  auto first = worker.post([&](const Control&) {
    gate.pass();
    return 5;
  });
  gate.wait_for_arrivals(1);
  auto second = std::move(first).then([](int value) { return value + 1; });
  // `waiting` waits for the continuation while the first job runs. The first job's thread then starts `blocking`, whose
  // priority is higher than the continuation's. It waits until the continuation has run, which only `waiting` can run.
  std::atomic<bool> taken{false};
  auto waiting = worker.post([&](const Control&) {
    const int value = second.get();
    taken = true;
    return value;
  });
  CHECK(eventually([&] { return worker.load().running == 2; }));
  auto blocking = worker.post([&](const Control&) { return eventually([&] { return taken.load(); }); },
                              {.priority = TaskPriority::high});
  gate.open();
  CHECK(take(waiting) == 6);
  CHECK(take(blocking));
}

TEST_CASE("a waiting job can be given up by ending the worker", "[worker]") {
  std::string inner_end;
  Job<void> outer;
  {
    Worker worker(options_with(1));
    Gate gate;
    outer = worker.post([&](const Control&) {
      auto inner = worker.post([&](const Control& control) {
        gate.pass();
        run_until_stopped(control);
      });
      inner_end = outcome_of([&] { inner.get(); });
    });
    gate.wait_for_arrivals(1);
    gate.open();
    worker.terminate();
  }
  CHECK(outcome(outer) == "stopped");
  CHECK(inner_end == "stopped");
}

TEST_CASE("requests may wait for each other in a row", "[worker]") {
  Worker worker(options_with(3));
  for (int round = 0; round < (kSanitized ? 20 : 200); ++round) {
    auto first = post_value(worker, 1);
    auto second = worker.post([&](const Control&) { return first.get() + 1; });
    auto third = worker.post([&](const Control&) { return second.get() + 1; });
    auto fourth = worker.post([&](const Control&) { return third.get() + 1; });
    CHECK(take(fourth) == 4);
  }
}

}  // namespace welkin::test
