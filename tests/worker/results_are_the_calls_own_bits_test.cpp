// Promise: whatever a worker is asked, on however many threads and beside however many jobs, the result has the bits
// of the direct call.
#include <tbb/task_arena.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/same_bits.h"
#include "support/sanitized.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/environment_writer.h"
#include "welkin/resampling.h"
#include "welkin/worker.h"

namespace welkin::test {
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
            auto future = std::make_shared<std::future<Result>>(worker.post(make_request()).future());
            return [shared, future] { return same_bits(take(std::move(*future)), *shared); };
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
  options.clamp = RadianceClamp{};
  options.negative = NegativePolicy::replace;
  return options;
}

void add_cubemap_projections(std::vector<Case>& cases, int size, std::uint32_t seed) {
  const auto floats = kept(CubemapImage{size, make_cubemap(Content::special_values, size, 3, seed).pixels});
  cases.push_back(
      make_case("moved in", project(floats->view()), [floats] { return ProjectCubemap{CubemapImage(*floats)}; }));
  cases.push_back(make_case("shared", project(floats->view(), midpoint_options()), [floats] {
    return ProjectCubemap{floats, midpoint_options()};
  }));
  const auto halves = kept(make_cubemap_half(Content::high_range, size, 4, seed));
  cases.push_back(make_case("borrowed", project(halves->view()),
                            [halves] { return ProjectCubemap{CubemapSource(halves->view(), nullptr)}; }));
  const auto bytes = kept(make_cubemap_bytes(Content::random, size, 4, seed));
  cases.push_back(make_case("owned by another", project(bytes->view()),
                            [bytes] { return ProjectCubemap{CubemapSource(bytes->view(), bytes)}; }));

  auto levels = std::make_shared<std::vector<TestCubemap>>();
  std::vector<CubemapView> chain;
  for (int level = size; level >= 1; level /= 2) levels->push_back(make_cubemap(Content::random, level, 3, seed + 1));
  for (const TestCubemap& level : *levels) chain.push_back(level.view());
  ProjectionOptions options;
  for (options.target_size = 1; options.target_size < size; options.target_size *= 8) {
    cases.push_back(make_case("mip chain", project(chain, options), [chain, levels, options] {
      return ProjectCubemap{CubemapSource(chain, levels), options};
    }));
  }
}

void add_lat_long_projections(std::vector<Case>& cases, int size, std::uint32_t seed) {
  const auto floats =
      kept(LatLongImage{2 * size, size, make_lat_long(Content::special_values, 2 * size, size, seed).pixels});
  cases.push_back(make_case("lat-long moved in", project(floats->view()),
                            [floats] { return ProjectLatLong{LatLongImage(*floats)}; }));
  cases.push_back(make_case("lat-long shared", project(floats->view(), midpoint_options()), [floats] {
    return ProjectLatLong{floats, midpoint_options()};
  }));
  const auto halves = kept(make_lat_long_half(Content::high_range, 2 * size, size, seed, 4));
  cases.push_back(make_case("lat-long borrowed", project(halves->view()),
                            [halves] { return ProjectLatLong{LatLongSource(halves->view(), nullptr)}; }));
}

void add_resamplings(std::vector<Case>& cases, int size, std::uint32_t seed) {
  const auto cubemap = kept(CubemapImage{size, make_cubemap(Content::high_range, size, 3, seed).pixels});
  const auto lat_long = kept(LatLongImage{2 * size, size, make_lat_long(Content::smooth, 2 * size, size, seed).pixels});
  const glm::dmat3 turn = turn_about_y(37.0);
  const int half = size / 2 + 1;
  cases.push_back(make_case("lat-long to cubemap", to_cubemap(lat_long->view(), half, turn), [lat_long, half, turn] {
    return LatLongToCubemap{lat_long, half, turn};
  }));
  cases.push_back(make_case("cubemap to cubemap", to_cubemap(cubemap->view(), size, turn), [cubemap, turn] {
    return CubemapToCubemap{CubemapImage(*cubemap), cubemap->size, turn};
  }));
  cases.push_back(
      make_case("cubemap to lat-long", to_lat_long(cubemap->view(), 3 * half, half, turn), [cubemap, half, turn] {
        return CubemapToLatLong{cubemap, 3 * half, half, turn};
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
    const Environment environment = read_environment(path);
    cases.push_back(make_case("project " + file, project_file(path), [path] { return ProjectFile{path}; }));
    cases.push_back(make_case("measure " + file, measure_environment(path), [path] { return MeasureFile{path}; }));
    cases.push_back(make_case("read " + file, read_environment(path), [path] { return ReadFile{path}; }));
    if (environment.face_size() > 0) {
      cases.push_back(make_case("environment of " + file, project(environment.cubemap()),
                                [path] { return ProjectCubemap{CubemapSource(read_environment(path))}; }));
    } else {
      cases.push_back(make_case("environment of " + file, project(environment.lat_long()),
                                [path] { return ProjectLatLong{LatLongSource(read_environment(path))}; }));
    }
  }
}

std::vector<Case> cases_of(const TemporaryDirectory& directory, int size) {
  const auto seed = static_cast<std::uint32_t>(size);
  std::vector<Case> cases;
  add_cubemap_projections(cases, size, seed);
  add_lat_long_projections(cases, size, seed);
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

TEST_CASE("a worker's results are the direct calls' bits", "[worker]") {
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

TEST_CASE("a worker in a lent arena gives the direct calls' bits", "[worker]") {
  const TemporaryDirectory directory;
  const std::vector<Case> cases = all_cases(directory);
  for (const int slots : {1, 3}) {
    INFO(slots << " slots");
    tbb::task_arena arena(slots);
    WorkerOptions options;
    options.lent_arena = [&arena](std::function<void()> task) { arena.enqueue(std::move(task)); };
    Worker worker(options);
    check_all(worker, cases, cases.size(), 16);
    check_all(worker, cases, 256, 256);
  }
}

}  // namespace welkin::test
