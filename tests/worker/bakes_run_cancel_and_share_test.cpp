// Promise: a bake is a request like any other: it has the call's bits, stops when told to, and equal ones share a run.
#include <memory>
#include <vector>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/environment_writer.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

std::shared_ptr<const LatLongImage> picture(int width, Content content = Content::high_range) {
  const TestLatLong made = make_lat_long(content, width, width / 2, 3);
  return std::make_shared<const LatLongImage>(LatLongImage{made.width, made.height, made.pixels});
}

std::shared_ptr<const CubemapImage> cubemap(int size) {
  const TestCubemap made = make_cubemap(Content::high_range, size, 3, 3);
  return std::make_shared<const CubemapImage>(CubemapImage{made.size, made.pixels});
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
      const auto found = take(jobs[k].future());
      REQUIRE(found);
      CHECK(same_bits(*found, k % 2 == 0 ? expected_lat_long : expected_cube));
    }
  }
}

TEST_CASE("equal bakes are run once", "[worker][bake]") {
  const auto image = picture(64);
  Worker worker(options_with(1));
  std::vector<Job<std::shared_ptr<const BakeResult>>> jobs;
  Hold hold(worker);
  for (int k = 0; k < 4; ++k) jobs.push_back(worker.post(Bake{image, small_bake()}));
  auto other = worker.post(Bake{image, small_bake(8)});
  hold.let_go();
  const auto first = take(jobs.front().future());
  for (std::size_t k = 1; k < jobs.size(); ++k) CHECK(take(jobs[k].future()) == first);  // the very same result
  CHECK(take(other.future()) != first);
  CHECK(Bake{image, small_bake()} == Bake{image, small_bake()});
  CHECK(!(Bake{image, small_bake()} == Bake{picture(64), small_bake()}));
  CHECK(!(Bake{image, small_bake()} == Bake{cubemap(8), small_bake()}));
  CHECK(Bake{image, small_bake()}.bytes() == 12 * 64 * 32);
}

TEST_CASE("a running bake stops when it is told to", "[worker][bake]") {
  const auto image = picture(1024);
  Worker worker(options_with(2));
  for (int round = 0; round < 3; ++round) {
    auto job = worker.post(Bake{image, small_bake(256 + round)});
    REQUIRE(eventually([&] { return job.progress() > 0.0 || job.ready(); }));
    job.cancel();
    const std::string end = outcome(job);
    CHECK((end == "cancelled" || end == "result"));
    worker.wait_until_idle();
    CHECK(worker.load().jobs == 0);
  }
  CHECK(take(worker.post(Bake{picture(64), small_bake()}).future()));
}

TEST_CASE("a bake's errors come through its future", "[worker][bake]") {
  Worker worker(options_with(2));
  BakeOptions rejecting = small_bake();
  rejecting.pixels.nan = NonFinitePolicy::reject;
  CHECK(outcome(worker.post(Bake{picture(64, Content::nan_bearing), rejecting})) == "rejected_pixel");
  BakeOptions limited = small_bake();
  limited.memory_limit_bytes = 1000;
  CHECK(outcome(worker.post(Bake{picture(64), limited})) == "limit_exceeded");
}

TEST_CASE("files are baked in a worker", "[worker][bake]") {
  const TemporaryDirectory directory;
  const auto image = picture(64);
  write_environment(directory.file("sky.pfm"), image->view());
  Worker worker(options_with(2));
  const auto found = take(worker.post(BakeFile{directory.file("sky.pfm"), {}, small_bake()}).future());
  REQUIRE(found);
  CHECK(same_bits(*found, bake_file(directory.file("sky.pfm"), {}, small_bake())));
  CHECK(outcome(worker.post(BakeFile{directory.file("none.pfm")})) == "file_access");
}

}  // namespace welkin::test
