// A chain of mips is put together from what other chains left, and is the chain that would have been made.
#include <functional>
#include <vector>

#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/result_cache.h"
#include "welkin/roughness.h"

namespace {

using namespace welkin;
using test::Content;

/// The options of a chain without bounds to think about.
PrefilterOptions chain(std::vector<double> roughness, int size = 32) {
  PrefilterOptions options{.size = size};
  options.roughness = std::move(roughness);
  return options;
}

bool same_mip(const MipRecord& a, const MipRecord& b) {
  return a.size == b.size && a.roughness == b.roughness && a.method == b.method && a.bands == b.bands &&
         a.bright_texels == b.bright_texels && a.samples == b.samples && a.error_estimate == b.error_estimate &&
         test::same_bits(a.mean, b.mean);
}

bool same_pixels(const ProjectionDiagnostics& a, const ProjectionDiagnostics& b) {
  return a.texels == b.texels && a.nans_replaced == b.nans_replaced && a.infinities_replaced == b.infinities_replaced &&
         a.negatives_replaced == b.negatives_replaced && a.texels_clamped == b.texels_clamped &&
         test::same_bits(a.flux, b.flux) && test::same_bits(a.flux_before_clamp, b.flux_before_clamp) &&
         test::same_bits(a.error_estimate, b.error_estimate);
}

bool same_specular(const PrefilteredSpecular& a, const PrefilteredSpecular& b) {
  const auto values = [](const CubemapChain& c) { return std::span<const float>(c.face(0, 0), c.bytes() / 4); };
  return a.cubemap.size() == b.cubemap.size() && a.cubemap.levels() == b.cubemap.levels() &&
         test::same_bytes(values(a.cubemap), values(b.cubemap)) &&
         std::equal(a.mips.begin(), a.mips.end(), b.mips.begin(), b.mips.end(), same_mip) &&
         same_pixels(a.pixels, b.pixels);
}

std::string reason_of_cache(const PrefilteredSpecular& specular) {
  const std::vector<PassRecord>& passes = specular.pixels.passes;
  return !passes.empty() && passes.front().name == "cache" ? passes.front().reason : "";
}

struct Change {
  const char* what;
  PrefilterOptions before;
  PrefilterOptions after;
  std::uint64_t made;  ///< mips of the second chain that the first does not have
};

std::vector<Change> changes() {
  const PrefilterOptions four = chain({0.0, 0.3, 0.5, 0.8});
  const auto with = [&](const std::function<void(PrefilterOptions&)>& change) {
    PrefilterOptions options = four;
    change(options);
    return options;
  };
  const auto babylon = [](int mips) { return chain(roughness_of_mips(RoughnessSchedule::babylon, mips, 32)); };
  PrefilterOptions sampled = four;
  sampled.method = PrefilterMethod::sampled;
  sampled.samples = 32;
  PrefilterOptions more_samples = sampled;
  more_samples.samples = 48;
  PrefilterOptions mixed = chain({0.0, 0.03, 0.3, 0.6});
  mixed.samples = 32;
  PrefilterOptions looser = mixed;
  looser.rms_error = 1e-2;
  looser.maximum_error = 5e-2;
  return {
      {"a mip more", four, chain({0.0, 0.3, 0.5, 0.8, 1.0}), 1},
      {"two mips more", four, chain({0.0, 0.3, 0.5, 0.8, 0.9, 1.0}), 2},
      {"a mip less", four, chain({0.0, 0.3, 0.5}), 0},
      {"a mip more of a schedule that does not look at their number", babylon(4), babylon(5), 1},
      {"a mip more of one that does", {.size = 32, .mips = 4}, {.size = 32, .mips = 5}, 4},
      {"a rougher mip changed", four, chain({0.0, 0.3, 0.6, 0.8}), 1},
      {"two that are not neighbours", four, chain({0.1, 0.3, 0.6, 0.8}), 4},  // and so the narrowest lobe
      {"the narrowest lobe changed", four, chain({0.0, 0.25, 0.5, 0.8}), 3},
      {"the narrowest lobe gone", four, chain({0.0, 0.0, 0.5, 0.8}), 3},
      {"a mip more at the sharp end, not the narrowest lobe", four, chain({0.0, 0.0, 0.3, 0.5, 0.8}, 64), 1},
      {"ends left out", four, with([](PrefilterOptions& o) { o.leave_out_sharp = o.leave_out_rough = 1; }), 0},
      {"ends no longer left out", with([](PrefilterOptions& o) { o.leave_out_sharp = o.leave_out_rough = 1; }), four,
       2},
      {"another word for the method", four, with([](PrefilterOptions& o) { o.method = PrefilterMethod::spectral; }), 0},
      {"other samples, and none is sampled", four, with([](PrefilterOptions& o) { o.samples = 9; }), 0},
      {"other samples", sampled, more_samples, 3},
      {"another bound, which one mip does not look at", mixed, looser, 2},
      {"other pixels", four, with([](PrefilterOptions& o) { o.pixels.clamp = RadianceClamp{3.0F}; }), 4},
  };
}

template <class View>
void check(const View& view, const Change& change) {
  INFO(change.what);
  ResultCache cache;
  CHECK(same_specular(cache.prefilter_specular(view, change.before), prefilter_specular(view, change.before)));
  const PrefilteredSpecular truth = prefilter_specular(view, change.after);
  const std::uint64_t misses = cache.statistics().misses;
  const PrefilteredSpecular made = cache.prefilter_specular(view, change.after);
  CHECK(same_specular(made, truth));
  const std::uint64_t cleaned = change.before.pixels == change.after.pixels ? 0 : 1;
  CHECK(cache.statistics().misses - misses == change.made + cleaned);
  if (change.made == 0) CHECK(reason_of_cache(made) == "found in memory");
  if (change.made == truth.mips.size()) CHECK(reason_of_cache(made).empty());
  CHECK(same_specular(cache.prefilter_specular(view, change.after), truth));
}

TEST_CASE("chains: with other mips only what is missing is made, and every bit is as without a cache") {
  const test::TestLatLong lat_long = test::make_lat_long(Content::high_range, 64, 32, 5);
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 24, 3, 5);
  for (const Change& change : changes()) {
    check(lat_long.view(), change);
    check(cubemap.view(), change);
  }
}

TEST_CASE("chains: pixels that must be cleaned, and huge ones") {
  const test::TestLatLong lat_long = test::make_lat_long(Content::special_values, 64, 32, 5);
  test::TestCubemap huge = test::make_cubemap(Content::high_range, 24, 3, 5);
  for (float& value : huge.pixels) value *= 1e28F;
  PrefilterOptions before = chain({0.0, 0.3, 0.5});
  before.pixels.negative = NegativePolicy::replace;
  before.pixels.clamp = RadianceClamp{100.0F};
  PrefilterOptions after = before;
  after.roughness.push_back(0.9);
  check(lat_long.view(), {"special", before, after, 1});
  check(huge.view(), {"huge", chain({0.0, 0.3, 0.5}), chain({0.0, 0.3, 0.5, 0.9}), 1});
}

TEST_CASE("chains: mips that are gone from the folder are made again, those between them too") {
  const test::TemporaryDirectory directory;
  const CacheOptions where{.folder = directory.file("cache"), .memory_bytes = 0};
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 24, 3, 5);
  const PrefilterOptions options = chain({0.0, 0.3, 0.4, 0.5, 0.8});
  const PrefilteredSpecular truth = ResultCache(where).prefilter_specular(cubemap.view(), options);
  const auto remove_mip = [&](int size) {
    const auto texels = static_cast<std::uintmax_t>(72 * size * size);
    int removed = 0;
    for (const auto& entry : std::filesystem::directory_iterator(where.folder)) {
      const std::uintmax_t rest = entry.file_size() - std::min(entry.file_size(), texels);
      if (entry.file_size() < texels || rest > 300) continue;
      std::filesystem::remove(entry.path());
      ++removed;
    }
    REQUIRE(removed == 1);
  };
  remove_mip(16);
  remove_mip(4);
  ResultCache cache(where);
  const PrefilteredSpecular made = cache.prefilter_specular(cubemap.view(), options);
  CHECK(same_specular(made, truth));
  CHECK(reason_of_cache(made) == "2 of 5 mips found on disk");
  CHECK(reason_of_cache(cache.prefilter_specular(cubemap.view(), options)) == "found on disk");
}

TEST_CASE("chains: a bake's mips are those of a prefilter, and the other way round") {
  const test::TestLatLong lat_long = test::make_lat_long(Content::special_values, 64, 32, 5);
  BakeOptions baking;
  baking.specular = chain({0.0, 0.3, 0.5, 0.8});
  baking.pixels.negative = NegativePolicy::replace;
  baking.irradiance_size = 0;
  baking.brdf.reset();
  PrefilterOptions alone = *baking.specular;
  alone.pixels = baking.pixels;
  const BakeResult truth = bake(lat_long.view(), baking);
  const PrefilteredSpecular truth_alone = prefilter_specular(lat_long.view(), alone);
  ResultCache baked;
  CHECK(same_specular(*baked.bake(lat_long.view(), baking).specular, *truth.specular));
  CHECK(same_specular(baked.prefilter_specular(lat_long.view(), alone), truth_alone));
  CHECK(baked.statistics().memory_hits == 4);
  ResultCache prefiltered;
  CHECK(same_specular(prefiltered.prefilter_specular(lat_long.view(), alone), truth_alone));
  CHECK(same_specular(*prefiltered.bake(lat_long.view(), baking).specular, *truth.specular));
  CHECK(prefiltered.statistics().memory_hits == 4);
}

TEST_CASE("chains: a bake with a mip more makes one mip, and says so") {
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 24, 3, 5);
  BakeOptions options;
  options.specular = chain({0.0, 0.3, 0.5});
  options.irradiance_size = 8;
  options.brdf.reset();
  ResultCache cache;
  static_cast<void>(cache.bake(cubemap.view(), options));
  const std::uint64_t misses = cache.statistics().misses;
  options.specular->roughness.push_back(0.9);
  const BakeResult made = cache.bake(cubemap.view(), options);
  CHECK(cache.statistics().misses == misses + 1);
  CHECK(same_specular(*made.specular, *bake(cubemap.view(), options).specular));
  for (const PassRecord& pass : made.diagnostics.passes) {
    if (pass.name != "specular") continue;
    CHECK(pass.action == "run");
    CHECK(pass.reason == "3 of 4 mips found in memory, the others made");
  }
}

}  // namespace
