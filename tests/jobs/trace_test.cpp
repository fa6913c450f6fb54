// What a call does, taken down on one thread.

#include "jobs/trace.h"

#include <chrono>
#include <thread>

#include "jobs/task_graph.h"
#include "jobs/tiles.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

using jobs::TracedRegion;
using jobs::TracedWork;

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

}  // namespace welkin::test
