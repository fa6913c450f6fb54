// The task graph that runs a bake's passes.
#include "jobs/task_graph.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include "jobs/tiles.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/jobs.h"
#include "support/thrown_error.h"
#include "welkin/core.h"

namespace welkin::test {

namespace {

using jobs::TaskGraph;

/// Returns a pass that is a job of tiles.
TaskGraph::Work tiles(std::size_t count, std::atomic<int>& done) {
  return [count, &done](const Control& control) {
    const auto placement = jobs::Placement::arena;
    jobs::run_tiles(count, placement, jobs::worker_count(placement), control,
                    [&](std::size_t, std::size_t) { ++done; });
  };
}

}  // namespace

TEST_CASE("A pass begins when all that it waits for have ended", "[bake][jobs]") {
  for (const int threads : {1, 2, 5}) {
    run_with_threads(threads, [] {
      for (int round = 0; round < 200; ++round) {
        std::array<std::atomic<bool>, 6> ended{};
        std::atomic<int> wrong{0};
        TaskGraph graph;
        const auto pass = [&](std::size_t index, std::vector<std::size_t> after) {
          return [&, index, after = std::move(after)](const Control&) {
            for (const std::size_t earlier : after) wrong += ended[earlier] ? 0 : 1;
            wrong += ended[index] ? 1 : 0;
            ended[index] = true;
          };
        };
        graph.add(1.0, pass(0, {}));
        graph.add(2.0, pass(1, {}));
        graph.add(1.0, pass(2, {0}), {0});
        graph.add(5.0, pass(3, {0, 1}), {0, 1});
        graph.add(1.0, pass(4, {2, 3}), {2, 3});
        graph.add(1.0, pass(5, {0}), {0});
        graph.run({});
        CHECK(wrong == 0);
        CHECK(std::all_of(ended.begin(), ended.end(), [](const auto& one) { return one.load(); }));
      }
    });
  }
}

TEST_CASE("Passes that do not wait for each other run at the same time", "[bake][jobs]") {
  run_with_threads(2, [] {
    std::atomic<int> inside{0};
    std::atomic<int> met{0};
    TaskGraph graph;
    for (int k = 0; k < 2; ++k) {
      graph.add(1.0, [&](const Control&) {
        ++inside;
        if (eventually([&] { return inside == 2; })) ++met;
      });
    }
    graph.run({});
    CHECK(met == 2);
  });
}

TEST_CASE("A thread without a pass joins the tiles of another's", "[bake][jobs]") {
  run_with_threads(2, [] {
    std::atomic<int> inside{0};
    std::atomic<bool> met{false};
    TaskGraph graph;
    graph.add(1.0, [](const Control&) {});
    graph.add(9.0, [&](const Control& control) {
      jobs::run_tiles(2, jobs::Placement::arena, 2, control, [&](std::size_t, std::size_t) {
        ++inside;
        if (eventually([&] { return inside == 2; })) met = true;
      });
    });
    graph.run({});
    CHECK(met);
  });
}

TEST_CASE("Progress of a graph is one rising number that ends with 1", "[bake][jobs]") {
  for (const int threads : {1, 4}) {
    run_with_threads(threads, [threads] {
      std::atomic<int> done{0};
      TaskGraph graph;
      graph.add(3.0, tiles(40, done));
      graph.add(1.0, tiles(7, done));
      graph.add(1.0, [](const Control&) {});
      graph.add(2.0, tiles(20, done), {0, 1});
      std::vector<double> reports;
      std::atomic<int> callers{0};
      std::atomic<bool> overlapped{false};
      graph.run({{}, [&](double now) {
                   if (++callers > 1) overlapped = true;
                   reports.push_back(now);
                   tbb::parallel_for(0, 8, [](int) { std::this_thread::yield(); });  // may use TBB
                   --callers;
                 }});
      CHECK(done == 67);
      CHECK(!overlapped);
      // Work that other threads finish during a call is reported by the next one, so a busy machine may make few calls.
      REQUIRE(reports.size() > (threads == 1 ? 3 : 0));
      CHECK(std::is_sorted(reports.begin(), reports.end()));
      CHECK(reports.front() > 0.0);
      CHECK(std::count(reports.begin(), reports.end(), 1.0) == 1);
      CHECK(reports.back() == 1.0);
    });
  }
}

TEST_CASE("A graph says 1 when its last pass has ended, and not before", "[bake][jobs]") {
  std::vector<double> reports;
  const Control control{{}, [&](double now) { reports.push_back(now); }};
  TaskGraph graph;
  graph.add(1.0, [&](const Control& pass) {
    pass.progress(0.5);
    pass.progress(1.0);
    REQUIRE(reports.size() == 2);
    CHECK(std::abs(reports[0] - 0.5) < 1e-8);
    CHECK(reports[1] < 1.0);
    pass.progress(0.7);
    CHECK(reports.size() == 2);  // it never falls
  });
  graph.run(control);
  REQUIRE(reports.size() == 3);
  CHECK(reports.back() == 1.0);

  reports.clear();
  TaskGraph().run(control);
  CHECK(reports == std::vector<double>{1.0});
}

TEST_CASE("Stopping a graph stops all passes and begins no other", "[bake][jobs]") {
  run_with_threads(2, [] {
    stop_source source;
    std::atomic<int> done{0};
    bool later = false;
    TaskGraph graph;
    graph.add(1.0, [&](const Control& control) {
      source.request_stop();
      CHECK(control.stop.stop_requested());
      tiles(1000, done)(control);
    });
    graph.add(1.0, [&](const Control&) { later = true; }, {0});
    CHECK(thrown_by([&] { graph.run({source.get_token(), {}}); }).code == ErrorCode::cancelled);
    CHECK(!later);
    CHECK(done == 0);
  });
}

TEST_CASE("The exception of a pass stops the others and comes out once", "[bake][jobs]") {
  for (const int threads : {1, 2, 4}) {
    run_with_threads(threads, [] {
      for (int round = 0; round < 50; ++round) {
        std::atomic<int> done{0};
        bool later = false;
        TaskGraph graph;
        graph.add(1.0, [&](const Control& control) {
          for (int k = 0; k < 1000; ++k) tiles(4, done)(control);  // throws `cancelled` once it is stopped
        });
        graph.add(2.0, [&](const Control&) { throw std::runtime_error("of pass 1"); });
        graph.add(1.0, [&](const Control&) { later = true; }, {1});
        CHECK_THROWS_WITH(graph.run({}), "of pass 1");
        CHECK(!later);
      }
    });
  }
}

TEST_CASE("A cancelled group of the caller's drops no pass", "[bake][jobs]") {
  run_with_threads(2, [] {
    std::atomic<int> done{0};
    std::atomic<int> passes{0};
    tbb::task_group group;
    group.run_and_wait([&] {
      group.cancel();
      TaskGraph graph;
      graph.add(1.0, tiles(50, done));
      graph.add(1.0, tiles(50, done));
      graph.add(1.0, [&](const Control&) { ++passes; }, {0, 1});
      graph.run({});
    });
    CHECK(done == 100);
    CHECK(passes == 1);
  });
}

TEST_CASE("A thread that waits in a graph runs no stranger's task", "[bake][jobs]") {
  run_with_threads(2, [] {
    for (int round = 0; round < 50; ++round) {
      thread_local bool inside_graph = false;
      std::atomic<bool> strange{false};
      std::atomic<bool> leave{false};
      tbb::task_group strangers;
      TaskGraph graph;
      graph.add(2.0, [](const Control&) {});
      graph.add(1.0, [&](const Control&) {
        const bool waiting_thread = inside_graph;
        if (!waiting_thread) eventually([&] { return leave.load(); });
      });
      for (int k = 0; k < 4; ++k) {
        strangers.run([&] {
          if (inside_graph) strange = true;
          leave = true;
        });
      }
      inside_graph = true;
      leave = round % 2 == 0;
      std::thread release([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        leave = true;
      });
      graph.run({});
      inside_graph = false;
      release.join();
      strangers.wait();
      CHECK(!strange);
    }
  });
}

TEST_CASE("Running out of memory anywhere in a graph is an exception", "[bake][jobs]") {
  run_with_threads(2, [] {
    bool ran_out = true;
    for (long number = 1; ran_out && number < 1000; ++number) {
      std::atomic<int> done{0};
      TaskGraph graph;
      graph.add(1.0, tiles(5, done));
      graph.add(1.0, tiles(5, done));
      graph.add(1.0, tiles(5, done), {0});
      graph.add(1.0, tiles(5, done), {0});
      const FailingHeap heap(Heap::this_thread, number, false);
      try {
        graph.run({});
        CHECK(done == 20);
      } catch (const std::bad_alloc&) {
      }
      ran_out = heap.failed();
    }
    CHECK(!ran_out);
  });
}

}  // namespace welkin::test
