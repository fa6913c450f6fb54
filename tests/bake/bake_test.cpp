// Bakes: every requested part, the same bits everywhere, within the predicted memory; or an error with nothing left.
#include "welkin/bake.h"

#include <typeinfo>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/jobs.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/core.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: a bake makes every requested part, each equal to that of its direct call, and reports its passes.

namespace {

/// Returns the largest |value - expected| / expected over a level or image, channel by channel.
double off(std::span<const float> values, const std::array<double, 3>& expected) {
  double worst = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = std::abs(values[k] - expected[k % 3]);
    worst = std::max(worst, std::isnan(off) ? std::numeric_limits<double>::infinity() : off / expected[k % 3]);
  }
  return worst;
}

void check_white_furnace(const EnvironmentView& view, const BakeOptions& options) {
  const std::array<double, 3> radiance{0.5, 1.0, 2.0};  // of Content::uniform
  const std::array<double, 3> irradiance{0.5 * std::numbers::pi, std::numbers::pi, 2.0 * std::numbers::pi};
  const BakeResult result = bake(view, options);
  REQUIRE(result.background);
  for (int level = 0; level < result.background->levels(); ++level) {
    CHECK(off(level_values(*result.background, level), radiance) < 1e-6);
  }
  REQUIRE(result.specular);
  for (int mip = 0; mip < result.specular->cubemap.levels(); ++mip) {
    INFO("mip " << mip);
    CHECK(off(level_values(result.specular->cubemap, mip), radiance) < 1e-5);
  }
  CHECK(off(result.irradiance->pixels(), irradiance) < 1e-5);
  for (int c = 0; c < 3; ++c) CHECK(result.diagnostics.total_radiance[c] == Approx(4.0 * irradiance[c]).epsilon(1e-6));
}

std::span<const float> span_of(const Cubemap& image) { return image.pixels(); }

}  // namespace

TEST_CASE("A uniform environment bakes to itself at any size", "[bake][slow]") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    INFO("size " << size);
    const TestLatLong lat_long = make_lat_long(Content::uniform, 36, 18, 1);
    const TestCubemap cubemap = make_cubemap(Content::uniform, std::min(size, 33), 3, 1);
    BakeOptions options = small_bake(size);
    options.irradiance->size = size;
    check_white_furnace(lat_long.view(), options);
    check_white_furnace(cubemap.view(), options);
  }
}

TEST_CASE("Each result of a bake is what its own call gives", "[bake]") {
  const TestLatLong image = make_lat_long(Content::high_range, 80, 40, 3);
  BakeOptions options = small_bake();
  options.background->size = 21;
  options.bands = 4;
  options.irradiance->method = IrradianceMethod::harmonics;
  const BakeResult result = bake(image.view(), options);
  REQUIRE(result.background->size() == 21);
  REQUIRE(result.background->levels() == 5);
  CHECK(same_bytes(level_values(*result.background, 0), span_of(to_cubemap(image.view(), 21))));
  CHECK(same_bits(*result.background, build_mips(to_cubemap(image.view(), 21).view())));
  REQUIRE(result.specular);
  CHECK(same_bits(result.specular->cubemap, prefilter_specular(image.view(), *options.specular).cubemap));
  REQUIRE(result.radiance);
  ProjectionOptions projecting{.bands = 4};
  const Projection projection = project(image.view(), projecting);
  CHECK(same_bytes(result.radiance->coefficients(), projection.radiance.coefficients()));
  CHECK(same_bits(*result.irradiance, irradiance_cubemap(irradiance_from_radiance(projection.radiance), 5)));
  CHECK(result.brdf == brdf_table(*options.brdf));
  CHECK(same_bits(result.diagnostics.total_radiance, projection.diagnostics.total_radiance));
  CHECK(result.diagnostics.texels == 80 * 40);
  CHECK(result.peak_bytes > 12 * 80 * 40);
  CHECK(result.peak_bytes <= bake_bytes(image.view(), options));
}

TEST_CASE("A background as large as the specular cubemap is its mip 0", "[bake]") {
  const TestLatLong image = make_lat_long(Content::sun_disc, 120, 60, 4);
  const BakeResult result = bake(image.view(), small_bake(32));
  REQUIRE(result.background->size() == 32);
  CHECK(same_bytes(level_values(*result.background, 0), level_values(result.specular->cubemap, 0)));
  CHECK(same_bytes(level_values(*result.background, 0), span_of(to_cubemap(image.view(), 32))));
  BakeOptions rough = small_bake(32);
  rough.specular->roughness = {0.4, 0.8};
  const BakeResult other = bake(image.view(), rough);
  CHECK(same_bits(*other.background, *result.background));
  CHECK(!same_bytes(level_values(*other.background, 0), level_values(other.specular->cubemap, 0)));
}

TEST_CASE("What was not asked for is left out, and the records say why", "[bake]") {
  const TestCubemap source = make_cubemap(Content::smooth, 12, 3, 2);
  BakeOptions options;
  options.background.reset();
  options.specular.reset();
  options.irradiance.reset();
  options.bands = 0;
  options.brdf.reset();
  const BakeResult nothing = bake(source.view(), options);
  CHECK(!nothing.background);
  CHECK(!nothing.specular);
  CHECK(!nothing.irradiance);
  CHECK(!nothing.radiance);
  CHECK(!nothing.brdf);
  CHECK(nothing.diagnostics.texels == 6 * 12 * 12);
  for (const char* name : {"background", "background mips", "specular", "irradiance", "brdf", "sanitize"}) {
    const PassRecord& pass = pass_named(nothing, name);
    INFO(name);
    CHECK(pass.action == PassAction::skip);
    CHECK(!pass.reason.empty());
    CHECK(pass.milliseconds == 0.0);
  }

  options.background = BackgroundOptions{.mips = false};
  const BakeResult sharp = bake(source.view(), options);
  CHECK(sharp.background->size() == 12);  // the source's own
  CHECK(sharp.background->levels() == 1);
  CHECK(same_bytes<float>(level_values(*sharp.background, 0), source.pixels));
  CHECK(pass_named(sharp, "background").action == PassAction::run);
  CHECK(pass_named(sharp, "background mips").action == PassAction::skip);

  const BakeResult all = bake(source.view(), small_bake());
  for (const char* name : {"background mips", "specular", "project", "irradiance"}) {
    INFO(name);
    CHECK(pass_named(all, name).action == PassAction::run);
    CHECK(pass_named(all, name).milliseconds > 0.0);
    CHECK(!pass_named(all, name).reason.empty());
  }
  CHECK(pass_named(bake(source.view(), small_bake()), "brdf").action == PassAction::reuse);
}

TEST_CASE("Irradiance can be convolved directly", "[bake]") {
  const TestLatLong image = make_lat_long(Content::smooth, 24, 12, 5);
  BakeOptions options = small_bake();
  options.irradiance->method = IrradianceMethod::direct;
  options.bands = 0;
  const BakeResult result = bake(image.view(), options);
  CHECK(same_bits(*result.irradiance, direct_irradiance_cubemap(image.view(), 5)));
}

TEST_CASE("An earlier result's memory is used again", "[bake]") {
  const TestLatLong first = make_lat_long(Content::smooth, 64, 32, 5);
  const TestLatLong second = make_lat_long(Content::random, 64, 32, 6);
  BakeResult result = bake(first.view(), small_bake());
  const float* const background = result.background->face(0, 0);
  bake_into(result, second.view(), small_bake());
  CHECK(result.background->face(0, 0) == background);
  CHECK(same_bits(result, bake(second.view(), small_bake())));
  bake_into(result, second.view(), small_bake(9));
  CHECK(same_bits(result, bake(second.view(), small_bake(9))));
  BakeOptions less = small_bake();
  less.specular.reset();
  less.background.reset();
  less.irradiance.reset();
  less.brdf.reset();
  bake_into(result, first.view(), less);
  CHECK(same_bits(result, bake(first.view(), less)));
}

TEST_CASE("Policies for pixels act alike in all passes", "[bake]") {
  // The reference is sanitized by hand: NaN and negatives become 0, infinities and values above 500 become 500.
  for (const bool cube : {false, true}) {
    TestLatLong image = make_lat_long(Content::special_values, 48, 24, 8);
    TestCubemap cubemap = make_cubemap(Content::special_values, 20, 3, 8);
    std::vector<float>& pixels = cube ? cubemap.pixels : image.pixels;
    BakeOptions options = small_bake();
    options.pixels.clamp = RadianceClamp{500.0F};
    const BakeResult found = cube ? bake(cubemap.view(), options) : bake(image.view(), options);
    CHECK(found.diagnostics.nans_replaced > 0);
    CHECK(found.diagnostics.infinities_replaced > 0);
    CHECK(found.diagnostics.texels_clamped > 0);
    for (float& value : pixels) {
      if (std::isnan(value)) value = 0.0F;
      value = std::clamp(value, 0.0F, 500.0F);
    }
    const BakeResult clean = cube ? bake(cubemap.view(), small_bake()) : bake(image.view(), small_bake());
    CHECK(same_bits(*found.background, *clean.background));
    CHECK(same_bits(found.specular->cubemap, clean.specular->cubemap));
    REQUIRE(found.irradiance->pixels().size() == clean.irradiance->pixels().size());
    for (std::size_t k = 0; k < clean.irradiance->pixels().size(); ++k) {
      CHECK(found.irradiance->pixels()[k] == Approx(clean.irradiance->pixels()[k]).epsilon(1e-5));
    }
    CHECK(pass_named(found, "sanitize").action == PassAction::run);
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
  for (const float value : level_values(*dark.background, 0)) REQUIRE(value == 0.0F);
  for (const float value : dark.irradiance->pixels()) REQUIRE(value == 0.0F);
  burning.pixels[3 * (5 * 32 + 7)] = 65504.0F;
  CHECK(same_bits(*bake(burning.view(), small_bake()).background, *bright.background));
}

TEST_CASE("A bake's tiles allocate nothing", "[bake]") {
  const TestLatLong image = make_lat_long(Content::high_range, 256, 128, 5);
  static_cast<void>(bake(image.view(), small_bake(64)));
  forget_allocations_in_tiles();
  static_cast<void>(bake(image.view(), small_bake(64)));
  CHECK(allocations_in_tiles() == 0);
}

// Promise: a bake needs at most `bake_bytes` of memory, and not much less where it matters.

TEST_CASE("A bake's memory stays below what was predicted", "[bake][slow]") {
  // The prediction covers thousands of lights, copies of their rows, and harmonics where near sums do not serve.
  const auto check = [](const EnvironmentView& view, const BakeOptions& options) { check_memory(view, options, 8); };
  for (const int width : {128, 1024}) {
    const TestLatLong wide = make_lat_long(Content::high_range, width, width / 2, 3);
    const TestCubemap cube = make_cubemap(Content::high_range, width / 4, 3, 3);
    for (const int size : {16, 256}) {  // lobe_bake_test.cpp has 128, with an octahedral map
      INFO("size " << size << ", lat-long " << width);
      check(wide.view(), small_bake(size));
      check(cube.view(), small_bake(size));
    }
  }
  // These bakes copy the pixels.
  check(make_lat_long_half(Content::high_range, 1024, 512, 3).view(), small_bake(64));
  check(make_lat_long(Content::special_values, 1024, 512, 3).view(), small_bake(64));
  BakeOptions sharp = small_bake(64);
  sharp.background->size = 512;
  check(make_cubemap(Content::high_range, 300, 3, 3).view(), sharp);
}

// Promise: an impossible bake is refused before it begins; one that is stopped or fails leaves nothing behind.

TEST_CASE("Options that no bake can have are refused", "[bake]") {
  const TestLatLong image = make_lat_long(Content::smooth, 24, 12, 5);
  const auto refused = [&](const std::function<void(BakeOptions&)>& change) {
    BakeOptions options = small_bake();
    change(options);
    bool worked = false;
    const ThrownError error = thrown_by([&] {
      static_cast<void>(bake(image.view(), options, {{}, [&](double) { worked = true; }}));
    });
    CHECK(!worked);
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(thrown_by([&] { static_cast<void>(bake_bytes(image.view(), options)); }).code == ErrorCode::invalid_argument);
    return error.message;
  };
  using Catch::Matchers::Contains;
  constexpr int largest = std::numeric_limits<int>::max();
  for (const int wrong : {-1, 16385, largest, std::numeric_limits<int>::min()}) {
    CHECK_THAT(refused([&](BakeOptions& o) { o.background->size = wrong; }), Contains("background.size"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.irradiance->size = wrong; }), Contains("irradiance.size"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.bands = wrong; }), Contains("bands"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.specular->size = wrong; }), Contains("size"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.specular->mips = wrong; }), Contains("mips"));
    CHECK_THAT(refused([&](BakeOptions& o) { o.brdf->width = wrong; }), Contains("width"));
  }
  CHECK_THAT(refused([&](BakeOptions& o) {
               o.bands = 0;
               o.irradiance->method = IrradianceMethod::harmonics;
             }),
             Contains("leave irradiance empty"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.background->size = 0; }), Contains("background.size"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.irradiance->size = 0; }), Contains("irradiance.size"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.specular->mips = 0; }), Contains("0 mips"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.specular->roughness = {0.0, 1.5}; }), Contains("roughness"));
  CHECK_THAT(refused([&](BakeOptions& o) { o.pixels.clamp = RadianceClamp{-1.0F}; }), Contains("clamp"));
  CHECK(thrown_by([&] {
          static_cast<void>(bake(LatLongView{nullptr, 4, 2}, small_bake()));
        }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] {
          static_cast<void>(bake(CubemapView{{}, 4}, small_bake()));
        }).code == ErrorCode::invalid_argument);
}

TEST_CASE("A bake above its memory limit is refused before it begins", "[bake]") {
  const TestLatLong image = make_lat_long(Content::smooth, 64, 32, 5);
  BakeOptions options = small_bake(64);
  const std::uint64_t needed = bake_bytes(image.view(), options);
  options.memory_limit_bytes = needed - 1;
  bool worked = false;
  const ThrownError error = thrown_by([&] {
    static_cast<void>(bake(image.view(), options, {{}, [&](double) { worked = true; }}));
  });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.says(std::to_string(needed)));
  CHECK(error.says(std::to_string(needed - 1)));
  CHECK(error.says("memory_limit_bytes"));
  CHECK(!worked);
  options.memory_limit_bytes = needed;
  CHECK(bake(image.view(), options).background->size() == 64);
  // The largest values of all options do not overflow.
  BakeOptions huge;
  huge.background->size = 16384;
  huge.specular = PrefilterOptions{.size = 8192};
  huge.irradiance->size = 4096;
  huge.brdf = BrdfTableOptions{4096, 4096};
  CHECK(bake_bytes(image.view(), huge) > std::uint64_t{12} * 6 * 16384 * 16384);
  CHECK(thrown_by([&] { static_cast<void>(bake(image.view(), huge)); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("A bake stops at any point of its progress", "[bake]") {
  const TestLatLong image = make_lat_long(Content::high_range, 512, 256, 5);
  for (const int threads : {1, 2}) {
    run_with_threads(threads, [&] {
      for (const double at : {0.0, 0.1, 0.5, 0.9}) {
        INFO("at " << at << ", " << threads << " threads");
        stop_source source;
        const Control control{source.get_token(), [&](double done) {
                                if (done >= at) source.request_stop();
                              }};
        CHECK(outcome_of([&] { static_cast<void>(bake(image.view(), small_bake(64), control)); }) == "cancelled");
      }
      // Before the first tile, and after the last.
      stop_source source;
      const Control late{source.get_token(), [&](double done) {
                           if (done == 1.0) source.request_stop();
                         }};
      CHECK(outcome_of([&] { static_cast<void>(bake(image.view(), small_bake(64), late)); }) == "result");
      CHECK(outcome_of([&] { static_cast<void>(bake(image.view(), small_bake(64), late)); }) == "cancelled");
    });
  }
}

TEST_CASE("What stops a bake comes out of it", "[bake]") {
  TestCubemap source = make_cubemap(Content::smooth, 33, 3, 2);
  source.pixels[3 * (2 * 33 * 33 + 4 * 33 + 5) + 1] = -1.0F;
  BakeOptions options = small_bake();
  options.pixels.negative = NegativePolicy::reject;
  for (const int threads : {1, 2, 4}) {
    run_with_threads(threads, [&] {
      const ThrownError error = thrown_by([&] { static_cast<void>(bake(source.view(), options)); });
      CHECK(error.code == ErrorCode::rejected_pixel);
      CHECK(error.says("face +Y, row 4, column 5"));
    });
  }
  const Control throwing{{}, [](double) { throw std::runtime_error("of the callback"); }};
  CHECK_THROWS_WITH(bake(source.view(), small_bake(), throwing), "of the callback");
}

TEST_CASE("A bake runs out of memory cleanly wherever it does", "[bake][slow]") {
  const TestLatLong image = make_lat_long(Content::special_values, 40, 20, 5);
  const BakeOptions options = small_bake(8);
  const BakeResult expected = bake(image.view(), options);
  for (const bool for_good : {false, true}) {
    bool failed = true;
    for (long number = 1; failed; number += stride(kSanitized ? 101 : 17)) {
      INFO("allocation " << number << (for_good ? " and all after it" : ""));
      REQUIRE(number < 100'000);
      std::string end;
      BakeResult result;
      {
        const FailingHeap heap(Heap::this_thread, number, for_good);
        end = outcome_of([&] { result = bake(image.view(), options); });
        failed = heap.failed();
      }
      if (!failed) CHECK(end == "result");
      if (end == "result") {
        CHECK(same_bits(result, expected));
      } else {
        CHECK(end == "bad_alloc");
      }
    }
  }
}

}  // namespace welkin::test
