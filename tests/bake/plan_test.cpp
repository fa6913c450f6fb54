// Plans: what is not needed is left out, and what is made has the bits of the whole bake.

#include "welkin/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "bake/baked.h"
#include "jobs/tiles.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/random_environments.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "transform/row_reduction.h"
#include "welkin/bake_file.h"
#include "welkin/irradiance.h"
#include "welkin/resampling.h"
#include "welkin/sky_plan.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: what a planned bake computes has the bits that the bake of everything gives it.

namespace {

BakeOptions whole_bake() {
  BakeOptions options = small_bake();
  // a copy, a narrow one, spectral ones
  options.specular = PrefilterOptions{.size = 32, .roughness = {0.0, 0.04, 0.25, 0.4, 0.7, 1.0}};
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
  if (part.background) {
    CHECK(part.background->size() == whole.background->size());
    for (int level = 0; level < part.background->levels(); ++level)
      CHECK(same_bytes(level_values(*part.background, level), level_values(*whole.background, level)));
  }
  if (part.specular) CHECK(same_mips(*part.specular, *whole.specular, first_mip));
  if (part.irradiance) CHECK(same_bits(*part.irradiance, *whole.irradiance));
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
      CHECK((done.action == PassAction::skip) == (said.action == PassAction::skip));
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
    REQUIRE(whole.specular->mips[1].bands > whole.specular->mips[2].bands + 40);
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
  BakeOptions options = small_bake();
  options.specular = PrefilterOptions{.size = 8, .roughness = {0.2, 0.5, 1.0}};
  Plan planned = plan(picture.view(), {}, options);
  planned.trim.mips = {.sharp = 2};
  CHECK(bake(picture.view(), planned).specular->cubemap.size() == 2);
  const auto refused = [&](const UnusedMips& mips) {
    planned.trim.mips = mips;
    return thrown_by([&] { static_cast<void>(bake(picture.view(), planned)); });
  };
  CHECK(refused({.sharp = 2, .rough = 1}).says("rough mips that are left out is 1"));
  CHECK(refused({.sharp = 3}).says("sharp mips that are left out is 3"));
  CHECK(refused({.sharp = -1}).says("sharp mips that are left out is -1"));
}

TEST_CASE("Bands that are projected beside those that are returned are within range", "[plan]") {
  const TestLatLong picture = make_lat_long(Content::smooth, 32, 16, 3);
  Plan planned = plan(picture.view(), {.diffuse_bands = 1}, small_bake());
  CHECK(planned.trim.projected_bands == 3);
  for (const int wrong : {-1, kMaximumBands + 1}) {
    planned.trim.projected_bands = wrong;
    CHECK(thrown_by([&] { static_cast<void>(bake(picture.view(), planned)); }).says("projected_bands"));
  }
}

TEST_CASE("A plan is for the source that it was made for", "[plan]") {
  const TestLatLong one = make_lat_long(Content::smooth, 32, 16, 3);
  const TestLatLong other = make_lat_long(Content::smooth, 34, 16, 3);
  const Plan planned = plan(one.view(), {});
  CHECK(thrown_by([&] { static_cast<void>(bake(other.view(), planned)); }).says("lat-long 32 x 16"));
}

// Promise: a plan says of every pass whether it runs and why, and what a scene does not use falls away.

namespace {

const SourceShape kPanorama{false, 512, 256, PixelFormat::rgb32f};

BakeOptions six_mip_bake() {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = 64, .roughness = {0.0, 0.1, 0.3, 0.5, 0.8, 1.0}};
  return options;
}

void check_skipped(const Plan& plan, const std::string& pass, const std::string& reason) {
  INFO(pass);
  CHECK(plan.pass(pass).action == PassAction::skip);
  CHECK(plan.pass(pass).reason == reason);
  CHECK(plan.pass(pass).bytes == 0);
}

}  // namespace

TEST_CASE("plan: rows that are brought to fewer count in the memory", "[bake][plan]") {
  const SourceShape wide{false, 8192, 4096, PixelFormat::rgb32f};
  BakeOptions options;
  options.background.reset();
  options.irradiance.reset();
  options.brdf.reset();
  options.specular = PrefilterOptions{.size = 64, .mips = 1, .roughness = {0.7}};
  const int bands = reflections::plan_prefilter(*options.specular).bands;
  const std::size_t rows =
      transforms::ReducedRows::most_bytes(8192, 4096, bands, jobs::worker_count(jobs::Placement::arena));
  CHECK(rows > std::size_t{1} << 20U);
  const auto working = [&](const SourceShape& shape) { return plan(shape, SceneNeeds(), options).working_bytes; };
  const SourceShape odd{false, 8191, 4096, PixelFormat::rgb32f};  // whose rows are taken as they are
  CHECK(working(wide) - working(odd) >= rows);
}

TEST_CASE("A scene that needs everything leaves nothing out", "[plan]") {
  const Plan all = plan(kPanorama, {}, six_mip_bake());
  REQUIRE(all.passes.size() == 7);
  for (const PlannedPass& pass : all.passes) {
    INFO(pass.name);
    CHECK(pass.action != PassAction::skip);
    CHECK(!pass.reason.empty());
  }
  CHECK(all.trim == PlanTrim());
}

TEST_CASE("Where coefficients are all, there is no cubemap", "[plan]") {
  const Plan light = plan(kPanorama, {.irradiance_cubemap = false, .glossy = std::nullopt, .background = false});
  check_skipped(light, "background", "nothing shows it");
  check_skipped(light, "background mips", "there is no background");
  check_skipped(light, "specular", "no glossy materials");
  check_skipped(light, "brdf", "no glossy materials");
  check_skipped(light, "irradiance", "diffuse light is read from coefficients");
  CHECK(light.pass("clean").action == PassAction::skip);
  CHECK(light.pass("project").action == PassAction::run);
  CHECK(light.result_bytes == 0);
}

TEST_CASE("Ambient light is one colour, and of no diffuse light nothing is projected", "[plan]") {
  const Plan ambient = plan(kPanorama, {.diffuse_bands = 1});
  CHECK(ambient.options.bands == 1);
  check_skipped(ambient, "irradiance", "ambient only: one colour is all of it");
  const Plan none = plan(kPanorama, {.diffuse_bands = 0});
  check_skipped(none, "project", "no diffuse light is used");
  check_skipped(none, "irradiance", "no diffuse light is used");
}

TEST_CASE("Mips that no lookup touches are left out", "[plan]") {
  struct Case {
    RoughnessRange range;
    int sharp;
    int rough;
  };
  // of 0.0, 0.1, 0.3, 0.5, 0.8, 1.0: a lookup between two mips reads both
  for (const Case& each : {Case{{0.0, 1.0}, 0, 0}, Case{{0.4, 1.0}, 2, 0}, Case{{0.3, 0.8}, 2, 1},
                           Case{{0.0, 0.0}, 0, 5}, Case{{1.0, 1.0}, 5, 0}, Case{{0.05, 0.31}, 0, 2}}) {
    INFO(each.range.minimum << " to " << each.range.maximum);
    const Plan planned = plan(kPanorama, {.glossy = each.range}, six_mip_bake());
    CHECK(planned.trim.mips == UnusedMips{each.sharp, each.rough});
    const Plan apart = plan(kPanorama, {.glossy = each.range, .same_bits = false}, six_mip_bake());
    CHECK(apart.trim.mips == UnusedMips());
    CHECK(apart.options.specular->size == 64 >> each.sharp);
    CHECK(static_cast<int>(apart.options.specular->roughness.size()) == 6 - each.sharp - each.rough);
  }
}

TEST_CASE("A background keeps its size when reflections lose theirs", "[plan]") {
  const Plan without = plan(kPanorama, {.glossy = std::nullopt}, six_mip_bake());
  CHECK(without.options.background->size == 64);
  const Plan rough = plan(kPanorama, {.glossy = RoughnessRange{0.4, 1.0}}, six_mip_bake());
  CHECK(rough.options.background->size == 64);
  CHECK(rough.pass("background").action == PassAction::run);
  CHECK(plan(kPanorama, {}, six_mip_bake()).pass("background").action == PassAction::reuse);
}

TEST_CASE("What is left out takes no memory", "[plan]") {
  const Plan all = plan(kPanorama, {}, six_mip_bake());
  const Plan rough = plan(kPanorama, {.glossy = RoughnessRange{0.4, 1.0}}, six_mip_bake());
  CHECK(rough.pass("specular").bytes < all.pass("specular").bytes);
  CHECK(rough.working_bytes < all.working_bytes);
}

TEST_CASE("A plan reads as a table", "[plan]") {
  const Plan planned = plan(kPanorama, {.glossy = std::nullopt}, six_mip_bake());
  const std::string text = plan_text(planned);
  CHECK(text.find("lat-long 512 x 256") != std::string::npos);
  CHECK(text.find("no glossy materials") != std::string::npos);
  CHECK(text.find("measured") == std::string::npos);
  const std::string after =
      plan_text(planned, {{"project", PassAction::run, "", 123.0}, {"clean", PassAction::run, "a copy", 1.0}});
  CHECK(after.find("measured") != std::string::npos);
  CHECK(after.find("123") != std::string::npos);
  CHECK(after.find("run: a copy") != std::string::npos);  // another action than was planned
}

TEST_CASE("Needs that make no sense are refused", "[plan]") {
  const auto refused = [](const SceneNeeds& needs, const std::string& word) {
    const ThrownError error = thrown_by([&] { static_cast<void>(plan(kPanorama, needs)); });
    INFO(error.message);
    return error.code == ErrorCode::invalid_argument && error.says(word);
  };
  CHECK(refused({.diffuse_bands = -1}, "diffuse_bands"));
  CHECK(refused({.glossy = RoughnessRange{0.6, 0.5}}, "roughness"));
  CHECK(refused({.glossy = RoughnessRange{0.0, 1.5}}, "roughness"));
}

}  // namespace welkin::test
