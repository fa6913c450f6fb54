// Work on tiles: every tile is done once, errors and stop requests are reported, and hot loops allocate nothing.
#include "jobs/tiles.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "float_environment/modes.h"
#include "jobs/task_graph.h"
#include "platform/thread.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/process_threads.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

using jobs::Placement;

void run(std::size_t count, Placement placement, const Control& control,
         const std::function<void(std::size_t, std::size_t)>& tile) {
  jobs::run_tiles(count, placement, jobs::worker_count(placement), control, tile);
}

/// Returns whether two tiles ever ran at once with the same worker number, or one with an invalid number.
bool tiles_share_workers(std::size_t count) {
  std::vector<std::atomic<int>> inside(jobs::worker_count(Placement::arena));
  std::atomic<bool> shared{false};
  run(count, Placement::arena, {}, [&](std::size_t, std::size_t worker) {
    if (worker >= inside.size() || inside[worker].fetch_add(1) != 0) shared = true;
    std::this_thread::yield();
    if (worker < inside.size()) inside[worker].fetch_sub(1);
  });
  return shared;
}

constexpr Placement kBoth[] = {Placement::calling_thread, Placement::arena};

}  // namespace

TEST_CASE("Every tile runs once", "[jobs]") {
  for (const Placement placement : kBoth) {
    for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{1000}}) {
      std::vector<std::atomic<int>> runs(count);
      run(count, placement, {}, [&](std::size_t tile, std::size_t) { ++runs[tile]; });
      for (const auto& run : runs) CHECK(run == 1);
    }
  }
}

TEST_CASE("A worker's number is its own while its tile runs", "[jobs]") {
  run_with_threads(8, [] {
    CHECK(jobs::worker_count(Placement::arena) == 8);
    CHECK_FALSE(tiles_share_workers(2000));
  });
}

TEST_CASE("Jobs started inside each other keep their workers apart", "[jobs]") {
  run_with_threads(4, [] {
    std::atomic<bool> shared{false};
    tbb::parallel_for(0, 20, [&](int) {
      if (tiles_share_workers(50)) shared = true;
    });
    CHECK_FALSE(shared);
  });
}

TEST_CASE("Progress rises to one and never falls", "[jobs]") {
  for (const Placement placement : kBoth) {
    std::vector<double> seen;
    Control control;
    control.progress = [&](double share) { seen.push_back(share); };
    run(100, placement, control, [](std::size_t, std::size_t) {});
    REQUIRE_FALSE(seen.empty());
    for (std::size_t k = 1; k < seen.size(); ++k) CHECK(seen[k] > seen[k - 1]);
    CHECK(seen.back() == 1.0);
  }
}

TEST_CASE("A stop request ends a job between tiles", "[jobs]") {
  for (const Placement placement : kBoth) {
    for (const double share : {0.0, 0.1, 0.5}) {
      stop_source source;
      Control control{source.get_token(), {}};
      std::atomic<int> tiles{0};
      if (share == 0.0) source.request_stop();
      const ThrownError error = thrown_by([&] {
        run(1000, placement, control, [&](std::size_t, std::size_t) {
          if (++tiles >= static_cast<int>(share * 1000.0)) source.request_stop();
        });
      });
      CHECK(error.code == ErrorCode::cancelled);
      CHECK(tiles <= static_cast<int>(share * 1000.0) + 8);  // at most one more per worker
    }
  }
}

TEST_CASE("What a tile throws comes out, and the next job runs", "[jobs]") {
  for (const Placement placement : kBoth) {
    CHECK_THROWS_AS(run(100, placement, {},
                        [](std::size_t tile, std::size_t) {
                          if (tile == 57) throw std::runtime_error("tile 57");
                        }),
                    std::runtime_error);
    std::atomic<int> tiles{0};
    run(10, placement, {}, [&](std::size_t, std::size_t) { ++tiles; });
    CHECK(tiles == 10);
  }
}

TEST_CASE("Threads that share an arena for one keep their workers apart", "[jobs][slow]") {
  tbb::task_arena arena(1);
  std::atomic<bool> shared{false};
  on_threads(3, [&](std::size_t) {
    arena.execute([&] {
      if (tiles_share_workers(300)) shared = true;
    });
  });
  CHECK_FALSE(shared);
}

TEST_CASE("A cancelled group around a job does not make it skip tiles", "[jobs]") {
  std::atomic<int> tiles{0};
  tbb::task_group_context context;
  tbb::parallel_for(
      0, 1,
      [&](int) {
        context.cancel_group_execution();
        run(500, Placement::arena, {}, [&](std::size_t, std::size_t) { ++tiles; });
      },
      context);
  CHECK(tiles == 500);
}

TEST_CASE("Tiles see the default floating-point environment and leave the caller's alone", "[jobs]") {
  const FloatEnvironment callers = flushing(mode_named("upward"));
  std::atomic<bool> all_default{true};
  FloatEnvironment after;
  {
    const InEnvironment environment(callers);
    for (const Placement placement : kBoth) {
      run(64, placement, {}, [&](std::size_t, std::size_t) {
        if (current_environment() != FloatEnvironment{}) all_default = false;
      });
    }
    after = current_environment();
  }
  CHECK(all_default);
  CHECK((after == callers));
}

TEST_CASE("The number of threads is checked", "[jobs]") {
  CHECK(available_threads() >= 1);
  const ThrownError error = thrown_by([] { run_with_threads(-1, [] {}); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("threads is -1"));
  CHECK(thrown_by([] { run_with_threads(1025, [] {}); }).says("threads is 1025"));
  bool ran = false;
  run_with_threads(0, [&] { ran = true; });
  CHECK(ran);
}

TEST_CASE("Work beside a OneThread stays in its thread, in order", "[jobs]") {
  run_with_threads(4, [] {
    const std::thread::id here = std::this_thread::get_id();
    std::vector<std::size_t> order;
    {
      const jobs::OneThread alone;
      CHECK(jobs::OneThread::here());
      CHECK(jobs::worker_count(jobs::Placement::arena) == 1);
      jobs::run_tiles(200, jobs::Placement::arena, 1, {}, [&](std::size_t tile, std::size_t worker) {
        if (worker == 0 && std::this_thread::get_id() == here) order.push_back(tile);
      });
      jobs::TaskGraph graph;
      for (std::size_t pass = 0; pass < 50; ++pass) {
        graph.add(1.0 + static_cast<double>(pass), [&, pass](const Control&) {
          if (std::this_thread::get_id() == here) order.push_back(200 + pass);
        });
      }
      graph.run({});
    }
    CHECK_FALSE(jobs::OneThread::here());
    REQUIRE(order.size() == 250);
    CHECK(std::ranges::is_sorted(order));
  });
}

// Sanitizers have their own heap, whose allocations cannot be counted.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

template <class Work>
long allocations_during(const Work& work) {
  forget_allocations_in_tiles();
  work();
  return allocations_in_tiles();
}

}  // namespace

TEST_CASE("Threads take part in the work of their arena, and are gone afterwards", "[jobs]") {
  constexpr int kThreads = 4;
  const std::set<int> before = process_threads();
  std::atomic<int> there{0};
  bool all = false;
  run_with_threads(kThreads, [&] {
    tbb::parallel_for(
        0, kThreads,
        [&](int) {
          ++there;
          while (there < kThreads) std::this_thread::yield();  // never ends if a thread is missing
        },
        tbb::static_partitioner());
    all = threads_since(before).size() == kThreads - 1;
  });
  CHECK(there == kThreads);
  CHECK(all);
  CHECK(threads_since(before).empty());
}

namespace {

/// Files of /proc and of control groups below a temporary root.
class FakeSystem {
 public:
  void add(const std::string& name, const std::string& text) const {
    const std::filesystem::path path = root() / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  [[nodiscard]] std::filesystem::path root() const { return folder_.file("root"); }
  [[nodiscard]] int quota() const { return detail::quota_processors(root()); }
  /// Once there is one file more.
  [[nodiscard]] int quota_with(const std::string& name, const std::string& text) const {
    add(name, text);
    return quota();
  }

 private:
  TemporaryDirectory folder_;
};

constexpr const char* kVersion2 = "35 24 0:30 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate\n";
constexpr const char* kVersion1 =
    "33 25 0:29 / /sys/fs/cgroup/cpu,cpuacct rw shared:10 - cgroup cgroup rw,cpu,cpuacct\n";

}  // namespace

TEST_CASE("A quota of control groups of version 2 counts, and of the groups around the process's own", "[jobs]") {
  const FakeSystem system;
  CHECK(system.quota() == 0);
  system.add("proc/self/cgroup", "0::/system/build\n");
  CHECK(system.quota_with("proc/self/mountinfo", kVersion2) == 0);
  CHECK(system.quota_with("sys/fs/cgroup/system/build/cpu.max", "max 100000\n") == 0);
  CHECK(system.quota_with("sys/fs/cgroup/system/build/cpu.max", "450000 100000\n") == 5);
  CHECK(system.quota_with("sys/fs/cgroup/system/cpu.max", "200000 100000\n") == 2);
  CHECK(system.quota_with("sys/fs/cgroup/cpu.max", "1000 100000\n") == 1);
}

TEST_CASE("A quota of control groups of version 1 counts", "[jobs]") {
  const FakeSystem system;
  system.add("proc/self/cgroup", "9:memory:/else\n4:cpu,cpuacct:/docker/1234\n0::/docker/1234\n");
  system.add("proc/self/mountinfo", kVersion1);
  system.add("sys/fs/cgroup/cpu,cpuacct/docker/1234/cpu.cfs_quota_us", "-1\n");
  CHECK(system.quota_with("sys/fs/cgroup/cpu,cpuacct/docker/1234/cpu.cfs_period_us", "100000\n") == 0);
  system.add("sys/fs/cgroup/cpu,cpuacct/docker/cpu.cfs_quota_us", "250000\n");
  CHECK(system.quota_with("sys/fs/cgroup/cpu,cpuacct/docker/cpu.cfs_period_us", "100000\n") == 3);

  SECTION("of a container, which sees its own group as the topmost") {
    system.add("proc/self/mountinfo",
               "33 25 0:29 /docker/1234 /sys/fs/cgroup/cpu,cpuacct rw - cgroup cgroup rw,cpu,cpuacct\n");
    system.add("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "400000\n");
    CHECK(system.quota_with("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n") == 4);
  }
  SECTION("beside one of version 2, of which the lesser counts") {
    system.add("proc/self/mountinfo",
               std::string(kVersion1) + "35 24 0:30 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n");
    CHECK(system.quota_with("sys/fs/cgroup/unified/docker/1234/cpu.max", "200000 100000\n") == 2);
    CHECK(system.quota_with("sys/fs/cgroup/unified/docker/1234/cpu.max", "900000 100000\n") == 3);
  }
}

TEST_CASE("Nothing outside the mounted control groups sets a quota", "[jobs]") {
  const FakeSystem system;
  system.add("proc/self/cgroup", "0::/../other\n");  // as a process of another namespace sees it
  system.add("proc/self/mountinfo", kVersion2);
  system.add("sys/fs/other/cpu.max", "100000 100000\n");
  CHECK(system.quota_with("sys/fs/cpu.max", "100000 100000\n") == 0);
  CHECK(system.quota_with("sys/fs/cgroup/cpu.max", "300000 100000\n") == 3);
}

TEST_CASE("Files of control groups that make no sense set no quota", "[jobs]") {
  const FakeSystem system;
  system.add("proc/self/cgroup", "0::/a\n");
  system.add("proc/self/mountinfo", std::string("x\n- - -\n") + kVersion2);
  for (const char* const text : {"", "100000\n", "-5 100000\n", "100000 0\n", "1e9 100000\n", "x y z\n", "1,5 1\n"}) {
    system.add("sys/fs/cgroup/a/cpu.max", text);
    INFO(text);
    CHECK(system.quota() == 0);
  }
  CHECK(system.quota_with("sys/fs/cgroup/a/cpu.max", "9223372036854775807 1\n") > 1000);
}

TEST_CASE("The counter sees allocations in tiles", "[jobs][allocation]") {
  run_with_threads(3, [] {
    CHECK(allocations_during([] {
            jobs::run_tiles(10, jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena), {},
                            [](std::size_t, std::size_t) {
                              int* volatile one = new int(1);  // volatile, or the compiler removes both pairs
                              delete one;
                              void* volatile other = std::malloc(100);
                              std::free(other);
                            });
          }) == (kSeesMalloc ? 20 : 10));
  });
}

TEST_CASE("Projection allocates nothing while it runs", "[jobs][allocation][slow]") {
  // The larger one is read in strips, of three bands and of ten.
  const std::array cubemaps{make_cubemap(Content::random, 64, 3, 1), make_cubemap(Content::random, 640, 3, 1)};
  for (const int threads : {1, 4}) {
    run_with_threads(threads, [&] {
      for (const TestCubemap& cubemap : cubemaps) {
        for (const int bands : {3, 10}) {
          ProjectionOptions options{.bands = bands};
          CHECK(allocations_during([&] { static_cast<void>(project(cubemap.view(), options)); }) == 0);
          options.target_size = 100;
          CHECK(allocations_during([&] { static_cast<void>(project(cubemap.view(), options)); }) == 0);
          options.quadrature = Quadrature::midpoint;
          options.pixels.clamp = RadianceClamp{};
          CHECK(allocations_during([&] { static_cast<void>(project(cubemap.view(), options)); }) == 0);
        }
      }
      const TestCubemap special = make_cubemap(Content::special_values, 128, 4, 1);
      CHECK(allocations_during([&] { static_cast<void>(project(special.view())); }) == 0);
      const TestLatLong lat_long = make_lat_long(Content::special_values, 1024, 512, 1);
      CHECK(allocations_during([&] { static_cast<void>(project(lat_long.view())); }) == 0);
    });
  }
}

#endif

}  // namespace welkin::test
