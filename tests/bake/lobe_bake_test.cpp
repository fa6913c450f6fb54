// Lobes other than GGX and octahedral maps in bakes: the bits of the direct calls for every kind of bake.
#include "bake/baked.h"
#include "cache/recipe.h"
#include "reflections/prefilter_plan.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/reflections.h"
#include "welkin/requests.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

double power(double roughness) { return 2.0 / (roughness * roughness * roughness * roughness) - 2.0; }

struct FamilyOptions {
  PrefilterOptions options;
  std::vector<ZonalLobe> kernels;  ///< of the direct call; if empty, that is the call by family
};

/// Wide lobes, because narrow ones take long.
std::vector<FamilyOptions> all_families() {
  const std::vector<double> two{0.5, 0.8};
  const std::vector<std::vector<double>> spectra{{2.0, 1.0, 0.5}, {3.0, 1.0, 0.25, -0.5}};
  return {
      {{.size = 8, .roughness = two, .lobe = LobeFamily::charlie}, {ZonalLobe::charlie(0.5), ZonalLobe::charlie(0.8)}},
      {{.size = 8, .lobe = LobeFamily::lambert}, {}},
      {{.size = 8, .roughness = two, .lobe = LobeFamily::phong},
       {ZonalLobe::phong(power(0.5)), ZonalLobe::phong(power(0.8))}},
      {{.size = 8, .roughness = {1.0}, .lobe = LobeFamily::phong}, {ZonalLobe::phong(1.0)}},
      {{.size = 8, .roughness = two, .lobe = LobeFamily::blinn},
       {ZonalLobe::blinn(power(0.5)), ZonalLobe::blinn(power(0.8))}},
      {{.size = 8, .roughness = {0.5, 0.5}, .lobe = LobeFamily::spectra, .spectra = spectra},
       {ZonalLobe::from_spectrum(spectra[0]), ZonalLobe::from_spectrum(spectra[1])}},
  };
}

BakeOptions bake_of(const PrefilterOptions& specular) {
  return {.background = {}, .specular = specular, .irradiance = {}, .bands = 0, .brdf = {}};
}

PrefilteredSpecular direct(const EnvironmentView& view, const FamilyOptions& family) {
  if (family.kernels.empty()) return prefilter_specular(view, family.options);
  return prefilter_by_lobes(view, {.size = family.options.size, .lobes = family.kernels});
}

std::vector<double> roughness_of(const PrefilteredSpecular& specular) {
  std::vector<double> roughness;
  for (const MipRecord& mip : specular.mips) roughness.push_back(mip.roughness);
  return roughness;
}

}  // namespace

TEST_CASE("lobes: bakes, plans and prefilters have the bits of the direct call", "[bake][lobes]") {
  const TestLatLong wide = make_lat_long(Content::high_range, 32, 16, 5);
  const TestCubemap cube = make_cubemap(Content::one_texel_sun, 8, 3, 6);
  const auto check = [](const auto& view, const FamilyOptions& family) {
    INFO(name(family.options.lobe));
    const PrefilteredSpecular truth = direct(view, family);
    const PrefilteredSpecular alone = prefilter_specular(view, family.options);
    CHECK(same_bits(alone.cubemap, truth.cubemap));
    CHECK(roughness_of(alone) == reflections::roughness_of_chain(family.options));
    CHECK(default_mip_count(family.options) == truth.cubemap.levels());
    const BakeOptions options = bake_of(family.options);
    CHECK(same_bits(bake(view, options).specular->cubemap, truth.cubemap));
    const Plan planned = plan(view, {}, options);
    CHECK(same_bits(bake(view, planned).specular->cubemap, truth.cubemap));
    CHECK(planned.pass("specular").reason.find(name(family.options.lobe)) != std::string::npos);
    CHECK(planned.pass("specular").bytes > 0);
  };
  for (const FamilyOptions& family : all_families()) {
    check(wide.view(), family);
    check(cube.view(), family);
  }
}

TEST_CASE("lobes: Lambert's is irradiance over pi, and looser bounds take fewer bands", "[bake][lobes]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 32, 3, 6);
  int before = 1000;
  for (const double bound : {1e-4, 1e-3, 3e-3, 1e-2}) {
    INFO("within " << bound);
    const PrefilteredSpecular lambert =
        prefilter_specular(cube.view(), {.size = 16, .lobe = LobeFamily::lambert, .rms_error = bound});
    CHECK(lambert.mips[0].bands < before);
    before = lambert.mips[0].bands;
    BakeOptions options{.background = {}, .specular = {}, .bands = 0, .brdf = {}};
    options.irradiance = IrradianceOptions{.size = 16, .rms_error = bound};
    const BakeResult made = bake(cube.view(), options);
    // From the default bound on both have the same bands; below it a chain begins with the bands of its lobe and adds
    // more where its estimate requires them.
    const std::span<const float> irradiance = made.irradiance->pixels();
    double off = 0.0;
    double whole = 0.0;
    for (std::size_t k = 0; k < irradiance.size(); ++k) {
      const double value = static_cast<double>(lambert.cubemap.face(0, 0)[k]) * std::numbers::pi;
      off += std::pow(value - static_cast<double>(irradiance[k]), 2);
      whole += std::pow(value, 2);
      if (bound >= 1e-3) REQUIRE(value == Approx(irradiance[k]).epsilon(1e-5));
    }
    CHECK(std::sqrt(off / whole) < 2e-5);
  }
}

TEST_CASE("lobes: a chain has as many mips, and as rough ones, as its family has", "[lobes]") {
  const auto roughness = [](LobeFamily lobe) {
    return reflections::roughness_of_chain({.size = 8, .roughness = {0.0, 0.02, 0.6}, .lobe = lobe});
  };
  CHECK(roughness(LobeFamily::charlie) == std::vector<double>{kMinCharlieRoughness, kMinCharlieRoughness, 0.6});
  CHECK(roughness(LobeFamily::phong) == std::vector<double>{0.12, 0.12, 0.6});
  CHECK(roughness(LobeFamily::blinn) == std::vector<double>{0.12, 0.12, 0.6});
  CHECK(roughness(LobeFamily::lambert) == std::vector<double>{0.0, 0.02, 0.6});
  const PrefilterOptions sheen{.size = 64, .lobe = LobeFamily::charlie};
  const int mips = default_mip_count(RoughnessSchedule::linear, 64);
  CHECK(default_mip_count(sheen) == mips);
  // glTF's sample renderer looks sheen up by the mips of its GGX chain; at roughness 0 the lobe is the horizon.
  std::vector<double> even = mip_roughness(RoughnessSchedule::linear, mips, 64);
  CHECK(even.back() == 1.0);
  even.front() = kMinCharlieRoughness;
  CHECK(reflections::roughness_of_chain(sheen) == even);
  CHECK(default_mip_count({.size = 64, .lobe = LobeFamily::lambert}) == 1);
  CHECK(default_mip_count({.size = 64}) == default_mip_count(RoughnessSchedule::filament, 64));
}

TEST_CASE("lobes: bakes into targets and of many probes have the bits of the direct call", "[bake][many][lobes]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 8, 3, 6);
  for (const FamilyOptions& family : all_families()) {
    INFO(name(family.options.lobe));
    const std::vector<std::byte> truth = stored(direct(cube.view(), family).cubemap);
    const UploadLayout layout{.format = TexelFormat::rgba32f, .size = 8, .levels = default_mip_count(family.options)};
    TargetMemory block(layout);
    static_cast<void>(bake_to({.specular = block.targets}, cube.view(), bake_of(family.options)));
    CHECK(block.memory == truth);
    TargetMemory of_many(layout);
    const CubemapView probe = cube.view();
    static_cast<void>(bake_many({&probe, 1}, of_many.targets, {}, family.options, 0));
    CHECK(of_many.memory == truth);
  }
}

TEST_CASE("lobes: a cache finds the chain of a lobe, and of no other", "[bake][cache][lobes][slow]") {
  const TestCubemap cube = make_cubemap(Content::high_range, 8, 3, 6);
  std::vector<PrefilterOptions> all;
  for (const FamilyOptions& family : all_families()) all.push_back(family.options);
  const auto add = [&](std::size_t from, const std::function<void(PrefilterOptions&)>& change) {
    PrefilterOptions changed = all[from];
    change(changed);
    all.push_back(changed);
  };
  add(0, [](PrefilterOptions& options) { options.lobe = LobeFamily::ggx; });
  add(0, [](PrefilterOptions& options) { options.rms_error = 1e-2; });
  add(0, [](PrefilterOptions& options) {
    options.method = PrefilterMethod::reference;
    options.size = 2;
  });
  add(5, [](PrefilterOptions& options) { options.spectra[1][2] = 0.375; });
  // Mip 1 of a chain is as large as mip 0 of this one, and is not the same.
  add(5, [](PrefilterOptions& options) { options.size = 4; });
  ResultCache cache;
  for (const PassAction expected : {PassAction::run, PassAction::reuse}) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      INFO(k << ' ' << name(all[k].lobe));
      const BakeResult found = cache.bake(cube.view(), bake_of(all[k]));
      CHECK(pass_named(found, "specular").action == expected);
      CHECK(same_bits(found.specular->cubemap, prefilter_specular(cube.view(), all[k]).cubemap));
      CHECK(same_bits(cache.prefilter_specular(cube.view(), all[k]).cubemap, found.specular->cubemap));
      for (std::size_t other = 0; other < k; ++other)
        CHECK(cache::hash_options(all[k]) != cache::hash_options(all[other]));
    }
  }
}

TEST_CASE("lobes: a bake's memory stays below what was predicted", "[bake][lobes]") {
  if (kSanitized) return;
  constexpr std::uint64_t kAnyTimes = 1'000'000;
  const TestLatLong wide = make_lat_long(Content::one_texel_sun, 256, 128, 3);
  const TestCubemap cube = make_cubemap(Content::high_range, 64, 3, 3);
  const auto check = [](const auto& view, LobeFamily lobe) {
    INFO(name(lobe));
    const BakeOptions options = bake_of({.size = 64, .roughness = {0.3, 0.6}, .lobe = lobe});
    CHECK(check_memory(view, options, kAnyTimes).specular->peak_bytes <= bake_bytes(view, options));
  };
  for (const LobeFamily lobe : {LobeFamily::charlie, LobeFamily::lambert, LobeFamily::phong, LobeFamily::blinn}) {
    check(wide.view(), lobe);
    check(cube.view(), lobe);
  }
}

TEST_CASE("lobes: what does not go together is refused, and the message says what to do", "[bake][lobes]") {
  const TestCubemap cube = make_cubemap(Content::smooth, 4, 3, 1);
  const auto refused = [&](const PrefilterOptions& options, const std::string& words) {
    const ThrownError error = thrown_by([&] { static_cast<void>(bake(cube.view(), bake_of(options))); });
    CHECK(error.code == ErrorCode::invalid_argument);
    INFO(error.message);
    CHECK(error.says(words));
  };
  refused({.size = 4, .lobe = static_cast<LobeFamily>(6)}, "the lobe 6 is unknown");
  refused({.size = 4, .lobe = LobeFamily::spectra}, "pass one for each mip");
  refused({.size = 4, .lobe = LobeFamily::charlie, .spectra = {{1.0}}}, "the lobe is charlie; set it to spectra");
  refused({.size = 4, .mips = 2, .lobe = LobeFamily::spectra, .spectra = {{1.0}}}, "each mip needs one");
  refused({.size = 4, .lobe = LobeFamily::spectra, .spectra = {{-1.0}}}, "must be above 0");
  refused({.size = 4, .roughness = {1.5}, .lobe = LobeFamily::phong}, "roughness of mip 0");
}

// Octahedral maps.

namespace {

/// Returns options of a bake of only the specular cubemap.
BakeOptions map_of(const OctahedralOptions& map, int size = 16) {
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
    const BakeOptions options = map_of(how);
    const OctahedralMap truth = to_octahedral(prefilter_specular(view, *options.specular).cubemap, how);
    const BakeResult result = bake(view, options);
    CHECK(same_map(result.octahedral, truth));
    CHECK(action_of(result) == PassAction::run);
    const Plan planned = plan(view, {}, options);
    CHECK(same_bits(bake(view, planned), result));
    CHECK(planned.pass("octahedral").bytes > 0);
    // The map stays in the result when the cubemap goes to targets.
    TargetMemory block({.format = TexelFormat::rgba32f, .size = 16, .levels = 4});
    const BakeResult rest = bake_to({.specular = block.targets}, view, options);
    CHECK(rest.specular->cubemap.levels() == 0);
    CHECK(same_map(rest.octahedral, truth));
  };
  check(wide.view(), {.size = 32, .levels = 3});
  check(cube.view(), {.size = 9});
  check(cube.view(), {.size = 24, .levels = 2, .border = 4});
  BakeOptions options = map_of({.size = 9});
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
  std::vector<BakeOptions> all(8, map_of({.size = 32, .levels = 2}));
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
  const TestCubemap cube = make_cubemap(Content::high_range, 128, 3, 3);
  for (const OctahedralOptions& how : {OctahedralOptions{.size = 512, .levels = 4}, OctahedralOptions{.size = 3}}) {
    BakeOptions options = map_of(how, 128);
    check_memory(cube.view(), options, 6);
    const std::uint64_t predicted = bake_bytes(cube.view(), options);
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
  refused(map_of({.size = 0}), "size of an octahedral map");
  refused(map_of({.size = 64, .levels = 5}), "levels of an octahedral map");
  refused(map_of({.size = 30, .levels = 3}), "multiples of 4");
  refused(map_of({.size = 8, .border = 4}), "all border");
  BakeOptions alone = map_of({.size = 8});
  alone.specular.reset();
  refused(alone, "octahedral requires specular");
}

}  // namespace welkin::test
