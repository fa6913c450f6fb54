// Promise: what a planned bake computes has the bits that the bake of everything gives it.
#include <algorithm>
#include <vector>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/plan.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

BakeOptions whole_bake() {
  BakeOptions options = small_bake();
  // a copy, a sampled one, spectral ones
  options.specular = PrefilterOptions{.size = 32, .roughness = {0.0, 0.04, 0.25, 0.4, 0.7, 1.0}, .samples = 32};
  return options;
}

/// Levels of `part` against those of `whole` from `first` on.
bool same_mips(const PrefilteredSpecular& part, const PrefilteredSpecular& whole, int first) {
  for (int level = 0; level < part.cubemap.levels(); ++level) {
    if (!same_bytes(level_values(part.cubemap, level), level_values(whole.cubemap, first + level))) return false;
    if (part.mips[static_cast<std::size_t>(level)].roughness !=
        whole.mips[static_cast<std::size_t>(first + level)].roughness)
      return false;
  }
  return true;
}

/// Whatever both have.
void check_same_where_both(const BakeResult& part, const BakeResult& whole, int first_mip) {
  if (part.background.levels() > 0) {
    CHECK(part.background.size() == whole.background.size());
    for (int level = 0; level < part.background.levels(); ++level)
      CHECK(same_bytes(level_values(part.background, level), level_values(whole.background, level)));
  }
  if (part.specular) CHECK(same_mips(*part.specular, *whole.specular, first_mip));
  if (part.irradiance.size > 0 && part.radiance->bands() == whole.radiance->bands())
    CHECK(same_bits(part.irradiance, whole.irradiance));
  if (part.radiance) {
    const auto count = part.radiance->coefficients().size();
    CHECK(same_bytes<glm::dvec3>(part.radiance->coefficients(), whole.radiance->coefficients().first(count)));
  }
  if (part.brdf) CHECK(same_bytes<float>(part.brdf->values, whole.brdf->values));
}

template <class View>
void check_all_needs(const View& view, const BakeResult& whole, const BakeOptions& options) {
  struct Case {
    SceneNeeds needs;
    int first_mip = 0;
    int mips = 0;
  };
  const std::vector<Case> cases = {
      {{}, 0, 6},
      {{.diffuse_bands = 1, .glossy = std::nullopt, .background = false}, 0, 0},
      {{.irradiance_cubemap = false, .glossy = RoughnessRange{0.5, 1.0}, .background_mips = false}, 3, 3},
      {{.glossy = RoughnessRange{0.0, 0.2}, .background = false}, 0, 3},
      {{.glossy = RoughnessRange{0.03, 0.04}, .brdf_table = false}, 0, 2},
      {{.diffuse_bands = 0, .glossy = RoughnessRange{0.4, 0.7}}, 3, 2},
      {{.diffuse_bands = 2, .glossy = RoughnessRange{1.0, 1.0}}, 5, 1},
      {{.diffuse_bands = 0, .glossy = std::nullopt, .background = false}, 0, 0},  // nothing at all
  };
  for (const Case& each : cases) {
    const Plan planned = plan(view, each.needs, options);
    INFO(plan_text(planned));
    const BakeResult part = bake(view, planned);
    check_same_where_both(part, whole, each.first_mip);
    CHECK((part.specular ? part.specular->cubemap.levels() : 0) == each.mips);
    CHECK(part.diagnostics.passes.size() == planned.passes.size());
    for (std::size_t k = 0; k < planned.passes.size(); ++k) {
      const PlannedPass& said = planned.passes[k];
      const PassRecord& done = part.diagnostics.passes[k];
      CHECK(done.name == said.name);
      CHECK((done.action == "skip") == (said.action == PassAction::skip));
      if (said.action == PassAction::skip) CHECK(done.reason == said.reason);
    }
    CHECK(part.peak_bytes == planned.result_bytes + planned.working_bytes);
  }
}

}  // namespace

TEST_CASE("A panorama baked by a plan has the whole bake's bits", "[plan]") {
  for (const Content content : {Content::high_range, Content::one_texel_sun}) {
    const TestLatLong picture = make_lat_long(content, 96, 48, 7);
    check_all_needs(picture.view(), bake(picture.view(), whole_bake()), whole_bake());
  }
}

TEST_CASE("A cubemap baked by a plan has the whole bake's bits", "[plan]") {
  const TestCubemapHalf cube = make_cubemap_half(Content::high_range, 16, 4, 8);
  check_all_needs(cube.view(), bake(cube.view(), whole_bake()), whole_bake());
}

TEST_CASE("A mip has the same bits where others that take many more bands are left out", "[plan]") {
  BakeOptions options = whole_bake();
  options.specular = PrefilterOptions{.size = 128, .roughness = {0.0, 0.12, 0.4, 1.0}};
  const auto check = [&](const auto& view) {
    const BakeResult whole = bake(view, options);
    const BakeResult part = bake(view, plan(view, {.glossy = RoughnessRange{0.4, 1.0}}, options));
    REQUIRE(whole.specular->mips[1].bands > 3 * whole.specular->mips[2].bands);
    check_same_where_both(part, whole, 2);
  };
  const TestLatLong picture = make_lat_long(Content::high_range, 512, 256, 7);
  check(picture.view());
  const TestCubemap cube = make_cubemap(Content::high_range, 64, 3, 8);
  check(cube.view());
}

TEST_CASE("A chain of its own is within the bounds of the whole one", "[plan]") {
  const TestCubemap cube = make_cubemap(Content::smooth, 16, 3, 9);
  const BakeResult whole = bake(cube.view(), whole_bake());
  const Plan apart = plan(cube.view(), {.glossy = RoughnessRange{0.4, 1.0}, .same_bits = false}, whole_bake());
  const BakeResult part = bake(cube.view(), apart);
  REQUIRE(part.specular);
  REQUIRE(part.specular->cubemap.levels() == 3);
  for (int level = 0; level < 3; ++level) {
    const auto values = level_values(part.specular->cubemap, level);
    const auto truth = level_values(whole.specular->cubemap, 3 + level);
    REQUIRE(values.size() == truth.size());
    for (std::size_t k = 0; k < values.size(); ++k) CHECK(values[k] == Approx(truth[k]).epsilon(2e-2));
  }
}

TEST_CASE("Mips that are left out stay within the chain", "[plan]") {
  const TestLatLong picture = make_lat_long(Content::smooth, 32, 16, 3);
  PrefilterOptions options{.size = 8, .roughness = {0.2, 0.5, 1.0}};
  options.leave_out_sharp = 2;
  CHECK(prefilter_specular(picture.view(), options).cubemap.size() == 2);
  options.leave_out_rough = 1;
  const auto refused = [&] {
    return thrown_by([&] { static_cast<void>(prefilter_specular(picture.view(), options)); });
  };
  CHECK(refused().says("leave_out_rough"));
  options.leave_out_rough = 0;
  options.leave_out_sharp = 3;
  CHECK(refused().says("leave_out_sharp"));
}

TEST_CASE("What the caller left out already is not left out twice", "[plan]") {
  const TestLatLong picture = make_lat_long(Content::high_range, 64, 32, 7);
  BakeOptions options = small_bake();
  options.specular = PrefilterOptions{.size = 32, .roughness = {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}};
  options.specular->leave_out_sharp = 1;
  options.specular->leave_out_rough = 1;
  for (const bool same_bits : {true, false}) {
    const SceneNeeds needs{.glossy = RoughnessRange{0.4, 1.0}, .same_bits = same_bits};
    const BakeResult part = bake(picture.view(), plan(picture.view(), needs, options));
    REQUIRE(part.specular->mips.size() == 3);
    CHECK(part.specular->mips.front().roughness == 0.4);
    CHECK(part.specular->mips.back().roughness == 0.8);
  }
}

TEST_CASE("A plan is for the source that it was made for", "[plan]") {
  const TestLatLong one = make_lat_long(Content::smooth, 32, 16, 3);
  const TestLatLong other = make_lat_long(Content::smooth, 34, 16, 3);
  const Plan planned = plan(one.view(), {});
  CHECK(thrown_by([&] { static_cast<void>(bake(other.view(), planned)); }).says("lat-long 32 x 16"));
}

TEST_CASE("An environment that was turned and scaled is not projected again", "[plan]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 16, 3, 4);
  BakeOptions options = small_bake();
  BakeResult result = bake(cube.view(), options);
  EnvironmentChange change;
  change.turn = turn_about_y(90.0);
  change.scale = glm::dvec3(2.0, 0.5, 1.0);
  apply_change(result, options, change);
  CubemapImage turned = to_cubemap(cube.view(), 16, change.turn);  // texels to texels
  for (std::size_t k = 0; k < turned.pixels.size(); ++k)
    turned.pixels[k] *= static_cast<float>(change.scale[static_cast<glm::length_t>(k % 3)]);
  const BakeResult anew = bake(turned.view(), options);
  const auto coefficients = result.radiance->coefficients();
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    for (glm::length_t c = 0; c < 3; ++c) {
      const double size = anew.radiance->coefficients()[0][c];
      CHECK(std::abs(coefficients[k][c] - anew.radiance->coefficients()[k][c]) < 1e-6 * size);
    }
  }
  for (std::size_t k = 0; k < result.irradiance.pixels.size(); ++k)
    CHECK(result.irradiance.pixels[k] == Approx(anew.irradiance.pixels[k]).epsilon(1e-5));
  CHECK(result.diagnostics.flux.x == Approx(anew.diagnostics.flux.x));
  EnvironmentChange wrong;
  wrong.scale = glm::dvec3(-1.0);
  CHECK(thrown_by([&] { apply_change(result, options, wrong); }).code == ErrorCode::invalid_argument);
  result.radiance.reset();  // nothing is left that could be turned
  const glm::dvec3 flux = result.diagnostics.flux;
  wrong.scale = glm::dvec3(1.0);
  wrong.turn[0][0] = 3.0;
  CHECK(thrown_by([&] { apply_change(result, options, wrong); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { static_cast<void>(plan_change(options, wrong)); }).code == ErrorCode::invalid_argument);
  apply_change(result, options, change);
  CHECK(result.diagnostics.flux == flux * change.scale);
}

}  // namespace welkin::test
