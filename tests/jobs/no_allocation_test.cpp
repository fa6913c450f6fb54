// Hot loops allocate nothing: not by operator new, not by malloc, on no thread.
#include <cstddef>
#include <cstdlib>

#include "jobs/tiles.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/test_environments.h"
#include "welkin/control.h"
#include "welkin/projection.h"

// Sanitizers bring a heap of their own; there is nothing to count under them.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace welkin::test {
namespace {

template <class Work>
long allocations_during(const Work& work) {
  forget_allocations_in_tiles();
  work();
  return allocations_in_tiles();
}

}  // namespace

TEST_CASE("The counter sees allocations in tiles", "[jobs][allocation]") {
  run_with_threads(3, [] {
    CHECK(allocations_during([] {
            jobs::run_tiles(10, jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena), {},
                            [](std::size_t, std::size_t) {
                              int* volatile one = new int(1);  // volatile, or the compiler leaves both pairs out
                              delete one;
                              void* volatile other = std::malloc(100);
                              std::free(other);
                            });
          }) == 20);
  });
}

TEST_CASE("Projection allocates nothing while it runs", "[jobs][allocation]") {
  for (const int threads : {1, 2, 4}) {
    run_with_threads(threads, [] {
      for (const int size : {64, 1024}) {
        const TestCubemap cubemap = make_cubemap(Content::random, size, 3, 1);
        for (const int bands : {3, 10}) {
          ProjectionOptions options;
          options.bands = bands;
          CHECK(allocations_during([&] { static_cast<void>(project(cubemap.view(), options)); }) == 0);
          options.target_size = 100;
          CHECK(allocations_during([&] { static_cast<void>(project(cubemap.view(), options)); }) == 0);
          options.quadrature = Quadrature::midpoint;
          options.clamp = RadianceClamp{};
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

}  // namespace welkin::test

#endif
