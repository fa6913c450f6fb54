// Promise: a plan says of every pass whether it runs and why, and what a scene does not use falls away.
#include <algorithm>

#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/plan.h"

namespace welkin::test {
namespace {

const SourceShape kPanorama{false, 512, 256, PixelFormat::rgb_f32};

BakeOptions whole_bake() {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = 64, .roughness = {0.0, 0.1, 0.3, 0.5, 0.8, 1.0}};
  return options;
}

void check_skipped(const Plan& plan, const std::string& pass, const std::string& reason) {
  INFO(pass);
  CHECK(plan.pass(pass).action == PassAction::skip);
  CHECK(plan.pass(pass).reason == reason);
  CHECK(plan.pass(pass).predicted_milliseconds == 0.0);
  CHECK(plan.pass(pass).bytes == 0);
}

}  // namespace

TEST_CASE("A scene that needs everything leaves nothing out", "[plan]") {
  const Plan all = plan(kPanorama, {}, whole_bake());
  REQUIRE(all.passes.size() == 7);
  for (const PlannedPass& pass : all.passes) {
    INFO(pass.name);
    CHECK(pass.action != PassAction::skip);
    CHECK(!pass.reason.empty());
    CHECK(pass.predicted_milliseconds > 0.0);
  }
  CHECK(all.options.specular->leave_out_sharp == 0);
  CHECK(all.options.specular->leave_out_rough == 0);
  CHECK(all.milliseconds(2) == Approx(all.milliseconds() / 2.0));
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
    INFO(each.range.least << " to " << each.range.greatest);
    const Plan planned = plan(kPanorama, {.glossy = each.range}, whole_bake());
    CHECK(planned.options.specular->leave_out_sharp == each.sharp);
    CHECK(planned.options.specular->leave_out_rough == each.rough);
    const Plan apart = plan(kPanorama, {.glossy = each.range, .same_bits = false}, whole_bake());
    CHECK(apart.options.specular->size == 64 >> each.sharp);
    CHECK(static_cast<int>(apart.options.specular->roughness.size()) == 6 - each.sharp - each.rough);
  }
}

TEST_CASE("A background keeps its size when reflections lose theirs", "[plan]") {
  const Plan without = plan(kPanorama, {.glossy = std::nullopt}, whole_bake());
  CHECK(without.options.background_size == 64);
  const Plan rough = plan(kPanorama, {.glossy = RoughnessRange{0.4, 1.0}}, whole_bake());
  CHECK(rough.options.background_size == 64);
  CHECK(rough.pass("background").action == PassAction::run);
  CHECK(plan(kPanorama, {}, whole_bake()).pass("background").action == PassAction::reuse);
}

TEST_CASE("What is left out is predicted to cost less", "[plan]") {
  const Plan all = plan(kPanorama, {}, whole_bake());
  const Plan rough = plan(kPanorama, {.glossy = RoughnessRange{0.4, 1.0}}, whole_bake());
  CHECK(rough.pass("specular").predicted_milliseconds < all.pass("specular").predicted_milliseconds);
  CHECK(rough.pass("specular").bytes < all.pass("specular").bytes);
  CHECK(rough.working_bytes < all.working_bytes);
}

TEST_CASE("A cost model scales what it names", "[plan]") {
  CostModel slow;
  for (const CostUnit& unit : cost_units()) {
    CHECK(slow.*unit.value > 0.0);
    slow.*unit.value *= 3.0;
  }
  const Plan planned = plan(kPanorama, {}, whole_bake());
  const Plan slowly = plan(kPanorama, {}, whole_bake(), slow);
  for (const PlannedPass& pass : planned.passes) {
    INFO(pass.name);
    CHECK(slowly.pass(pass.name).predicted_milliseconds == Approx(3.0 * pass.predicted_milliseconds));
  }
}

TEST_CASE("A plan reads as a table", "[plan]") {
  const Plan planned = plan(kPanorama, {.glossy = std::nullopt}, whole_bake());
  const std::string text = plan_text(planned);
  CHECK(text.find("lat-long 512 x 256") != std::string::npos);
  CHECK(text.find("no glossy materials") != std::string::npos);
  CHECK(text.find("measured") == std::string::npos);
  const std::string after = plan_text(planned, {{"project", "run", "", 123.0}, {"clean", "run", "a copy", 1.0}});
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

TEST_CASE("A change of exposure or direction reads no pixel", "[plan]") {
  const BakeOptions baked = whole_bake();
  EnvironmentChange turned;
  turned.turn = glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0);
  const Plan change = plan_change(baked, turned);
  CHECK(change.pass("project").action == PassAction::reuse);
  CHECK(change.pass("clean").action == PassAction::skip);
  CHECK(change.pass("specular").action == PassAction::reuse);
  CHECK(change.pass("irradiance").action == PassAction::run);
  CHECK(change.milliseconds() < 0.2 * plan(kPanorama, {}, baked).milliseconds());
}

}  // namespace welkin::test
