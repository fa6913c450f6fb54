// Promise: the hot loops allocate nothing when a worker runs them either.
#include "support/catch.h"
#include "support/gate.h"
#include "support/heap.h"
#include "support/outcome.h"
#include "support/sanitized.h"
#include "support/test_environments.h"
#include "welkin/worker.h"

namespace welkin::test {

TEST_CASE("projections allocate nothing in a worker's tiles", "[worker][allocation]") {
  if (kSanitized) return;  // sanitizers bring a heap of their own
  for (const int threads : {1, 2, 4}) {
    Worker worker(options_with(threads));
    std::vector<Job<Projection>> jobs;
    forget_allocations_in_tiles();
    for (const int size : {64, 512, 1024}) {
      const TestCubemap cubemap = make_cubemap(Content::random, size, 3, 1);
      for (int k = 0; k < 3; ++k) jobs.push_back(worker.post(ProjectCubemap{CubemapImage{size, cubemap.pixels}}));
    }
    const TestLatLong lat_long = make_lat_long(Content::special_values, 1024, 512, 1);
    jobs.push_back(worker.post(ProjectLatLong{LatLongImage{1024, 512, lat_long.pixels}}));
    worker.wait_until_idle();
    CHECK(allocations_in_tiles() == 0);
    for (auto& job : jobs) CHECK(outcome(job) == "result");
  }
}

}  // namespace welkin::test
