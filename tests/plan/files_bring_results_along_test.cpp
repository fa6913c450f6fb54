// Promise: what a file carries already is taken as it is and not computed again, and pixels that no pass wants are not
// even read.
#include <cstring>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/babylon_environment.h"
#include "welkin/environment_writer.h"
#include "welkin/plan.h"
#include "welkin/texture_file.h"

namespace welkin::test {
namespace {

constexpr int kSize = 16;

/// Levels that are no mips of each other.
CubemapChain odd_chain() {
  CubemapChain chain(kSize, full_chain_levels(kSize));
  for (int level = 0; level < chain.levels(); ++level) {
    const TestCubemap pixels =
        make_cubemap(Content::smooth, chain.level_size(level), 3, 3U + static_cast<unsigned>(level));
    std::memcpy(chain.face(level, 0), pixels.pixels.data(), pixels.pixels.size() * sizeof(float));
  }
  return chain;
}

BakeOptions whole_bake() {
  BakeOptions options = small_bake(kSize);
  options.background_size = kSize;
  return options;
}

std::filesystem::path write_env(const TemporaryDirectory& directory) {
  const CubemapChain chain = odd_chain();
  BabylonEnvironment environment = to_babylon(chain, project(chain.view(0)).radiance);
  environment.polynomial->xx = {41.0, 42.0, 43.0};  // one that no pixels have
  write_babylon_environment(directory.file("sky.env"), environment);
  return directory.file("sky.env");
}

std::filesystem::path write_ktx2(const TemporaryDirectory& directory, const std::string& roughness) {
  TextureOptions options{.format = TexelFormat::rgba32f};
  if (!roughness.empty()) options.metadata["welkin.roughness"] = roughness;
  write_texture(directory.file("sky.ktx2"), odd_chain().views(), options);
  return directory.file("sky.ktx2");
}

}  // namespace

TEST_CASE("Of an .env whose light alone is used only the manifest is read", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = probe_environment(write_env(directory));
  CHECK(file.has_polynomial);
  CHECK(file.content == LevelContent::reflections);
  CHECK(file.levels == 5);
  const Plan light = plan(file, {.glossy = std::nullopt, .background = false}, whole_bake());
  CHECK(light.pass("read").action == PassAction::skip);
  CHECK(light.pass("project").action == PassAction::reuse);
  const BakeResult result = bake(file, light);
  REQUIRE(result.radiance);
  CHECK(same_bytes<glm::dvec3>(result.radiance->coefficients(), project_file(file.path).radiance.coefficients()));
  CHECK(same_bits(result.irradiance, bake_file(file.path, {}, whole_bake()).irradiance));
  REQUIRE(result.stored_polynomial);
  CHECK(result.stored_polynomial->xx == glm::dvec3(41.0, 42.0, 43.0));
}

TEST_CASE("The prefiltered chain of an .env is the specular cubemap", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = probe_environment(write_env(directory));
  const CubemapChain stored = mirrored_x(read_babylon_environment(file.path).specular);
  for (const RoughnessRange range : {RoughnessRange{0.0, 1.0}, RoughnessRange{0.6, 1.0}}) {
    const Plan planned = plan(file, {.glossy = range}, whole_bake());
    INFO(plan_text(planned));
    CHECK(planned.pass("specular").action == PassAction::reuse);
    const BakeResult result = bake(file, planned);
    REQUIRE(result.specular);
    const int first = planned.first_stored_mip;
    CHECK((first > 0) == (range.least > 0.0));
    CHECK(result.specular->cubemap.levels() == planned.stored_mips);
    for (int level = 0; level < planned.stored_mips; ++level) {
      CHECK(same_bytes(level_values(result.specular->cubemap, level), level_values(stored, first + level)));
      CHECK(result.specular->mips[static_cast<std::size_t>(level)].roughness ==
            file.roughness[static_cast<std::size_t>(first + level)]);
    }
    CHECK(pass_named(result, "specular").action == "reuse");
    CHECK(pass_named(result, "project").action == "reuse");
    CHECK(same_bytes(level_values(result.background, 0), level_values(stored, 0)));
  }
}

TEST_CASE("What a file carries is computed all the same if that is asked for", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = probe_environment(write_env(directory));
  const Plan planned = plan(file, {.stored_results = false}, whole_bake());
  for (const char* pass : {"read", "specular", "project"}) CHECK(planned.pass(pass).action == PassAction::run);
  const BakeResult result = bake(file, planned);
  const CubemapChain stored = mirrored_x(read_babylon_environment(file.path).specular);
  const BakeResult pixels = bake(stored.view(0), whole_bake());
  CHECK(same_bytes<glm::dvec3>(result.radiance->coefficients(), pixels.radiance->coefficients()));
  CHECK(same_bits(result.specular->cubemap, pixels.specular->cubemap));
  // stored results were made without a clamp
  BakeOptions clamped = whole_bake();
  clamped.pixels.clamp = RadianceClamp{.maximum = 1.0F};
  CHECK(plan(file, {}, clamped).pass("project").action == PassAction::run);
}

TEST_CASE("A KTX2's levels are the background's mips", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = probe_environment(write_ktx2(directory, ""));
  CHECK(file.content == LevelContent::radiance);
  const SceneNeeds needs{.glossy = std::nullopt};
  const Plan planned = plan(file, needs, whole_bake());
  CHECK(planned.pass("background mips").action == PassAction::reuse);
  const BakeResult result = bake(file, planned);
  CHECK(same_bits(result.background, odd_chain()));
  CHECK(pass_named(result, "background mips").action == "reuse");
  BakeOptions smaller = whole_bake();
  smaller.background_size = 8;
  CHECK(plan(file, needs, smaller).pass("background mips").action == PassAction::run);
}

TEST_CASE("A KTX2 that speaks of roughness holds reflections", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = probe_environment(write_ktx2(directory, "0 0.25 0.5 0.75 1"));
  CHECK(file.content == LevelContent::reflections);
  CHECK(file.roughness == std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0});
  const Plan planned = plan(file, {.glossy = RoughnessRange{0.3, 0.6}, .background = false}, whole_bake());
  CHECK(planned.first_stored_mip == 1);
  CHECK(planned.stored_mips == 3);
  const BakeResult result = bake(file, planned);
  CHECK(same_bytes(level_values(result.specular->cubemap, 0), level_values(odd_chain(), 1)));
  CHECK(plan(file, {}, whole_bake()).pass("background mips").action == PassAction::run);
}

TEST_CASE("A DDS cannot say what its levels are, a caller can", "[plan][codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.dds");
  write_texture(path, odd_chain().views(), {.format = TexelFormat::rgba32f});
  const SceneNeeds needs{.glossy = std::nullopt};
  const auto action = [&](LevelContent content) {
    return plan(probe_environment(path, {}, content), needs, whole_bake()).pass("background mips").action;
  };
  CHECK(action(LevelContent::automatic) == PassAction::run);
  CHECK(action(LevelContent::radiance) == PassAction::reuse);
  CHECK(action(LevelContent::reflections) == PassAction::run);
}

TEST_CASE("A bake that reads no pixel keeps its memory limit too", "[plan][codec]") {
  const TemporaryDirectory directory;
  const TestLatLong picture = make_lat_long(Content::high_range, 32, 16, 7);
  const std::filesystem::path file = directory.file("sky.hdr");
  write_environment(file, picture.view());
  const SceneNeeds needs{.glossy = std::nullopt, .background = false};
  BakeOptions options;
  options.irradiance_size = 512;
  options.memory_limit_bytes = 1'000'000;
  const StoredEnvironment stored = probe_environment(file);
  const Plan planned = plan(stored, needs, options);
  REQUIRE(planned.streams);
  CHECK(thrown_by([&] { static_cast<void>(bake(stored, planned)); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("A panorama whose light alone is used is projected while it is read", "[plan][codec]") {
  const TemporaryDirectory directory;
  const TestLatLong picture = make_lat_long(Content::high_range, 64, 32, 3);
  write_environment(directory.file("sky.pfm"), picture.view());
  const StoredEnvironment file = probe_environment(directory.file("sky.pfm"));
  const BakeResult whole = bake(picture.view(), whole_bake());
  const Plan light = plan(file, {.irradiance_cubemap = false, .glossy = std::nullopt, .background = false});
  CHECK(light.streams);
  CHECK(light.pass("read").bytes == 0);
  CHECK(same_bytes<glm::dvec3>(bake(file, light).radiance->coefficients(), whole.radiance->coefficients()));
  const Plan all = plan(file, {}, whole_bake());
  CHECK(!all.streams);
  BakeResult baked = bake(file, all);
  baked.diagnostics.passes.erase(baked.diagnostics.passes.begin());
  CHECK(same_bits(baked.specular->cubemap, whole.specular->cubemap));
  CHECK(same_bits(baked.background, whole.background));
  CHECK(same_bits(baked.irradiance, whole.irradiance));
  CHECK(thrown_by([&] { static_cast<void>(bake(file, plan(picture.view(), {}))); }).says("plan again"));
}

}  // namespace welkin::test
