// Promise: whatever goes wrong in a request arrives through its future, and the worker goes on.
#include <exception>
#include <stdexcept>
#include <string>

#include "support/catch.h"
#include "support/gate.h"
#include "support/outcome.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/worker.h"

namespace welkin::test {

TEST_CASE("the library's own errors arrive, words and all", "[worker]") {
  Worker worker(options_with(2));
  TestCubemap cubemap = make_cubemap(Content::random, 16, 3, 1);
  cubemap.pixels[(2 * 16 * 16 + 5 * 16 + 3) * 3] = std::numeric_limits<float>::quiet_NaN();
  ProjectionOptions options;
  options.nan = NonFinitePolicy::reject;
  const ThrownError expected = thrown_by([&] { static_cast<void>(project(cubemap.view(), options)); });
  const ThrownError got = thrown_by([&] {
    static_cast<void>(take(worker.post(ProjectCubemap{CubemapImage{16, cubemap.pixels}, options}).future()));
  });
  CHECK(got.code == ErrorCode::rejected_pixel);
  CHECK(got.message == expected.message);

  CHECK(outcome(worker.post(ProjectFile{"no-such-file.exr"})) == "file_access");
  CHECK(outcome(worker.post(ReadFile{"no-such-file.exr"})) == "file_access");
  CHECK(outcome(worker.post(MeasureFile{"no-such-file.exr"})) == "file_access");
  const TemporaryDirectory directory;
  write_bytes(directory.file("empty.exr"), {'a', 'b', 'c', 'd', 'e'});
  CHECK(outcome(worker.post(ProjectFile{directory.file("empty.exr")})) == "unsupported_file");

  CHECK(outcome(worker.post(CubemapToCubemap{CubemapImage{16, cubemap.pixels}, -1})) == "invalid_argument");
  CHECK(outcome(worker.post(CubemapToLatLong{CubemapImage{16, cubemap.pixels}, 0, 1})) == "invalid_argument");
  const CubemapView no_view{};
  CHECK(outcome(worker.post(ProjectCubemap{CubemapSource(no_view, nullptr)})) == "invalid_argument");
}

TEST_CASE("anything that a request throws arrives", "[worker]") {
  Worker worker(options_with(1));
  CHECK(outcome(worker.post([](const Control&) { throw std::runtime_error("a thunderstorm"); })) == "a thunderstorm");
  CHECK(outcome(worker.post([](const Control&) { throw std::bad_alloc(); })) == "bad_alloc");
  auto job = worker.post([](const Control&) -> std::string { throw 42; });
  try {
    take(job.future());
    FAIL("nothing was thrown");
  } catch (const int thrown) {
    CHECK(thrown == 42);
  }
  CHECK(outcome(worker.post([](const Control&) { throw "a pointer"; })) == "something");
  CHECK(outcome(worker.post([](const Control&) { throw Error(ErrorCode::cancelled, "by the request itself"); })) ==
        "cancelled");
  CHECK(worker.post([](const Control&) { return 5; }).get() == 5);
  CHECK(worker.load().jobs == 0);
}

// GCC 12's thread sanitizer never ends a std::call_once whose function throws, and a promise is set within one.
#if !defined(__SANITIZE_THREAD__)
TEST_CASE("a result that cannot be moved out arrives as an error", "[worker]") {
  struct Stuck {
    Stuck() = default;
    Stuck(const Stuck&) { throw std::runtime_error("stuck"); }
    Stuck& operator=(const Stuck&) = delete;
    ~Stuck() = default;
  };
  Worker worker(options_with(1));
  CHECK(outcome(worker.post([](const Control&) { return Stuck(); })) == "stuck");
  CHECK(worker.post([](const Control&) { return 5; }).get() == 5);
}
#endif

TEST_CASE("what moving a request throws comes out of post, and nothing is posted", "[worker]") {
  struct Immovable {
    explicit Immovable(int moves) : moves_left(moves) {}
    Immovable(const Immovable&) = delete;
    Immovable(Immovable&& other) : moves_left(other.moves_left - 1) {
      if (moves_left < 0) throw std::runtime_error("does not move");
    }
    Immovable& operator=(const Immovable&) = delete;
    Immovable& operator=(Immovable&&) = delete;
    ~Immovable() = default;
    int operator()(const Control&) const { return 1; }
    int moves_left;
  };
  Worker worker(options_with(1));
  std::string end;
  for (int moves = 0; end != "result"; ++moves) {
    REQUIRE(moves < 20);
    end = outcome_of([&] {
      auto job = worker.post(Immovable(moves));
      CHECK(outcome(job) == "result");
    });
    CHECK((end == "result" || end == "does not move"));
    CHECK(worker.load().jobs == 0);
  }
}

TEST_CASE("an exception of TBB's own making arrives", "[worker]") {
  Worker worker(options_with(2));
  auto job = worker.post([](const Control& control) {
    control.progress(0.5);
    throw std::out_of_range("inside");
  });
  CHECK(outcome(job) == "inside");
}

}  // namespace welkin::test
