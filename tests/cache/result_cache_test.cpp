// What comes out of a cache is what would have been computed.
#include "welkin/result_cache.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_writer.h"
#include "welkin/harmonic_transforms.h"

namespace {

using namespace welkin;
using test::Content;

bool same_light(const Projection& a, const Projection& b) {
  return test::same_bytes(a.radiance.coefficients(), b.radiance.coefficients()) &&
         test::same_bits(a.diagnostics.flux, b.diagnostics.flux) &&
         test::same_bits(a.diagnostics.flux_before_clamp, b.diagnostics.flux_before_clamp) &&
         test::same_bits(a.diagnostics.error_estimate, b.diagnostics.error_estimate) &&
         a.diagnostics.texels == b.diagnostics.texels && a.diagnostics.texels_clamped == b.diagnostics.texels_clamped &&
         a.diagnostics.nans_replaced == b.diagnostics.nans_replaced &&
         a.diagnostics.infinities_replaced == b.diagnostics.infinities_replaced &&
         a.diagnostics.negatives_replaced == b.diagnostics.negatives_replaced;
}

bool same_chain(const CubemapChain& a, const CubemapChain& b) {
  return a.size() == b.size() && a.levels() == b.levels() &&
         (a.levels() == 0 || test::same_bytes<float>({a.face(0, 0), a.bytes() / 4}, {b.face(0, 0), b.bytes() / 4}));
}

bool same_bake(const BakeResult& a, const BakeResult& b) {
  return same_chain(a.background, b.background) && a.specular.has_value() == b.specular.has_value() &&
         (!a.specular || same_chain(a.specular->cubemap, b.specular->cubemap)) &&
         test::same_bits(a.irradiance, b.irradiance) && a.radiance.has_value() == b.radiance.has_value() &&
         (!a.radiance || test::same_bytes(a.radiance->coefficients(), b.radiance->coefficients())) &&
         (a.brdf == nullptr) == (b.brdf == nullptr) && a.peak_bytes == b.peak_bytes &&
         same_light({SphericalHarmonics(), a.diagnostics}, {SphericalHarmonics(), b.diagnostics});
}

std::string action(const ProjectionDiagnostics& diagnostics, const std::string& pass) {
  for (const PassRecord& record : diagnostics.passes) {
    if (record.name == pass) return record.action;
  }
  return "none";
}

BakeOptions small_bake() {
  BakeOptions options;
  options.specular = PrefilterOptions{.size = 16, .mips = 3};
  options.irradiance_size = 8;
  options.brdf = BrdfTableOptions{8, 8};
  return options;
}

TEST_CASE("cache: a projection is computed once, in memory and on disk, and never for other options") {
  const test::TemporaryDirectory directory;
  const CacheOptions options{.folder = directory.file("cache")};
  const test::TestLatLong lat_long = test::make_lat_long(Content::special_values, 64, 32, 3);
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 20, 3, 3);
  ProjectionOptions clamped{.bands = 4};
  clamped.clamp = RadianceClamp{10.0F};
  ResultCache cache(options);
  for (const ProjectionOptions& each : {ProjectionOptions{}, clamped}) {
    CHECK(test::same_bits(cache.project(lat_long.view(), each), project(lat_long.view(), each)));
    CHECK(test::same_bits(cache.project(cubemap.view(), each), project(cubemap.view(), each)));
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
  test::TestCubemap cubemap = test::make_cubemap(Content::random, 70, 3, 9);
  const LightChange keep{.keep_faces = true};
  CHECK(same_light(cache.project(cubemap.view(), {}, keep), project(cubemap.view())));
  cubemap.pixels[cubemap.pixels.size() / 2] += 3.0F;
  const Projection now = cache.project(cubemap.view(), {}, keep);
  CHECK(same_light(now, project(cubemap.view())));
  CHECK(now.diagnostics.passes.front().reason == "5 of 6 faces were projected before");
  // Two projections and two faces were not there, and six faces at first.
  CHECK(cache.statistics().misses == 1 + 6 + 1 + 1);
  CHECK(cache.statistics().memory_hits == 5);
}

TEST_CASE("cache: exposure is a factor, rotation a transform, and no pixel is projected for them") {
  ResultCache cache;
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 16, 3, 9);
  const Projection plain = cache.project(cubemap.view(), {.bands = 5});
  const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, 3.0)));
  const Projection light = cache.project(cubemap.view(), {.bands = 5}, {.exposure = 4.0, .rotation = turn});
  CHECK(cache.statistics().memory_hits == 1);
  CHECK(action(light.diagnostics, "project") == "reuse");
  CHECK(action(light.diagnostics, "exposure") == "run");
  CHECK(action(light.diagnostics, "rotation") == "run");
  const SphericalHarmonics expected = rotate(scale(plain.radiance, glm::dvec3(4.0)), turn);
  CHECK(test::same_bytes(light.radiance.coefficients(), expected.coefficients()));
  // A power of two: what the exposed pixels themselves give, bit for bit.
  test::TestCubemap exposed = cubemap;
  for (float& value : exposed.pixels) value *= 4.0F;
  CHECK(same_light(changed(plain, {.exposure = 4.0}), project(exposed.view(), {.bands = 5})));
  for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    CHECK(test::thrown_by([&] { static_cast<void>(changed(plain, {.exposure = wrong})); }).code ==
          ErrorCode::invalid_argument);
  }
}

TEST_CASE("cache: a bake is what it is without, and only what is missing is baked") {
  const test::TemporaryDirectory directory;
  const CacheOptions where{.folder = directory.file("cache"), .memory_bytes = 0};
  const test::TestLatLong lat_long = test::make_lat_long(Content::high_range, 64, 32, 5);
  const BakeOptions options = small_bake();
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
  smoother.irradiance_size = 4;
  const BakeResult third = cache.bake(lat_long.view(), smoother);
  CHECK(same_bake(third, bake(lat_long.view(), smoother)));
  CHECK(action(third.diagnostics, "irradiance") == "run");
  CHECK(action(third.diagnostics, "specular") == "reuse");
  smoother.specular->mips = 4;
  CHECK(same_bake(cache.bake(lat_long.view(), smoother), bake(lat_long.view(), smoother)));
  smoother.specular.reset();
  smoother.bands = 0;
  smoother.irradiance_size = 0;
  CHECK(same_bake(cache.bake(lat_long.view(), smoother), bake(lat_long.view(), smoother)));
}

TEST_CASE("cache: every option of a bake is part of some key") {
  ResultCache cache;
  const test::TestCubemap cubemap = test::make_cubemap(Content::special_values, 12, 3, 5);
  std::vector<BakeOptions> all(15, small_bake());
  all[1].background_size = 10;
  all[2].background = false;
  all[3].background_mips = false;
  all[4].mip_filter = MipFilter::box;
  all[5].specular->roughness = {0.0, 0.5, 0.9};
  all[6].irradiance_size = 6;
  all[7].irradiance_method = IrradianceMethod::direct;
  all[8].bands = 5;
  all[9].brdf.reset();
  all[10].pixels.clamp = RadianceClamp{2.0F};
  all[11].specular->size = 10;
  all[12].pixels.negative = NegativePolicy::replace;
  all[13].bands = all[13].irradiance_size = 0;
  all[13].flux = false;
  all[14] = all[13];
  all[14].specular.reset();
  all[14].background = false;
  for (const int round : {0, 1}) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      INFO(round << ' ' << k);
      CHECK(same_bake(cache.bake(cubemap.view(), all[k]), bake(cubemap.view(), all[k])));
    }
  }
}

TEST_CASE("cache: irradiance from the first of many bands is not taken for that from a few") {
  const test::TestLatLong lat_long = test::make_lat_long(Content::high_range, 32, 16, 5);
  BakeOptions options = small_bake();
  options.bands = 2;
  ResultCache cache;
  static_cast<void>(cache.bake(lat_long.view(), options));
  options.projected_bands = 9;  // rounded otherwise: in double, so that floats seldom show it
  const std::uint64_t misses = cache.statistics().misses;
  CHECK(same_bake(cache.bake(lat_long.view(), options), bake(lat_long.view(), options)));
  CHECK(cache.statistics().misses == misses + 2);
}

TEST_CASE("cache: a prefilter and a file's projection are found again") {
  const test::TemporaryDirectory directory;
  ResultCache cache({.folder = directory.file("cache"), .memory_bytes = 0});
  const test::TestLatLong lat_long = test::make_lat_long(Content::smooth, 32, 16, 5);
  const PrefilterOptions options{.size = 8, .mips = 2};
  const PrefilteredSpecular truth = prefilter_specular(lat_long.view(), options);
  for (const char* expected : {"none", "reuse"}) {
    const PrefilteredSpecular specular = cache.prefilter_specular(lat_long.view(), options);
    CHECK(same_chain(specular.cubemap, truth.cubemap));
    CHECK(action(specular.pixels, "cache") == expected);
    REQUIRE(specular.mips.size() == 2);
    CHECK(specular.mips[1].method == truth.mips[1].method);
    CHECK(test::same_bits(specular.mips[1].mean, truth.mips[1].mean));
  }
  const std::filesystem::path path = directory.file("sky.pfm");
  static_cast<void>(write_environment(path, lat_long.view()));
  for (const char* expected : {"none", "reuse"}) {
    const Projection projection = cache.project_file(path);
    CHECK(same_light(projection, project_file(path)));
    CHECK(action(projection.diagnostics, "cache") == expected);
  }
  test::TestLatLong other = lat_long;
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
  CHECK(test::same_bytes<float>(first.scattering, second.scattering));
  CHECK(test::same_bytes<float>(first.single_mie, second.single_mie));
  CHECK(test::same_bytes<float>(first.transmittance, second.transmittance));
  CHECK(test::same_bytes<float>(first.irradiance, second.irradiance));
  CHECK(action({.passes = second.passes}, "cache") == "reuse");
  options.memory_limit_bytes = 1000;
  CHECK(test::thrown_by([&] { static_cast<void>(cache.precompute_sky(air, options)); }).code ==
        ErrorCode::limit_exceeded);
}

TEST_CASE("cache: what is refused without a cache is refused with one, hit or not") {
  ResultCache cache;
  const test::TestCubemap cubemap = test::make_cubemap(Content::smooth, 8, 3, 5);
  BakeOptions options = small_bake();
  static_cast<void>(cache.bake(cubemap.view(), options));
  options.memory_limit_bytes = 1000;
  CHECK(test::thrown_by([&] { static_cast<void>(cache.bake(cubemap.view(), options)); }).code ==
        ErrorCode::limit_exceeded);
  CHECK(test::thrown_by([&] { static_cast<void>(cache.project(cubemap.view(), {.bands = 0})); }).code ==
        ErrorCode::invalid_argument);
  CHECK(test::thrown_by([&] { static_cast<void>(cache.project(CubemapView{})); }).code == ErrorCode::invalid_argument);
}

TEST_CASE("cache: a file that a memory limit refuses is refused, whoever read it before") {
  const test::TemporaryDirectory directory;
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 8, 3, 3);
  const std::filesystem::path file = directory.file("cube.exr");
  write_environment(file, cubemap.view());
  ResultCache cache({.folder = directory.file("cache")});
  static_cast<void>(cache.project_file(file));
  ReadOptions tight;
  tight.memory_limit_bytes = 100;
  CHECK(test::thrown_by([&] { static_cast<void>(project_file(file, tight)); }).code == ErrorCode::limit_exceeded);
  CHECK(test::thrown_by([&] { static_cast<void>(cache.project_file(file, tight)); }).code == ErrorCode::limit_exceeded);
}

TEST_CASE("cache: a change that is none is refused before anything is computed") {
  const test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 8, 3, 3);
  ResultCache cache;
  for (const LightChange& change : {LightChange{.exposure = -1.0}, LightChange{.rotation = {0.0, 0.0, 0.0, 0.0}}}) {
    CHECK_THROWS_AS(cache.project(cubemap.view(), {}, change), Error);
    CHECK(cache.statistics().misses == 0);
  }
}

TEST_CASE("cache: what was found on the way to a projection is not told again when the projection is found") {
  test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 8, 3, 3);
  ResultCache cache;
  static_cast<void>(cache.project(cubemap.view(), {}, {.keep_faces = true}));
  cubemap.pixels[0] += 1.0F;
  CHECK(action(cache.project(cubemap.view(), {}, {.keep_faces = true}).diagnostics, "faces") == "reuse");
  CHECK(action(cache.project(cubemap.view()).diagnostics, "faces") == "none");
}

TEST_CASE("cache: of huge and tiny radiance a background is the same, whatever was there before") {
  test::TestCubemap cubemap = test::make_cubemap(Content::smooth, 16, 3, 2);
  for (std::size_t k = 0; k < cubemap.pixels.size(); ++k) cubemap.pixels[k] = k % 2 == 0 ? 1.0F : 1e-30F;
  cubemap.pixels[77] = 3e38F;
  BakeOptions apart = small_bake();  // a background of another size than the chain's
  apart.specular->size = 8;
  apart.background_size = 16;
  const BakeResult truth = bake(cubemap.view(), small_bake());
  CHECK(truth.background.face(0, 0)[1] == 1e-30F);
  ResultCache cache;
  CHECK(same_chain(cache.bake(cubemap.view(), small_bake()).background, truth.background));
  CHECK(same_chain(cache.bake(cubemap.view(), apart).background, bake(cubemap.view(), apart).background));
  ResultCache the_other_way;
  CHECK(same_chain(the_other_way.bake(cubemap.view(), apart).background, bake(cubemap.view(), apart).background));
  CHECK(same_chain(the_other_way.bake(cubemap.view(), small_bake()).background, truth.background));
}

TEST_CASE("cache: memory stays within its bound") {
  ResultCache cache({.memory_bytes = 20'000});
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    static_cast<void>(cache.project(test::make_cubemap(Content::random, 4, 3, seed).view(), {.bands = 16}));
    CHECK(cache.statistics().memory_bytes <= 20'000);
  }
  CHECK(cache.statistics().memory_bytes > 10'000);
  static_cast<void>(cache.project(test::make_cubemap(Content::random, 4, 3, 19).view(), {.bands = 16}));
  CHECK(cache.statistics().memory_hits == 1);
  static_cast<void>(cache.project(test::make_cubemap(Content::random, 4, 3, 0).view(), {.bands = 16}));
  CHECK(cache.statistics().memory_hits == 1);
}

}  // namespace
