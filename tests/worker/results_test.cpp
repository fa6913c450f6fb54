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
// of the direct call.

namespace {

/// A request whose result is known. `post` gives what waits for the result and tells whether it is right.
struct Case {
  std::string name;
  std::function<std::function<bool()>(Worker&)> post;
};

/// `make_request` gives a new request for each post.
template <class Result, class MakeRequest>
Case make_case(std::string name, Result expected, MakeRequest make_request) {
  auto shared = std::make_shared<const Result>(std::move(expected));
  return {std::move(name), [shared, make_request](Worker& worker) -> std::function<bool()> {
            auto job = std::make_shared<Job<Result>>(worker.post(make_request()));
            return [shared, job] { return same_bits(take(*job), *shared); };
          }};
}

template <class Cubemap>
std::shared_ptr<const Cubemap> kept(Cubemap cubemap) {
  return std::make_shared<const Cubemap>(std::move(cubemap));
}

ProjectionOptions midpoint_options() {
  ProjectionOptions options;
  options.bands = 5;
  options.quadrature = Quadrature::midpoint;
  options.pixels.clamp = RadianceClamp{};
  options.pixels.negative = NegativePolicy::replace;
  return options;
}

void add_cubemap_projections(std::vector<Case>& cases, int size, std::uint32_t seed) {
  const auto floats = kept(Cubemap{size, make_cubemap(Content::special_values, size, 3, seed).pixels});
  cases.push_back(make_case("moved in", project(floats->view()), [floats] { return Project{Cubemap(*floats)}; }));
  cases.push_back(make_case("shared", project(floats->view(), midpoint_options()), [floats] {
    return Project{floats, midpoint_options()};
  }));
  const auto halves = kept(make_cubemap_half(Content::high_range, size, 4, seed));
  cases.push_back(make_case("borrowed", project(halves->view()),
                            [halves] { return Project{EnvironmentSource(halves->view(), nullptr)}; }));
  const auto bytes = kept(make_cubemap_bytes(Content::random, size, 4, seed));
  cases.push_back(make_case("owned by another", project(bytes->view()),
                            [bytes] { return Project{EnvironmentSource(bytes->view(), bytes)}; }));

  auto levels = std::make_shared<std::vector<TestCubemap>>();
  std::vector<CubemapView> chain;
  for (int level = size; level >= 1; level /= 2) levels->push_back(make_cubemap(Content::random, level, 3, seed + 1));
  for (const TestCubemap& level : *levels) chain.push_back(level.view());
  ProjectionOptions options;
  for (int target = 1; target < size; target *= 8) {
    options.target_size = target;
    cases.push_back(make_case("mip chain", project(chain, options), [chain, levels, options] {
      return Project{EnvironmentSource(chain, levels), options};
    }));
  }
}

void add_resamplings(std::vector<Case>& cases, int size, std::uint32_t seed) {
  const auto cubemap = kept(Cubemap{size, make_cubemap(Content::high_range, size, 3, seed).pixels});
  const auto lat_long = kept(LatLongImage{2 * size, size, make_lat_long(Content::smooth, 2 * size, size, seed).pixels});
  const glm::dmat3 turn = turn_about_y(37.0);
  const int half = size / 2 + 1;
  cases.push_back(make_case("lat-long to cubemap", to_cubemap(lat_long->view(), half, turn), [lat_long, half, turn] {
    return ToCubemap{lat_long, half, turn};
  }));
  cases.push_back(make_case("cubemap to cubemap", to_cubemap(cubemap->view(), size, turn), [cubemap, turn] {
    return ToCubemap{Cubemap(*cubemap), cubemap->size(), turn};
  }));
  cases.push_back(
      make_case("cubemap to lat-long", to_lat_long(cubemap->view(), 3 * half, half, turn), [cubemap, half, turn] {
        return ToLatLong{cubemap, 3 * half, half, turn};
      }));
}

void add_files(std::vector<Case>& cases, const TemporaryDirectory& directory, int size, std::uint32_t seed) {
  const TestLatLong lat_long = make_lat_long(Content::smooth, 2 * size, size, seed);
  const TestCubemap cubemap = make_cubemap(Content::smooth, size, 3, seed);
  std::vector<std::filesystem::path> paths;
  for (const char* extension : {".exr", ".hdr", ".pfm", ".png"}) {
    paths.push_back(directory.file(std::to_string(size) + extension));
    write_environment(paths.back(), lat_long.view());
  }
  paths.push_back(directory.file(std::to_string(size) + "-cube.exr"));
  write_environment(paths.back(), cubemap.view());
  for (const std::filesystem::path& path : paths) {
    const std::string file = path.filename().string();
    cases.push_back(make_case("project " + file, project_file(path), [path] { return ProjectFile{path}; }));
    cases.push_back(make_case("measure " + file, measure_environment(path), [path] { return MeasureFile{path}; }));
    cases.push_back(make_case("read " + file, read_environment(path), [path] { return ReadFile{path}; }));
  }
}

std::vector<Case> cases_of(const TemporaryDirectory& directory, int size) {
  const auto seed = static_cast<std::uint32_t>(size);
  std::vector<Case> cases;
  add_cubemap_projections(cases, size, seed);
  add_resamplings(cases, size, seed);
  add_files(cases, directory, size, seed);
  for (Case& one : cases) one.name += ", size " + std::to_string(size);
  return cases;
}

/// Posts `total` of the cases in turn, `together` in flight at a time, and checks every one.
void check_all(Worker& worker, const std::vector<Case>& cases, std::size_t total, std::size_t together) {
  for (std::size_t first = 0; first < total; first += together) {
    std::vector<std::pair<std::string, std::function<bool()>>> posted;
    for (std::size_t k = first; k < std::min(first + together, total); ++k) {
      const Case& one = cases[k % cases.size()];
      posted.emplace_back(one.name, one.post(worker));
    }
    for (const auto& [name, is_right] : posted) {
      INFO(name << ", " << together << " together");
      CHECK(is_right());
    }
  }
}

std::vector<Case> all_cases(const TemporaryDirectory& directory) {
  std::vector<Case> cases;
  for (const int size : {1, 2, 3, 7, 64, kSanitized ? 90 : 257}) {
    for (Case& one : cases_of(directory, size)) cases.push_back(std::move(one));
  }
  return cases;
}

}  // namespace

TEST_CASE("a worker's results are the direct calls' bits", "[worker][slow]") {
  const TemporaryDirectory directory;
  const std::vector<Case> cases = all_cases(directory);
  for (const int threads : {1, 2, 5}) {
    INFO(threads << " threads");
    Worker worker(options_with(threads));
    check_all(worker, cases, cases.size(), 1);
    check_all(worker, cases, cases.size(), 16);
    check_all(worker, cases, 256, 256);
  }
}

TEST_CASE("a worker in a lent arena gives the direct calls' bits", "[worker][slow]") {
  const TemporaryDirectory directory;
  const std::vector<Case> cases = all_cases(directory);
  for (const int slots : {1, 3}) {
    INFO(slots << " slots");
    tbb::task_arena arena(slots);
    Worker worker(lent(arena));
    check_all(worker, cases, cases.size(), 16);
    check_all(worker, cases, 256, 256);
  }
}

// Promise: a bake is a request like any other: it has the call's bits, stops when told to, and equal ones share a run.

namespace {

std::shared_ptr<const LatLongImage> picture(int width, Content content = Content::high_range) {
  const TestLatLong made = make_lat_long(content, width, width / 2, 3);
  return std::make_shared<const LatLongImage>(LatLongImage{made.width, made.height, made.pixels});
}

std::shared_ptr<const Cubemap> cubemap(int size) {
  const TestCubemap made = make_cubemap(Content::high_range, size, 3, 3);
  return std::make_shared<const Cubemap>(Cubemap{made.size, made.pixels});
}

}  // namespace

TEST_CASE("bakes in a worker have the call's bits", "[worker][bake]") {
  const auto lat_long = picture(128);
  const auto cube = cubemap(40);
  const BakeResult expected_lat_long = bake(lat_long->view(), small_bake());
  const BakeResult expected_cube = bake(cube->view(), small_bake());
  for (const int threads : {1, 2, 4}) {
    Worker worker(options_with(threads));
    std::vector<Job<std::shared_ptr<const BakeResult>>> jobs;
    for (int k = 0; k < 6; ++k) {
      jobs.push_back(worker.post(k % 2 == 0 ? Bake{lat_long, small_bake()} : Bake{cube, small_bake()}));
    }
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      const auto found = take(jobs[k]);
      REQUIRE(found);
      CHECK(same_bits(*found, k % 2 == 0 ? expected_lat_long : expected_cube));
    }
  }
}

TEST_CASE("files are baked in a worker", "[worker][bake]") {
  const TemporaryDirectory directory;
  const auto image = picture(64);
  write_environment(directory.file("sky.pfm"), image->view());
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
  for (const int threads : {1, 2, 4}) {
    Worker worker(options_with(threads));
    std::vector<Job<Projection>> jobs;
    forget_allocations_in_tiles();
    for (const int size : {64, 512, 1024}) {
      const TestCubemap cubemap = make_cubemap(Content::random, size, 3, 1);
      for (int k = 0; k < 3; ++k) jobs.push_back(worker.post(Project{Cubemap{size, cubemap.pixels}}));
    }
    const TestLatLong lat_long = make_lat_long(Content::special_values, 1024, 512, 1);
    jobs.push_back(worker.post(Project{LatLongImage{1024, 512, lat_long.pixels}}));
    worker.wait_until_idle();
    CHECK(allocations_in_tiles() == 0);
    for (auto& job : jobs) CHECK(outcome(job) == "result");
  }
}

}  // namespace welkin::test
