// Prefiltered cubemaps: the promises of the calls. prefilter_truth_test.cpp measures the error of each mip.
#include "reflections/prefilter.h"

#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {

// Promise: records of what was done, and errors that state what would work.

TEST_CASE("Records say how each mip was made", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::one_texel_sun, 256, 128, 3);
  const PrefilteredSpecular result =
      prefilter_specular(source.view(), {.size = 64, .roughness = mip_roughness(RoughnessSchedule::linear, 7, 64)});
  REQUIRE(result.mips.size() == 7);
  CHECK(result.mips[0].method == MipMethod::copy);
  CHECK(result.mips[0].bands == 0);
  for (std::size_t k = 1; k < 7; ++k) {
    CHECK(result.mips[k].size == 64 >> k);
    CHECK(result.mips[k].roughness == Approx(static_cast<double>(k) / 6.0));
    CHECK(result.mips[k].method == MipMethod::spectral);
    CHECK(result.mips[k].bands >= 16);
    CHECK(result.mips[k].bright_texels == 1);
    CHECK(result.mips[k].error_estimate > 0.0);
    CHECK(result.mips[k].error_estimate < 1e-2);
  }
  CHECK(result.peak_bytes > 0);
  CHECK_FALSE(result.pixels.passes.empty());
  CHECK(result.pixels.texels == 256 * 128);
}

TEST_CASE("A quality sets the method and the bounds", "[specular][prefilter]") {
  CHECK(PrefilterOptions::at(Quality::normal) == PrefilterOptions());
  CHECK(PrefilterOptions::at(Quality::fast) == PrefilterOptions{.rms_error = 1e-2});
  const PrefilterOptions reference = PrefilterOptions::at(Quality::reference);
  CHECK(reference == PrefilterOptions{.method = PrefilterMethod::reference});
  CHECK(std::string(name(Quality::fast)) == "fast");
  CHECK(thrown_by([] { (void)PrefilterOptions::at(static_cast<Quality>(3)); }).says("quality 3"));
  // The bound on single texels follows, or a looser rms_error would change nothing.
  const auto bands = [](const PrefilterOptions& options) { return reflections::plan_prefilter(options).bands; };
  CHECK(bands({.rms_error = 1e-2}) < bands({}));
  CHECK(bands({.rms_error = 1e-2}) == bands({.rms_error = 1e-2, .maximum_error = 0.1}));
  CHECK(bands({.rms_error = 1e-2, .maximum_error = 1e-2}) == bands({}));
  CHECK(reflections::bounds_of({}).maximum == 1e-2);
  CHECK(reflections::bounds_of({.rms_error = 0.5}).maximum == 1.0);
}

TEST_CASE("What the prefilter cannot do is refused with a word", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::random, 32, 16, 3);
  const auto refused = [&](const PrefilterOptions& options) {
    return thrown_by([&] { (void)prefilter_specular(source.view(), options); });
  };
  CHECK(refused({.size = 0}).says("size"));
  CHECK(refused({.size = 8193}).says("size"));
  CHECK(refused({.size = 16, .mips = 6}).says("1 to 5"));
  CHECK(refused({.size = 16, .mips = -1}).says("mips"));
  CHECK(refused({.size = 16, .mips = 3, .roughness = {0.0, 1.0}}).says("3 mips, but roughness names 2"));
  CHECK(refused({.size = 16, .roughness = {0.0, 1.5}}).says("roughness of mip 1 is 1.5"));
  CHECK(refused({.size = 16, .rms_error = 0.0}).says("rms_error"));
  CHECK(refused({.size = 16, .rms_error = 1e-9}).code == ErrorCode::limit_exceeded);
  CHECK(refused({.size = 16, .maximum_error = 2.0}).says("maximum_error"));
  CHECK(refused({.size = 16, .method = static_cast<PrefilterMethod>(9)}).says("method"));
  const ThrownError narrow = refused({.size = 16, .roughness = {0.01}, .method = PrefilterMethod::spectral});
  CHECK(narrow.code == ErrorCode::limit_exceeded);
  CHECK(narrow.says("harmonic bands"));
  CHECK(thrown_by([] { (void)prefilter_specular(LatLongView{}, {}); }).code == ErrorCode::invalid_argument);
  const PixelPolicy strict{.negative = NegativePolicy::reject};
  TestLatLong negative = source;
  negative.pixels[3 * (2 * 32 + 5)] = -1.0F;
  const ThrownError rejected =
      thrown_by([&] { (void)prefilter_specular(negative.view(), {.size = 16, .pixels = strict}); });
  CHECK(rejected.code == ErrorCode::rejected_pixel);
  CHECK(rejected.says("row 2, column 5"));
}

// Promise: any size of source and result, any chain, any kind of image; black stays black, uniform light uniform.

TEST_CASE("A uniform environment keeps its value in every mip, whatever the sizes", "[specular][prefilter]") {
  for (const int size : {1, 2, 7, 64, 257}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {64, 32}, {257, 129}}) {
      CAPTURE(size, width, height);
      const TestLatLong source = make_lat_long(Content::uniform, width, height, 0);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = size});
      REQUIRE(result.cubemap.levels() == default_mip_count(RoughnessSchedule::filament, size));
      for (int level = 0; level < result.cubemap.levels(); ++level)
        CHECK(largest_deviation(result.cubemap, level, source.pixels) < 2e-5);
    }
  }
}

TEST_CASE("A uniform cubemap keeps its value in every mip, whatever the sizes", "[specular][prefilter]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    for (const int source_size : {1, 2, 3, 7, 64}) {
      CAPTURE(size, source_size);
      const TestCubemap source = make_cubemap(Content::uniform, source_size, 3, 0);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = size});
      for (int level = 0; level < result.cubemap.levels(); ++level)
        CHECK(largest_deviation(result.cubemap, level, source.pixels) < 2e-4);
    }
  }
}

TEST_CASE("A black environment is black in every mip", "[specular][prefilter]") {
  const std::vector<float> pixels(3 * 64 * 32, 0.0F);
  const PrefilteredSpecular result = prefilter_specular(LatLongView{pixels.data(), 64, 32}, {.size = 32});
  CHECK(std::ranges::all_of(result.cubemap.pixels(), [](float value) { return value == 0.0F; }));
}

TEST_CASE("NaN and infinities are replaced and counted before anything is blurred", "[specular][prefilter]") {
  TestLatLong source = make_lat_long(Content::random, 64, 32, 5);
  source.pixels[10] = std::numeric_limits<float>::quiet_NaN();
  source.pixels[3000] = std::numeric_limits<float>::infinity();
  source.pixels[4000] = -std::numeric_limits<float>::infinity();
  const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 16});
  CHECK(result.pixels.nans_replaced == 1);
  CHECK(result.pixels.infinities_replaced == 2);
  TestLatLong clean = source;
  clean.pixels[10] = 0.0F;
  clean.pixels[3000] = 65504.0F;
  clean.pixels[4000] = 0.0F;
  CHECK(same_bits(result.cubemap, prefilter_specular(clean.view(), {.size = 16}).cubemap));
}

TEST_CASE("All pixel formats are read, and a stride changes nothing", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::high_range, 64, 32, 5);
  const PrefilteredSpecular expected = prefilter_specular(source.view(), {.size = 16});
  const TestLatLong four = make_lat_long(Content::high_range, 64, 32, 5, 4);
  CHECK(same_bits(expected.cubemap, prefilter_specular(four.view(), {.size = 16}).cubemap));
  std::vector<float> padded;
  for (int row = 0; row < 32; ++row) {
    padded.insert(padded.end(), source.pixels.begin() + 192 * row, source.pixels.begin() + 192 * (row + 1));
    padded.insert(padded.end(), 8, -1e30F);
  }
  const LatLongView strided{padded.data(), 64, 32, 200 * 4, PixelFormat::rgb32f};
  CHECK(same_bits(expected.cubemap, prefilter_specular(strided, {.size = 16}).cubemap));
}

}  // namespace welkin::test
