// Each ErrorCode has a status of its own, and arrives as that one.
#include <new>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>

#include "c_interface/c_views.h"
#include "c_interface/error_status.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"

namespace welkin::test {
namespace {

/// What an entry returns whose body throws this.
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
    REQUIRE(welkin_status_name(status) != std::string("unknown"));
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
  const welkin_cubemap view = c_view(cube.view());
  auto strict = c_struct<welkin_projection_options>();
  strict.negative = WELKIN_NEGATIVE_REJECT;
  REQUIRE(welkin_project_cubemap(&view, 1, &strict, nullptr, &light) == WELKIN_REJECTED_PIXEL);
  REQUIRE(std::string(welkin_last_error()).find("face") != std::string::npos);

  // The same through a job, and as often as one asks.
  const CWorker worker(1);
  welkin_job* job = nullptr;
  REQUIRE(welkin_post_project_cubemap(worker.get(), &view, 1, &strict, nullptr, &job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_REJECTED_PIXEL);
  const std::string message = welkin_last_error();
  REQUIRE(message.find("face") != std::string::npos);
  static_cast<void>(read("none.exr"));
  REQUIRE(welkin_job_poll(job, nullptr) == WELKIN_REJECTED_PIXEL);
  REQUIRE(welkin_last_error() == message);
  REQUIRE(welkin_job_projection(job, &light) == WELKIN_REJECTED_PIXEL);
  welkin_job_release(job);
}

TEST_CASE("C: a request beyond the worker's memory is a limit exceeded", "[c_interface]") {
  auto options = c_struct<welkin_worker_options>();
  options.threads = 1;
  options.most_bytes = 1000;
  welkin_worker* worker = nullptr;
  REQUIRE(welkin_worker_create(&options, &worker) == WELKIN_OK);
  const auto cube = make_cubemap(Content::random, 8, 3, 1);
  const welkin_cubemap view = c_view(cube.view());
  welkin_job* job = nullptr;
  REQUIRE(welkin_post_project_cubemap(worker, &view, 1, nullptr, nullptr, &job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_LIMIT_EXCEEDED);
  welkin_job_release(job);
  auto post = c_struct<welkin_post_options>();
  post.bytes = 10;  // the caller knows better
  REQUIRE(welkin_post_project_cubemap(worker, &view, 1, nullptr, &post, &job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_OK);
  welkin_job_release(job);
  welkin_worker_destroy(worker);
}

TEST_CASE("C: what a callback throws stays inside", "[c_interface]") {
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

}  // namespace welkin::test
