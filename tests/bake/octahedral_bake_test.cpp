// Octahedral maps out of bakes: the bits of the direct call, whichever way a bake is asked for.
#include "bake/baked.h"
#include "cache/recipe.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/requests.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

/// With nothing else but the specular cubemap.
BakeOptions bake_of(const OctahedralOptions& map, int size = 16) {
  return {.background = {},
          .specular = PrefilterOptions{.size = size, .roughness = {0.0, 0.4, 0.7, 1.0}},
          .octahedral = map,
          .irradiance = {},
          .bands = 0,
          .brdf = {}};
}

bool same_map(const std::optional<OctahedralMap>& found, const OctahedralMap& wanted) {
  return found && found->size == wanted.size && found->border == wanted.border && found->levels == wanted.levels;
}

PassAction action_of(const BakeResult& result) { return pass_named(result, "octahedral").action; }

}  // namespace

TEST_CASE("octahedral: bakes of any kind have the bits of the direct call", "[bake][octahedral][slow]") {
  const TestLatLong wide = make_lat_long(Content::high_range, 64, 32, 5);
  const TestCubemap cube = make_cubemap(Content::high_range, 16, 3, 6);
  const auto check = [](const auto& view, const OctahedralOptions& how) {
    const BakeOptions options = bake_of(how);
    const OctahedralMap truth = to_octahedral(prefilter_specular(view, *options.specular).cubemap, how);
    const BakeResult result = bake(view, options);
    CHECK(same_map(result.octahedral, truth));
    CHECK(action_of(result) == PassAction::run);
    const Plan planned = plan(view, {}, options);
    CHECK(same_bits(bake(view, planned), result));
    CHECK(planned.pass("octahedral").bytes > 0);
    // It stays where the cubemap goes to targets.
    TargetMemory block({.format = TexelFormat::rgba32f, .size = 16, .levels = 4});
    const BakeResult rest = bake_to({.specular = block.targets}, view, options);
    CHECK(rest.specular->cubemap.levels() == 0);
    CHECK(same_map(rest.octahedral, truth));
  };
  check(wide.view(), {.size = 32, .levels = 3});
  check(cube.view(), {.size = 9});
  check(cube.view(), {.size = 24, .levels = 2, .border = 4});
  BakeOptions options = bake_of({.size = 9});
  options.specular->lobe = LobeFamily::phong;
  BakeResult reused = bake(cube.view(), options);
  CHECK(same_map(reused.octahedral,
                 to_octahedral(prefilter_specular(cube.view(), *options.specular).cubemap, *options.octahedral)));
  options.octahedral.reset();
  bake_into(reused, cube.view(), options);
  CHECK_FALSE(reused.octahedral.has_value());
}

TEST_CASE("octahedral: a cache finds the map of the same options and cubemap, and no other",
          "[bake][cache][octahedral][slow]") {
  const TemporaryDirectory directory;
  ResultCache cache({.folder = directory.file("cache"), .memory_bytes = 0});
  const TestCubemap cube = make_cubemap(Content::high_range, 16, 3, 6);
  std::vector<BakeOptions> all(8, bake_of({.size = 32, .levels = 2}));
  all[1].octahedral->size = 64;
  all[2].octahedral->levels = 3;
  all[3].octahedral->border = 4;
  all[4].specular->roughness[1] = 0.5;
  all[5].specular->lobe = LobeFamily::phong;
  all[6].specular->roughness[1] = 0.5;
  all[6].specular->lobe = LobeFamily::phong;
  all[7].pixels.clamp = RadianceClamp{2.0F};
  std::vector<OctahedralMap> truths;
  for (const BakeOptions& options : all) truths.push_back(*bake(cube.view(), options).octahedral);
  for (const PassAction expected : {PassAction::run, PassAction::reuse}) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      INFO(k);
      const BakeResult found = cache.bake(cube.view(), all[k]);
      CHECK(action_of(found) == expected);
      CHECK(same_map(found.octahedral, truths[k]));
      for (std::size_t other = 0; other < k; ++other)
        CHECK(cache::hash_options(all[k]) != cache::hash_options(all[other]));
    }
  }
  BakeOptions none = all[0];
  none.octahedral.reset();
  CHECK_FALSE(cache.bake(cube.view(), none).octahedral.has_value());
  CHECK(cache::hash_options(none) != cache::hash_options(all[0]));
}

TEST_CASE("octahedral: a bake's memory stays below what was predicted", "[bake][octahedral]") {
  if (kSanitized) return;
  constexpr std::uint64_t kBesides = std::uint64_t{6} << 20U;  // as in bake_test.cpp
  const TestCubemap cube = make_cubemap(Content::high_range, 128, 3, 3);
  for (const OctahedralOptions& how : {OctahedralOptions{.size = 512, .levels = 4}, OctahedralOptions{.size = 3}}) {
    BakeOptions options = bake_of(how, 128);
    options.specular->roughness = {0.0, 0.4, 0.7, 1.0};
    release_working_memory();
    const HeapWatch heap;
    const BakeResult result = bake(cube.view(), options);
    const std::uint64_t predicted = bake_bytes(cube.view(), options);
    const auto peak = static_cast<std::uint64_t>(heap.peak_bytes());
    INFO("peak " << peak << " predicted " << predicted);
    CHECK(peak <= predicted + kBesides);
    CHECK(predicted <= 6 * (peak + kBesides));
    options.octahedral.reset();
    CHECK(bake_bytes(cube.view(), options) < predicted);
  }
}

TEST_CASE("octahedral: what does not go together is refused before anything is baked", "[bake][octahedral]") {
  const TestCubemap cube = make_cubemap(Content::smooth, 4, 3, 1);
  const auto refused = [&](const BakeOptions& options, const std::string& words) {
    const ThrownError error = thrown_by([&] { static_cast<void>(bake_bytes(cube.view(), options)); });
    CHECK(error.code == ErrorCode::invalid_argument);
    INFO(error.message);
    CHECK(error.says(words));
  };
  refused(bake_of({.size = 0}), "size of an octahedral map");
  refused(bake_of({.size = 64, .levels = 5}), "levels of an octahedral map");
  refused(bake_of({.size = 30, .levels = 3}), "multiples of 4");
  refused(bake_of({.size = 8, .border = 4}), "all border");
  BakeOptions alone = bake_of({.size = 8});
  alone.specular.reset();
  refused(alone, "octahedral requires specular");
}

}  // namespace welkin::test
