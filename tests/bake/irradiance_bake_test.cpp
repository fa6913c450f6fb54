// Irradiance cubemaps of bakes: within their bound of the integral.
#include "bake/baked.h"
#include "image/geometry.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/bake.h"
#include "welkin/projection.h"
#include "welkin/result_cache.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: by default the irradiance cubemap of a bake is within 1e-3 rms of the integral, and within 1 % at any texel.

namespace {

constexpr double kPi = std::numbers::pi;

BakeOptions irradiance_alone(int size, double rms_error = 1e-3) {
  BakeOptions options;
  options.background.reset();
  options.specular.reset();
  options.brdf.reset();
  options.bands = 0;
  options.irradiance = IrradianceOptions{.size = size, .rms_error = rms_error};
  return options;
}

Cubemap irradiance_of(const EnvironmentView& view, int size, double rms_error = 1e-3) {
  return *bake(view, irradiance_alone(size, rms_error)).irradiance;
}

struct Off {
  double rms = 0.0;      ///< relative to the root mean square of the reference
  double largest = 0.0;  ///< relative to the reference at the same texel and channel
};

Off off(const Cubemap& found, const Cubemap& truth) {
  REQUIRE(found.pixels().size() == truth.pixels().size());
  double squares = 0.0;
  double whole = 0.0;
  Off result;
  for (std::size_t k = 0; k < truth.pixels().size(); ++k) {
    const auto wanted = static_cast<double>(truth.pixels()[k]);
    const double difference = static_cast<double>(found.pixels()[k]) - wanted;
    squares += difference * difference;
    whole += wanted * wanted;
    if (difference != 0.0) result.largest = std::max(result.largest, std::abs(difference) / std::abs(wanted));
  }
  result.rms = whole > 0.0 ? std::sqrt(squares / whole) : squares;
  return result;
}

Off error_of(const EnvironmentView& view, int size, double rms_error = 1e-3) {
  return off(irradiance_of(view, size, rms_error), direct_irradiance_cubemap(view, size));
}

Off error_of_bands(const LatLongView& view, int size, int bands) {
  BakeOptions options = irradiance_alone(size);
  options.bands = bands;
  options.irradiance->method = IrradianceMethod::harmonics;
  return off(*bake(view, options).irradiance, direct_irradiance_cubemap(view, size));
}

/// Calls `check` with the irradiance at each texel's centre and the centre's direction.
template <class Check>
void at_texels(const Cubemap& irradiance, const Check& check) {
  const int size = irradiance.size();
  for (int row = 0; row < 6 * size; ++row) {
    for (int column = 0; column < size; ++column) {
      const glm::dvec3 normal = image::face_direction(size, row / size, column + 0.5, row % size + 0.5);
      const float* const rgb = irradiance.face(0) + 3 * (row * size + column);
      check(glm::dvec3(rgb[0], rgb[1], rgb[2]), normal);
    }
  }
}

LatLongImage grey(int width, float value) {
  return {width, width / 2, std::vector<float>(static_cast<std::size_t>(3 * width * width / 2), value)};
}

void set(LatLongImage& image, int column, int row, float value) {
  for (std::size_t c = 0; c < 3; ++c)
    image.pixels[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                      static_cast<std::size_t>(column)) +
                 c] = value;
}

}  // namespace

TEST_CASE("Irradiance of even light is pi times it, at any size and of any source", "[irradiance_bake]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    for (const int edge : {1, 2, 3, 7, 64}) {
      INFO("size " << size << ", source " << edge);
      const TestCubemap cube = make_cubemap(Content::uniform, edge, 3, 1);
      const TestLatLong lat_long = make_lat_long(Content::uniform, edge, (edge + 1) / 2, 1);
      for (const Cubemap& found : {irradiance_of(cube.view(), size), irradiance_of(lat_long.view(), size)}) {
        REQUIRE(found.size() == size);
        at_texels(found, [](const glm::dvec3& rgb, const glm::dvec3&) {
          REQUIRE(glm::length(rgb / glm::dvec3(0.5, 1.0, 2.0) - kPi) < 3e-5);
        });
      }
    }
  }
}

TEST_CASE("Irradiance of a hemisphere, of a cosine and of a lamp is what the closed forms say", "[irradiance_bake]") {
  LatLongImage above = grey(128, 0.0F);
  for (int row = 0; row < 32; ++row) {
    for (int column = 0; column < 128; ++column) set(above, column, row, 1.0F);
  }
  at_texels(irradiance_of(above.view(), 16), [](const glm::dvec3& rgb, const glm::dvec3& normal) {
    REQUIRE(std::abs(rgb.g - 0.5 * kPi * (1.0 + normal.y)) < 2e-5);
  });
  LatLongImage cosine = grey(512, 0.0F);
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 512; ++column)
      set(cosine, column, row,
          static_cast<float>(2.0 + image::lat_long_direction(512, 256, column + 0.5, row + 0.5).z));
  }
  at_texels(irradiance_of(cosine.view(), 16), [](const glm::dvec3& rgb, const glm::dvec3& normal) {
    REQUIRE(rgb.g == Approx(2.0 * kPi + 2.0 / 3.0 * kPi * normal.z).epsilon(5e-5));
  });
  LatLongImage lamp = grey(256, 0.0F);
  set(lamp, 70, 40, 1e5F);
  const glm::dvec3 towards = image::lat_long_direction(256, 128, 70.5, 40.5);
  const double power = 1e5 * image::lat_long_texel_solid_angle(256, 128, 40);
  at_texels(irradiance_of(lamp.view(), 16), [&](const glm::dvec3& rgb, const glm::dvec3& normal) {
    const double cosine_of_lamp = glm::dot(normal, towards);
    if (std::abs(cosine_of_lamp) < 0.02) return;  // the horizon may cut the lamp
    REQUIRE(std::abs(rgb.g - power * std::max(0.0, cosine_of_lamp)) <= 1e-3 * power * std::max(0.0, cosine_of_lamp));
  });
}

TEST_CASE("Irradiance under a sun is within its bound, which three bands miss by far", "[irradiance_bake][truth]") {
  for (const Content content : {Content::sun_disc, Content::high_range, Content::clamped, Content::blocks}) {
    INFO(name(content));
    const TestLatLong image = make_lat_long(content, 128, 64, 5);
    const Off found = error_of(image.view(), 12);
    CHECK(found.rms < 1e-4);
    CHECK(found.largest < 5e-3);
    for (const int edge : {32, 97, 256}) {
      if (edge > 32 && content != Content::sun_disc) continue;
      INFO("cubemap of " << edge);
      const Off of_cube = error_of(make_cubemap(content, edge, 3, 6).view(), 12);
      CHECK(of_cube.rms < 2e-4);
      CHECK(of_cube.largest < 5e-3);
    }
  }
  const TestLatLong sunny = make_lat_long(Content::sun_disc, 128, 64, 5);
  CHECK(error_of_bands(sunny.view(), 12, 3).rms > 0.05);
  CHECK(error_of_bands(sunny.view(), 12, 3).largest > 0.2);
}

TEST_CASE("Irradiance of sources of one and two texels is within its bound", "[irradiance_bake][truth]") {
  for (const int seed : {1, 2, 3}) {
    for (const int edge : {1, 2, 3}) {
      const Off of_cube = error_of(make_cubemap(Content::random, edge, 3, static_cast<std::uint32_t>(seed)).view(), 7);
      CHECK(of_cube.rms < 1e-4);
      CHECK(of_cube.largest < 1e-2);
    }
    for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 1), std::pair(1, 2), std::pair(2, 2)}) {
      const Off found =
          error_of(make_lat_long(Content::random, width, height, static_cast<std::uint32_t>(seed)).view(), 7);
      CHECK(found.rms < 1e-4);
      CHECK(found.largest < 1e-2);
    }
  }
}

TEST_CASE("Irradiance keeps negative light, and huge and tiny radiance", "[irradiance_bake][truth]") {
  TestLatLong signs = make_lat_long(Content::random, 96, 48, 4);
  for (float& value : signs.pixels) value -= 0.52F;
  const Cubemap truth = direct_irradiance_cubemap(signs.view(), 9);
  const Cubemap found = irradiance_of(signs.view(), 9);
  CHECK(*std::min_element(truth.pixels().begin(), truth.pixels().end()) < 0.0F);
  double largest = 0.0;
  for (std::size_t k = 0; k < truth.pixels().size(); ++k)
    largest = std::max(largest, static_cast<double>(std::abs(found.pixels()[k] - truth.pixels()[k])));
  CHECK(largest < 1e-3);

  const TestCubemap bright = make_cubemap(Content::sun_disc, 64, 3, 5);
  const Cubemap usual = irradiance_of(bright.view(), 9);
  for (const float scale : {0x1p100F, 0x1p-120F}) {
    TestCubemap scaled = bright;
    for (float& value : scaled.pixels) value *= scale;
    const Cubemap huge = irradiance_of(scaled.view(), 9);
    for (std::size_t k = 0; k < usual.pixels().size(); ++k)
      REQUIRE(huge.pixels()[k] == Approx(usual.pixels()[k] * scale).epsilon(1e-5));
  }
  const LatLongImage most = grey(16, std::numeric_limits<float>::max());
  const Cubemap most_irradiance = irradiance_of(most.view(), 3);
  for (const float value : most_irradiance.pixels())
    REQUIRE(value == std::numeric_limits<float>::max());  // pi times that exceeds a float
}

namespace {

BakeOptions beside_chain(int size, double chain_error = 1e-3) {
  BakeOptions options = irradiance_alone(size);
  options.specular = PrefilterOptions{.size = 16, .rms_error = chain_error};
  return options;
}

}  // namespace

TEST_CASE("Irradiance of stripes is no further off than its estimate", "[irradiance_bake]") {
  constexpr int kSize = 4;
  // Rows of one and two texels, whose frequencies lie at the odd degrees that a clipped cosine lacks, and columns.
  for (const auto& [width, height, rows] :
       {std::array{106, 53, 1}, std::array{65, 32, 2}, std::array{8, 63, 1}, std::array{128, 64, 0}}) {
    LatLongImage stripes{width, height, {}};
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const int stripe = rows > 0 ? row / rows : column;
        stripes.pixels.insert(stripes.pixels.end(), 3, stripe % 2 == 0 ? 1e-3F : 1.0F);
      }
    }
    const Cubemap truth = direct_irradiance_cubemap(stripes.view(), kSize);
    for (const double bound : {1e-2, 1e-3}) {
      const BakeResult made = bake(stripes.view(), irradiance_alone(kSize, bound));
      const double error = off(*made.irradiance, truth).rms;
      CAPTURE(width, height, rows, bound, error, *made.irradiance_record->error_estimate);
      CHECK(error <= *made.irradiance_record->error_estimate);
      CHECK(*made.irradiance_record->error_estimate <= bound);
    }
  }
}

TEST_CASE("Irradiance beside a chain is within its bound, and its estimate is no less than its error",
          "[irradiance_bake][truth]") {
  const auto check = [](const auto& view, int size) {
    const Cubemap truth = direct_irradiance_cubemap(view, size);
    for (const BakeOptions& options : {irradiance_alone(size), beside_chain(size)}) {
      const BakeResult made = bake(view, options);
      const Off found = off(*made.irradiance, truth);
      CAPTURE(options.specular.has_value(), found.rms, found.largest, *made.irradiance_record->error_estimate);
      CHECK(found.rms < 1e-4);
      CHECK(found.largest < 5e-3);
      CHECK(found.rms <= *made.irradiance_record->error_estimate);
      CHECK(*made.irradiance_record->error_estimate <= 1e-3);
      CHECK(made.irradiance_record->size == size);
    }
  };
  for (const Content content :
       {Content::sun_disc, Content::one_texel_sun, Content::high_range, Content::blocks, Content::random}) {
    CAPTURE(name(content));
    check(make_lat_long(content, 128, 64, 5).view(), 10);
    check(make_cubemap(content, 48, 3, 5).view(), 10);
  }
  // a studio: panels and a dark room
  LatLongImage studio = grey(128, 1e-3F);
  for (int row = 8; row < 16; ++row) {
    for (int column = 20; column < 30; ++column) set(studio, column, row, 60.0F);
  }
  set(studio, 90, 30, 4e3F);
  check(studio.view(), 10);
}

TEST_CASE("A chain's mips do not depend on irradiance beside it, nor irradiance on the mips that are left out",
          "[irradiance_bake]") {
  const TestCubemap image = make_cubemap(Content::sun_disc, 32, 3, 5);
  BakeOptions options = beside_chain(6);
  const BakeResult both = bake(image.view(), options);
  REQUIRE(both.irradiance_record->method == MipMethod::spectral);
  const PrefilteredSpecular alone = prefilter_specular(image.view(), *options.specular);
  CHECK(same_bits(both.specular->cubemap, alone.cubemap));
  options.irradiance->rms_error = 1e-4;  // the chain's harmonics are not accurate enough
  const BakeResult tighter = bake(image.view(), options);
  CHECK(same_bits(tighter.specular->cubemap, alone.cubemap));
  CHECK(same_bits(*tighter.irradiance, irradiance_of(image.view(), 6, 1e-4)));
}

TEST_CASE("Irradiance beside a chain has the same bits whatever a cache holds", "[irradiance_bake]") {
  const TestLatLong image = make_lat_long(Content::high_range, 64, 32, 5);
  const BakeOptions options = beside_chain(6);
  const BakeResult whole = bake(image.view(), options);
  BakeOptions chain = options;
  chain.irradiance.reset();
  ResultCache cache;
  static_cast<void>(cache.bake(image.view(), irradiance_alone(6)));
  static_cast<void>(cache.bake(image.view(), chain));
  for (int k = 0; k < 2; ++k) {  // mips are cached already; irradiance is cached the second time
    const BakeResult found = cache.bake(image.view(), options);
    CHECK(same_bits(*found.irradiance, *whole.irradiance));
    CHECK(same_bits(found.specular->cubemap, whole.specular->cubemap));
    CHECK(found.irradiance_record->error_estimate == whole.irradiance_record->error_estimate);
  }
}

TEST_CASE("Irradiance whose estimate exceeds its bound is integrated, or refused", "[irradiance_bake]") {
  // stripes of the harmonics' own degrees
  LatLongImage lamps = grey(64, 0.0F);
  set(lamps, 3, 0, 1e6F);
  const BakeResult made = bake(lamps.view(), irradiance_alone(4, 2e-5));
  CHECK(off(*made.irradiance, direct_irradiance_cubemap(lamps.view(), 4)).rms <= 2e-5);
  CHECK(*made.irradiance_record->error_estimate <= 2e-5);
}

}  // namespace welkin::test
