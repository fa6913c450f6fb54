// Bakes and their plans, from pixels and from the cache.
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "calls.h"
#include "images.h"
#include "support/temporary_directory.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"

namespace welkin::test {
namespace {

std::vector<PassRecord> records_of(const std::vector<PlannedPass>& passes) {
  std::vector<PassRecord> records;
  for (const PlannedPass& pass : passes) records.push_back({pass.name, PassAction::run, "", 1.2345});
  return records;
}

void call_plans(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  const SceneNeeds rough{.glossy = RoughnessRange{0.4, 1.0}};
  const SourceShape shape = shape_of(wide.view());
  calls.call("check(SceneNeeds", [&] {
    check(rough);
    return 0;
  });
  calls.call("plan(SourceShape", [&] { return plan(shape, {}, small_bake()).passes; });
  for (const EnvironmentView& view : views_of(cube, wide)) {
    calls.call("plan(EnvironmentView", [&] { return plan(view, rough, small_bake()).passes; });
    const Plan planned = plan(view, {}, small_bake());
    const std::vector<PassRecord> records = records_of(planned.passes);
    calls.call("plan_text(Plan", [&] { return plan_text(planned, records); });
    calls.call("bake_to(BakeTargets const&, EnvironmentView", [&] { return bake_to({}, view, small_bake()); });
    calls.call("bake(EnvironmentView const&, Plan", [&] { return bake(view, planned); });
  }
  const std::vector<CubemapView> probes(3, cube.view());
  const UploadLayout layout{.size = 8, .levels = 3};
  std::vector<std::byte> memory(3 * upload_bytes(layout));
  std::vector<CubemapTarget> targets;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::span<std::byte> slice = std::span(memory).subspan(k * upload_bytes(layout), upload_bytes(layout));
    for (const CubemapTarget& target : upload_targets(layout, slice)) targets.push_back(target);
  }
  calls.call("bake_many(", [&] {
    std::vector<dvec3> light(27);
    static_cast<void>(bake_many(probes, targets, light, *small_bake().specular));
    for (const std::byte byte : memory) light.emplace_back(static_cast<double>(std::to_integer<int>(byte)));
    return light;
  });
}

void call_cache(Calls& calls, const LatLongImage& wide, const Cubemap& cube) {
  const TemporaryDirectory folder;
  const std::filesystem::path file = folder.file("wide.pfm");
  write_environment(file, wide.view());
  const CacheOptions cache_options{.folder = folder.file("cache")};
  calls.call("ResultCache::ResultCache(CacheOptions", [&] { return ResultCache(cache_options).statistics().misses; });
  ResultCache cache(cache_options);
  const LightTransform change{.exposure = 1.7, .rotation = glm::mat3_cast(glm::dquat(0.4, 0.2, -0.4, 0.8))};
  const Projection projection = project(cube.view());
  calls.call("changed(", [&] { return changed(projection, change); });
  calls.call("ResultCache::project_file(", [&] { return cache.project_file(file); });
  const PrefilterOptions specular{.size = 8, .roughness = {0.2, 0.7}};
  calls.call("PrefilterOptions::texel_bound(", [&] { return specular.texel_bound(); });
  ResultCache planned;
  for (const EnvironmentView& view : views_of(cube, wide)) {
    calls.call("ResultCache::project(EnvironmentView", [&] { return cache.project(view, {}, change); });
    calls.call("ResultCache::prefilter_specular(EnvironmentView",
               [&] { return cache.prefilter_specular(view, specular); });
    calls.call("ResultCache::bake(EnvironmentView const&, BakeOptions", [&] { return cache.bake(view, small_bake()); });
    const Plan plan_of_view = plan(view, {}, small_bake());
    calls.call("ResultCache::bake(EnvironmentView const&, Plan", [&] { return planned.bake(view, plan_of_view); });
  }
  const StoredEnvironment stored = inspect_stored_environment(file);
  const Plan of_stored = plan(stored, {}, small_bake());
  calls.call("ResultCache::bake(StoredEnvironment", [&] { return planned.bake(stored, of_stored); });
}

}  // namespace

void call_bakes(Calls& calls) {
  const LatLongImage wide = small_lat_long();
  const Cubemap cube = small_cubemap();
  BakeResult result;
  for (const EnvironmentView& view : views_of(cube, wide)) {
    calls.call("bake_bytes(EnvironmentView", [&] { return bake_bytes(view, small_bake()); });
    calls.call("bake(EnvironmentView const&, BakeOptions", [&] { return bake(view, small_bake()); });
    calls.call("bake_into(BakeResult&, EnvironmentView", [&] {
      bake_into(result, view, small_bake());
      return std::cref(result);
    });
  }
  call_plans(calls, wide, cube);
  call_cache(calls, wide, cube);
}

}  // namespace welkin::test
