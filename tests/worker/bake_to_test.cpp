// Bakes into the caller's memory, as requests: whose bits they write, and what is written if there is no result.
#include "bake/baked.h"
#include "support/catch.h"
#include "support/jobs.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

BakeOptions bake_of(int size = 8) {
  BakeOptions options{.background = BackgroundOptions{.size = 16},
                      .specular = PrefilterOptions{.size = size, .roughness = {0.0, 0.3, 0.9}},
                      .irradiance = IrradianceOptions{.size = 5}};
  options.brdf.reset();
  return options;
}

/// One chain in memory, with bytes between its rows that nobody may write to.
struct Block : TargetMemory {
  Block(TexelFormat format, int size, int levels)
      : TargetMemory({format, size, levels, UploadOrder::face_by_face, 96, 128}) {}
};

/// Memory for all cubemaps of a small bake.
struct Room {
  explicit Room(int size = 8) : specular(TexelFormat::rgba16f, size, 3) {}

  [[nodiscard]] BakeTargets targets() const { return {background.targets, specular.targets, irradiance.targets[0]}; }
  [[nodiscard]] bool untouched() const {
    return background.untouched() && specular.untouched() && irradiance.untouched();
  }
  [[nodiscard]] std::array<std::vector<std::byte>, 3> bytes() const {
    return {background.memory, specular.memory, irradiance.memory};
  }
  friend bool operator==(const Room& a, const Room& b) { return a.bytes() == b.bytes(); }

  Block background{TexelFormat::b10g11r11, 16, 5};
  Block specular;
  Block irradiance{TexelFormat::rgba16f, 5, 1};
};

/// Whether no byte between the texels was written.
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

TEST_CASE("BakeTo: halves in and out, with the bits that bake_to writes", "[worker][bake]") {
  const TestCubemapHalf cube = halves(24);
  const TestLatLong wide = make_lat_long(Content::high_range, 32, 16, 5);
  const Room of_cube;
  const Room of_lat_long;
  const BakeResult expected_cube = bake_to(of_cube.targets(), cube.view(), bake_of());
  const BakeResult expected_lat_long = bake_to(of_lat_long.targets(), wide.view(), bake_of());
  REQUIRE_FALSE(of_cube.untouched());
  for (const int threads : {1, 2, 4}) {
    Worker worker(options_with(threads));
    const std::array<Room, 4> rooms;
    std::vector<JobOf<BakeTo>> jobs;
    for (std::size_t k = 0; k < rooms.size(); ++k) {
      jobs.push_back(
          worker.post(k % 2 == 0 ? BakeTo{source_of(cube), rooms.at(k).targets(), bake_of()}
                                 : BakeTo{EnvironmentSource(wide.view(), nullptr), rooms.at(k).targets(), bake_of()}));
    }
    for (std::size_t k = 0; k < rooms.size(); ++k) {
      const auto found = take(jobs[k]);
      REQUIRE(found);
      CHECK(same_bits(*found, k % 2 == 0 ? expected_cube : expected_lat_long));
      CHECK(rooms.at(k) == (k % 2 == 0 ? of_cube : of_lat_long));
      CHECK(jobs[k].progress() == 1.0);
    }
  }
}

TEST_CASE("BakeTo: a job that never starts or is refused writes nothing", "[worker][bake]") {
  const TestCubemapHalf cube = halves(24);
  const Room room;
  Worker worker(options_with(1));
  Hold hold(worker);
  auto job = worker.post(BakeTo{source_of(cube), room.targets(), bake_of()});
  CHECK(job.cancel());
  CHECK(job.ready());
  hold.let_go();
  CHECK(outcome(worker.post(BakeTo{source_of(cube), room.targets(), bake_of(9)})) == "invalid_argument");
  worker.wait_until_idle();
  CHECK(room.untouched());
}

TEST_CASE("BakeTo: a cancelled run writes texels only, none once it is ready, and the memory serves again",
          "[worker][bake]") {
  const TestCubemapHalf cube = halves(48);
  const Room expected;
  static_cast<void>(bake_to(expected.targets(), cube.view(), bake_of()));
  const Room room;
  for (const double share : {0.05, 0.4, 0.7, 0.95}) {  // of the work that is done before the bake is asked to stop
    stop_source stop;
    const BakeTo request{source_of(cube), room.targets(), bake_of()};
    const Control control{stop.get_token(), [&](double done) {
                            if (done >= share) stop.request_stop();
                          }};
    CHECK(outcome_of([&] { static_cast<void>(request(control)); }) == "cancelled");
    CHECK(gaps_untouched(room.specular));
  }
  Worker worker(options_with(2));
  for (int round = 0; round < 3; ++round) {
    auto job = worker.post(BakeTo{source_of(cube), room.targets(), bake_of()});
    REQUIRE(eventually([&] { return job.progress() > 0.0 || job.ready(); }));
    job.cancel();
    const std::string end = outcome(job);
    CHECK((end == "cancelled" || end == "result"));
    const auto left = room.bytes();
    worker.wait_until_idle();
    CHECK(room.bytes() == left);
  }
  REQUIRE(take(worker.post(BakeTo{source_of(cube), room.targets(), bake_of()})));
  CHECK(room == expected);
}

TEST_CASE("BakeTo: the owner keeps the targets' memory until the job is ready", "[worker][bake]") {
  const TestCubemapHalf cube = halves(24);
  Worker worker(options_with(1));
  auto room = std::make_shared<Room>();
  const std::weak_ptr<Room> watched = room;
  Hold hold(worker);
  auto job = worker.post(BakeTo{source_of(cube), room->targets(), bake_of(), std::move(room)});
  CHECK_FALSE(watched.expired());
  hold.let_go();
  CHECK(take(job));
  worker.wait_until_idle();
  CHECK(watched.expired());
}

}  // namespace welkin::test
