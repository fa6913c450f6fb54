// Promise: results go from the request to whoever takes them without a copy, on every way there is.
#include <atomic>
#include <memory>
#include <utility>

#include "support/catch.h"
#include "support/detached.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

std::atomic<int> copies{0};

/// Counts its copies. Has no default and cannot be assigned, as results need not.
class Copied {
 public:
  explicit Copied(int value) : value_(value) {}
  Copied(const Copied& other) : value_(other.value_) { ++copies; }
  Copied(Copied&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Copied& operator=(const Copied&) = delete;
  Copied& operator=(Copied&&) = delete;
  ~Copied() = default;

  [[nodiscard]] int value() const { return value_; }

 private:
  int value_;
};

Job<Copied> post_seven(Worker& worker) {
  return worker.post([](const Control&) { return Copied(7); });
}

Detached await_into(Job<Copied> job, bool drained, std::promise<int>& got) {
  if (drained) {
    got.set_value((co_await std::move(job).drained()).value());
  } else {
    got.set_value((co_await std::move(job)).value());
  }
}

}  // namespace

TEST_CASE("no way of taking a result copies it", "[worker]") {
  Worker worker(options_with(2));
  copies = 0;
  CHECK(post_seven(worker).get().value() == 7);
  CHECK(take(post_seven(worker).future()).value() == 7);
  CHECK(take(post_seven(worker).then([](Copied seven) { return seven; }).future()).value() == 7);
  CHECK(take(post_seven(worker).then([](Copied&& seven) { return seven.value(); }).future()) == 7);
  CHECK(take(post_seven(worker).then([](const Copied& seven) { return seven.value(); }).future()) == 7);

  int drained = 0;
  post_seven(worker).on_drain([&](std::future<Copied> future) { drained = future.get().value(); });
  CHECK(eventually([&] { return worker.drain() == 1; }));
  CHECK(drained == 7);

  std::promise<int> awaited;
  await_into(post_seven(worker), false, awaited);
  CHECK(take(awaited.get_future()) == 7);
  std::promise<int> awaited_in_drain;
  await_into(post_seven(worker), true, awaited_in_drain);
  CHECK(eventually([&] { return worker.drain() == 1; }));
  CHECK(take(awaited_in_drain.get_future()) == 7);
  CHECK(copies == 0);
}

TEST_CASE("requests, results and follow-ups that only move will do", "[worker]") {
  Worker worker(options_with(1));
  auto job = worker.post([held = std::make_unique<int>(3)](const Control&) mutable { return std::move(held); });
  auto next = std::move(job).then(
      [four = std::make_unique<int>(4)](std::unique_ptr<int> three) { return std::make_unique<int>(*three + *four); });
  int drained = 0;
  std::move(next).on_drain([five = std::make_unique<int>(5), &drained](std::future<std::unique_ptr<int>> future) {
    drained = *future.get() + *five;
  });
  CHECK(eventually([&] { return worker.drain() == 1; }));
  CHECK(drained == 12);
}

TEST_CASE("a request may give nothing", "[worker]") {
  Worker worker(options_with(1));
  bool ran = false;
  worker.post([&](const Control&) { ran = true; }).get();
  CHECK(ran);
}

TEST_CASE("a request may be a member of what it is posted with, or a function", "[worker]") {
  Worker worker(options_with(1));
  struct Half {
    double of;
    double operator()(const Control&) const { return of / 2.0; }
  };
  CHECK(worker.post(Half{5.0}).get() == 2.5);
  int (*const function)(const Control&) = [](const Control&) { return 9; };
  CHECK(worker.post(function).get() == 9);
}

TEST_CASE("of jobs that share a run all but one get a copy", "[worker]") {
  struct Seven {
    Copied operator()(const Control&) const { return Copied(7); }
    bool operator==(const Seven&) const = default;
  };
  Worker worker(options_with(1));
  copies = 0;
  // A result that can be copied but not assigned is not std::copyable, which sharing asks for: three runs, no copy.
  std::vector<std::future<Copied>> futures;
  {
    Hold hold(worker);
    for (int k = 0; k < 3; ++k) futures.push_back(worker.post(Seven{}).future());
  }
  for (auto& future : futures) CHECK(take(std::move(future)).value() == 7);
  CHECK(copies == 0);

  struct Vector {
    std::vector<int> operator()(const Control&) const { return std::vector<int>(1000, 7); }
    bool operator==(const Vector&) const = default;
  };
  std::vector<std::future<std::vector<int>>> vectors;
  {
    Hold hold(worker);
    for (int k = 0; k < 3; ++k) vectors.push_back(worker.post(Vector{}).future());
  }
  for (auto& vector : vectors) CHECK(take(std::move(vector)) == std::vector<int>(1000, 7));
}

}  // namespace welkin::test
