// Promise: a bake has the same bits on any number of threads and instruction set, and in a worker.
#include <tbb/task_group.h>

#include <memory>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/test_environments.h"
#include "welkin/bake.h"
#include "welkin/control.h"
#include "welkin/instruction_set.h"

namespace welkin::test {
namespace {

template <class View>
void check_bits(const View& view, const BakeOptions& options) {
  const BakeResult expected = bake(view, options);
  const InstructionSet before = active_instruction_set();
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 7}) {
      INFO(name(set) << ", " << threads << " threads");
      run_with_threads(threads, [&] { CHECK(same_bits(bake(view, options), expected)); });
    }
  }
  force_instruction_set(before);
}

}  // namespace

TEST_CASE("Bakes of lat-longs and cubemaps have the same bits everywhere", "[bake]") {
  BakeOptions options = small_bake(48);
  options.bands = 5;
  check_bits(make_lat_long(Content::sun_disc, 400, 200, 5).view(), options);
  check_bits(make_cubemap(Content::special_values, 97, 4, 6).view(), options);
  options.background_size = 31;
  check_bits(make_lat_long_half(Content::high_range, 101, 37, 7).view(), options);
}

TEST_CASE("Bakes side by side in one arena have their own bits", "[bake]") {
  const TestLatLong first = make_lat_long(Content::high_range, 300, 150, 5);
  const TestCubemap second = make_cubemap(Content::smooth, 64, 3, 6);
  const BakeResult expected_first = bake(first.view(), small_bake(40));
  const BakeResult expected_second = bake(second.view(), small_bake(24));
  for (int round = 0; round < 5; ++round) {
    tbb::task_group group;
    bool right[4]{};
    for (int k = 0; k < 4; ++k) {
      group.run([&, k] {
        right[k] = k % 2 == 0 ? same_bits(bake(first.view(), small_bake(40)), expected_first)
                              : same_bits(bake(second.view(), small_bake(24)), expected_second);
      });
    }
    group.wait();
    for (const bool one : right) CHECK(one);
  }
}

TEST_CASE("A bake's tiles allocate nothing", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::high_range, 256, 128, 5);
  static_cast<void>(bake(picture.view(), small_bake(64)));
  forget_allocations_in_tiles();
  static_cast<void>(bake(picture.view(), small_bake(64)));
  CHECK(allocations_in_tiles() == 0);
}

}  // namespace welkin::test
