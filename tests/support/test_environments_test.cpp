// Promise: the seeded environments are what their header says, the same bits everywhere. (Cubemaps are also held
// against their JavaScript twin: every recorded Babylon.js case carries a checksum.)
#include "support/test_environments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <vector>

#include "support/catch.h"

using namespace welkin;
using namespace welkin::test;

TEST_CASE("test environments: names go there and back", "[support]") {
  CHECK(all_contents().size() == 11);
  for (const Content content : all_contents()) CHECK(content_named(name(content)) == content);
  CHECK_THROWS_AS(content_named("nothing"), std::invalid_argument);
}

TEST_CASE("test environments: views have the stated layout", "[support]") {
  const TestCubemap map = make_cubemap(Content::random, 5, 4, 7);
  const CubemapView view = map.view();
  CHECK(map.pixels.size() == 6U * 5U * 5U * 4U);
  CHECK(view.size == 5);
  CHECK(view.row_stride_bytes == 0);
  CHECK(view.format == PixelFormat::rgba32f);
  for (std::size_t face = 0; face < 6; ++face) CHECK(view.faces[face] == map.pixels.data() + face * 100);
  CHECK(make_cubemap(Content::random, 2, 3, 7).view().format == PixelFormat::rgb32f);
  CHECK(make_cubemap_half(Content::random, 2, 3, 7).view().format == PixelFormat::rgb16f);
  CHECK(make_cubemap_half(Content::random, 2, 4, 7).view().format == PixelFormat::rgba16f);
  CHECK(make_cubemap_bytes(Content::random, 2, 3, 7).view().format == PixelFormat::rgb8);
  CHECK(make_cubemap_bytes(Content::random, 2, 4, 7).view().format == PixelFormat::rgba8);

  const TestLatLong picture = make_lat_long(Content::random, 8, 4, 7);
  CHECK(picture.view().pixels == picture.pixels.data());
  CHECK(picture.view().width == 8);
  CHECK(picture.view().height == 4);
  CHECK(picture.view().format == PixelFormat::rgb32f);
  CHECK(picture.pixels.size() == 8U * 4U * 3U);
}

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

TEST_CASE("test environments: a lat-long's sun stands where the cubemap's does", "[support]") {
  // Towards (3, 2, -6) / 7: latitude 16.6 degrees, longitude 153.4.
  const TestLatLong picture = make_lat_long(Content::sun_disc, 128, 64, 1);
  const auto brightest = std::max_element(picture.pixels.begin(), picture.pixels.end()) - picture.pixels.begin();
  const auto texel = static_cast<int>(brightest / 3);
  CHECK(std::abs(texel / 128 - 26) <= 1);
  CHECK(std::abs(texel % 128 - 9) <= 1);
}

TEST_CASE("test environments: ranges, seeds and special values are as stated", "[support]") {
  const auto range = [](Content content) {
    const std::vector<float> pixels = make_cubemap(content, 64, 3, 3).pixels;
    const auto [low, high] = std::minmax_element(pixels.begin(), pixels.end());
    return std::array{*low, *high};
  };
  const auto within = [&range](Content content, float low, float high) {
    INFO(name(content));
    const auto [lowest, highest] = range(content);
    CHECK(lowest >= low);
    CHECK(highest <= high);
    CHECK(highest > low + 0.9F * (high - low));
  };
  within(Content::random, 0.0F, 1.0F);
  within(Content::smooth, 0.1F, 1.5F);
  within(Content::high_range, 0.1F, 3300.0F);
  within(Content::clamped, 0.0F, 20000.0F);
  within(Content::sun_disc, 0.1F, 61000.0F);
  within(Content::gamma_encoded, -0.2F, 1.3F);
  within(Content::blocks, 0.0F, 10.0F);
  within(Content::uniform, 0.5F, 2.0F);
  within(Content::one_texel_sun, 0.0F, 1e6F);

  const auto count = [](Content content, auto&& is) {
    const std::vector<float> pixels = make_cubemap(content, 64, 3, 3).pixels;
    return std::count_if(pixels.begin(), pixels.end(), is);
  };
  const auto is_nan = [](float value) { return std::isnan(value); };
  const auto is_infinite = [](float value) { return std::isinf(value); };
  const auto is_denormal = [](float value) { return std::fpclassify(value) == FP_SUBNORMAL; };
  CHECK(count(Content::special_values, is_nan) > 10);
  CHECK(count(Content::special_values, is_infinite) > 10);
  CHECK(count(Content::special_values, is_denormal) > 10);
  CHECK(count(Content::nan_bearing, is_nan) > 10);
  CHECK(count(Content::nan_bearing, is_infinite) == 0);
  CHECK(count(Content::one_texel_sun, [](float value) { return value > 1.0F; }) == 3);

  std::set<std::uint32_t> seeds;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    seeds.insert(checksum(make_cubemap(Content::random, 4, 3, seed).pixels));
  }
  CHECK(seeds.size() == 20);
}
