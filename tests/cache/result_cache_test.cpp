// Results of a cache equal the computed ones, whether they are stored as a whole or assembled.
#include "welkin/result_cache.h"

#include <glm/gtc/quaternion.hpp>

#include "bake/baked.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Results of a cache equal the computed ones.

namespace {

bool same_bake(const BakeResult& a, const BakeResult& b) { return same_results(a, b) && a.peak_bytes == b.peak_bytes; }

std::string action(const ProjectionDiagnostics& diagnostics, const std::string& pass) {
  for (const PassRecord& record : diagnostics.passes) {
    if (record.name == pass) return name(record.action);
  }
  return "none";
}

BakeOptions three_mips() {
  BakeOptions options{.specular = PrefilterOptions{.size = 16, .mips = 3}};
  options.irradiance->size = 8;
  options.brdf = BrdfTableOptions{8, 8};
  return options;
}

TEST_CASE("cache: a projection is computed once, in memory and on disk, and never for other options") {
  const TemporaryDirectory directory;
  const CacheOptions options{.folder = directory.file("cache")};
  const TestLatLong lat_long = make_lat_long(Content::special_values, 64, 32, 3);
  const TestCubemap cubemap = make_cubemap(Content::high_range, 20, 3, 3);
  ProjectionOptions clamped{.bands = 4};
  clamped.pixels.clamp = RadianceClamp{10.0F};
  ResultCache cache(options);
  for (const ProjectionOptions& each : {ProjectionOptions{}, clamped}) {
    CHECK(same_bits(cache.project(lat_long.view(), each), project(lat_long.view(), each)));
    CHECK(same_bits(cache.project(cubemap.view(), each), project(cubemap.view(), each)));
  }
  CHECK(cache.statistics().misses == 4);
  const Projection again = cache.project(lat_long.view(), clamped);
  CHECK(same_light(again, project(lat_long.view(), clamped)));
  CHECK(action(again.diagnostics, "cache") == "reuse");
  CHECK(action(again.diagnostics, "project") == "reuse");
  CHECK(cache.statistics().memory_hits == 1);
  ResultCache other(options);
  CHECK(same_light(other.project(cubemap.view(), clamped), project(cubemap.view(), clamped)));
  CHECK(other.statistics().disk_hits == 1);
  CHECK(other.statistics().misses == 0);
}

TEST_CASE("cache: a changed face alone is projected again") {
  ResultCache cache;
  TestCubemap cubemap = make_cubemap(Content::random, 70, 3, 9);
  const LightTransform keep{.keep_faces = true};
  CHECK(same_light(cache.project(cubemap.view(), {}, keep), project(cubemap.view())));
  cubemap.pixels[cubemap.pixels.size() / 2] += 3.0F;
  const Projection now = cache.project(cubemap.view(), {}, keep);
  CHECK(same_light(now, project(cubemap.view())));
  CHECK(now.diagnostics.passes.front().reason == "5 of 6 faces were projected before");
  // Misses: two projections, six faces at first, and one face later.
  CHECK(cache.statistics().misses == 1 + 6 + 1 + 1);
  CHECK(cache.statistics().memory_hits == 5);
}

TEST_CASE("cache: exposure is a factor, a turn is one of the coefficients, and no pixel is projected for them") {
  ResultCache cache;
  const TestCubemap cubemap = make_cubemap(Content::high_range, 16, 3, 9);
  const Projection plain = cache.project(cubemap.view(), {.bands = 5});
  const glm::dmat3 rotation = glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, 3.0))));
  const Projection light = cache.project(cubemap.view(), {.bands = 5}, {.exposure = 4.0, .rotation = rotation});
  CHECK(cache.statistics().memory_hits == 1);
  CHECK(action(light.diagnostics, "project") == "reuse");
  CHECK(action(light.diagnostics, "exposure") == "run");
  CHECK(action(light.diagnostics, "rotation") == "run");
  const SphericalHarmonics expected = rotate(scale(plain.radiance, glm::dvec3(4.0)), rotation);
  CHECK(same_bytes(light.radiance.coefficients(), expected.coefficients()));
  // The exposure is a power of two: the result equals that of the exposed pixels bit for bit.
  TestCubemap exposed = cubemap;
  for (float& value : exposed.pixels) value *= 4.0F;
  CHECK(same_light(changed(plain, {.exposure = 4.0}), project(exposed.view(), {.bands = 5})));
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK(thrown_by([&] { static_cast<void>(changed(plain, {.exposure = wrong})); }).code ==
          ErrorCode::invalid_argument);
  }
}

TEST_CASE("cache: a bake is what it is without, and only what is missing is baked") {
  const TemporaryDirectory directory;
  const CacheOptions where{.folder = directory.file("cache"), .memory_bytes = 0};
  const TestLatLong lat_long = make_lat_long(Content::high_range, 64, 32, 5);
  const BakeOptions options = three_mips();
  ResultCache cache(where);
  const BakeResult first = cache.bake(lat_long.view(), options);
  CHECK(same_bake(first, bake(lat_long.view(), options)));
  CHECK(action(first.diagnostics, "specular") == "run");
  CHECK(action(first.diagnostics, "project") == "run");
  const BakeResult second = cache.bake(lat_long.view(), options);
  CHECK(same_bake(second, first));
  for (const char* pass : {"background", "background mips", "specular", "project", "irradiance"}) {
    INFO(pass);
    CHECK(action(second.diagnostics, pass) == "reuse");
  }
  BakeOptions smoother = options;
  smoother.irradiance->size = 4;
  const BakeResult third = cache.bake(lat_long.view(), smoother);
  CHECK(same_bake(third, bake(lat_long.view(), smoother)));
  CHECK(action(third.diagnostics, "irradiance") == "run");
  CHECK(action(third.diagnostics, "specular") == "reuse");
  smoother.specular->mips = 4;
  CHECK(same_bake(cache.bake(lat_long.view(), smoother), bake(lat_long.view(), smoother)));
  smoother.specular.reset();
  smoother.bands = 0;
  smoother.irradiance.reset();
  CHECK(same_bake(cache.bake(lat_long.view(), smoother), bake(lat_long.view(), smoother)));
}

TEST_CASE("cache: every option of a bake is part of some key", "[slow]") {
  ResultCache cache;
  const TestCubemap cubemap = make_cubemap(Content::special_values, 12, 3, 5);
  std::vector<BakeOptions> all(17, three_mips());
  all[1].background->size = 10;
  all[2].background.reset();
  all[3].background->mips = false;
  all[4].background->mip_filter = MipFilter::box;
  all[5].specular->roughness = {0.0, 0.5, 0.9};
  all[6].irradiance->size = 6;
  all[7].irradiance->method = IrradianceMethod::direct;
  all[8].bands = 5;
  all[9].brdf.reset();
  all[10].pixels.clamp = RadianceClamp{2.0F};
  all[11].specular->size = 10;
  all[12].pixels.negative = NegativePolicy::replace;
  all[13].bands = 0;
  all[13].irradiance.reset();
  all[14] = all[13];
  all[14].specular.reset();
  all[14].background.reset();
  all[15].irradiance->method = IrradianceMethod::harmonics;
  all[16].irradiance->rms_error = 1e-6;
  for (const int round : {0, 1}) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      INFO(round << ' ' << k);
      CHECK(same_bake(cache.bake(cubemap.view(), all[k]), bake(cubemap.view(), all[k])));
    }
  }
}

TEST_CASE("cache: mips that a plan leaves out are found in the whole chain, and those that it made are kept for it") {
  const TestCubemap cubemap = make_cubemap(Content::high_range, 24, 3, 5);
  BakeOptions options = three_mips();
  options.specular = PrefilterOptions{.size = 32, .roughness = {0.0, 0.3, 0.5, 0.8}};
  const Plan rest = plan(cubemap.view(), {.glossy = RoughnessRange{0.0, 0.5}}, options);
  REQUIRE(rest.options.specular->mips == 3);
  ResultCache whole_first;
  static_cast<void>(whole_first.bake(cubemap.view(), options));
  const BakeResult found = whole_first.bake(cubemap.view(), rest);
  CHECK(same_bake(found, bake(cubemap.view(), rest)));
  CHECK(action(found.diagnostics, "specular") == "reuse");
  ResultCache rest_first;
  static_cast<void>(rest_first.bake(cubemap.view(), rest));
  const BakeResult whole = rest_first.bake(cubemap.view(), options);
  CHECK(same_bake(whole, bake(cubemap.view(), options)));
  CHECK(pass_named(whole, "specular").reason == "3 of 4 mips found in memory, the others computed");
}

TEST_CASE("cache: a prefilter and a file's projection are found again") {
  const TemporaryDirectory directory;
  ResultCache cache({.folder = directory.file("cache"), .memory_bytes = 0});
  const TestLatLong lat_long = make_lat_long(Content::smooth, 32, 16, 5);
  const PrefilterOptions options{.size = 8, .mips = 2};
  const PrefilteredSpecular truth = prefilter_specular(lat_long.view(), options);
  for (const char* expected : {"none", "reuse"}) {
    const PrefilteredSpecular specular = cache.prefilter_specular(lat_long.view(), options);
    CHECK(same_bits(specular.cubemap, truth.cubemap));
    CHECK(action(specular.pixels, "cache") == expected);
    REQUIRE(specular.mips.size() == 2);
    CHECK(specular.mips[1].method == truth.mips[1].method);
    CHECK(same_bits(specular.mips[1].mean, truth.mips[1].mean));
  }
  const std::filesystem::path path = directory.file("sky.pfm");
  static_cast<void>(write_environment(path, lat_long.view()));
  for (const char* expected : {"none", "reuse"}) {
    const Projection projection = cache.project_file(path);
    CHECK(same_light(projection, project_file(path)));
    CHECK(action(projection.diagnostics, "cache") == expected);
  }
  TestLatLong other = lat_long;
  other.pixels[100] += 1.0F;
  static_cast<void>(write_environment(path, other.view()));
  CHECK(same_light(cache.project_file(path), project_file(path)));
}

TEST_CASE("cache: sky tables come back with the caller's own names and limits") {
  ResultCache cache;
  SkyTableOptions options{.heights = 4, .view_zeniths = 8, .sun_zeniths = 8, .sun_angles = 2, .orders = 2};
  Atmosphere air = earth();
  const SkyTables first = cache.precompute_sky(air, options);
  air.name = "elsewhere";
  options.memory_limit_bytes = std::uint64_t{1} << 31U;
  const SkyTables second = cache.precompute_sky(air, options);
  CHECK(cache.statistics().memory_hits == 1);
  CHECK(second.atmosphere == air);
  CHECK(second.options == options);
  CHECK(same_bytes<float>(first.scattering, second.scattering));
  CHECK(same_bytes<float>(first.single_mie, second.single_mie));
  CHECK(same_bytes<float>(first.transmittance, second.transmittance));
  CHECK(same_bytes<float>(first.irradiance, second.irradiance));
  CHECK(action({.passes = second.passes}, "cache") == "reuse");
  options.memory_limit_bytes = 1000;
  CHECK(thrown_by([&] { static_cast<void>(cache.precompute_sky(air, options)); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("cache: what is refused without a cache is refused with one, hit or not") {
  ResultCache cache;
  const TestCubemap cubemap = make_cubemap(Content::smooth, 8, 3, 5);
  BakeOptions options = three_mips();
  static_cast<void>(cache.bake(cubemap.view(), options));
  options.memory_limit_bytes = 1000;
  CHECK(thrown_by([&] { static_cast<void>(cache.bake(cubemap.view(), options)); }).code == ErrorCode::limit_exceeded);
  CHECK(thrown_by([&] { static_cast<void>(cache.project(cubemap.view(), {.bands = 0})); }).code ==
        ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { static_cast<void>(cache.project(CubemapView{})); }).code == ErrorCode::invalid_argument);
}

TEST_CASE("cache: a file that a memory limit refuses is refused, whoever read it before") {
  const TemporaryDirectory directory;
  const TestCubemap cubemap = make_cubemap(Content::high_range, 8, 3, 3);
  const std::filesystem::path file = directory.file("cube.exr");
  write_environment(file, cubemap.view());
  ResultCache cache({.folder = directory.file("cache")});
  static_cast<void>(cache.project_file(file));
  ReadOptions tight{.memory_limit_bytes = 100};
  CHECK(thrown_by([&] { static_cast<void>(project_file(file, tight)); }).code == ErrorCode::limit_exceeded);
  CHECK(thrown_by([&] { static_cast<void>(cache.project_file(file, tight)); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("cache: of huge and tiny radiance a background is the same, whatever was there before") {
  TestCubemap cubemap = make_cubemap(Content::smooth, 16, 3, 2);
  for (std::size_t k = 0; k < cubemap.pixels.size(); ++k) cubemap.pixels[k] = k % 2 == 0 ? 1.0F : 1e-30F;
  cubemap.pixels[77] = 3e38F;
  BakeOptions apart = three_mips();  // a background of another size than the chain's
  apart.specular->size = 8;
  apart.background->size = 16;
  const BakeResult truth = bake(cubemap.view(), three_mips());
  CHECK(truth.background->face(0, 0)[1] == 1e-30F);
  ResultCache cache;
  CHECK(same_bits(*cache.bake(cubemap.view(), three_mips()).background, *truth.background));
  CHECK(same_bits(*cache.bake(cubemap.view(), apart).background, *bake(cubemap.view(), apart).background));
  ResultCache the_other_way;
  CHECK(same_bits(*the_other_way.bake(cubemap.view(), apart).background, *bake(cubemap.view(), apart).background));
  CHECK(same_bits(*the_other_way.bake(cubemap.view(), three_mips()).background, *truth.background));
}

TEST_CASE("cache: memory stays within its bound") {
  ResultCache cache({.memory_bytes = 20'000});
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    static_cast<void>(cache.project(make_cubemap(Content::random, 4, 3, seed).view(), {.bands = 16}));
    CHECK(cache.statistics().memory_bytes <= 20'000);
  }
  CHECK(cache.statistics().memory_bytes > 10'000);
  static_cast<void>(cache.project(make_cubemap(Content::random, 4, 3, 19).view(), {.bands = 16}));
  CHECK(cache.statistics().memory_hits == 1);
  static_cast<void>(cache.project(make_cubemap(Content::random, 4, 3, 0).view(), {.bands = 16}));
  CHECK(cache.statistics().memory_hits == 1);
}

}  // namespace

// A chain is assembled from the mips that other chains left, and equals the computed chain.

namespace {

/// Returns options of a chain of the given roughness with default bounds.
PrefilterOptions chain(std::vector<double> roughness, int size = 32) {
  PrefilterOptions options{.size = size};
  options.roughness = std::move(roughness);
  return options;
}

bool same_mip(const MipRecord& a, const MipRecord& b) {
  return a.size == b.size && a.roughness == b.roughness && a.method == b.method && a.bands == b.bands &&
         a.bright_texels == b.bright_texels && a.error_estimate == b.error_estimate &&
         a.lobe_roughness == b.lobe_roughness && a.error_between == b.error_between && same_bits(a.mean, b.mean);
}

bool same_specular(const PrefilteredSpecular& a, const PrefilteredSpecular& b) {
  return same_bits(a.cubemap, b.cubemap) &&
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
  const auto babylon = [](int mips) { return chain(mip_roughness(RoughnessSchedule::babylon, mips, 32)); };
  const PrefilterOptions mixed = chain({0.0, 0.03, 0.3, 0.6});
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
      {"the method without near sums", four, with([](PrefilterOptions& o) { o.method = PrefilterMethod::spectral; }),
       3},
      {"another bound, at which every lobe looks", mixed, looser, 3},
      {"other pixels", four, with([](PrefilterOptions& o) { o.pixels.clamp = RadianceClamp{3.0F}; }), 4},
  };
}

void check(const EnvironmentView& view, const Change& change) {
  INFO(change.what);
  ResultCache cache;
  CHECK(same_specular(cache.prefilter_specular(view, change.before), prefilter_specular(view, change.before)));
  const PrefilteredSpecular truth = prefilter_specular(view, change.after);
  const std::uint64_t misses = cache.statistics().misses;
  const PrefilteredSpecular made = cache.prefilter_specular(view, change.after);
  CHECK(same_specular(made, truth));
  const std::uint64_t cleaned = change.before.pixels == change.after.pixels ? 0 : 1;
  const std::uint64_t new_mips = change.made;
  CHECK(cache.statistics().misses - misses == new_mips + cleaned);
  if (new_mips == 0) CHECK(reason_of_cache(made) == "found in memory");
  if (new_mips == truth.mips.size()) CHECK(reason_of_cache(made).empty());
  CHECK(same_specular(cache.prefilter_specular(view, change.after), truth));
}

TEST_CASE("chains: with other mips only what is missing is made, and every bit is as without a cache", "[slow]") {
  const TestLatLong lat_long = make_lat_long(Content::high_range, 64, 32, 5);
  const TestCubemap cubemap = make_cubemap(Content::high_range, 24, 3, 5);
  for (const Change& change : changes()) {
    check(lat_long.view(), change);
    check(cubemap.view(), change);
  }
}

TEST_CASE("chains: pixels that must be cleaned, and huge ones") {
  const TestLatLong lat_long = make_lat_long(Content::special_values, 64, 32, 5);
  TestCubemap huge = make_cubemap(Content::high_range, 24, 3, 5);
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
  const TemporaryDirectory directory;
  const CacheOptions where{.folder = directory.file("cache"), .memory_bytes = 0};
  const TestCubemap cubemap = make_cubemap(Content::high_range, 24, 3, 5);
  const PrefilterOptions options = chain({0.0, 0.3, 0.4, 0.5, 0.8});
  const PrefilteredSpecular truth = ResultCache(where).prefilter_specular(cubemap.view(), options);
  constexpr std::uintmax_t kLastMip = 72 * 2 * 2;
  std::uintmax_t beside = std::numeric_limits<std::uintmax_t>::max();  // bytes other than texels: energies, record
  for (const auto& entry : std::filesystem::directory_iterator(where.folder)) {
    if (entry.file_size() > kLastMip) beside = std::min(beside, entry.file_size() - kLastMip);
  }
  const auto remove_mip = [&](int size) {
    const std::uintmax_t bytes = beside + static_cast<std::uintmax_t>(72 * size * size);
    int removed = 0;
    for (const auto& entry : std::filesystem::directory_iterator(where.folder)) {
      if (entry.file_size() + 50 < bytes || entry.file_size() > bytes + 50) continue;
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
  const TestLatLong lat_long = make_lat_long(Content::special_values, 64, 32, 5);
  BakeOptions baking{.specular = chain({0.0, 0.3, 0.5, 0.8})};
  baking.pixels.negative = NegativePolicy::replace;
  baking.irradiance.reset();
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

}  // namespace

}  // namespace welkin::test
