// Results of a worker: bitwise those of the direct call, moved (never copied) or written to the caller's memory.
#include <tbb/task_arena.h>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/jobs.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/trials.h"
#include "welkin/resampling.h"
#include "welkin/worker.h"

namespace welkin::test {

// Promise: for any request, number of threads and number of concurrent jobs, the result equals that of the direct call
// bit for bit. (The results of each request are on record: [same_as_before].)

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
    for (int k = 0; k < 6; ++k) {
      projections.emplace_back(worker.post(Project{Cubemap(floats)}), &of_floats);
      projections.emplace_back(worker.post(Project{EnvironmentSource(halves.view(), nullptr)}), &of_halves);
      projections.emplace_back(worker.post(Project{EnvironmentSource(chain->views(), chain), reduced}), &of_chain);
      cubemaps.push_back(worker.post(ToCubemap{lat_long, 33, rotation}));
      if (k % 2 == 0) bakes.push_back(worker.post(Bake{lat_long, small_bake()}));
    }
    for (auto& [job, wanted] : projections) CHECK(same_bits(take(job), *wanted));
    for (auto& job : cubemaps) CHECK(same_bits(take(job), rotated));
    for (auto& job : bakes) CHECK(same_bits(*take(job), baked));
  }
}

// Promise: results reach the caller without a copy, in every way of taking them.

namespace {

std::atomic<int> copies{0};

/// Counts its copies. Results need no default constructor and no assignment, so it has neither.
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

// Promise: bakes into the caller's memory write the bits of `bake_to`, and nothing if there is no result.

namespace {

/// One chain in memory, with bytes between its rows that must not be written.
struct Block : TargetMemory {
  Block(TexelFormat format, int size, int levels)
      : TargetMemory({format, size, levels, UploadOrder::face_by_face, 96, 128}) {}
};

/// Memory for all cubemaps of a small bake.
struct BakeMemory {
  explicit BakeMemory(int size = 8) : specular(TexelFormat::rgba16f, size, 3) {}

  [[nodiscard]] BakeTargets targets() const { return {background.targets, specular.targets, irradiance.targets[0]}; }
  [[nodiscard]] bool untouched() const {
    return background.untouched() && specular.untouched() && irradiance.untouched();
  }
  [[nodiscard]] std::array<std::vector<std::byte>, 3> bytes() const {
    return {background.memory, specular.memory, irradiance.memory};
  }
  friend bool operator==(const BakeMemory& a, const BakeMemory& b) { return a.bytes() == b.bytes(); }

  Block background{TexelFormat::b10g11r11, 16, 5};
  Block specular;
  Block irradiance{TexelFormat::rgba16f, 5, 1};
};

/// Returns whether no byte between the texels was written.
bool gaps_untouched(const Block& block) {
  std::vector<std::byte> bytes = block.memory;
  for (const CubemapTarget& target : block.targets) {
    for (const void* const face : target.faces) {
      for (int row = 0; row < target.size; ++row) {
        const auto* const texels = static_cast<const std::byte*>(face) + row * target.row_stride_bytes;
        std::fill_n(bytes.begin() + (texels - block.memory.data()), 8 * target.size, kUntouched);
      }
    }
  }
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte byte) { return byte == kUntouched; });
}

/// A cubemap of four halves per texel.
TestCubemapHalf halves(int size, std::uint32_t seed = 5) { return make_cubemap_half(Content::random, size, 4, seed); }

EnvironmentSource source_of(const TestCubemapHalf& cube) { return {cube.view(), nullptr}; }

}  // namespace

TEST_CASE("BakeTo: a job that never starts or is refused writes nothing", "[worker][bake]") {
  const TestCubemapHalf cube = halves(24);
  const BakeMemory memory;
  Worker worker(options_with(1));
  Hold hold(worker);
  auto job = worker.post(BakeTo{source_of(cube), memory.targets(), quick_bake()});
  CHECK(job.cancel());
  CHECK(job.ready());
  hold.let_go();
  CHECK(outcome(worker.post(BakeTo{source_of(cube), memory.targets(), quick_bake(9)})) == "invalid_argument");
  worker.wait_until_idle();
  CHECK(memory.untouched());
}

TEST_CASE("BakeTo: a cancelled run writes texels only, none once it is ready, and the memory serves again",
          "[worker][bake]") {
  const TestCubemapHalf cube = halves(48);
  const BakeMemory expected;
  const BakeResult baked = bake_to(expected.targets(), cube.view(), quick_bake());
  const BakeMemory memory;
  for (const double share : {0.05, 0.4, 0.7, 0.95}) {  // of the work, done before the stop request
    stop_source stop;
    const BakeTo request{source_of(cube), memory.targets(), quick_bake()};
    const Control control{stop.get_token(), [&](double done) {
                            if (done >= share) stop.request_stop();
                          }};
    CHECK(outcome_of([&] { static_cast<void>(request(control)); }) == "cancelled");
    CHECK(gaps_untouched(memory.specular));
  }
  Worker worker(options_with(2));
  for (int round = 0; round < 3; ++round) {
    auto job = worker.post(BakeTo{source_of(cube), memory.targets(), quick_bake()});
    REQUIRE(eventually([&] { return job.progress() > 0.0 || job.ready(); }));
    job.cancel();
    const std::string end = outcome(job);
    CHECK((end == "cancelled" || end == "result"));
    const auto left = memory.bytes();
    worker.wait_until_idle();
    CHECK(memory.bytes() == left);
  }
  auto last = worker.post(BakeTo{source_of(cube), memory.targets(), quick_bake()});
  const auto found = take(last);
  REQUIRE(found);
  CHECK(same_bits(*found, baked));
  CHECK(memory == expected);
  CHECK(last.progress() == 1.0);
}

TEST_CASE("BakeTo: the owner keeps the targets' memory until the job is ready", "[worker][bake]") {
  const TestCubemapHalf cube = halves(24);
  Worker worker(options_with(1));
  auto memory = std::make_shared<BakeMemory>();
  const std::weak_ptr<BakeMemory> watched = memory;
  Hold hold(worker);
  auto job = worker.post(BakeTo{source_of(cube), memory->targets(), quick_bake(), std::move(memory)});
  CHECK_FALSE(watched.expired());
  hold.let_go();
  CHECK(take(job));
  worker.wait_until_idle();
  CHECK(watched.expired());
}

}  // namespace welkin::test
