// How many bands and rings the prefilter takes: as few as the bounds allow, more for pictures that need them.
#include "reflections/band_choice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "reflections/prefilter.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

Cubemap picture(int size, const std::function<float(const glm::dvec3&)>& light) {
  std::vector<float> pixels;
  for (const glm::dvec3& direction : centres(size)) pixels.insert(pixels.end(), 3, light(direction));
  return {size, pixels};
}

/// Rings of latitude of one frequency.
Cubemap stripes(int size, double frequency) {
  return picture(size, [=](const glm::dvec3& d) { return std::sin(frequency * std::asin(d.y)) > 0.0 ? 1.0F : 0.01F; });
}

int bands_of(const Cubemap& image, const PrefilterOptions& options) {
  return prefilter_specular(image.view(), options).mips.front().bands;
}

}  // namespace

TEST_CASE("Each looser bound takes fewer bands and rings", "[specular][bands]") {
  constexpr double kAlpha = 0.018;
  int bands = 10'000;
  double rings = 1e9;
  for (const double rms : {1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
    const reflections::ErrorBounds bounds{rms, 10.0 * rms};
    CAPTURE(rms);
    const int own = reflections::bands_within(kAlpha, bounds);
    CHECK(own < bands);
    CHECK(reflections::rings_within(kAlpha, bounds) <= rings);
    const int wide = reflections::bands_within(1.0, bounds);
    CHECK((wide < reflections::bands_within(1.0, bounds.tightened(1)) || wide == 24));  // as few as there are
    bands = own;
    rings = reflections::rings_within(kAlpha, bounds);
  }
  // 264 and 540 were taken whatever the picture
  CHECK(reflections::bands_within(kAlpha, {}) <= 208);
  CHECK(reflections::rings_within(kAlpha, {}) <= 320.0);
}

TEST_CASE("Each looser bound takes fewer bands, rings and texels of small probes too", "[specular][bands]") {
  int bands = 10'000;
  int rows = 10'000;
  int face = 64;
  for (const double rms : {1e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
    const reflections::PrefilterPlan plan =
        reflections::plan_prefilter(PrefilterOptions{.size = 64, .mips = 3, .rms_error = rms}).at_step(0, 64);
    CAPTURE(rms);
    CHECK(plan.bands < bands);
    CHECK(plan.rows_for_cubemap() <= rows);
    CHECK(plan.face_for_cubemap(64) <= face);
    bands = plan.bands;
    rows = plan.rows_for_cubemap();
    face = plan.face_for_cubemap(64);
  }
  CHECK(rows <= 60);
  CHECK(face <= 32);
}

TEST_CASE("A bound of 1e-4 begins with hardly more bands than one of 1e-3", "[specular][bands]") {
  for (const int size : {16, 32, 64, 128, 256}) {
    const auto first = [&](double rms) {
      return reflections::plan_prefilter(PrefilterOptions{.size = size, .rms_error = rms}).at_step(0, size);
    };
    CAPTURE(size);
    CHECK(first(1e-4).bands <= first(1e-3).bands * 5 / 4);
    CHECK(first(1e-3).bands <= (size > 64 ? 192 : 64));
    CHECK(first(1e-4).rows_for_cubemap() <= 2 * first(1e-3).rows_for_cubemap());
    CHECK(!first(1e-3).near_mips.empty());
    // dark parts then take more
    CHECK(reflections::plan_prefilter(PrefilterOptions{.size = size}).at_step(1, size).bands >=
          reflections::bands_for_dark({}));
  }
}

TEST_CASE("A picture takes its bands at once where the transform has enough", "[specular][bands]") {
  const Cubemap fine = stripes(64, 20.0);
  const PrefilteredSpecular result =
      prefilter_specular(fine.view(), {.size = 64, .mips = 3, .method = PrefilterMethod::spectral, .rms_error = 3e-2});
  const auto again = [](const PassRecord& pass) { return pass.name == "energies"; };
  CHECK(std::ranges::none_of(result.pixels.passes, again));
  CHECK(*result.mips[1].error_estimate <= 3e-2);
}

TEST_CASE("Pictures with more energy than most take more bands", "[specular][bands]") {
  const PrefilterOptions options{.size = 16, .mips = 1, .roughness = {0.2}, .method = PrefilterMethod::spectral};
  const int usual = reflections::plan_prefilter(options).bands;
  CHECK(bands_of(picture(32, [](const glm::dvec3& d) { return static_cast<float>(2.0 + d.x); }), options) <= usual);
  const Cubemap fine = stripes(64, 78.0);
  const PrefilteredSpecular result = prefilter_specular(fine.view(), options);
  CHECK(result.mips.front().bands > reflections::plan_prefilter(options).mips.front().bands.bands());
  CHECK(*result.mips.front().error_estimate <= 1e-3);
}

TEST_CASE("Bands that a small cubemap's lobe will take are foreseen within reason", "[kernels][bands]") {
  const Cubemap noise = picture(64, [](const glm::dvec3& d) {
    return static_cast<float>(1.5 + std::sin(9.0 * d.x) +
                              (std::sin(71.0 * d.x + 53.0 * d.y + 97.0 * d.z) > 0.9 ? 20.0 : 0.0));
  });
  const PrefilteredSpecular result =
      prefilter_specular(noise.view(), {.size = 64, .mips = 3, .lobe = LobeFamily::charlie, .rms_error = 1e-2});
  int most = 0;
  for (const PassRecord& pass : result.pixels.passes) {
    if (pass.name == "analyse") most = std::max(most, std::stoi(pass.reason));
  }
  CHECK(most > 112);
  CHECK(most < 2 * result.mips.front().bands);
}

// A chain's other mips decide too, so that a mip has the same bits with and without them.
TEST_CASE("Mips that are left out do not change the bands of the others", "[specular][bands][bits]") {
  const Cubemap fine = stripes(64, 78.0);
  const reflections::PrefilterPlan plan =
      reflections::plan_prefilter({.size = 16, .roughness = {0.2, 0.5}, .method = PrefilterMethod::spectral});
  const PrefilteredSpecular whole = reflections::prefilter(fine.view(), plan, {}, {}, {});
  const PrefilteredSpecular rough = reflections::prefilter(fine.view(), plan.without(1, 0), {}, {}, {});
  CHECK(whole.mips[0].bands > plan.mips[0].bands.bands());
  const auto values = level_values(whole.cubemap, 1);
  const auto alone = level_values(rough.cubemap, 0);
  CHECK(std::equal(values.begin(), values.end(), alone.begin(), alone.end()));
}

TEST_CASE("The dark side of a bright sky keeps the bound on the largest error", "[specular][bands][truth]") {
  TestLatLong sky = make_lat_long(Content::uniform, 64, 32, 0);
  for (std::size_t k = 0; k < sky.pixels.size(); ++k) sky.pixels[k] = k < 13U * 64U * 3U ? 1.0F : 3e-4F;
  for (const double roughness : {0.3, 1.0}) {
    const PrefilteredSpecular result = prefilter_specular(
        sky.view(), {.size = 8, .mips = 1, .roughness = {roughness}, .method = PrefilterMethod::spectral});
    const LevelError error = level_error(result.cubemap, 0, reference_specular(sky.view(), roughness, centres(8)));
    CAPTURE(roughness, result.mips[0].bands, error.rms, error.maximum);
    CHECK(error.maximum < 1e-2);
  }
}

TEST_CASE("No estimate is above the bound that was asked for", "[specular][bands]") {
  for (const double rms : {1e-2, 1e-3, 1e-4}) {
    for (const Content content : {Content::random, Content::blocks, Content::one_texel_sun}) {
      const TestCubemap source = make_cubemap(content, 32, 3, 17);
      const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 16,
                                                                            .roughness = {0.2, 0.6},
                                                                            .method = PrefilterMethod::spectral,
                                                                            .rms_error = rms,
                                                                            .maximum_error = 10.0 * rms});
      for (const MipRecord& mip : result.mips) {
        CAPTURE(rms, std::string(name(content)), mip.roughness);
        CHECK(*mip.error_estimate <= rms);
      }
    }
  }
  const TestCubemap source = make_cubemap(Content::one_texel_sun, 32, 3, 17);
  const ThrownError thrown = thrown_by([&] {
    (void)prefilter_specular(source.view(),
                             {.size = 16, .mips = 1, .roughness = {0.6}, .rms_error = 2e-6, .maximum_error = 2e-5});
  });
  CHECK(thrown.code == ErrorCode::limit_exceeded);
  CHECK(thrown.says("would err by an estimated"));
}

// Texels of a coarse mip may miss a lamp whose lobe is narrower than they are: what is left is dark beside the lamp's
// own errors.
TEST_CASE("Mips that harmonics do not bring within the bound are integrated", "[specular][bands][truth]") {
  int integrated = 0;
  for (std::size_t texel = 0; texel < 5766; texel += 61) {
    TestCubemap source = make_cubemap(Content::random, 31, 3, 17);  // near sums take an even size
    for (float& value : source.pixels) value = static_cast<float>(std::pow(static_cast<double>(value), 12.0));
    for (std::size_t c = 0; c < 3; ++c) source.pixels[3 * texel + c] *= 1e6F;
    PrefilterOptions options{.size = 8, .mips = 1, .roughness = {0.134}};
    const MipRecord mip = prefilter_specular(source.view(), options).mips.front();
    CHECK(*mip.error_estimate <= options.rms_error);
    if (mip.method != MipMethod::reference) continue;
    ++integrated;
    options.method = PrefilterMethod::spectral;
    const ThrownError thrown = thrown_by([&] { (void)prefilter_specular(source.view(), options); });
    CHECK(thrown.code == ErrorCode::limit_exceeded);
  }
  CHECK(integrated > 0);
}

}  // namespace welkin::test
