// What a call does, taken down on one thread, and how long that would take on many.

#include "jobs/trace.h"

#include <chrono>
#include <thread>
#include <typeinfo>
#include <utility>
#include <vector>

#include "jobs/task_graph.h"
#include "jobs/tiles.h"
#include "perf/report/schedule.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

using jobs::TracedRegion;
using jobs::TracedWork;

TracedWork serial(double seconds) { return {{{seconds, {}}}}; }

/// Serial work, parts side by side, serial work.
TracedWork forked(double before, std::vector<TracedWork> parts, double after,
                  std::vector<std::vector<std::size_t>> waits = {}) {
  TracedWork work = {{{before, {}}, {after, {}}}};
  work.stretches.front().region.push_back({&typeid(int), std::move(parts), std::move(waits)});
  return work;
}

void wait_a_little() { std::this_thread::sleep_for(std::chrono::milliseconds(2)); }

}  // namespace

TEST_CASE("a recording has the regions of a call, with the regions inside their parts", "[jobs][trace]") {
  TracedWork trace;
  run_with_threads(1, [&] {
    jobs::TraceRecording recording;
    wait_a_little();
    jobs::TaskGraph graph;
    const std::size_t first = graph.add(1.0, [](const Control&) { wait_a_little(); });
    graph.add(1.0,
              [](const Control& control) {
                jobs::run_tiles(3, jobs::Placement::arena, 1, control,
                                [](std::size_t, std::size_t) { wait_a_little(); });
              },
              {first});
    graph.run({});
    trace = recording.finish();
  });
  REQUIRE(trace.stretches.size() == 2);
  CHECK(trace.stretches[0].seconds >= 0.002);
  CHECK(trace.stretches[1].region.empty());
  REQUIRE(trace.stretches[0].region.size() == 1);
  const TracedRegion& passes = trace.stretches[0].region.front();
  CHECK(passes.what == nullptr);
  CHECK(passes.after == std::vector<std::vector<std::size_t>>{{}, {0}});
  REQUIRE(passes.parts.size() == 2);
  REQUIRE(passes.parts[1].stretches.size() == 2);
  const TracedRegion& tiles = passes.parts[1].stretches[0].region.at(0);
  CHECK(tiles.what != nullptr);
  REQUIRE(tiles.parts.size() == 3);
  for (const TracedWork& tile : tiles.parts) {
    REQUIRE(tile.stretches.size() == 1);
    CHECK(tile.stretches[0].seconds >= 0.002);
  }
  // Five waits in all; of the three tiles two can be done beside another.
  CHECK(report::scheduled_seconds(trace, 1) >= 0.010);
  CHECK(report::scheduled_seconds(trace, 64) < report::scheduled_seconds(trace, 1) - 0.0039);
}

TEST_CASE("without a recording nothing is taken down, nor after it has ended", "[jobs][trace]") {
  const auto tiles = [] {
    jobs::run_tiles(2, jobs::Placement::calling_thread, 1, {}, [](std::size_t, std::size_t) {});
  };
  {
    jobs::TraceRecording recording;
    CHECK(recording.finish().stretches.size() == 1);
  }
  tiles();
  jobs::TraceRecording recording;
  CHECK(recording.finish().stretches.front().region.empty());
  tiles();
  CHECK(recording.finish().stretches.size() == 2);
}

TEST_CASE("work is scheduled on workers without idle ones while something is ready", "[report][trace]") {
  using report::critical_path_seconds;
  using report::scheduled_seconds;
  const TracedWork even = forked(1.0, std::vector<TracedWork>(8, serial(1.0)), 0.5);
  CHECK(scheduled_seconds(even, 1) == 9.5);
  CHECK(scheduled_seconds(even, 2) == 5.5);
  CHECK(scheduled_seconds(even, 3) == 4.5);  // 3, 3 and 2 tiles
  CHECK(scheduled_seconds(even, 100) == 2.5);
  CHECK(critical_path_seconds(even) == 2.5);

  // A diamond whose one side is a region itself.
  const TracedWork side = forked(0.0, {serial(2.0), serial(2.0)}, 0.0);
  const TracedWork diamond = forked(0.0, {serial(1.0), side, serial(3.0), serial(1.0)}, 0.0, {{}, {0}, {0}, {1, 2}});
  CHECK(scheduled_seconds(diamond, 1) == 9.0);
  CHECK(critical_path_seconds(diamond) == 5.0);
  CHECK(scheduled_seconds(diamond, 3) == 5.0);
  CHECK(scheduled_seconds(diamond, 2) == 6.0);  // 1, then 2 + 2 beside 3, then 1

  CHECK(scheduled_seconds({}, 4) == 0.0);
  CHECK(scheduled_seconds(forked(1.0, {}, 1.0), 4) == 2.0);
}

}  // namespace welkin::test
