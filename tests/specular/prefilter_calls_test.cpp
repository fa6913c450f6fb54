// Promise: the same bits everywhere, no allocation in tiles, cancellation, progress, and errors that say what would do.
#include <atomic>
#include <stop_token>

#include "specular/prefilter.h"
#include "specular/prefilter_support.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/heap.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/instruction_set.h"
#include "welkin/projection.h"

namespace welkin::test {
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

TEST_CASE("The prefilter's harmonics are the projection's", "[specular][prefilter]") {
  for (const Content content : {Content::high_range, Content::one_texel_sun}) {
    const TestLatLong source = make_lat_long(content, 256, 128, 3);
    const specular::Prefiltered result = specular::prefilter(source.view(), {.size = 64}, 4, {}, {});
    REQUIRE(result.harmonics);
    ProjectionOptions options;
    options.bands = 4;
    CHECK(relative_error(*result.harmonics, project(source.view(), options).radiance) < 2e-6);
  }
}

TEST_CASE("Records say how each mip was made", "[specular][prefilter]") {
  const TestLatLong source = make_lat_long(Content::one_texel_sun, 256, 128, 3);
  const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 64});
  REQUIRE(result.mips.size() == 7);
  CHECK(result.mips[0].method == "copy");
  CHECK(result.mips[0].bands == 0);
  for (std::size_t k = 1; k < 7; ++k) {
    CHECK(result.mips[k].size == 64 >> k);
    CHECK(result.mips[k].roughness == Approx(static_cast<double>(k) / 6.0));
    CHECK(result.mips[k].method == "spectral");
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
  ProjectionOptions strict;
  strict.negative = NegativePolicy::reject;
  TestLatLong negative = source;
  negative.pixels[3 * (2 * 32 + 5)] = -1.0F;
  const ThrownError rejected =
      thrown_by([&] { (void)prefilter_specular(negative.view(), {.size = 16, .pixels = strict}); });
  CHECK(rejected.code == ErrorCode::rejected_pixel);
  CHECK(rejected.says("row 2, column 5"));
}

}  // namespace welkin::test
