// Promise: the waiting job of the highest priority starts next, and of equals the oldest.
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

using Order = std::vector<std::string>;

/// Posts requests that note their names in the order in which they run, once the worker's one thread is let go.
class Line {
 public:
  Job<void> post(std::string name, Priority priority) {
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
  line.post("low 1", Priority::low);
  line.post("normal 1", Priority::normal);
  line.post("high 1", Priority::high);
  line.post("low 2", Priority::low);
  line.post("high 2", Priority::high);
  line.post("normal 2", Priority::normal);
  CHECK(line.run() == Order{"high 1", "high 2", "normal 1", "normal 2", "low 1", "low 2"});
}

TEST_CASE("a waiting job moves to the end of those of its new priority", "[worker]") {
  Line line;
  auto raised = line.post("raised", Priority::low);
  line.post("high", Priority::high);
  auto lowered = line.post("lowered", Priority::normal);
  line.post("normal", Priority::normal);
  line.post("low", Priority::low);
  auto kept = line.post("kept", Priority::low);
  line.post("last", Priority::low);
  CHECK(raised.priority() == Priority::low);
  raised.set_priority(Priority::high);
  lowered.set_priority(Priority::low);
  CHECK(raised.priority() == Priority::high);
  CHECK(lowered.priority() == Priority::low);
  kept.set_priority(Priority::low);  // as it was: it keeps its place
  CHECK(line.run() == Order{"high", "raised", "normal", "low", "kept", "last", "lowered"});
}

TEST_CASE("a running job goes on when its priority is set", "[worker]") {
  Worker worker(options_with(1));
  auto gate = std::make_shared<Gate>();
  auto job = worker.post([gate](const Control&) { gate->pass(); });
  gate->wait_for_arrivals(1);
  job.set_priority(Priority::low);
  auto other = worker.post([](const Control&) { return 1; }, {.priority = Priority::high});
  gate->open();
  CHECK(other.get() == 1);
  CHECK(outcome(job) == "result");
  job.set_priority(Priority::high);
}

TEST_CASE("continuations keep the priority of the job that they follow, and come first in it", "[worker]") {
  Line line;
  auto low = line.post("low", Priority::low).then(line.note("after low"));
  CHECK(low.priority() == Priority::low);
  auto high = line.post("high", Priority::high).then(line.note("after high"));
  CHECK(high.priority() == Priority::high);
  line.post("high 2", Priority::high);
  line.post("normal", Priority::normal);
  line.post("low 2", Priority::low);
  CHECK(line.run() == Order{"high", "after high", "high 2", "normal", "low", "after low", "low 2"});
}

TEST_CASE("priorities decide on every number of threads", "[worker]") {
  for (const int threads : {2, 4}) {
    Worker worker(options_with(threads));
    std::atomic<int> high_left{50};
    std::atomic<int> low_too_early{0};
    {
      Hold hold(worker, threads);
      for (int k = 0; k < 50; ++k) {
        worker.post([&, threads](const Control&) { low_too_early += high_left > threads - 1 ? 1 : 0; },
                    {.priority = Priority::low});
        worker.post([&](const Control&) { --high_left; }, {.priority = Priority::high});
      }
    }
    worker.wait_until_idle();
    CHECK(high_left == 0);
    CHECK(low_too_early == 0);
  }
}

}  // namespace welkin::test
