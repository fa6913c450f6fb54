// Prefiltered cubemaps: what the calls promise, and how near each mip comes to the truth.

#include "reflections/prefilter.h"

#include <array>
#include <atomic>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>
#include <stop_token>

#include "reflections/lobe.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/coefficients.h"
#include "support/heap.h"
#include "support/shared_pictures.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"

namespace welkin::test {

// Promise: the same bits everywhere, no allocation in tiles, cancellation, progress, and errors that say what would do.

namespace {

const PrefilterOptions kSmall{.size = 32, .samples = 32};

template <class View>
void check_same_bits(const View& view, PrefilterOptions options) {
  const InstructionSet before = active_instruction_set();
  const PrefilteredSpecular expected = prefilter_specular(view, options);
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    for (const int threads : {1, 2, 3}) {
      CAPTURE(name(set), threads);
      run_with_threads(threads, [&] {
        const PrefilteredSpecular result = prefilter_specular(view, options);
        CHECK(same_bits(result.cubemap, expected.cubemap));
        for (std::size_t k = 0; k < result.mips.size(); ++k) {
          CHECK(same_bits(result.mips[k].mean, expected.mips[k].mean));
          CHECK(result.mips[k].bright_texels == expected.mips[k].bright_texels);
        }
      });
    }
  }
  force_instruction_set(before);
}

}  // namespace

TEST_CASE("The prefilter gives the same bits on any threads and instruction set", "[specular][prefilter][bits]") {
  const TestLatLong source = make_lat_long(Content::one_texel_sun, 256, 128, 3);
  check_same_bits(source.view(), {.size = 64});
  check_same_bits(make_lat_long(Content::random, 67, 35, 3).view(), {.size = 19});
  check_same_bits(make_cubemap(Content::high_range, 33, 3, 3).view(), kSmall);
  for (const PrefilterMethod method : {PrefilterMethod::sampled, PrefilterMethod::reference}) {
    PrefilterOptions options{.size = 4, .method = method, .samples = 32};
    check_same_bits(make_lat_long(Content::high_range, 32, 16, 3).view(), options);
  }
}

TEST_CASE("Nothing is allocated inside tiles", "[specular][prefilter][heap]") {
  const TestLatLong large = make_lat_long(Content::one_texel_sun, 256, 128, 3);
  const TestLatLong small = make_lat_long(Content::one_texel_sun, 64, 32, 3);
  for (const PrefilterMethod method :
       {PrefilterMethod::automatic, PrefilterMethod::sampled, PrefilterMethod::reference}) {
    const TestLatLong& source = method == PrefilterMethod::reference ? small : large;
    PrefilterOptions options{.size = 4, .roughness = {0.3, 0.7}, .method = method, .samples = 32};
    (void)prefilter_specular(source.view(), options);
    forget_allocations_in_tiles();
    (void)prefilter_specular(source.view(), options);
    CAPTURE(name(method));
    CHECK(allocations_in_tiles() == 0);
  }
}

TEST_CASE("The prefilter can be cancelled at any time", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::random, 64, 32, 3);
  for (const PrefilterMethod method :
       {PrefilterMethod::automatic, PrefilterMethod::sampled, PrefilterMethod::reference}) {
    for (const double when : {0.0, 0.02, 0.3, 0.6, 0.9}) {
      CAPTURE(name(method), when);
      std::stop_source stop;
      Control control{stop.get_token(), [&](double share) {
                        if (share >= when) stop.request_stop();
                      }};
      if (when == 0.0) stop.request_stop();
      PrefilterOptions options{.size = 4, .method = method, .samples = 16};
      CHECK(thrown_by([&] { (void)prefilter_specular(source.view(), options, control); }).code == ErrorCode::cancelled);
    }
  }
}

TEST_CASE("Progress rises to 1", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::random, 256, 128, 3);
  for (const PrefilterMethod method : {PrefilterMethod::automatic, PrefilterMethod::sampled}) {
    double last = 0.0;
    bool fell = false;
    std::atomic<int> inside{0};
    bool together = false;
    const Control control{{}, [&](double share) {
                            together = together || inside.fetch_add(1) != 0;
                            fell = fell || share < last;
                            last = share;
                            inside.fetch_sub(1);
                          }};
    PrefilterOptions options{.size = 32, .method = method, .samples = 16};
    (void)prefilter_specular(source.view(), options, control);
    CHECK(last == 1.0);
    CHECK_FALSE(fell);
    CHECK_FALSE(together);
  }
}

TEST_CASE("Records say how each mip was made", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::one_texel_sun, 256, 128, 3);
  const PrefilteredSpecular result =
      prefilter_specular(source.view(), {.size = 64, .roughness = roughness_of_mips(RoughnessSchedule::linear, 7, 64)});
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
  CHECK(refused({.size = 16, .samples = 0}).says("samples"));
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

// Promise: any size of source and result, any chain, any kind of picture; black stays black, what is uniform stays so.

TEST_CASE("A uniform environment keeps its value in every mip, whatever the sizes", "[specular][prefilter]") {
  for (const int size : {1, 2, 7, 64, 257}) {
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {64, 32}, {257, 129}}) {
      CAPTURE(size, width, height);
      const TestLatLong source = make_lat_long(Content::uniform, width, height, 0);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = size});
      REQUIRE(result.cubemap.levels() == mips_of_chain(RoughnessSchedule::filament, size));
      double worst = 0.0;
      for (int level = 0; level < result.cubemap.levels(); ++level) {
        const auto values = level_values(result.cubemap, level);
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
        const auto values = level_values(result.cubemap, level);
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
      const auto values = level_values(result.cubemap, level);
      for (std::size_t k = 0; k < values.size(); ++k)
        CHECK(values[k] == Approx(source.pixels[k % 3]).epsilon(method == PrefilterMethod::reference ? 1e-4 : 2e-5));
    }
  }
}

TEST_CASE("A black environment is black in every mip", "[specular][prefilter]") {
  const std::vector<float> pixels(3 * 64 * 32, 0.0F);
  const PrefilteredSpecular result = prefilter_specular(LatLongView{pixels.data(), 64, 32}, {.size = 32});
  for (int level = 0; level < result.cubemap.levels(); ++level) {
    for (const float value : level_values(result.cubemap, level)) CHECK(value == 0.0F);
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
    CHECK(result.mips[0].method == (roughness == 0.0 ? MipMethod::copy : MipMethod::spectral));
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
  const LatLongView strided{padded.data(), 64, 32, 200 * 4, PixelFormat::rgb32f};
  CHECK(same_bits(expected.cubemap, prefilter_specular(strided, {.size = 16}).cubemap));
}

// Promise: each mip is the integral over GGX's lobe: against the truth, closed forms, and what any such blur keeps.

namespace {

/// Errors of all mips that are blurred against the truth, at some `probes` texels each.
template <class View>
void check_against_truth(const View& view, const PrefilterOptions& options, std::size_t probes, double rms,
                         double maximum) {
  const PrefilteredSpecular result = prefilter_specular(view, options);
  for (std::size_t level = 0; level < result.mips.size(); ++level) {
    const MipRecord& mip = result.mips[level];
    if (mip.method == MipMethod::copy) continue;
    const std::vector<glm::dvec3> all = centres(mip.size);
    const std::size_t step = std::max<std::size_t>(1, all.size() / probes);
    std::vector<glm::dvec3> some;
    for (std::size_t k = 0; k < all.size(); k += step) some.push_back(all[k]);
    const auto truth = reference_specular(view, mip.roughness, some);
    const LevelError error = level_error(result.cubemap, static_cast<int>(level), truth, step);
    CAPTURE(level, mip.roughness, mip.bands, error.rms, error.maximum);
    CHECK(error.rms < rms);
    CHECK(error.maximum < maximum);
  }
}

TestLatLong black_with_one_light(int width, int height, int column, int row, float value) {
  TestLatLong image = make_lat_long(Content::uniform, width, height, 0);
  for (float& channel : image.pixels) channel = 0.0F;
  for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(3 * (row * width + column) + c)] = value;
  return image;
}

}  // namespace

TEST_CASE("Every content is blurred to within the default bounds", "[specular][prefilter][truth]") {
  for (const Content content : {Content::random, Content::smooth, Content::high_range, Content::sun_disc,
                                Content::blocks, Content::uniform, Content::one_texel_sun}) {
    CAPTURE(std::string(name(content)));
    const TestLatLong source = make_lat_long(content, 256, 128, 17);
    check_against_truth(source.view(), {.size = 64}, 40, 1e-3, 1e-2);
  }
}

TEST_CASE("Cubemaps are blurred to within the default bounds", "[specular][prefilter][truth]") {
  for (const Content content : {Content::smooth, Content::high_range, Content::blocks}) {
    CAPTURE(std::string(name(content)));
    const TestCubemap source = make_cubemap(content, 64, 3, 17);
    check_against_truth(source.view(), {.size = 32, .roughness = {0.0, 0.3, 0.6, 1.0}}, 60, 1e-3, 1e-2);
  }
}

TEST_CASE("Odd sizes are blurred to within the default bounds", "[specular][prefilter][truth]") {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {7, 5}, {65, 33}, {200, 101}}) {
    CAPTURE(width, height);
    const TestLatLong source = make_lat_long(Content::random, width, height, 4);
    check_against_truth(source.view(), {.size = 13, .roughness = {0.0, 0.35, 1.0}}, 40, 1e-3, 1e-2);
  }
}

TEST_CASE("Tighter bounds are met too", "[specular][prefilter][truth]") {
  const TestLatLong source = make_lat_long(Content::high_range, 128, 64, 8);
  check_against_truth(source.view(),
                      {.size = 32, .roughness = {0.2, 0.5, 1.0}, .rms_error = 2e-5, .maximum_error = 5e-4}, 60, 2e-5,
                      2e-3);  // at the horizon of a sun on a coarse map the last bound is not met, see docs
}

TEST_CASE("A light in the dark gives the lobe's closed form, near and far", "[specular][prefilter][truth]") {
  const TestLatLong source = black_with_one_light(512, 256, 117, 60, 1e6F);
  const glm::dvec3 light = image::lat_long_direction(512, 256, 117.5, 60.5);
  const double total_radiance = 1e6 * image::lat_long_texel_solid_angle(512, 256, 60);
  const PrefilteredSpecular result =
      prefilter_specular(source.view(), {.size = 64, .roughness = {0.25, 0.5, 0.75, 1.0}});
  for (int level = 0; level < 4; ++level) {
    const double roughness = result.mips[static_cast<std::size_t>(level)].roughness;
    const double alpha = roughness * roughness;
    const auto directions = centres(result.cubemap.level_size(level));
    double worst = 0.0;
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const double cosine = glm::dot(light, directions[k]);
      const double expected = total_radiance * reflections::lobe(cosine, alpha) / reflections::lobe_integral(alpha);
      const double got = static_cast<double>(result.cubemap.face(level, 0)[3 * k]);
      REQUIRE(got >= 0.0);
      if (cosine < 0.02) continue;  // the light's own width matters at the horizon, and below there is none
      worst = std::max(worst, std::abs(got - expected) / expected);
    }
    CAPTURE(level, roughness);
    CHECK(worst < 1e-2);
  }
}

TEST_CASE("No mip is negative beside a sun of 1e6, and each keeps its light", "[specular][prefilter]") {
  for (const Content content : {Content::one_texel_sun, Content::sun_disc, Content::blocks}) {
    const TestLatLong source = make_lat_long(content, 256, 128, 6);
    const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 128});
    for (int level = 0; level < result.cubemap.levels(); ++level) {
      for (const float value : level_values(result.cubemap, level)) REQUIRE(value >= 0.0F);
    }
  }
}

TEST_CASE("The mean stays on every mip", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::high_range, 256, 128, 6);
  const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 64});
  glm::dvec3 mean(0.0);
  for (int row = 0; row < 128; ++row) {
    const double solid_angle = image::lat_long_texel_solid_angle(256, 128, row);
    for (int column = 0; column < 256; ++column) {
      const float* const rgb = source.pixels.data() + 3 * (row * 256 + column);
      mean += solid_angle / (4.0 * 3.14159265358979323846) * glm::dvec3(rgb[0], rgb[1], rgb[2]);
    }
  }
  // Centres stand for texels here, so the smallest mips, of few texels, are left out.
  for (const MipRecord& mip : result.mips) {
    if (mip.size < 8) continue;
    CAPTURE(mip.size, name(mip.method));
    CHECK(glm::length(mip.mean - mean) < 1e-3 * glm::length(mean));
  }
}

TEST_CASE("What is added before is added after", "[specular][prefilter]") {
  const TestLatLong a = make_lat_long(Content::smooth, 128, 64, 1);
  const TestLatLong b = make_lat_long(Content::random, 128, 64, 2);
  TestLatLong sum = a;
  for (std::size_t k = 0; k < sum.pixels.size(); ++k) sum.pixels[k] = 3.0F * a.pixels[k] + b.pixels[k];
  const PrefilterOptions options{.size = 32};
  const auto of_a = prefilter_specular(a.view(), options);
  const auto of_b = prefilter_specular(b.view(), options);
  const auto of_sum = prefilter_specular(sum.view(), options);
  for (int level = 0; level < of_sum.cubemap.levels(); ++level) {
    const auto x = level_values(of_a.cubemap, level);
    const auto y = level_values(of_b.cubemap, level);
    const auto z = level_values(of_sum.cubemap, level);
    double worst = 0.0;
    for (std::size_t k = 0; k < z.size(); ++k) {
      const double expected = 3.0 * static_cast<double>(x[k]) + static_cast<double>(y[k]);
      worst = std::max(worst, std::abs(static_cast<double>(z[k]) - expected) / expected);
    }
    CHECK(worst < 5e-6);
  }
}

TEST_CASE("A quarter turn of the environment permutes the faces", "[specular][prefilter]") {
  // To the left by a quarter: what was at +x comes to +z, what was at +z to -x.
  const TestLatLong source = make_lat_long(Content::high_range, 128, 64, 9);
  TestLatLong turned = source;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 128; ++column) {
      for (int c = 0; c < 3; ++c) {
        turned.pixels[static_cast<std::size_t>(3 * (row * 128 + (column + 32) % 128) + c)] =
            source.pixels[static_cast<std::size_t>(3 * (row * 128 + column) + c)];
      }
    }
  }
  const PrefilterOptions options{.size = 32, .roughness = {0.3, 0.6}};
  const auto before = prefilter_specular(source.view(), options);
  const auto after = prefilter_specular(turned.view(), options);
  constexpr std::array<int, 4> from{0, 4, 1, 5};  // +X came to +Z, +Z to -X, -X to -Z, -Z to +X
  constexpr std::array<int, 4> to{4, 1, 5, 0};
  for (int level = 0; level < 2; ++level) {
    const std::size_t count = face_values(before.cubemap, level);
    for (std::size_t k = 0; k < 4; ++k) {
      const float* const x = before.cubemap.face(level, from[k]);
      const float* const y = after.cubemap.face(level, to[k]);
      double worst = 0.0;
      for (std::size_t i = 0; i < count; ++i) worst = std::max(worst, std::abs(static_cast<double>(y[i] / x[i]) - 1.0));
      CAPTURE(level, k);
      CHECK(worst < 2e-5);
    }
  }
}

TEST_CASE("Importance sampling comes near the truth of what is smooth", "[specular][prefilter][sampled]") {
  const TestLatLong source = make_lat_long(Content::smooth, 256, 128, 6);
  check_against_truth(
      source.view(),
      {.size = 32, .roughness = {0.0, 0.3, 0.6, 1.0}, .method = PrefilterMethod::sampled, .samples = 512}, 60, 2e-2,
      6e-2);
}

TEST_CASE("The whole reference is the truth at each texel's centre", "[specular][prefilter][truth]") {
  const TestLatLong source = make_lat_long(Content::random, 32, 16, 6);
  const PrefilteredSpecular result =
      prefilter_specular(source.view(), {.size = 4, .roughness = {0.3, 1.0}, .method = PrefilterMethod::reference});
  for (int level = 0; level < 2; ++level) {
    const auto truth = reference_specular(source.view(), result.mips[static_cast<std::size_t>(level)].roughness,
                                          centres(result.cubemap.level_size(level)));
    CHECK(level_error(result.cubemap, level, truth).maximum < 1e-7);
  }
}

TEST_CASE("Real environments are blurred to within the default bounds", "[specular][prefilter][truth]") {
  if (!shared_pictures_are_here()) return;
  for (const char* const file : {"venice_sunset_1k.hdr", "dikhololo_night_1k.hdr", "lebombo_1k.hdr"}) {
    const std::filesystem::path path = kPictures / "env" / file;
    if (!std::filesystem::exists(path)) continue;
    CAPTURE(file);
    const Environment environment = read_environment(path);
    check_against_truth(environment.lat_long(), {.size = 256, .roughness = {0.111, 0.222, 0.5, 1.0}}, 12, 1e-3, 1e-2);
  }
}

// Promise: the bounds hold where they are hardest: suns at poles and on horizons, and cubemaps of few texels.

namespace {

TestLatLong sun_at(int column, int row, float sun, float sky) {
  TestLatLong image = make_lat_long(Content::uniform, 256, 128, 0);
  for (float& channel : image.pixels) channel = sky;
  for (int c = 0; c < 3; ++c) image.pixels[static_cast<std::size_t>(3 * (row * 256 + column) + c)] = sun;
  return image;
}

/// Every texel of every mip against the truth.
template <class View>
LevelError worst_level(const View& view, const PrefilterOptions& options) {
  const PrefilteredSpecular result = prefilter_specular(view, options);
  LevelError worst;
  for (std::size_t level = 0; level < result.mips.size(); ++level) {
    const auto truth = reference_specular(view, result.mips[level].roughness, centres(result.mips[level].size));
    const LevelError error = level_error(result.cubemap, static_cast<int>(level), truth);
    worst.rms = std::max(worst.rms, error.rms);
    worst.maximum = std::max(worst.maximum, error.maximum);
  }
  return worst;
}

}  // namespace

TEST_CASE("A bright texel that the horizon cuts counts by its part above", "[specular][prefilter][truth]") {
  // Seen from the ring around it, the sun gives as much as the sky though hardly anything of it is above.
  for (const auto& [column, row] : {std::pair{32, 63}, {32, 38}}) {
    CAPTURE(column, row);
    const TestLatLong source = sun_at(column, row, 1e5F, 0.2F);
    const LevelError worst = worst_level(source.view(), {.size = 8, .roughness = {0.7, 1.0}});
    CHECK(worst.rms < 1e-3);
    CHECK(worst.maximum < 1e-2);
  }
}

TEST_CASE("A bright texel at a pole lies where its area is", "[specular][prefilter][truth]") {
  for (const int row : {0, 127}) {
    CAPTURE(row);
    const TestLatLong source = sun_at(3, row, 1e6F, 0.2F);
    const LevelError worst = worst_level(source.view(), {.size = 4, .roughness = {0.3, 0.7}});
    CHECK(worst.rms < 2e-4);
    CHECK(worst.maximum < 1e-2);
  }
}

TEST_CASE("Cubemaps of few texels are blurred as areas", "[specular][prefilter][truth]") {
  for (const int size : {1, 3, 7}) {
    CAPTURE(size);
    const TestCubemap source = make_cubemap(Content::random, size, 3, 5);
    const LevelError worst = worst_level(source.view(), {.size = 4, .roughness = {0.1, 0.3, 1.0}});
    CHECK(worst.rms < 1e-3);
    CHECK(worst.maximum < 1e-2);
  }
}

TEST_CASE("A lone bright texel of a small cubemap is blurred to within the default bounds",
          "[specular][prefilter][truth]") {
  // In a face, beside a pole, in a corner.
  for (const std::size_t texel :
       {std::size_t{5 * 32 + 7}, std::size_t{2 * 1024 + 16 * 32 + 15}, std::size_t{4 * 1024 + 31 * 32 + 31}}) {
    CAPTURE(texel);
    CubemapImage source{32, std::vector<float>(std::size_t{18} * 32 * 32, 1.0F)};
    for (std::size_t c = 0; c < 3; ++c) source.pixels[3 * texel + c] = 1e4F;
    const LevelError worst = worst_level(source.view(), {.size = 16, .roughness = {0.3, 0.5, 0.8}});
    CHECK(worst.rms < 1e-3);
    CHECK(worst.maximum < 1e-2);
  }
}

// Such edges lie on the rings' own: taking back more than was blurred there cost 8e-5.
TEST_CASE("A sky over a ground on a cubemap keeps its horizon", "[specular][prefilter][truth]") {
  for (const int size : {4, 8, 9}) {
    CubemapImage image{size, std::vector<float>(std::size_t{18} * static_cast<std::size_t>(size * size), 0.1F)};
    const image::TexelGrid grid = image::TexelGrid::cubemap(size);
    for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
      const glm::dvec3 d = grid.direction(texel);
      // A ground, and a wall that ends at meridians.
      const float value = d.y > 0.0 ? 2.0F : (d.z > std::abs(d.x) ? 0.5F : 0.1F);
      std::fill_n(image.pixels.begin() + 3 * texel, 3, value);
    }
    const auto result = prefilter_specular(image.view(), {.size = 16, .mips = 1, .roughness = {0.19}});
    const LevelError error = level_error(result.cubemap, 0, reference_specular(image.view(), 0.19, centres(16)));
    INFO("faces of " << size);
    CHECK(error.rms < 2e-5);
    CHECK(error.rms <= result.mips[0].error_estimate);
  }
}

TEST_CASE("Values at the end of the floats do not end at infinity", "[specular][prefilter]") {
  TestLatLong source = make_lat_long(Content::random, 64, 32, 3);
  TestLatLong huge = source;
  for (float& value : huge.pixels) value *= 0x1p126F;
  huge.pixels[3 * 100] = 3.4e38F;
  source.pixels[3 * 100] = 3.4e38F * 0x1p-126F;
  const PrefilterOptions options{.size = 16, .roughness = {0.0, 0.1, 0.5, 1.0}};
  const PrefilteredSpecular plain = prefilter_specular(source.view(), options);
  const PrefilteredSpecular result = prefilter_specular(huge.view(), options);
  for (int level = 0; level < 4; ++level) {
    const auto x = level_values(plain.cubemap, level);
    const auto y = level_values(result.cubemap, level);
    for (std::size_t k = 0; k < x.size(); ++k) REQUIRE(y[k] == x[k] * 0x1p126F);
  }
  CHECK(result.pixels.total_radiance == plain.pixels.total_radiance * 0x1p126);
}

TEST_CASE("The darkest floats lose no digits that floats have", "[specular][prefilter]") {
  TestLatLong source = make_lat_long(Content::random, 64, 32, 3);
  TestLatLong dark = source;
  for (float& value : dark.pixels) value = std::ldexp(value, -115);
  const PrefilterOptions options{.size = 16, .roughness = {0.0, 0.02, 0.3, 1.0}, .samples = 32};
  const PrefilteredSpecular plain = prefilter_specular(source.view(), options);
  const PrefilteredSpecular result = prefilter_specular(dark.view(), options);
  for (int level = 0; level < 4; ++level) {
    const auto x = level_values(plain.cubemap, level);
    const auto y = level_values(result.cubemap, level);
    for (std::size_t k = 0; k < x.size(); ++k) REQUIRE(y[k] == std::ldexp(x[k], -115));
  }
  CHECK(result.pixels.total_radiance == plain.pixels.total_radiance * 0x1p-115);
}

TEST_CASE("The total radiance that is reported is the picture's", "[specular][prefilter]") {
  const TestLatLong source = sun_at(32, 38, 1e4F, 0.2F);
  const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 64});
  const double sun = 1e4 * image::lat_long_texel_solid_angle(256, 128, 38);
  const double sky = 0.2F * (4.0 * 3.14159265358979323846 - image::lat_long_texel_solid_angle(256, 128, 38));
  CHECK(std::abs(result.pixels.total_radiance.x / (sun + sky) - 1.0) < 1e-5);
}

}  // namespace welkin::test
