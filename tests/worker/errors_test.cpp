// Every failure in a job arrives as the job's error, including a lack of memory.
#include "support/catch.h"
#include "support/heap.h"
#include "support/jobs.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/worker.h"
#include "worker/scheduler.h"

namespace welkin::test {

// Promise: every failure in a request arrives through its future, and the worker goes on.

TEST_CASE("the library's own errors arrive, words and all", "[worker]") {
  Worker worker(options_with(2));
  TestCubemap cubemap = make_cubemap(Content::random, 16, 3, 1);
  cubemap.pixels[(2 * 16 * 16 + 5 * 16 + 3) * 3] = std::numeric_limits<float>::quiet_NaN();
  ProjectionOptions options;
  options.pixels.nan = NonFinitePolicy::reject;
  const ThrownError expected = thrown_by([&] { static_cast<void>(project(cubemap.view(), options)); });
  const ThrownError got = thrown_by([&] {
    static_cast<void>(take(worker.post(Project{Cubemap{16, cubemap.pixels}, options})));
  });
  CHECK(got.code == ErrorCode::rejected_pixel);
  CHECK(got.message == expected.message);

  CHECK(outcome(worker.post(ProjectFile{"no-such-file.exr"})) == "file_access");
  CHECK(outcome(worker.post(ReadFile{"no-such-file.exr"})) == "file_access");
  CHECK(outcome(worker.post(MeasureFile{"no-such-file.exr"})) == "file_access");
  CHECK(outcome(worker.post(BakeFile{"no-such-file.exr"})) == "file_access");
  const TemporaryDirectory directory;
  write_bytes(directory.file("empty.exr"), {'a', 'b', 'c', 'd', 'e'});
  CHECK(outcome(worker.post(ProjectFile{directory.file("empty.exr")})) == "unsupported_file");

  CHECK(outcome(worker.post(ToCubemap{Cubemap{16, cubemap.pixels}, -1})) == "invalid_argument");
  CHECK(outcome(worker.post(ToLatLong{Cubemap{16, cubemap.pixels}, 0, 1})) == "invalid_argument");
  const CubemapView no_view{};
  CHECK(outcome(worker.post(Project{EnvironmentSource(no_view, nullptr)})) == "invalid_argument");
}

TEST_CASE("anything that a request throws arrives", "[worker]") {
  Worker worker(options_with(1));
  CHECK(outcome(worker.post([](const Control&) { throw std::runtime_error("a thunderstorm"); })) == "a thunderstorm");
  CHECK(outcome(worker.post([](const Control&) { throw std::bad_alloc(); })) == "bad_alloc");
  auto job = worker.post([](const Control&) -> std::string { throw 42; });
  try {
    take(job);
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

// Promise: if memory runs out while a job is done, its future reports that, and the worker goes on. If it runs out in
// `post`, nothing is posted. Cancelling needs no memory.

namespace {

/// Returns whether a job ended with a result, bad_alloc, or an error of the library. (Some codecs report a damaged file
/// when they lack the memory for it.)
bool is_clean(const std::string& end) {
  return end == "result" || end == "bad_alloc" || end == "corrupt_file" || end == "unsupported_file" ||
         end == "file_access" || end == "limit_exceeded";
}

/// A sample of allocations: every `step`-th one from `first` + 1 on, or all if WELKIN_RANDOM_TRIALS is set.
struct Sample {
  int first = 0;
  int step = 3;
};

/// Makes the n-th allocation of the worker's threads fail, for each n of the sample, until the request needs fewer.
template <class MakeRequest, class Result>
void fail_everywhere(int threads, const MakeRequest& make_request, const Result& expected, const Sample& sample) {
  Worker worker(options_with(threads));
  const int step = kSanitized ? 7 : stride(sample.step);
  for (const bool for_good : {false, true}) {
    bool failed = true;
    for (long number = 1 + sample.first % step; failed; number += step) {
      INFO("allocation " << number << (for_good ? " and all after it" : "") << ", " << threads << " threads");
      REQUIRE(number < 100'000);
      auto request = make_request();
      std::string end;
      bool right = true;
      {
        const FailingHeap heap(Heap::other_threads, number, for_good);
        auto job = worker.post(std::move(request));
        if (!eventually([&] { return job.ready(); })) give_up("a job without memory");
        failed = heap.failed();
        end = outcome_of([&] { right = same_bits(job.get(), expected); });
      }
      CHECK(right);
      if (!is_clean(end)) CHECK(end == "bad_alloc");
      if (!failed) CHECK(end == "result");
      if (worker.post([number](const Control&) { return number; }).get() != number) FAIL("the worker is of no use");
      worker.wait_until_idle();
      if (worker.load().bytes != 0 || worker.load().jobs != 0) FAIL("jobs or bytes are left");
    }
  }
}

template <class MakeRequest, class Result>
void fail_everywhere(const MakeRequest& make_request, const Result& expected, const Sample& sample = {}) {
  for (const int threads : {1, 2}) fail_everywhere(threads, make_request, expected, sample);
}

}  // namespace

TEST_CASE("projections of pixels run out of memory cleanly", "[worker]") {
  // Sizes for which no table exists yet: small ones that stay on one thread, and ones that use several.
  for (const int size : {37, 151}) {
    const TestCubemap cubemap = make_cubemap(Content::special_values, size, 3, 1);
    fail_everywhere([&] { return Project{Cubemap{size, cubemap.pixels}}; }, project(cubemap.view()));
    const TestLatLong lat_long = make_lat_long(Content::special_values, 4 * size, 2 * size, 1);
    fail_everywhere(
        [&] {
          return Project{LatLongImage{4 * size, 2 * size, lat_long.pixels}};
        },
        project(lat_long.view()));
  }
}

TEST_CASE("files run out of memory cleanly", "[worker][slow]") {
  const TemporaryDirectory directory;
  for (const char* extension : {".exr", ".hdr", ".pfm", ".png"}) {
    INFO(extension);
    // OpenEXR 3.1 leaks the copy of an attribute if there is no memory to list it.
    if (kAddressSanitized && std::string(extension) == ".exr") continue;
    const auto path = directory.file(std::string("sky") + extension);
    write_environment(path, make_lat_long(Content::smooth, 90, 45, 1).view());
    // All three open the file in the same way, so each samples other allocations: every tenth (all by --all).
    fail_everywhere([&] { return ProjectFile{path}; }, project_file(path), {0, 10});
    fail_everywhere([&] { return ReadFile{path}; }, read_environment(path), {3, 10});
    fail_everywhere([&] { return MeasureFile{path}; }, measure_environment(path), {6, 10});
  }
}

TEST_CASE("a post that runs out of memory posts nothing and gives nothing up", "[worker]") {
  const TestCubemap cubemap = make_cubemap(Content::random, 8, 3, 1);
  const std::string key = "a key that is too long to be kept inside a string";
  for (const std::size_t max_jobs : {std::size_t{2}, std::size_t{3}}) {  // at the limit, and below it
    Worker worker(options_with(1, {.max_jobs = max_jobs}));
    Hold hold(worker);
    const PostOptions options{.key = key};
    auto old = worker.post([key](const Control&) { return key.size(); }, options);
    bool failed = true;
    bool posted = false;
    Job<Projection> job;
    for (long number = 1; !posted; ++number) {
      INFO("allocation " << number);
      REQUIRE(number < 1000);
      Project request{Cubemap{8, cubemap.pixels}};
      detail::give_back_job_memory();  // memory kept from earlier posts would suffice
      const WorkerLoad before = worker.load();
      {
        const FailingHeap heap(Heap::this_thread, number, false);
        try {
          job = worker.post(std::move(request), options);
          posted = true;
        } catch (const std::bad_alloc&) {
        }
        failed = heap.failed();
      }
      CHECK((posted || failed));
      CHECK(old.ready() == posted);
      CHECK(worker.load().jobs == before.jobs);  // one job replaced another, or neither happened
      if (!posted) {
        CHECK(worker.load().bytes == before.bytes);
        CHECK(worker.load().waiting == before.waiting);
      }
    }
    // The remaining work may lack the memory for an error's message, and for nothing else.
    const std::string end = outcome(old);
    CHECK((end == "replaced" || end == "bad_alloc"));
    hold.let_go();
    CHECK(outcome(job) == "result");
  }
}

namespace {

Detached await_quietly(Job<int> job, std::string& end) {
  try {
    static_cast<void>(co_await std::move(job));
    end = "result";
  } catch (const std::bad_alloc&) {
    end = "bad_alloc";
  } catch (const Error& error) {
    end = name(error.code());
  }
}

}  // namespace

TEST_CASE("what follows runs out of memory where it is made, and harms nothing", "[worker]") {
  Worker worker(options_with(1));
  for (int way = 0; way < 4; ++way) {
    bool failed = true;
    for (long number = 1; failed; ++number) {
      INFO("way " << way << ", allocation " << number);
      REQUIRE(number < 1000);
      auto job = worker.post([number](const Control&) { return number > 0 ? 1 : 0; });
      const JobHandle handle = job;
      bool threw = false;
      std::string awaited;
      Job<int> follower;
      detail::give_back_job_memory();
      {
        const FailingHeap heap(Heap::this_thread, number, false);
        try {
          if (way == 0) follower = std::move(job).then([](int value) { return value; });
          if (way == 1) std::move(job).on_drain([](Job<int>) {});
          if (way == 2) await_quietly(std::move(job), awaited);
          if (way == 3) static_cast<void>(handle.cancel());
        } catch (const std::bad_alloc&) {
          threw = true;
        }
        failed = heap.failed();
      }
      CHECK((!threw || failed));
      CHECK_FALSE((threw && way == 3));
      CHECK(eventually([&] { return handle.ready(); }));
      if (way == 0 && !threw) CHECK(outcome(follower) == "result");
      worker.wait_until_idle();
      if (way == 2 && !threw) CHECK((awaited == "result" || awaited == "bad_alloc"));
      worker.drain();
      CHECK(worker.load().jobs == 0);
      CHECK(Detached::alive == 0);
    }
  }
}

TEST_CASE("jobs can be given up without memory", "[worker]") {
  std::vector<Job<int>> jobs;
  std::vector<Job<int>> cancelled;
  int given_up = 0;
  {
    Worker worker(options_with(1));
    auto hold = std::make_unique<Hold>(worker);
    for (int k = 0; k < 10; ++k) {
      jobs.push_back(worker.post([k](const Control&) { return k; }));
      jobs.push_back(worker.post([k](const Control&) { return k; }).then([](int value) { return value; }));
      cancelled.push_back(worker.post([k](const Control&) { return k; }));
    }
    auto running = worker.post(
        [](const Control& control) {
          while (!control.stop.stop_requested()) std::this_thread::yield();
          return 1;
        },
        {.priority = TaskPriority::high});
    {
      const FailingHeap heap(Heap::this_thread, 1, true);  // Catch2's assertions lack memory too
      for (const auto& job : cancelled) given_up += job.cancel() ? 1 : 0;
    }
    CHECK(given_up == 10);
    hold->let_go();
    hold.reset();
    CHECK(eventually([&] { return worker.load().running == 1; }));
    jobs.push_back(std::move(running));
    const FailingHeap heap(Heap::this_thread, 1, true);
    worker.terminate();
  }
  for (auto& job : jobs) {
    const std::string end = outcome(job);
    CHECK((end == "stopped" || end == "bad_alloc"));
  }
  for (auto& job : cancelled) {
    const std::string end = outcome(job);
    CHECK((end == "cancelled" || end == "bad_alloc"));
  }
}

}  // namespace welkin::test
