// Checks that the thread sanitizer reports a race in a tile, so that its silence elsewhere means something.
#ifdef __SANITIZE_THREAD__

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <thread>

#include "jobs/tiles.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace {
std::atomic<bool> swallows{false};
std::atomic<int> swallowed{0};
}  // namespace

// The sanitizer's hook: it is called before each report and suppresses the report if it returns true.
namespace __tsan {
class ReportDesc;
[[gnu::no_sanitize_thread]] bool OnReport(const ReportDesc*, bool suppressed) {
  if (!swallows) return suppressed;
  if (!suppressed) ++swallowed;
  return true;
}
}  // namespace __tsan

namespace welkin::test {
namespace {

int races_reported(const std::function<void(std::size_t tile, std::size_t worker)>& tile) {
  swallowed = 0;
  swallows = true;
  run_with_threads(
      2, [&] { jobs::run_tiles(2, jobs::Placement::arena, jobs::worker_count(jobs::Placement::arena), {}, tile); });
  swallows = false;
  return swallowed;
}

/// Holds each of two tiles until the other has a thread too. Relaxed, because it must not order their accesses.
void wait_for_the_other(std::atomic<int>& inside) {
  inside.fetch_add(1, std::memory_order_relaxed);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (inside.load(std::memory_order_relaxed) < 2 && std::chrono::steady_clock::now() < patience) {
    std::this_thread::yield();
  }
}

}  // namespace

// The sanitizer may miss a race between two simultaneous accesses, hence several attempts.
TEST_CASE("Two tiles that write to the same place are reported", "[jobs]") {
  int same = 0;
  int reported = 0;
  for (int attempt = 0; attempt < 10 && reported == 0; ++attempt) {
    std::atomic<int> inside{0};
    reported = races_reported([&](std::size_t, std::size_t) {
      wait_for_the_other(inside);
      ++same;
    });
  }
  CHECK(reported > 0);
  CHECK(same > 0);
}

TEST_CASE("Two tiles that write to places of their own are not reported", "[jobs]") {
  std::atomic<int> inside{0};
  int counts[2] = {0, 0};
  CHECK(races_reported([&](std::size_t tile, std::size_t) {
          wait_for_the_other(inside);
          ++counts[tile];
        }) == 0);
  CHECK(counts[0] + counts[1] == 2);  // read without an atomic: oneTBB orders it after both
}

}  // namespace welkin::test

#endif
