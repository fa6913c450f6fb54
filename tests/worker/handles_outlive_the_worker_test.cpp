// Promise: ids rise, `ready` means that the future will not wait, and a handle can be asked after its worker is gone.
#include <algorithm>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "welkin/worker.h"

namespace welkin::test {

TEST_CASE("ids rise from 1 on, through all workers", "[worker]") {
  CHECK(JobHandle().id() == 0);
  CHECK(Job<int>().id() == 0);
  Worker first(options_with(1));
  Worker second(options_with(1));
  std::uint64_t before = 0;
  for (int k = 0; k < 50; ++k) {
    auto job = (k % 2 == 0 ? first : second).post([k](const Control&) { return k; });
    CHECK(job.id() > before);
    before = job.id();
    auto follower = std::move(job).then([](int value) { return value; });
    CHECK(follower.id() > before);
    before = follower.id();
  }
}

TEST_CASE("ids are unique when posted from many threads", "[worker]") {
  Worker worker(options_with(2));
  constexpr std::size_t kThreads = 4;
  std::vector<std::vector<std::uint64_t>> ids(kThreads);
  std::vector<std::thread> threads;
  for (auto& own : ids) {
    threads.emplace_back([&worker, &own] {
      for (int k = 0; k < 200; ++k) own.push_back(worker.post([k](const Control&) { return k; }).id());
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<std::uint64_t> all;
  for (const auto& own : ids) {
    CHECK(std::is_sorted(own.begin(), own.end()));
    all.insert(own.begin(), own.end());
  }
  CHECK(all.size() == kThreads * 200);
}

TEST_CASE("ready means that the future does not wait, for results and errors", "[worker]") {
  Worker worker(options_with(1));
  for (const bool fails : {false, true}) {
    auto job = worker.post([fails](const Control&) {
      if (fails) throw Error(ErrorCode::corrupt_file, "no good");
    });
    CHECK(eventually([&] { return job.ready(); }));
    auto future = job.future();
    CHECK(future.wait_for(std::chrono::seconds(0)) == std::future_status::ready);
    CHECK(job.ready());
    CHECK(outcome(std::move(future)) == (fails ? "corrupt_file" : "result"));
    CHECK(job.ready());
  }
}

TEST_CASE("handles and futures outlive their worker", "[worker]") {
  auto worker = std::make_unique<Worker>(options_with(1));
  auto done = worker->post([](const Control&) { return 5; });
  auto followed = worker->post([](const Control&) { return 5; });
  const JobHandle copy = done;
  worker->wait_until_idle();
  auto hold = std::make_unique<Hold>(*worker);
  auto waiting = worker->post([](const Control&) { return 6; }, {.priority = Priority::high});
  hold->let_go();
  hold.reset();
  worker.reset();

  CHECK(copy.id() == done.id());
  CHECK(done.ready());
  CHECK(copy.progress() == 1.0);
  CHECK(done.get() == 5);
  CHECK(waiting.ready());
  CHECK(waiting.priority() == Priority::high);
  CHECK_FALSE(waiting.cancel());
  CHECK_FALSE(copy.cancel());
  waiting.set_priority(Priority::low);
  const std::string end = outcome(waiting);
  CHECK((end == "result" || end == "stopped"));

  bool called = false;
  auto follower = std::move(followed).then([&](int) { called = true; });
  CHECK(follower.ready());
  CHECK(outcome(follower) == "stopped");
  CHECK_FALSE(called);
}

TEST_CASE("a job that is let go of runs to its end", "[worker]") {
  Worker worker(options_with(1));
  std::atomic<int> runs{0};
  {
    Hold hold(worker);
    for (int k = 0; k < 10; ++k) worker.post([&runs, k](const Control&) { runs += k; });
  }
  worker.wait_until_idle();
  CHECK(runs == 45);
}

TEST_CASE("a handle can be asked from any thread while its job runs", "[worker]") {
  Worker worker(options_with(1));
  auto gate = std::make_shared<Gate>();
  auto job = worker.post([gate](const Control&) { gate->pass(); });
  std::atomic<bool> fell{false};
  std::vector<std::thread> threads;
  for (int k = 0; k < 3; ++k) {
    threads.emplace_back([handle = JobHandle(job), &fell] {
      double before = 0.0;
      while (!handle.ready()) {
        if (handle.progress() < before || handle.priority() != Priority::normal || handle.id() == 0) fell = true;
        before = handle.progress();
        std::this_thread::yield();
      }
    });
  }
  gate->wait_for_arrivals(1);
  gate->open();
  for (std::thread& thread : threads) thread.join();
  CHECK_FALSE(fell);
}

}  // namespace welkin::test
