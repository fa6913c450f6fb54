// Promise: the seeded environments are as their header states, bit-identical everywhere. (Cubemaps are also checked
// against their JavaScript twin: every recorded Babylon.js case carries a checksum.)
#include "support/test_environments.h"

#include "support/catch.h"

using namespace welkin;
using namespace welkin::test;

TEST_CASE("test environments: the same bits on every machine", "[support]") {
  // Recorded from this code; test_environments.mjs gives the same for the cubemaps.
  struct Sums {
    Content content;
    std::uint32_t cubemap, lat_long;
  };
  const std::array<Sums, 11> recorded{{
      {Content::random, 0x0580f93dU, 0x2e104ae9U},
      {Content::smooth, 0x3e229c08U, 0x3fc34e72U},
      {Content::high_range, 0x51b8f8cfU, 0xc55b8da8U},
      {Content::clamped, 0x316106b3U, 0xc5710024U},
      {Content::sun_disc, 0x3e229c08U, 0x3fc34e72U},
      {Content::gamma_encoded, 0xa293eac3U, 0xe2e195a6U},
      {Content::special_values, 0x801f5eedU, 0x1ce986adU},
      {Content::nan_bearing, 0x87d6ec3fU, 0xaf74bfa9U},
      {Content::blocks, 0xb3375f91U, 0x6b89fd2aU},
      {Content::uniform, 0x5442b365U, 0xfd923edfU},
      {Content::one_texel_sun, 0x3ba60161U, 0x95b1e7c6U},
  }};
  for (const Sums& sums : recorded) {
    INFO(name(sums.content));
    CHECK(checksum(make_cubemap(sums.content, 6, 3, 11).pixels) == sums.cubemap);
    CHECK(checksum(make_lat_long(sums.content, 13, 7, 11).pixels) == sums.lat_long);
  }
}
