#include "image/formats.h"

#include <Imath/half.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "support/catch.h"

namespace welkin::test {
namespace {

/// The double nearest to 2.2 is not 2.2: at 1e-100 that makes 4e-14.
double power_2_2(double x) { return static_cast<double>(std::pow(static_cast<long double>(x), 2.2L)); }

}  // namespace

TEST_CASE("Halves become the floats that Imath makes of them", "[image]") {
  for (std::uint32_t bits = 0; bits < 0x10000U; ++bits) {
    Imath::half half;
    half.setBits(static_cast<std::uint16_t>(bits));
    const float expected = half;
    const float found = image::float_from_half(static_cast<std::uint16_t>(bits));
    if (std::isnan(expected)) {
      REQUIRE(std::isnan(found));
    } else {
      REQUIRE(found == expected);
      REQUIRE(std::signbit(found) == std::signbit(expected));
    }
  }
}

TEST_CASE("Transfer functions match libm to a few roundings", "[image]") {
  for (int k = 0; k <= 1000; ++k) {
    const double x = k / 1000.0;
    const double srgb = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    CHECK(image::linear_from_srgb(x) == Approx(srgb).epsilon(2e-15).margin(1e-300));
    CHECK(image::power_2_2(x) == Approx(power_2_2(x)).epsilon(2e-15).margin(1e-300));
  }
  for (const double x : {1e-100, 1e-38, 1e-10, 1e-3}) {
    CHECK(image::power_2_2(x) == Approx(power_2_2(x)).epsilon(2e-15).margin(0.0));
  }
}

TEST_CASE("Eight-bit formats map their ends to 0 and 1", "[image]") {
  const std::vector<std::uint8_t> texels{0, 128, 255, 7};
  for (const PixelFormat format :
       {PixelFormat::rgb_u8, PixelFormat::rgba_u8, PixelFormat::rgb_srgb8, PixelFormat::rgba_srgb8}) {
    float rgb[3];
    image::decode_texels(format, texels.data(), 1, rgb);
    CHECK(rgb[0] == 0.0F);
    CHECK(rgb[2] == 1.0F);
    const bool srgb = format == PixelFormat::rgb_srgb8 || format == PixelFormat::rgba_srgb8;
    CHECK(static_cast<double>(rgb[1]) == Approx(srgb ? 0.21586050 : 128.0 / 255.0).epsilon(1e-7));
  }
}

}  // namespace welkin::test
