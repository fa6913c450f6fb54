// Sources that are posted, the pixels behind them, and handles of jobs.
#include "support/catch.h"
#include "support/jobs.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/requests.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: a source takes over or shares pixels and never copies them; it has their size and identity.

namespace {

Cubemap some_cubemap(int size) { return {size, make_cubemap(Content::random, size, 3, 1).pixels}; }
LatLongImage some_lat_long(int height) {
  return {2 * height, height, make_lat_long(Content::random, 2 * height, height, 1).pixels};
}

}  // namespace

TEST_CASE("a source has the very pixels that it was given", "[worker]") {
  Cubemap cubemap = some_cubemap(5);
  const float* pixels = cubemap.face(0);
  EnvironmentSource source(std::move(cubemap));
  CHECK(source.view().cubemap().faces[0] == pixels);
  CHECK(source.view().cubemap().faces[5] == pixels + std::ptrdiff_t{5} * 5 * 5 * 3);
  CHECK(source.view().cubemap().size == 5);
  CHECK(source.mips().empty());

  const EnvironmentSource copy = source;
  CHECK(copy.view().cubemap().faces[0] == pixels);
  const Project request{std::move(source)};
  CHECK(request.source.view().cubemap().faces[0] == pixels);

  LatLongImage lat_long = some_lat_long(5);
  pixels = lat_long.pixels.data();
  CHECK(EnvironmentSource(std::move(lat_long)).view().lat_long().pixels == pixels);

  const auto shared_cubemap = std::make_shared<const Cubemap>(some_cubemap(3));
  CHECK(EnvironmentSource(shared_cubemap).view() == shared_cubemap->view());
  const auto shared_lat_long = std::make_shared<const LatLongImage>(some_lat_long(3));
  CHECK(EnvironmentSource(shared_lat_long).view() == shared_lat_long->view());
}

TEST_CASE("a source counts the bytes of its pixels, padding included", "[worker]") {
  CHECK(EnvironmentSource(some_cubemap(7)).bytes() == 6 * 7 * 7 * 12);
  CHECK(EnvironmentSource(some_lat_long(7)).bytes() == 14 * 7 * 12);
  CHECK(Project{some_cubemap(7)}.bytes() == 6 * 7 * 7 * 12);
  CHECK(Project{some_lat_long(7)}.bytes() == 14 * 7 * 12);
  CHECK(ToCubemap{some_cubemap(7), 3}.bytes() == 6 * 7 * 7 * 12);

  const TestCubemapHalf halves = make_cubemap_half(Content::random, 8, 4, 1);
  CubemapView view = halves.view();
  CHECK(EnvironmentSource(view, nullptr).bytes() == 6 * 8 * 8 * 8);
  view.size = 4;
  view.row_stride_bytes = 64;
  CHECK(EnvironmentSource(view, nullptr).bytes() == 6 * 4 * 64);
  const std::byte* last_row = static_cast<const std::byte*>(view.faces[0]) + std::ptrdiff_t{3} * 64;
  view.faces.fill(last_row);
  view.row_stride_bytes = -64;
  CHECK(EnvironmentSource(view, nullptr).bytes() == 6 * 4 * 64);

  const TestCubemap full = make_cubemap(Content::random, 4, 3, 1);
  const TestCubemap next = make_cubemap(Content::random, 2, 3, 1);
  CHECK(EnvironmentSource({full.view(), next.view()}, nullptr).bytes() == 6 * (16 + 4) * 12);

  const TestLatLongBytes bytes = make_lat_long_bytes(Content::random, 8, 4, 1, 4);
  CHECK(EnvironmentSource(bytes.view(), nullptr).bytes() == 8 * 4 * 4);
}

// Promise: posted pixels are not copied, and their memory is released however a job ends.

namespace {

Cubemap some_image() { return {8, make_cubemap(Content::random, 8, 3, 1).pixels}; }

/// Shared pixels, and a way to see whether they are still held.
struct Watched {
  std::shared_ptr<const Cubemap> image = std::make_shared<const Cubemap>(some_image());
  std::weak_ptr<const Cubemap> weak = image;

  [[nodiscard]] EnvironmentSource give() { return {std::move(image)}; }
  [[nodiscard]] bool comes_back() const {
    return eventually([&] { return weak.expired(); });
  }
};

}  // namespace

TEST_CASE("pixels of a waiting job are freed when it is given up, while the threads are busy", "[worker]") {
  Worker worker(options_with(1, {.max_jobs = 2}));
  Hold hold(worker);

  Watched cancelled;
  auto job = worker.post(Project{cancelled.give()});
  CHECK(job.cancel());
  CHECK(cancelled.comes_back());

  Watched replaced;
  job = worker.post(Project{replaced.give()}, {.key = "probe"});
  auto newer = worker.post([](const Control&) {}, {.key = "probe"});
  CHECK(outcome(job) == "replaced");
  CHECK(replaced.comes_back());

  Watched refused;
  job = worker.post(Project{refused.give()}, {.priority = TaskPriority::low});
  CHECK(outcome(job) == "queue_full");
  CHECK(refused.comes_back());
}

TEST_CASE("pixels are freed when their worker ends", "[worker]") {
  Watched waiting;
  Watched undrained;
  Watched late;
  bool called = false;
  JobHandle handle;
  {
    Worker worker(options_with(1));
    Gate gate;
    auto held = worker.post([&](const Control&) { gate.pass(); }, {.priority = TaskPriority::high});
    gate.wait_for_arrivals(1);
    auto job = worker.post(Project{waiting.give()});
    handle = job;
    worker.post([](const Control&) {}).on_drain([&called, image = undrained.give()](Job<void>) { called = true; });
    gate.open();
    worker.terminate();
    CHECK(waiting.comes_back());
    CHECK_FALSE(undrained.weak.expired());
    CHECK(outcome(worker.post(Project{late.give()})) == "stopped");
    CHECK(late.comes_back());
  }
  CHECK(undrained.comes_back());
  CHECK_FALSE(called);
  CHECK(handle.ready());
}

// Promise: ids rise, `ready` means that the future will not wait, and a handle remains usable after its worker is gone.

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

TEST_CASE("handles and futures outlive their worker", "[worker]") {
  auto worker = std::make_unique<Worker>(options_with(1));
  auto done = worker->post([](const Control&) { return 5; });
  auto followed = worker->post([](const Control&) { return 5; });
  const JobHandle copy = done;
  worker->wait_until_idle();
  auto hold = std::make_unique<Hold>(*worker);
  auto waiting = worker->post([](const Control&) { return 6; }, {.priority = TaskPriority::high});
  hold->let_go();
  hold.reset();
  worker.reset();

  CHECK(copy.id() == done.id());
  CHECK(done.ready());
  CHECK(copy.progress() == 1.0);
  CHECK(done.get() == 5);
  CHECK(waiting.ready());
  CHECK(waiting.priority() == TaskPriority::high);
  CHECK_FALSE(waiting.cancel());
  CHECK_FALSE(copy.cancel());
  waiting.set_priority(TaskPriority::low);
  const std::string end = outcome(waiting);
  CHECK((end == "result" || end == "stopped"));

  bool called = false;
  auto follower = std::move(followed).then([&](int) { called = true; });
  CHECK(follower.ready());
  CHECK(outcome(follower) == "stopped");
  CHECK_FALSE(called);
}

// Promise: a result is taken once, by `poll` or by waiting; an empty job answers every call.

TEST_CASE("polling gives nothing while a job runs, its result once, and nothing after", "[worker]") {
  Worker worker(options_with(1));
  std::optional<Hold> hold(std::in_place, worker);
  auto job = worker.post([](const Control&) { return std::make_unique<int>(7); });
  for (int frame = 0; frame < 3; ++frame) {
    CHECK(job.valid());
    CHECK_FALSE(job.try_take());
  }
  hold.reset();
  int taken = 0;
  CHECK(eventually([&] {
    if (auto seven = job.try_take()) taken += **seven;
    return job.ready() && !job.valid();
  }));
  for (int frame = 0; frame < 3; ++frame) {
    if (auto seven = job.try_take()) taken += **seven;
  }
  CHECK(taken == 7);
  CHECK(job.ready());
  CHECK_FALSE(job.error());
  CHECK(outcome_of([&] { job.get(); }) == "invalid_argument");
}

TEST_CASE("polling a job that failed gives nothing, and its error says why", "[worker]") {
  Worker worker(options_with(1));
  auto error = worker.post([](const Control&) -> int { throw Error(ErrorCode::corrupt_file, "no good"); });
  auto other = worker.post([](const Control&) -> int { throw std::runtime_error("enough"); });
  auto odd = worker.post([](const Control&) -> int { throw 3; });
  auto well = worker.post([](const Control&) { return 3; });
  worker.wait_until_idle();
  CHECK_FALSE(error.try_take());
  REQUIRE(error.error());
  CHECK(error.error()->code == ErrorCode::corrupt_file);
  CHECK(error.error()->message == "no good");
  REQUIRE(other.error());
  CHECK_FALSE(other.error()->code);
  CHECK(other.error()->message == "enough");
  REQUIRE(odd.error());
  CHECK_FALSE(odd.error()->code);
  CHECK_FALSE(odd.error()->message.empty());
  CHECK_FALSE(well.error());

  const Hold hold(worker);
  auto waiting = worker.post([](const Control&) { return 3; }, {.key = "probe 7"});
  CHECK_FALSE(waiting.error());
  CHECK(waiting.cancel());
  CHECK_FALSE(waiting.try_take());
  REQUIRE(waiting.error());
  CHECK(waiting.error()->code == ErrorCode::cancelled);
  CHECK(waiting.error()->message == "job " + std::to_string(waiting.id()) + " (probe 7): cancelled by the caller");
  CHECK(waiting.valid());  // `get` can still throw its error
  CHECK(outcome_of([&] { waiting.get(); }) == "cancelled");
  CHECK_FALSE(waiting.valid());
}

TEST_CASE("a job that is none answers", "[worker]") {
  const auto ask = [](const JobHandle& handle) {
    CHECK(handle.id() == 0);
    CHECK_FALSE(handle.ready());
    CHECK(handle.progress() == 0.0);
    CHECK_FALSE(handle.error());
    CHECK_FALSE(handle.cancel());
    CHECK(handle.priority() == TaskPriority::normal);
    handle.set_priority(TaskPriority::high);
  };
  ask(JobHandle());
  Worker worker(options_with(1));
  Job<int> moved_from = worker.post([](const Control&) { return 1; });
  const Job<int> moved_to = std::move(moved_from);
  Job<int> none;
  for (Job<int>* job : {&none, &moved_from}) {  // NOLINT(bugprone-use-after-move)
    ask(*job);
    CHECK_FALSE(job->valid());
    CHECK_FALSE(job->try_take());
    CHECK(outcome_of([&] { job->get(); }) == "invalid_argument");
    CHECK(outcome_of([&] { static_cast<void>(std::move(*job).then([](int value) { return value; })); }) ==
          "invalid_argument");
    CHECK(outcome_of([&] { std::move(*job).on_drain([](const Job<int>&) {}); }) == "invalid_argument");
    CHECK(outcome_of([&] { static_cast<void>(std::move(*job).drained()); }) == "invalid_argument");
    CHECK(outcome_of([&] { static_cast<void>(future_of(std::move(*job))); }) == "invalid_argument");
  }
  Job<void> no_result;
  CHECK_FALSE(no_result.try_take());
  CHECK(outcome_of([&] { no_result.get(); }) == "invalid_argument");
}

// Promise: a job converts to a std::future with its result or error, and its handle still works.

TEST_CASE("a future of a job has its result or its error", "[worker]") {
  Worker worker(options_with(1));
  std::optional<Hold> hold(std::in_place, worker);
  auto value = future_of(worker.post([](const Control&) { return std::make_unique<int>(7); }));
  auto nothing = future_of(worker.post([](const Control&) {}));
  auto failed = future_of(worker.post([](const Control&) -> int { throw std::runtime_error("enough"); }));
  auto followed = future_of(worker.post([](const Control&) { return 1; }).then([](int one) { return one + 1; }));
  auto job = worker.post([](const Control&) { return 1; });
  const JobHandle handle = job;
  auto cancelled = future_of(std::move(job));
  CHECK(value.wait_for(std::chrono::milliseconds(1)) == std::future_status::timeout);
  CHECK(handle.cancel());
  CHECK(cancelled.wait_for(kPatience) == std::future_status::ready);
  hold->let_go();
  CHECK(*take(std::move(value)) == 7);
  CHECK(outcome(std::move(nothing)) == "result");
  CHECK(outcome(std::move(failed)) == "enough");
  CHECK(take(std::move(followed)) == 2);
  CHECK(outcome(std::move(cancelled)) == "cancelled");

  auto ready = worker.post([](const Control&) { return 5; });
  CHECK(eventually([&] { return ready.ready(); }));
  CHECK(take(future_of(std::move(ready))) == 5);

  auto stopped = future_of(worker.post([](const Control& control) { run_until_stopped(control); }));
  worker.terminate();
  CHECK(stopped.wait_for(std::chrono::seconds(0)) == std::future_status::ready);
  CHECK(outcome(std::move(stopped)) == "stopped");
  CHECK(outcome(future_of(worker.post([](const Control&) { return 1; }))) == "stopped");
}

}  // namespace welkin::test
