// Page faults of warm calls. They are comparable only where Linux counts them and glibc's threshold can be set.

#if defined(__linux__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <malloc.h>
#include <sys/resource.h>

#include "support/catch.h"
#include "support/heap.h"
#include "support/test_environments.h"
#include "welkin/bake.h"

namespace welkin::test {
namespace {

/// During its lifetime malloc maps every block of 256 KiB and more separately, as in a new process, so that memory from
/// the heap is cleared page by page in each call.
class FreshHeap {
 public:
  FreshHeap() noexcept { mallopt(M_MMAP_THRESHOLD, 256 << 10); }
  ~FreshHeap() { mallopt(M_MMAP_THRESHOLD, 32 << 20); }
  FreshHeap(const FreshHeap&) = delete;
  FreshHeap& operator=(const FreshHeap&) = delete;
};

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

/// Returns the page faults of the fourth call, on one thread.
long warm_faults(const std::function<void()>& call) {
  long faults = 0;
  run_with_threads(1, [&] {
    for (int k = 0; k < 3; ++k) call();
    faults = page_faults();
    call();
    faults = page_faults() - faults;
  });
  return faults;
}

}  // namespace

TEST_CASE("A warm bake takes no page faults beyond its result", "[platform][memory][pages]") {
  constexpr long few = 64;  // stacks, tables of pointers and the like
  const FreshHeap fresh;
  BakeOptions options;
  options.specular->size = 128;
  options.irradiance.reset();
  BakeResult result;
  const auto lat_long = make_lat_long(Content::sun_disc, 512, 256, 1);
  const auto cubemap = make_cubemap(Content::sun_disc, 128, 3, 1);
  {
    const KeptMemory kept(std::size_t{128} << 20U);
    CHECK(warm_faults([&] { bake_into(result, lat_long.view(), options); }) <= few);
    CHECK(warm_faults([&] { bake_into(result, cubemap.view(), options); }) <= few);
  }
  // Without kept memory a cubemap's rings take hundreds of page faults, which are counted here. `malloc_trim` removes
  // free memory that other tests left.
  const KeptMemory kept(0);
  const auto bake = [&] {
    malloc_trim(0);
    bake_into(result, cubemap.view(), options);
  };
  CHECK(warm_faults(bake) > 10 * few);
}

}  // namespace welkin::test
#endif
