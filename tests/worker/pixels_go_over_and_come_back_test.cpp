// Promise: posted pixels are not copied, and their memory comes back however a job ends.
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

CubemapImage some_image() { return {8, make_cubemap(Content::random, 8, 3, 1).pixels}; }

/// Shared pixels, and a way to see whether they are still held by anyone.
struct Watched {
  std::shared_ptr<const CubemapImage> image = std::make_shared<const CubemapImage>(some_image());
  std::weak_ptr<const CubemapImage> weak = image;

  [[nodiscard]] CubemapSource give() { return {std::move(image)}; }
  [[nodiscard]] bool comes_back() const {
    return eventually([&] { return weak.expired(); });
  }
};

}  // namespace

TEST_CASE("a request sees the very pixels that were moved in", "[worker]") {
  Worker worker(options_with(1));
  CubemapImage image = some_image();
  const float* pixels = image.pixels.data();
  auto job = worker.post([request = ProjectCubemap{std::move(image)}](const Control& control) {
    static_cast<void>(request(control));
    return request.source.view().faces[0];
  });
  CHECK(job.get() == pixels);
}

TEST_CASE("pixels are freed when their job is done, handles or not", "[worker]") {
  Worker worker(options_with(1));
  Watched watched;
  auto job = worker.post(ProjectCubemap{watched.give()});
  CHECK(outcome(job) == "result");
  CHECK(watched.comes_back());
  CHECK(job.id() > 0);
}

TEST_CASE("pixels are freed when their job fails", "[worker]") {
  Worker worker(options_with(1));
  Watched watched;
  ProjectionOptions options;
  options.bands = 99;
  auto job = worker.post(ProjectCubemap{watched.give(), options});
  CHECK(outcome(job) == "invalid_argument");
  CHECK(watched.comes_back());
}

TEST_CASE("pixels of a waiting job are freed when it is given up, while the threads are busy", "[worker]") {
  WorkerOptions options = options_with(1);
  options.when_full = WhenFull::drop_oldest;
  options.most_jobs = 2;
  Worker worker(options);
  Hold hold(worker);

  Watched cancelled;
  auto job = worker.post(ProjectCubemap{cancelled.give()});
  CHECK(job.cancel());
  CHECK(cancelled.comes_back());

  Watched replaced;
  job = worker.post(ProjectCubemap{replaced.give()}, {.key = "probe"});
  auto newer = worker.post([](const Control&) {}, {.key = "probe"});
  CHECK(outcome(job) == "replaced");
  CHECK(replaced.comes_back());
  newer.cancel();

  Watched dropped;
  job = worker.post(ProjectCubemap{dropped.give()}, {.priority = Priority::low});
  newer = worker.post([](const Control&) {});
  CHECK(outcome(job) == "queue_full");
  CHECK(dropped.comes_back());

  Watched refused;
  job = worker.post(ProjectCubemap{refused.give()}, {.priority = Priority::low});
  CHECK(outcome(job) == "queue_full");
  CHECK(refused.comes_back());
}

TEST_CASE("pixels of a running job are freed once it has stopped", "[worker]") {
  Worker worker(options_with(1));
  Watched watched;
  std::atomic<bool> inside{false};
  std::atomic<bool> looking{false};
  std::atomic<bool> gone_while_looking{false};
  auto job = worker.post([&, source = watched.give()](const Control& control) {
    looking = true;
    inside = true;
    while (!control.stop.stop_requested()) std::this_thread::yield();
    if (watched.weak.expired() || source.view().size != 8) gone_while_looking = true;
    looking = false;
  });
  CHECK(eventually([&] { return inside.load(); }));
  CHECK(job.cancel());
  CHECK(outcome(job) == "cancelled");
  CHECK_FALSE(looking);  // the future is ready when nothing reads the pixels any more
  CHECK_FALSE(gone_while_looking);
  CHECK(watched.comes_back());
}

TEST_CASE("pixels are freed when their worker ends", "[worker]") {
  Watched waiting;
  Watched undrained;
  Watched late;
  JobHandle handle;
  {
    Worker worker(options_with(1));
    Gate gate;
    auto held = worker.post([&](const Control&) { gate.pass(); }, {.priority = Priority::high});
    gate.wait_for_arrivals(1);
    auto job = worker.post(ProjectCubemap{waiting.give()});
    handle = job;
    worker.post([](const Control&) {}).on_drain([image = undrained.give()](std::future<void>) {});
    gate.open();
    worker.terminate();
    CHECK(waiting.comes_back());
    CHECK_FALSE(undrained.weak.expired());
    CHECK(outcome(worker.post(ProjectCubemap{late.give()})) == "stopped");
    CHECK(late.comes_back());
  }
  CHECK(undrained.comes_back());
  CHECK(handle.ready());
}

TEST_CASE("a result that nobody takes is freed", "[worker]") {
  Worker worker(options_with(1));
  const auto result = std::make_shared<int>(1);
  {
    auto job = worker.post([result](const Control&) { return result; });
    worker.wait_until_idle();
  }
  CHECK(eventually([&] { return result.use_count() == 1; }));
}

}  // namespace welkin::test
