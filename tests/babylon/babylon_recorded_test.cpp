// Promise: in midpoint mode Welkin's polynomial is Babylon.js 9.34's, every entry within 1e-6 of the largest.
// The expected values come from the real package (record.mjs); the ctest babylon_live asks it again.
#include "babylon/recorded_cases.h"
#include "support/catch.h"

namespace {

using namespace welkin;
using namespace welkin::test;

/// The promise for one case, on a cubemap of either channel type.
template <class Cubemap>
void check_case(const RecordedCase& recorded, const Cubemap& cubemap) {
  INFO(recorded.description());
  REQUIRE(checksum(cubemap.pixels) == recorded.checksum);
  const Projection projection = project(cubemap.view(), recorded.options);
  const double deviation = relative_deviation(terms(babylon_polynomial(projection.radiance)), recorded.polynomial);
  CHECK(deviation <= 1e-6);
}

void check_group(const std::string& group) {
  int checked = 0;
  for (const RecordedCase& recorded : recorded_cases()) {
    if (recorded.group != group) continue;
    ++checked;
    if (recorded.bytes) {
      check_case(recorded, make_cubemap_bytes(recorded.content, recorded.size, recorded.channels, recorded.seed));
    } else {
      check_case(recorded, make_cubemap(recorded.content, recorded.size, recorded.channels, recorded.seed));
    }
  }
  CHECK(checked >= 7);
}

}  // namespace

TEST_CASE("Babylon.js's polynomial of random cubemaps, sizes 1 to 257", "[babylon]") { check_group("random"); }

TEST_CASE("Babylon.js's polynomial of smooth cubemaps, sizes 1 to 257", "[babylon]") { check_group("smooth"); }

TEST_CASE("Babylon.js's polynomial of uniform and blocky cubemaps, sizes 1 to 257", "[babylon]") {
  check_group("plain");
}

TEST_CASE("Babylon.js's polynomial of high-range cubemaps, sizes 1 to 257", "[babylon]") { check_group("high_range"); }

TEST_CASE("Babylon.js's polynomial of cubemaps that its clamp cuts, per channel and preserving colour", "[babylon]") {
  check_group("clamped");
}

TEST_CASE("Babylon.js's polynomial of gamma-encoded cubemaps", "[babylon]") { check_group("gamma"); }

TEST_CASE("Babylon.js's polynomial of 8-bit cubemaps, linear and gamma-encoded", "[babylon]") { check_group("u8"); }

TEST_CASE("Babylon.js's polynomial of cubemaps with NaN, infinities, negatives and denormals", "[babylon]") {
  check_group("nan_bearing");
}

TEST_CASE("Babylon.js's polynomial with a target size: sizes 64, 100, 256 to 8, 16, 32, 48, 64", "[babylon]") {
  check_group("target_size");
}
