// The C interface: statuses, handles, noise, and the same bits as the C++ calls.
#include "c/c_calls.h"
#include "c/c_support.h"
#include "support/catch.h"
#include "support/pfm_files.h"
#include "support/process_threads.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/welkin.h"

namespace welkin::test {

// Each ErrorCode has its own status and arrives as that one.

namespace {

/// Returns the status of an entry whose body throws `thrown`.
template <class Thrown>
welkin_status status_after(const Thrown& thrown) {
  return c_interface::guarded([&]() -> welkin_status { throw thrown; });
}

}  // namespace

TEST_CASE("C: every error code has a status of its own, with a name and the message", "[c_interface]") {
  std::set<welkin_status> seen;
  for (int number = 0; number <= static_cast<int>(ErrorCode::stopped); ++number) {
    const auto code = static_cast<ErrorCode>(number);
    const std::string message = "message of " + std::to_string(number);
    const welkin_status status = status_after(Error(code, message));
    REQUIRE(status == number + 1);
    REQUIRE(seen.insert(status).second);
    REQUIRE(welkin_status_name(status) == std::string(name(code)));
    REQUIRE(welkin_last_error() == message);
  }
}

TEST_CASE("C: what is no Error has a status too", "[c_interface]") {
  REQUIRE(status_after(std::bad_alloc()) == WELKIN_OUT_OF_MEMORY);
  REQUIRE(std::string(welkin_last_error()).find("memory") != std::string::npos);
  REQUIRE(status_after(std::runtime_error("some reason")) == WELKIN_INTERNAL);
  REQUIRE(welkin_last_error() == std::string("some reason"));
  REQUIRE(status_after(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again))) ==
          WELKIN_INTERNAL);
  REQUIRE(status_after(42) == WELKIN_INTERNAL);
  REQUIRE(std::string(welkin_last_error()).size() > 0);
}

TEST_CASE("C: files' and pixels' errors arrive as what they are", "[c_interface]") {
  const TemporaryDirectory directory;
  write_bytes(directory.file("short.pfm"), {'P', 'F', '\n', '8', ' ', '4', '\n', '-', '1', '\n', 0});
  write_bytes(directory.file("other.txt"), {'t', 'e', 'x', 't'});
  auto light = c_struct<welkin_projection>();
  const auto read = [&](const char* name) {
    return welkin_project_file(directory.file(name).string().c_str(), nullptr, nullptr, nullptr, &light);
  };
  REQUIRE(read("none.exr") == WELKIN_FILE_ACCESS);
  REQUIRE(read("short.pfm") == WELKIN_CORRUPT_FILE);
  REQUIRE(read("other.txt") == WELKIN_UNSUPPORTED_FILE);

  auto cube = make_cubemap(Content::random, 8, 3, 1);
  cube.pixels[100] = -1.0F;
  const welkin_environment view = c_view(cube.view());
  auto policy = c_struct<welkin_pixel_policy>();
  policy.negative = WELKIN_NEGATIVE_REJECT;
  auto strict = c_struct<welkin_projection_options>();
  strict.pixels = &policy;
  REQUIRE(welkin_project(&view, 1, &strict, nullptr, &light) == WELKIN_REJECTED_PIXEL);
  REQUIRE(std::string(welkin_last_error()).find("face") != std::string::npos);

  // A job reports it as well, however often it is called.
  const CWorker worker(1);
  welkin_job* job = nullptr;
  REQUIRE(welkin_post_project(worker.get(), &view, 1, &strict, nullptr, &job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_REJECTED_PIXEL);
  const std::string message = welkin_last_error();
  REQUIRE(message.find("face") != std::string::npos);
  static_cast<void>(read("none.exr"));
  REQUIRE(welkin_job_poll(job, nullptr) == WELKIN_REJECTED_PIXEL);
  REQUIRE(welkin_last_error() == message);
  REQUIRE(welkin_job_projection(job, &light) == WELKIN_REJECTED_PIXEL);
  welkin_job_release(job);
}

TEST_CASE("C: what a callback throws stays inside", "[c_interface][slow]") {
  const CWorker worker(1);
  welkin_job* job = nullptr;
  REQUIRE(welkin_post_function(
              worker.get(), [](void*, const welkin_control*) -> welkin_status { throw std::runtime_error("thrown"); },
              nullptr, nullptr, &job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_INTERNAL);
  REQUIRE(welkin_last_error() == std::string("thrown"));
  welkin_job_release(job);

  auto post = c_struct<welkin_post_options>();
  post.release = [](void*) { throw 1; };
  post.completed = [](welkin_job*, void*) { throw std::runtime_error("drained"); };
  REQUIRE(welkin_post_function(
              worker.get(), [](void*, const welkin_control*) -> welkin_status { return WELKIN_OK; }, nullptr, &post,
              nullptr) == WELKIN_OK);
  REQUIRE(welkin_worker_wait_until_idle(worker.get()) == WELKIN_OK);
  REQUIRE(welkin_worker_drain(worker.get(), WELKIN_NO_LIMIT, nullptr) == WELKIN_INTERNAL);
  REQUIRE(welkin_last_error() == std::string("drained"));
}

// Structures full of noise: a status comes back, and nothing else happens.

namespace {

/// A structure in a buffer longer than any size that is accepted, so that no read passes its end.
template <class Struct>
class Noisy {
 public:
  /// Copies `sound` and overwrites up to two of its first `words` words with all kinds of numbers.
  Noisy(const Struct& sound, std::size_t words, std::mt19937& random) {
    std::memcpy(bytes_.data(), &sound, sizeof sound);
    std::uniform_int_distribution<std::size_t> word(0, words - 1);
    std::uniform_int_distribution<int> kind(0, 3);
    for (int changes = kind(random) - 1; changes > 0; --changes) {
      const std::array<std::uint32_t, 4> values{static_cast<std::uint32_t>(random()), 0xffffffffU, 0x80000000U,
                                                static_cast<std::uint32_t>(random() % 40)};
      std::memcpy(bytes_.data() + 4 * word(random), &values.at(static_cast<std::size_t>(kind(random))), 4);
    }
  }

  [[nodiscard]] Struct* get() { return reinterpret_cast<Struct*>(bytes_.data()); }

 private:
  alignas(Struct) std::array<std::byte, 2 * (sizeof(Struct) + 4096)> bytes_{};
};

}  // namespace

TEST_CASE("C: noise in structures is refused or harmless", "[c_interface]") {
  const unsigned seed = 20261121;
  INFO("seed " << seed);
  std::mt19937 random(seed);
  const auto image = make_lat_long(Content::random, 8, 4, 1);
  // Dimensions stay: an image larger than its memory cannot be distinguished from a valid one.
  auto sound_view = c_view(image.view());
  auto sound_options = c_struct<welkin_projection_options>();
  sound_options.bands = 2;
  constexpr std::size_t kOptionWords = offsetof(welkin_projection_options, pixels) / 4;
  constexpr std::size_t kViewWords = 2;  // struct_size, format
  constexpr std::size_t kPostWords = 2;  // struct_size, priority
  static std::atomic<long> released{0};
  auto sound_post = c_struct<welkin_post_options>();
  sound_post.release = [](void*) { released.fetch_add(1); };

  long owed = 0;
  int refused = 0;
  int done = 0;
  {
    const CWorker worker(1);
    for (int run = 0; run < 3000; ++run) {
      Noisy<welkin_projection_options> options(sound_options, kOptionWords, random);
      // Wider formats would read past the image; the first half of it in f32 is within the image in any format.
      sound_view.height = 2;
      Noisy<welkin_environment> view(sound_view, kViewWords, random);
      auto light = c_struct<welkin_projection>();
      light.struct_size = random() % 4 == 0 ? static_cast<std::uint32_t>(random() % sizeof light) : light.struct_size;
      const welkin_status status = welkin_project(view.get(), 1, options.get(), nullptr, &light);
      REQUIRE((status == WELKIN_OK || status == WELKIN_INVALID_ARGUMENT || status == WELKIN_REJECTED_PIXEL));
      (status == WELKIN_OK ? done : refused) += 1;

      Noisy<welkin_post_options> post(sound_post, kPostWords, random);
      const std::uint32_t size = post.get()->struct_size;
      const bool readable = size >= 8 && size % 8 == 0 && size <= sizeof(welkin_post_options) + 4096 &&
                            size >= offsetof(welkin_post_options, release_user);
      welkin_job* job = nullptr;
      const welkin_status posted = welkin_post_project(worker.get(), view.get(), 1, options.get(), post.get(), &job);
      REQUIRE((posted == WELKIN_OK || posted == WELKIN_INVALID_ARGUMENT));
      REQUIRE((job != nullptr) == (posted == WELKIN_OK));
      if (readable) ++owed;
      welkin_job_release(job);
    }
  }
  REQUIRE(refused > 500);
  REQUIRE(done > 500);
  REQUIRE(released.load() == owed);
}

TEST_CASE("C: noise in the structures of bakes and skies is refused or harmless", "[c_interface][slow]") {
  const unsigned seed = 20261122;
  INFO("seed " << seed);
  std::mt19937 random(seed);
  const auto cube = make_cubemap(Content::random, 4, 3, 1);
  const welkin_environment view = c_view(cube.view());
  // Memory limits stay, so that they refuse large sizes and no noise causes minutes of work.
  auto sound_bake = c_struct<welkin_bake_options>();
  sound_bake.memory_limit_bytes = 1 << 26;
  auto sound_specular = c_struct<welkin_prefilter_options>();
  sound_specular.size = 4;
  auto sound_tables = c_struct<welkin_sky_table_options>();
  sound_tables.memory_limit_bytes = 1 << 16;
  std::vector<float> texels(6 * 4 * 4 * 4);
  const welkin_target sound_target = c_target(texels, 4);
  const auto air = c_struct<welkin_atmosphere>();  // Earth's
  welkin_chain* chain = nullptr;
  REQUIRE(welkin_prefilter(&view, &sound_specular, nullptr, &chain) == WELKIN_OK);

  int refused = 0;
  int done = 0;
  for (int run = 0; run < 400; ++run) {
    Noisy<welkin_prefilter_options> specular(sound_specular, offsetof(welkin_prefilter_options, roughness) / 4, random);
    sound_bake.specular = specular.get();
    Noisy<welkin_bake_options> options(sound_bake, offsetof(welkin_bake_options, specular) / 4, random);
    auto* result = reinterpret_cast<welkin_bake_result*>(&sound_bake);
    const welkin_status status = welkin_bake(&view, options.get(), nullptr, &result);
    INFO(welkin_status_name(status) << ": " << welkin_last_error());
    REQUIRE((status == WELKIN_OK || status == WELKIN_INVALID_ARGUMENT || status == WELKIN_LIMIT_EXCEEDED));
    REQUIRE((result != nullptr) == (status == WELKIN_OK));
    (status == WELKIN_OK ? done : refused) += 1;
    welkin_bake_result_destroy(result);

    Noisy<welkin_sky_table_options> tables(
        sound_tables, offsetof(welkin_sky_table_options, minimum_sun_elevation_degrees) / 4, random);
    auto* made = reinterpret_cast<welkin_sky_tables*>(&sound_bake);
    const welkin_status sky = welkin_sky_tables_create(&air, tables.get(), nullptr, &made);
    REQUIRE((sky == WELKIN_OK || sky == WELKIN_INVALID_ARGUMENT || sky == WELKIN_LIMIT_EXCEEDED));
    REQUIRE((made != nullptr) == (sky == WELKIN_OK));
    welkin_sky_tables_destroy(made);

    // Four floats per texel suffice for every format that is written.
    Noisy<welkin_target> target(sound_target, 2, random);
    const welkin_status copied = welkin_chain_copy(chain, 0, target.get(), nullptr);
    REQUIRE((copied == WELKIN_OK || copied == WELKIN_INVALID_ARGUMENT));
  }
  REQUIRE(refused > 30);
  REQUIRE(done > 30);
  welkin_chain_destroy(chain);
}

// Many threads retain, query, cancel and release; each job's pixels are released once, and each handle lives until its
// last reference is released.

namespace {

/// One post's pixels: how often they were released, and whether the job's callback was called.
struct Slot {
  std::atomic<int> released{0};
  std::atomic<int> completed{0};
};

void release_slot(void* slot) { static_cast<Slot*>(slot)->released.fetch_add(1); }
void complete_slot(welkin_job* job, void* slot) {
  if (welkin_job_poll(job, nullptr) != WELKIN_NOT_READY) static_cast<Slot*>(slot)->completed.fetch_add(1);
}

welkin_post_options post_for(Slot& slot) {
  auto post = c_struct<welkin_post_options>();
  post.release = release_slot;
  post.release_user = &slot;
  post.completed = complete_slot;
  post.completed_user = &slot;
  return post;
}

}  // namespace

TEST_CASE("C: a handle is shared by many threads", "[c_interface]") {
  constexpr int kThreads = 4;
  const CWorker worker(2);
  const auto cube = make_cubemap(Content::random, 32, 3, 1);
  const welkin_environment view = c_view(cube.view());
  std::atomic<int> wrong{0};
  for (int round = 0; round < 50; ++round) {
    welkin_job* job = nullptr;
    REQUIRE(welkin_post_project(worker.get(), &view, 1, nullptr, nullptr, &job) == WELKIN_OK);
    std::vector<std::thread> threads;
    for (int i = 0; i < kThreads; ++i) {
      welkin_job_retain(job);
      threads.emplace_back([&wrong, job, i, round] {
        if (i == 0 && round % 2 == 0) welkin_job_cancel(job, nullptr);
        const welkin_status status = welkin_job_wait(job, WELKIN_NO_LIMIT);
        if (status != WELKIN_OK && status != WELKIN_CANCELLED) wrong.fetch_add(1);
        auto light = c_struct<welkin_projection>();
        if (welkin_job_projection(job, &light) != status) wrong.fetch_add(1);
        welkin_job_release(job);
      });
    }
    welkin_job_release(job);  // the others keep it
    for (std::thread& thread : threads) thread.join();
  }
  REQUIRE(wrong.load() == 0);
}

TEST_CASE("C: pixels are released once, whoever posts, cancels, drains and terminates", "[c_interface][slow]") {
  constexpr int kThreads = 3;
  constexpr int kPosts = 60;
  const unsigned seed = 4711;
  INFO("seed " << seed);
  const auto cube = make_cubemap(Content::random, 24, 3, 1);
  const welkin_environment view = c_view(cube.view());
  for (unsigned round = 0; round < 8; ++round) {
    std::vector<Slot> slots(std::size_t{kThreads} * kPosts);
    std::atomic<int> posted{0};
    auto options = c_struct<welkin_worker_options>();
    options.threads = 2;
    options.max_jobs = 16;
    welkin_worker* worker = nullptr;
    REQUIRE(welkin_worker_create(&options, &worker) == WELKIN_OK);
    on_threads(kThreads, [&](std::size_t thread) {
      const auto i = static_cast<unsigned>(thread);
      std::mt19937 random(seed + round * kThreads + i);
      for (unsigned k = 0; k < kPosts; ++k) {
        welkin_post_options post = post_for(slots[i * kPosts + k]);
        const std::array<const char*, 4> keys{nullptr, nullptr, "one", "two"};
        post.key = keys.at(random() % keys.size());
        post.priority = static_cast<welkin_priority>(random() % 3) - 1;
        welkin_job* job = nullptr;
        if (welkin_post_project(worker, &view, 1, nullptr, &post, &job) == WELKIN_OK) posted.fetch_add(1);
        if (random() % 3 == 0) welkin_job_cancel(job, nullptr);
        if (random() % 4 == 0) welkin_worker_drain(worker, 0, nullptr);
        if (i == 0 && k == kPosts / 2 && round % 2 == 0) welkin_worker_terminate(worker);
        welkin_job_release(job);
      }
    });
    welkin_worker_wait_until_idle(worker);
    REQUIRE(welkin_worker_terminate(worker) == WELKIN_OK);
    REQUIRE(welkin_worker_drain(worker, WELKIN_NO_LIMIT, nullptr) == WELKIN_OK);
    welkin_worker_destroy(worker);
    REQUIRE(posted.load() == static_cast<int>(slots.size()));
    for (const Slot& slot : slots) {
      REQUIRE(slot.released.load() == 1);
      REQUIRE(slot.completed.load() == 1);
    }
  }
}

// Results of the C interface equal those of the C++ calls bit for bit.

namespace {

/// Two sets of options. (fields_in_c_test.cpp maps each option to C++.)
std::array<welkin_projection_options, 2> all_wanted() {
  static std::array<welkin_pixel_policy, 2> policies;
  for (welkin_pixel_policy& policy : policies) policy = c_struct<welkin_pixel_policy>();
  policies[0].clamp_maximum = 100.0F;
  policies[0].clamp_preserve_colour = 1;
  policies[0].negative = WELKIN_NEGATIVE_REPLACE;
  policies[1].gamma = 1;
  std::array<welkin_projection_options, 2> both;
  both.fill(c_struct<welkin_projection_options>());
  both[0].bands = 16;
  both[0].pixels = &policies[0];
  both[1].midpoint = 1;
  both[1].target_size = 8;
  both[1].pixels = &policies[1];
  return both;
}

/// Calls both interfaces with each set of options and compares the results with `expected`.
void check_projections(const std::function<Projection(const ProjectionOptions&)>& expected,
                       const std::function<welkin_status(const welkin_projection_options*, welkin_projection*)>& call,
                       const std::function<welkin_status(const welkin_projection_options*, welkin_job**)>& post) {
  for (const welkin_projection_options& asked : all_wanted()) {
    const Projection wanted = expected(c_interface::projection_options(&asked));
    auto light = c_struct<welkin_projection>();
    REQUIRE(call(&asked, &light) == WELKIN_OK);
    require_same_projection(light, wanted);
    welkin_job* job = nullptr;
    REQUIRE(post(&asked, &job) == WELKIN_OK);
    REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_OK);
    light = c_struct<welkin_projection>();
    REQUIRE(welkin_job_projection(job, &light) == WELKIN_OK);
    welkin_job_release(job);
    require_same_projection(light, wanted);
  }
}

}  // namespace

TEST_CASE("C: cubemaps, their mip chains and lat-longs give the C++ calls' bits", "[c_interface]") {
  const CWorker worker(2);
  const auto check = [&](const std::vector<welkin_environment>& mips, const auto& expected) {
    const auto count = static_cast<std::int32_t>(mips.size());
    check_projections(
        expected,
        [&](const auto* options, auto* light) { return welkin_project(mips.data(), count, options, nullptr, light); },
        [&](const auto* options, auto** job) {
          return welkin_post_project(worker.get(), mips.data(), count, options, nullptr, job);
        });
  };
  const auto large = make_cubemap_half(Content::special_values, 32, 4, 1);
  const auto small = make_cubemap_half(Content::random, 16, 4, 2);
  const std::vector<CubemapView> views{large.view(), small.view()};
  const auto wide = make_lat_long(Content::high_range, 128, 64, 3);
  check({c_view(views[0])}, [&](const auto& options) { return project(std::span(views).first(1), options); });
  check({c_view(views[0]), c_view(views[1])}, [&](const auto& options) { return project(views, options); });
  check({c_view(wide.view())}, [&](const auto& options) { return project(wide.view(), options); });
}

TEST_CASE("C: many probes give the C++ call's bits", "[c_interface][many]") {
  const auto first = make_cubemap_half(Content::special_values, 32, 4, 1);
  const auto second = make_cubemap(Content::random, 9, 3, 2);
  const std::vector<CubemapView> views{first.view(), second.view(), first.view()};
  std::vector<welkin_environment> probes;
  for (const CubemapView& view : views) probes.push_back(c_view(view));
  for (const welkin_projection_options& asked : all_wanted()) {
    const ProjectionOptions options = c_interface::projection_options(&asked);
    std::vector<dvec3> expected(static_cast<std::size_t>(3 * options.bands * options.bands));
    const ProjectionDiagnostics sum = project_many(views, expected, options);
    std::vector<double> found(3 * expected.size());
    auto totals = c_struct<welkin_projection>();
    REQUIRE(welkin_project_many(probes.data(), 3, &asked, nullptr, found.data(), &totals) == WELKIN_OK);
    CHECK(std::memcmp(expected.data(), found.data(), found.size() * sizeof(double)) == 0);
    CHECK(totals.texels == sum.texels);
    CHECK(totals.nans_replaced == sum.nans_replaced);
    CHECK(totals.bands == 0);
    CHECK(totals.total_radiance[1] == sum.total_radiance[1]);
    CHECK(totals.error_estimate == sum.error_estimate);
    CHECK(welkin_project_many(probes.data(), 3, &asked, nullptr, found.data(), nullptr) == WELKIN_OK);
  }
  CHECK(welkin_project_many(nullptr, 0, nullptr, nullptr, nullptr, nullptr) == WELKIN_OK);
  for (const std::int64_t count : {std::int64_t{-1}, std::int64_t{1} << 31, std::numeric_limits<std::int64_t>::max()}) {
    double nowhere = 0.0;
    CHECK(welkin_project_many(probes.data(), count, nullptr, nullptr, &nowhere, nullptr) == WELKIN_INVALID_ARGUMENT);
    CHECK(std::string(welkin_last_error()).starts_with("probe_count is " + std::to_string(count)));
  }
  CHECK(welkin_project_many(nullptr, 1, nullptr, nullptr, nullptr, nullptr) == WELKIN_INVALID_ARGUMENT);
  CHECK(welkin_project_many(probes.data(), 1, nullptr, nullptr, nullptr, nullptr) == WELKIN_INVALID_ARGUMENT);
  probes[1].faces[2] = nullptr;
  std::vector<double> found(81);
  CHECK(welkin_project_many(probes.data(), 3, nullptr, nullptr, found.data(), nullptr) == WELKIN_INVALID_ARGUMENT);
  CHECK(std::string(welkin_last_error()).starts_with("probe 1: "));
}

TEST_CASE("C: files give the C++ call's bits", "[c_interface]") {
  const CWorker worker(2);
  const TemporaryDirectory directory;
  const auto image = make_lat_long(Content::sun_disc, 64, 32, 4);
  write_bytes(directory.file("sky.pfm"), pfm_bytes(64, 32, false, "-1.0", image.pixels));
  const std::string path = directory.file("sky.pfm").string();
  auto reading = c_struct<welkin_read_options>();
  reading.layout = WELKIN_LAYOUT_LAT_LONG;
  reading.primaries_as_stored = 1;
  check_projections([&](const auto& options) { return project_file(path, {}, options); },
                    [&](const auto* options, auto* light) {
                      return welkin_project_file(path.c_str(), &reading, options, nullptr, light);
                    },
                    [&](const auto* options, auto** job) {
                      return welkin_post_project_file(worker.get(), path.c_str(), nullptr, options, nullptr, job);
                    });
}

}  // namespace welkin::test
