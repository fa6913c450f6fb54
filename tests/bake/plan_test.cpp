// Plans: unneeded parts are left out, and a bake makes what the options of the plan say.
#include "bake/baked.h"
#include "jobs/tiles.h"
#include "reflections/prefilter_plan.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/random_environments.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "transform/row_reduction.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promise: a bake depends on nothing but its plan's options.

namespace {

BakeOptions whole_bake() {
  BakeOptions options = small_bake();
  // one mip that is copied, one with a narrow lobe, and spectral ones
  options.specular = PrefilterOptions{.size = 32, .roughness = {0.0, 0.04, 0.25, 0.4, 0.7, 1.0}};
  return options;
}

void check_all_needs(const EnvironmentView& view, const BakeOptions& options) {
  struct Case {
    SceneNeeds needs;
    int size = 0;
    int mips = 0;
  };
  const std::vector<Case> cases = {
      {{}, 32, 6},
      {{.diffuse_bands = 1, .glossy = std::nullopt, .background = false}, 0, 0},
      {{.irradiance_cubemap = false, .glossy = RoughnessRange{0.5, 1.0}, .background_mips = false}, 4, 3},
      {{.glossy = RoughnessRange{0.0, 0.2}, .background = false}, 32, 3},
      {{.glossy = RoughnessRange{0.03, 0.04}, .brdf_table = false}, 32, 2},
      {{.diffuse_bands = 0, .glossy = RoughnessRange{0.4, 0.7}}, 4, 2},
      {{.diffuse_bands = 2, .glossy = RoughnessRange{1.0, 1.0}}, 1, 1},
      {{.diffuse_bands = 0, .glossy = std::nullopt, .background = false}, 0, 0},  // nothing at all
  };
  for (const Case& each : cases) {
    const Plan planned = plan(view, each.needs, options);
    INFO(plan_text(planned));
    const BakeResult part = bake(view, planned);
    BakeResult direct = bake(view, planned.options);
    for (PassRecord& pass : direct.diagnostics.passes) pass.reason = pass_named(part, pass.name).reason;
    CHECK(same_bits(part, direct));
    CHECK((part.specular ? part.specular->cubemap.size() : 0) == each.size);
    CHECK((part.specular ? part.specular->cubemap.levels() : 0) == each.mips);
    if (each.needs.diffuse_bands == 0) CHECK(part.diagnostics.total_radiance == glm::dvec3(0.0));
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

TEST_CASE("A panorama baked by a plan has the bits of a bake by the plan's options", "[plan]") {
  for (const Content content : {Content::high_range, Content::one_texel_sun}) {
    const TestLatLong image = make_lat_long(content, 96, 48, 7);
    check_all_needs(image.view(), whole_bake());
  }
}

TEST_CASE("Mips that are left are within the bounds of the whole chain", "[plan]") {
  const TestCubemap cube = make_cubemap(Content::smooth, 16, 3, 9);
  const BakeResult whole = bake(cube.view(), whole_bake());
  const Plan apart = plan(cube.view(), {.glossy = RoughnessRange{0.4, 1.0}}, whole_bake());
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

// Promise: a plan states for every pass whether it runs and why, and omits what a scene does not use.

namespace {

const SourceShape kPanorama{false, 512, 256, PixelFormat::rgb32f};

BakeOptions six_mip_bake() {
  BakeOptions options{.specular = PrefilterOptions{.size = 64, .roughness = {0.0, 0.1, 0.3, 0.5, 0.8, 1.0}}};
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
  CHECK(rows > std::size_t{1} << 19U);
  const auto working = [&](const SourceShape& shape) { return plan(shape, SceneNeeds(), options).working_bytes; };
  const SourceShape odd{false, 8191, 4096, PixelFormat::rgb32f};  // whose rows are not reduced
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
  CHECK(all.options.specular == six_mip_bake().specular);
  CHECK(all.options.irradiance == six_mip_bake().irradiance);
  CHECK(all.options.bands == six_mip_bake().bands);
}

TEST_CASE("Where coefficients are all, there is no cubemap", "[plan]") {
  const Plan light = plan(kPanorama, {.irradiance_cubemap = false, .glossy = std::nullopt, .background = false});
  check_skipped(light, "background", "the scene does not show it");
  check_skipped(light, "background mips", "no background is made");
  check_skipped(light, "specular", "the scene has no glossy materials");
  check_skipped(light, "brdf", "the scene has no glossy materials");
  check_skipped(light, "irradiance", "the scene evaluates coefficients instead");
  CHECK(light.pass("sanitize").action == PassAction::skip);
  CHECK(light.pass("project").action == PassAction::run);
  CHECK(light.result_bytes == 0);
}

TEST_CASE("Ambient light is one colour, and of no diffuse light nothing is projected", "[plan]") {
  const Plan ambient = plan(kPanorama, {.diffuse_bands = 1});
  CHECK(ambient.options.bands == 1);
  check_skipped(ambient, "irradiance", "the scene uses ambient light only");
  const Plan none = plan(kPanorama, {.diffuse_bands = 0});
  check_skipped(none, "project", "the scene uses no diffuse light");
  check_skipped(none, "irradiance", "the scene uses no diffuse light");
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
    const std::vector<double> whole = six_mip_bake().specular->roughness;
    CHECK(planned.options.specular->size == 64 >> each.sharp);
    CHECK(planned.options.specular->roughness ==
          std::vector<double>(whole.begin() + each.sharp, whole.end() - each.rough));
    const std::string left_out =
        "; omitted: " + std::to_string(each.sharp) + " sharper, " + std::to_string(each.rough) + " rougher";
    const bool says = planned.pass("specular").reason.find(left_out) != std::string::npos;
    CHECK(says == (each.sharp + each.rough > 0));
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

TEST_CASE("A plan reads as a table", "[plan]") {
  const Plan planned = plan(kPanorama, {.glossy = std::nullopt}, six_mip_bake());
  const std::string text = plan_text(planned);
  CHECK(text.find("lat-long 512 x 256") != std::string::npos);
  CHECK(text.find("no glossy materials") != std::string::npos);
  CHECK(text.find("measured") == std::string::npos);
  const std::string after =
      plan_text(planned, {{"project", PassAction::run, "", 123.0}, {"sanitize", PassAction::run, "a copy", 1.0}});
  CHECK(after.find("measured") != std::string::npos);
  CHECK(after.find("123") != std::string::npos);
  CHECK(after.find("run: a copy") != std::string::npos);  // differs from the planned action
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
