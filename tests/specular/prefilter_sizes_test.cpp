// Promise: any size of source and result, any chain, any kind of picture; black stays black, what is uniform stays so.
#include <limits>

#include "specular/prefilter_support.h"
#include "support/catch.h"
#include "support/test_environments.h"

namespace welkin::test {

TEST_CASE("A uniform environment keeps its value in every mip, whatever the sizes", "[specular][prefilter]") {
  for (const int size : {1, 2, 7, 64, 257}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {64, 32}, {257, 129}}) {
      CAPTURE(size, width, height);
      const TestLatLong source = make_lat_long(Content::uniform, width, height, 0);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = size});
      REQUIRE(result.cubemap.levels() == full_chain_levels(size));
      double worst = 0.0;
      for (int level = 0; level < result.cubemap.levels(); ++level) {
        const auto values = level_of(result.cubemap, level);
        for (std::size_t k = 0; k < values.size(); ++k) {
          const double expected = static_cast<double>(source.pixels[k % 3]);
          worst = std::max(worst, std::abs(static_cast<double>(values[k]) / expected - 1.0));
        }
      }
      CHECK(worst < 2e-5);
    }
  }
}

TEST_CASE("A uniform cubemap keeps its value in every mip, whatever the sizes", "[specular][prefilter]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    for (const int source_size : {1, 2, 3, 7, 64}) {
      CAPTURE(size, source_size);
      const TestCubemap source = make_cubemap(Content::uniform, source_size, 3, 0);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = size});
      double worst = 0.0;
      for (int level = 0; level < result.cubemap.levels(); ++level) {
        const auto values = level_of(result.cubemap, level);
        for (std::size_t k = 0; k < values.size(); ++k) {
          const double expected = static_cast<double>(source.pixels[k % 3]);
          worst = std::max(worst, std::abs(static_cast<double>(values[k]) / expected - 1.0));
        }
      }
      CHECK(worst < 2e-5);
    }
  }
}

TEST_CASE("Every method keeps a uniform environment", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::uniform, 32, 16, 0);
  for (const PrefilterMethod method :
       {PrefilterMethod::automatic, PrefilterMethod::spectral, PrefilterMethod::sampled, PrefilterMethod::reference}) {
    CAPTURE(name(method));
    const PrefilteredSpecular result =
        prefilter_specular(source.view(), {.size = 4, .roughness = {0.2, 0.5, 1.0}, .method = method, .samples = 64});
    for (int level = 0; level < 3; ++level) {
      const auto values = level_of(result.cubemap, level);
      for (std::size_t k = 0; k < values.size(); ++k)
        CHECK(values[k] == Approx(source.pixels[k % 3]).epsilon(method == PrefilterMethod::reference ? 1e-4 : 2e-5));
    }
  }
}

TEST_CASE("A black environment is black in every mip", "[specular][prefilter]") {
  const std::vector<float> pixels(3 * 64 * 32, 0.0F);
  const PrefilteredSpecular result = prefilter_specular(LatLongView{pixels.data(), 64, 32}, {.size = 32});
  for (int level = 0; level < result.cubemap.levels(); ++level) {
    for (const float value : level_of(result.cubemap, level)) CHECK(value == 0.0F);
  }
}

TEST_CASE("A chain may have one mip, of any roughness", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::blocks, 64, 32, 3);
  for (const double roughness : {0.0, 0.3, 1.0}) {
    CAPTURE(roughness);
    const PrefilteredSpecular result =
        prefilter_specular(source.view(), {.size = 8, .mips = 1, .roughness = {roughness}});
    REQUIRE(result.cubemap.levels() == 1);
    REQUIRE(result.mips.size() == 1);
    CHECK(result.mips[0].method == (roughness == 0.0 ? "copy" : "spectral"));
    const double alpha = roughness * roughness;
    if (alpha == 0.0) continue;
    const auto truth = reference_specular(source.view(), roughness, centres(8));
    CHECK(level_error(result.cubemap, 0, truth).maximum < 1e-2);
  }
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
  const LatLongView strided{padded.data(), 64, 32, 200 * 4, PixelFormat::rgb_f32};
  CHECK(same_bits(expected.cubemap, prefilter_specular(strided, {.size = 16}).cubemap));
}

}  // namespace welkin::test
