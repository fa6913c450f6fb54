// Results of a worker: the direct call's bits, moved and not copied, hot loops without allocations.
#include <tbb/task_arena.h>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/jobs.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/trials.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: whatever a worker is asked, on however many threads and beside however many jobs, the result has the bits
// of the direct call. (What each request gives is on record: [same_as_before].)

TEST_CASE("a worker's results are the direct calls' bits, also in a lent arena", "[worker][bake][slow]") {
  constexpr int kSize = kSanitized ? 90 : 257;
  const Cubemap floats{kSize, make_cubemap(Content::special_values, kSize, 3, 1).pixels};
  const TestCubemapHalf halves = make_cubemap_half(Content::high_range, kSize, 4, 2);
  const TestLatLong made = make_lat_long(Content::high_range, 64, 32, 3);
  const auto lat_long = std::make_shared<const LatLongImage>(LatLongImage{64, 32, made.pixels});
  const auto chain = std::make_shared<const Cubemap>(build_mips(floats.view()));
  const ProjectionOptions reduced{.bands = 5, .target_size = 8, .pixels = {.negative = NegativePolicy::replace}};
  const glm::dmat3 rotation = rotation_about_y(37.0);
  const Projection of_floats = project(floats.view());
  const Projection of_halves = project(halves.view());
  const Projection of_chain = project(chain->views(), reduced);
  const Cubemap rotated = to_cubemap(lat_long->view(), 33, rotation);
  const BakeResult baked = bake(lat_long->view(), small_bake());

  tbb::task_arena arena(3);
  for (const WorkerOptions& options : {options_with(1), options_with(2), options_with(5), lent(arena)}) {
    Worker worker(options);
    CAPTURE(worker.threads());
    std::vector<std::pair<Job<Projection>, const Projection*>> projections;
    std::vector<Job<Cubemap>> cubemaps;
    std::vector<JobOf<Bake>> bakes;
    for (int k = 0; k < 12; ++k) {
      projections.emplace_back(worker.post(Project{Cubemap(floats)}), &of_floats);
      projections.emplace_back(worker.post(Project{EnvironmentSource(halves.view(), nullptr)}), &of_halves);
      projections.emplace_back(worker.post(Project{EnvironmentSource(chain->views(), chain), reduced}), &of_chain);
      cubemaps.push_back(worker.post(ToCubemap{lat_long, 33, rotation}));
      if (k % 4 == 0) bakes.push_back(worker.post(Bake{lat_long, small_bake()}));
    }
    for (auto& [job, wanted] : projections) CHECK(same_bits(take(job), *wanted));
    for (auto& job : cubemaps) CHECK(same_bits(take(job), rotated));
    for (auto& job : bakes) CHECK(same_bits(*take(job), baked));
  }
}

TEST_CASE("files are baked in a worker", "[worker][bake]") {
  const TemporaryDirectory directory;
  write_environment(directory.file("sky.pfm"), make_lat_long(Content::high_range, 64, 32, 3).view());
  Worker worker(options_with(2));
  const auto found = take(worker.post(BakeFile{directory.file("sky.pfm"), {}, small_bake()}));
  REQUIRE(found);
  CHECK(same_bits(*found, bake_file(directory.file("sky.pfm"), {}, small_bake())));
  CHECK(outcome(worker.post(BakeFile{directory.file("none.pfm")})) == "file_access");
}

// Promise: results go from the request to whoever takes them without a copy, on every way there is.

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
  CHECK(take(post_seven(worker)).value() == 7);
  CHECK(take(post_seven(worker).then([](Copied seven) { return seven; })).value() == 7);
  CHECK(take(post_seven(worker).then([](Copied&& seven) { return seven.value(); })) == 7);
  CHECK(take(post_seven(worker).then([](const Copied& seven) { return seven.value(); })) == 7);

  int drained = 0;
  post_seven(worker).on_drain([&](Job<Copied> job) { drained = job.get().value(); });
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
  std::move(next).on_drain(
      [five = std::make_unique<int>(5), &drained](Job<std::unique_ptr<int>> done) { drained = *done.get() + *five; });
  CHECK(eventually([&] { return worker.drain() == 1; }));
  CHECK(drained == 12);
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

// Promise: the hot loops allocate nothing when a worker runs them either.

TEST_CASE("projections allocate nothing in a worker's tiles", "[worker][allocation][slow]") {
  if (kSanitized) return;  // sanitizers bring a heap of their own
  // The larger one is read in strips.
  const std::array cubemaps{make_cubemap(Content::random, 64, 3, 1), make_cubemap(Content::random, 640, 3, 1)};
  const TestLatLong lat_long = make_lat_long(Content::special_values, 512, 256, 1);
  for (const int threads : {1, 2, 4}) {
    Worker worker(options_with(threads));
    std::vector<Job<Projection>> jobs;
    forget_allocations_in_tiles();
    for (const TestCubemap& cubemap : cubemaps) {
      for (int k = 0; k < 2; ++k) jobs.push_back(worker.post(Project{EnvironmentSource(cubemap.view(), nullptr)}));
    }
    jobs.push_back(worker.post(Project{EnvironmentSource(lat_long.view(), nullptr)}));
    worker.wait_until_idle();
    CHECK(allocations_in_tiles() == 0);
    for (auto& job : jobs) CHECK(outcome(job) == "result");
  }
}

}  // namespace welkin::test
