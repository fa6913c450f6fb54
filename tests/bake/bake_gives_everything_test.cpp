// Promise: a bake gives all that was asked for, each part what its own call gives, and says what it did.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

/// The largest |value - expected| / expected over a level or image, channel by channel.
double off(std::span<const float> values, const std::array<double, 3>& expected) {
  double worst = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = std::abs(values[k] - expected[k % 3]);
    worst = std::max(worst, std::isnan(off) ? std::numeric_limits<double>::infinity() : off / expected[k % 3]);
  }
  return worst;
}

template <class View>
void check_white_furnace(const View& view, const BakeOptions& options) {
  const std::array<double, 3> radiance{0.5, 1.0, 2.0};  // of Content::uniform
  const std::array<double, 3> irradiance{0.5 * std::numbers::pi, std::numbers::pi, 2.0 * std::numbers::pi};
  const BakeResult result = bake(view, options);
  for (int level = 0; level < result.background.levels(); ++level) {
    CHECK(off(level_values(result.background, level), radiance) < 1e-6);
  }
  REQUIRE(result.specular);
  for (int mip = 0; mip < result.specular->cubemap.levels(); ++mip) {
    INFO("mip " << mip);
    CHECK(off(level_values(result.specular->cubemap, mip), radiance) < 1e-5);
  }
  CHECK(off(result.irradiance.pixels, irradiance) < 1e-5);
  for (int c = 0; c < 3; ++c) CHECK(result.diagnostics.flux[c] == Approx(4.0 * irradiance[c]).epsilon(1e-6));
}

std::span<const float> span_of(const CubemapImage& image) { return image.pixels; }

}  // namespace

TEST_CASE("A uniform environment bakes to itself at any size", "[bake]") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    INFO("size " << size);
    const TestLatLong lat_long = make_lat_long(Content::uniform, 36, 18, 1);
    const TestCubemap cubemap = make_cubemap(Content::uniform, std::min(size, 33), 3, 1);
    BakeOptions options = small_bake(size);
    options.irradiance_size = size;
    check_white_furnace(lat_long.view(), options);
    check_white_furnace(cubemap.view(), options);
  }
}

TEST_CASE("Sources of any size are baked", "[bake]") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    INFO("size " << size);
    check_white_furnace(make_lat_long(Content::uniform, 2 * size, size, 1).view(), small_bake(7));
    check_white_furnace(make_lat_long(Content::uniform, size, 2, 1).view(), small_bake(7));
    check_white_furnace(make_cubemap(Content::uniform, size, 4, 1).view(), small_bake(7));
    check_white_furnace(make_cubemap_half(Content::uniform, size, 4, 1).view(), small_bake(7));
  }
}

TEST_CASE("Each result of a bake is what its own call gives", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::high_range, 80, 40, 3);
  BakeOptions options = small_bake();
  options.background_size = 21;
  options.bands = 4;
  const BakeResult result = bake(picture.view(), options);
  REQUIRE(result.background.size() == 21);
  REQUIRE(result.background.levels() == 5);
  CHECK(same_bytes(level_values(result.background, 0), span_of(to_cubemap(picture.view(), 21))));
  CHECK(same_bits(result.background, build_mips(to_cubemap(picture.view(), 21).view())));
  REQUIRE(result.specular);
  CHECK(same_bits(result.specular->cubemap, prefilter_specular(picture.view(), *options.specular).cubemap));
  REQUIRE(result.radiance);
  ProjectionOptions projecting;
  projecting.bands = 4;
  const Projection projection = project(picture.view(), projecting);
  CHECK(same_bytes(result.radiance->coefficients(), projection.radiance.coefficients()));
  CHECK(same_bits(result.irradiance, irradiance_cubemap(irradiance_from_radiance(projection.radiance), 5)));
  CHECK(result.brdf == brdf_table(*options.brdf));
  CHECK(same_bits(result.diagnostics.flux, projection.diagnostics.flux));
  CHECK(result.diagnostics.texels == 80 * 40);
  CHECK(result.peak_bytes > 12 * 80 * 40);
  CHECK(result.peak_bytes <= bake_bytes(picture.view(), options));
}

TEST_CASE("A background as large as the specular cubemap is its mip 0", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::sun_disc, 120, 60, 4);
  const BakeResult result = bake(picture.view(), small_bake(32));
  REQUIRE(result.background.size() == 32);
  CHECK(same_bytes(level_values(result.background, 0), level_values(result.specular->cubemap, 0)));
  CHECK(same_bytes(level_values(result.background, 0), span_of(to_cubemap(picture.view(), 32))));
  BakeOptions rough = small_bake(32);
  rough.specular->roughness = {0.4, 0.8};
  const BakeResult other = bake(picture.view(), rough);
  CHECK(same_bits(other.background, result.background));
  CHECK(!same_bytes(level_values(other.background, 0), level_values(other.specular->cubemap, 0)));
}

TEST_CASE("What was not asked for is left out, and the records say why", "[bake]") {
  const TestCubemap source = make_cubemap(Content::smooth, 12, 3, 2);
  BakeOptions options;
  options.background = false;
  options.specular.reset();
  options.irradiance_size = 0;
  options.bands = 0;
  options.brdf.reset();
  const BakeResult nothing = bake(source.view(), options);
  CHECK(nothing.background.levels() == 0);
  CHECK(!nothing.specular);
  CHECK(nothing.irradiance.size == 0);
  CHECK(!nothing.radiance);
  CHECK(!nothing.brdf);
  CHECK(nothing.diagnostics.texels == 6 * 12 * 12);
  for (const char* name : {"background", "background mips", "specular", "irradiance", "brdf", "clean"}) {
    const PassRecord& pass = pass_named(nothing, name);
    INFO(name);
    CHECK(pass.action == "skip");
    CHECK(!pass.reason.empty());
    CHECK(pass.milliseconds == 0.0);
  }

  options.background = true;
  options.background_mips = false;
  const BakeResult sharp = bake(source.view(), options);
  CHECK(sharp.background.size() == 12);  // the source's own
  CHECK(sharp.background.levels() == 1);
  CHECK(same_bytes<float>(level_values(sharp.background, 0), source.pixels));
  CHECK(pass_named(sharp, "background").action == "run");
  CHECK(pass_named(sharp, "background mips").action == "skip");

  const BakeResult all = bake(source.view(), small_bake());
  for (const char* name : {"background mips", "specular", "project", "irradiance"}) {
    INFO(name);
    CHECK(pass_named(all, name).action == "run");
    CHECK(pass_named(all, name).milliseconds > 0.0);
    CHECK(!pass_named(all, name).reason.empty());
  }
  CHECK(pass_named(bake(source.view(), small_bake()), "brdf").action == "reuse");
}

TEST_CASE("Irradiance can be convolved directly", "[bake]") {
  const TestLatLong picture = make_lat_long(Content::smooth, 24, 12, 5);
  BakeOptions options = small_bake();
  options.irradiance_method = IrradianceMethod::direct;
  options.bands = 0;
  const BakeResult result = bake(picture.view(), options);
  CHECK(same_bits(result.irradiance, direct_irradiance_cubemap(picture.view(), 5)));
}

TEST_CASE("An earlier result's memory is used again", "[bake]") {
  const TestLatLong first = make_lat_long(Content::smooth, 64, 32, 5);
  const TestLatLong second = make_lat_long(Content::random, 64, 32, 6);
  BakeResult result = bake(first.view(), small_bake());
  const float* const background = result.background.face(0, 0);
  bake_into(result, second.view(), small_bake());
  CHECK(result.background.face(0, 0) == background);
  CHECK(same_bits(result, bake(second.view(), small_bake())));
  bake_into(result, second.view(), small_bake(9));
  CHECK(same_bits(result, bake(second.view(), small_bake(9))));
  BakeOptions less = small_bake();
  less.specular.reset();
  less.background = false;
  less.irradiance_size = 0;
  less.brdf.reset();
  bake_into(result, first.view(), less);
  CHECK(same_bits(result, bake(first.view(), less)));
}

TEST_CASE("Policies for pixels act alike in all passes", "[bake]") {
  // The same picture cleaned by hand: NaN 0, infinities 500, all above 500 too, negatives 0.
  for (const bool cube : {false, true}) {
    TestLatLong picture = make_lat_long(Content::special_values, 48, 24, 8);
    TestCubemap cubemap = make_cubemap(Content::special_values, 20, 3, 8);
    std::vector<float>& pixels = cube ? cubemap.pixels : picture.pixels;
    BakeOptions options = small_bake();
    options.pixels.clamp = RadianceClamp{500.0F};
    const BakeResult found = cube ? bake(cubemap.view(), options) : bake(picture.view(), options);
    CHECK(found.diagnostics.nans_replaced > 0);
    CHECK(found.diagnostics.infinities_replaced > 0);
    CHECK(found.diagnostics.texels_clamped > 0);
    for (float& value : pixels) {
      if (std::isnan(value)) value = 0.0F;
      value = std::clamp(value, 0.0F, 500.0F);
    }
    const BakeResult clean = cube ? bake(cubemap.view(), small_bake()) : bake(picture.view(), small_bake());
    CHECK(same_bits(found.background, clean.background));
    CHECK(same_bits(found.specular->cubemap, clean.specular->cubemap));
    REQUIRE(found.irradiance.pixels.size() == clean.irradiance.pixels.size());
    for (std::size_t k = 0; k < clean.irradiance.pixels.size(); ++k) {
      CHECK(found.irradiance.pixels[k] == Approx(clean.irradiance.pixels[k]).epsilon(1e-5));
    }
    CHECK(pass_named(found, "clean").action == "run");
  }
}

TEST_CASE("Maps with infinities and black ones are baked", "[bake]") {
  TestLatLong black = make_lat_long(Content::uniform, 32, 16, 1);
  std::fill(black.pixels.begin(), black.pixels.end(), 0.0F);
  TestLatLong burning = black;
  burning.pixels[3 * (5 * 32 + 7)] = std::numeric_limits<float>::infinity();
  const BakeResult dark = bake(black.view(), small_bake());
  const BakeResult bright = bake(burning.view(), small_bake());
  CHECK(bright.diagnostics.infinities_replaced == 1);
  for (int mip = 0; mip < dark.specular->cubemap.levels(); ++mip) {
    for (const float value : level_values(dark.specular->cubemap, mip)) REQUIRE(value == 0.0F);
    for (const float value : level_values(bright.specular->cubemap, mip)) {
      REQUIRE(value >= 0.0F);
      REQUIRE(value <= 65504.0F);
    }
  }
  for (const float value : level_values(dark.background, 0)) REQUIRE(value == 0.0F);
  for (const float value : dark.irradiance.pixels) REQUIRE(value == 0.0F);
  burning.pixels[3 * (5 * 32 + 7)] = 65504.0F;
  CHECK(same_bits(bake(burning.view(), small_bake()).background, bright.background));
}

}  // namespace welkin::test
