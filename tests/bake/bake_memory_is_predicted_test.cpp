// Promise: a bake needs no more memory than `bake_bytes` says, and not much less where it matters.
#include "bake/baked.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/sanitized.h"
#include "support/test_environments.h"
#include "welkin/bake.h"

namespace welkin::test {
namespace {

/// Tables by size that are kept between calls (weights, rules), TBB's own, and what is too small to be predicted.
constexpr std::uint64_t kBesides = std::uint64_t{6} << 20U;

template <class View>
void check_memory(const View& view, const BakeOptions& options) {
  if (kSanitized) return;
  std::uint64_t peak = 0;
  std::uint64_t reported = 0;
  {
    const HeapWatch heap;
    const BakeResult result = bake(view, options);
    peak = static_cast<std::uint64_t>(heap.peak_bytes());
    reported = result.peak_bytes;
  }
  const std::uint64_t predicted = bake_bytes(view, options);
  INFO("peak " << peak << " reported " << reported << " predicted " << predicted);
  CHECK(peak <= predicted + kBesides);
  CHECK(reported <= predicted);
  CHECK(peak <= 2 * reported + kBesides);  // what a pass holds for a moment is not in the report
  CHECK(predicted <= 4 * (peak + kBesides));
}

}  // namespace

TEST_CASE("A bake's memory stays below what was predicted", "[bake]") {
  for (const int size : {16, 128, 256}) {
    for (const int width : {128, 1024}) {
      INFO("size " << size << ", lat-long " << width);
      const BakeOptions options = small_bake(size);
      check_memory(make_lat_long(Content::high_range, width, width / 2, 3).view(), options);
      check_memory(make_cubemap(Content::high_range, width / 4, 3, 3).view(), options);
    }
  }
  // With a copy of the pixels.
  check_memory(make_lat_long_half(Content::high_range, 1024, 512, 3).view(), small_bake(64));
  check_memory(make_lat_long(Content::special_values, 1024, 512, 3).view(), small_bake(64));
  BakeOptions sharp = small_bake(64);
  sharp.background_size = 512;
  check_memory(make_cubemap(Content::high_range, 300, 3, 3).view(), sharp);
}

}  // namespace welkin::test
