// Sources of bakes: files, with the results that they store, and skies.
#include "bake/baked.h"
#include "places.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/images.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/result_cache.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

namespace {

constexpr int kSize = 16;

/// Levels that are not mips of each other.
Cubemap odd_chain() {
  Cubemap chain(kSize, full_chain_levels(kSize));
  for (int level = 0; level < chain.levels(); ++level) {
    const TestCubemap pixels =
        make_cubemap(Content::smooth, chain.level_size(level), 3, 3U + static_cast<unsigned>(level));
    std::memcpy(chain.face(level, 0), pixels.pixels.data(), pixels.pixels.size() * sizeof(float));
  }
  return chain;
}

BakeOptions whole_bake() {
  BakeOptions options = small_bake(kSize);
  options.background->size = kSize;
  return options;
}

std::filesystem::path write_env(const TemporaryDirectory& directory) {
  const Cubemap chain = odd_chain();
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

// Promise: baking a file equals baking its content; an .env file keeps its polynomial.

TEST_CASE("A file bakes as its pixels do", "[bake][codec]") {
  const TemporaryDirectory directory;
  const TestLatLong image = make_lat_long(Content::high_range, 64, 32, 3);
  write_environment(directory.file("sky.pfm"), image.view());
  std::vector<double> reports;
  const Control control{{}, [&](double done) { reports.push_back(done); }};
  BakeResult found = bake_file(directory.file("sky.pfm"), {}, small_bake(), control);
  REQUIRE(!reports.empty());
  CHECK(std::is_sorted(reports.begin(), reports.end()));
  CHECK(reports.back() == 1.0);
  REQUIRE(!found.diagnostics.passes.empty());
  CHECK(found.diagnostics.passes.front().name == "read");
  CHECK(found.diagnostics.passes.front().reason.find("PFM") != std::string::npos);
  CHECK(!found.stored_polynomial);
  found.diagnostics.passes.erase(found.diagnostics.passes.begin());
  CHECK(same_bits(found, bake(image.view(), small_bake())));
}

TEST_CASE("An .env file is baked in our axes and keeps its polynomial", "[bake][codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = write_env(directory);

  BakeResult found = bake_file(path, {}, small_bake());
  REQUIRE(found.stored_polynomial);
  CHECK(found.stored_polynomial->xx == glm::dvec3(41.0, 42.0, 43.0));
  CHECK(pass_named(found, "project").action == PassAction::reuse);
  CHECK(found.diagnostics.passes.front().name == "read");
  // The coefficients and the irradiance come from the polynomial as well.
  const Projection stored = project_file(path);
  REQUIRE(found.radiance);
  CHECK(same_bytes<glm::dvec3>(found.radiance->coefficients(), stored.radiance.coefficients()));
  CHECK(same_bits(*found.irradiance, irradiance_cubemap(irradiance_from_radiance(stored.radiance), 5)));
  CHECK(same_bits(found.diagnostics.total_radiance, stored.diagnostics.total_radiance));
  CHECK(found.diagnostics.texels == 6 * 16 * 16);

  // The polynomial has no more bands. RGBD rounds to a few parts per thousand: the same image in the same orientation.
  BakeOptions more = small_bake();
  more.bands = 4;
  const BakeResult projected = bake_file(path, {}, more);
  const SphericalHarmonics radiance = project(odd_chain().view(0)).radiance;
  CHECK(pass_named(projected, "project").action == PassAction::run);
  CHECK(projected.stored_polynomial);
  for (std::size_t k = 0; k < 9; ++k) {
    INFO("coefficient " << k);
    CHECK(glm::length(projected.radiance->coefficients()[k] - radiance.coefficients()[k]) < 0.01);
  }
}

TEST_CASE("Files that cannot be baked say why", "[bake][codec]") {
  const TemporaryDirectory directory;
  CHECK(thrown_by([&] { static_cast<void>(bake_file(directory.file("none.hdr"))); }).code == ErrorCode::file_access);
  write_bytes(directory.file("text.hdr"), {'n', 'o'});
  CHECK(thrown_by([&] { static_cast<void>(bake_file(directory.file("text.hdr"))); }).says("text.hdr"));
  const TestLatLong image = make_lat_long(Content::nan_bearing, 64, 32, 3);
  write_environment(directory.file("nan.pfm"), image.view());
  BakeOptions options = small_bake();
  options.pixels.nan = NonFinitePolicy::reject;
  const ThrownError error = thrown_by([&] { static_cast<void>(bake_file(directory.file("nan.pfm"), {}, options)); });
  CHECK(error.code == ErrorCode::rejected_pixel);
  CHECK(error.says("nan.pfm"));
  CHECK(error.says("row"));
}

// Promise: results stored in a file are taken unchanged and not recomputed; pixels that no pass needs are not even
// read.

TEST_CASE("Of an .env whose light alone is used only the manifest is read", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = inspect_stored_environment(write_env(directory));
  CHECK(file.has_polynomial);
  CHECK(file.content == LevelContent::reflections);
  CHECK(file.levels == 5);
  const Plan light = plan(file, {.glossy = std::nullopt, .background = false}, whole_bake());
  CHECK(light.pass("read").action == PassAction::skip);
  CHECK(light.pass("project").action == PassAction::reuse);
  const BakeResult result = bake(file, light);
  REQUIRE(result.radiance);
  CHECK(same_bytes<glm::dvec3>(result.radiance->coefficients(), project_file(file.input).radiance.coefficients()));
  CHECK(same_bits(*result.irradiance, *bake_file(file.input, {}, whole_bake()).irradiance));
  REQUIRE(result.stored_polynomial);
  CHECK(result.stored_polynomial->xx == glm::dvec3(41.0, 42.0, 43.0));
}

TEST_CASE("The prefiltered chain of an .env is the specular cubemap", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = inspect_stored_environment(write_env(directory));
  const Cubemap stored = mirrored_x(read_babylon_environment(file.input).specular);
  for (const RoughnessRange range : {RoughnessRange{0.0, 1.0}, RoughnessRange{0.6, 1.0}}) {
    const Plan planned = plan(file, {.glossy = range}, whole_bake());
    INFO(plan_text(planned));
    CHECK(planned.pass("specular").action == PassAction::reuse);
    const BakeResult result = bake(file, planned);
    REQUIRE(result.specular);
    const int first = planned.first_stored_mip;
    CHECK((first > 0) == (range.minimum > 0.0));
    CHECK(result.specular->cubemap.levels() == planned.stored_mips);
    for (int level = 0; level < planned.stored_mips; ++level) {
      CHECK(same_bytes(level_values(result.specular->cubemap, level), level_values(stored, first + level)));
      CHECK(result.specular->mips[static_cast<std::size_t>(level)].roughness ==
            file.roughness[static_cast<std::size_t>(first + level)]);
    }
    CHECK(pass_named(result, "specular").action == PassAction::reuse);
    CHECK(pass_named(result, "project").action == PassAction::reuse);
    CHECK(same_bytes(level_values(*result.background, 0), level_values(stored, 0)));
  }
}

TEST_CASE("What a file carries is computed all the same if that is asked for", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = inspect_stored_environment(write_env(directory));
  const Plan planned = plan(file, {.stored_results = false}, whole_bake());
  for (const char* pass : {"read", "specular", "project"}) CHECK(planned.pass(pass).action == PassAction::run);
  const BakeResult result = bake(file, planned);
  const Cubemap stored = mirrored_x(read_babylon_environment(file.input).specular);
  const BakeResult pixels = bake(stored.view(0), whole_bake());
  CHECK(same_bytes<glm::dvec3>(result.radiance->coefficients(), pixels.radiance->coefficients()));
  CHECK(same_bits(result.specular->cubemap, pixels.specular->cubemap));
  // its stored chain is of GGX
  BakeOptions sheen = whole_bake();
  sheen.specular->roughness = {0.5, 0.8};
  sheen.specular->mips = 2;
  sheen.specular->lobe = LobeFamily::charlie;
  CHECK(plan(file, {}, sheen).pass("specular").action == PassAction::run);
  // stored results were made without a clamp
  BakeOptions clamped = whole_bake();
  clamped.pixels.clamp = RadianceClamp{.maximum = 1.0F};
  CHECK(plan(file, {}, clamped).pass("project").action == PassAction::run);
}

TEST_CASE("A KTX2's levels are the background's mips", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = inspect_stored_environment(write_ktx2(directory, ""));
  CHECK(file.content == LevelContent::radiance);
  const SceneNeeds needs{.glossy = std::nullopt};
  const Plan planned = plan(file, needs, whole_bake());
  CHECK(planned.pass("background mips").action == PassAction::reuse);
  const BakeResult result = bake(file, planned);
  CHECK(same_bits(*result.background, odd_chain()));
  CHECK(pass_named(result, "background mips").action == PassAction::reuse);
  BakeOptions smaller = whole_bake();
  smaller.background->size = 8;
  CHECK(plan(file, needs, smaller).pass("background mips").action == PassAction::run);
}

TEST_CASE("A KTX2 that speaks of roughness holds reflections", "[plan][codec]") {
  const TemporaryDirectory directory;
  const StoredEnvironment file = inspect_stored_environment(write_ktx2(directory, "0 0.25 0.5 0.75 1"));
  CHECK(file.content == LevelContent::reflections);
  CHECK(file.roughness == std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0});
  const Plan planned = plan(file, {.glossy = RoughnessRange{0.3, 0.6}, .background = false}, whole_bake());
  CHECK(planned.first_stored_mip == 1);
  CHECK(planned.stored_mips == 3);
  const BakeResult result = bake(file, planned);
  CHECK(same_bytes(level_values(result.specular->cubemap, 0), level_values(odd_chain(), 1)));
  CHECK(plan(file, {}, whole_bake()).pass("background mips").action == PassAction::run);
}

TEST_CASE("A cached bake of a file is the bake of the file, whatever was baked of its pixels before", "[plan][codec]") {
  const TemporaryDirectory directory;
  for (const auto& path : {write_env(directory), write_ktx2(directory, "")}) {
    const StoredEnvironment file = inspect_stored_environment(path);
    ResultCache cache;
    for (const bool stored_results : {true, false, true, false}) {
      INFO(path << (stored_results ? ", with" : ", without") << " what it carries");
      const Plan planned = plan(file, {.stored_results = stored_results}, whole_bake());
      const BakeResult expected = bake(file, planned);
      const BakeResult found = cache.bake(file, planned);
      CHECK(same_bits(*found.background, *expected.background));
      CHECK(same_bits(found.specular->cubemap, expected.specular->cubemap));
      CHECK(same_bits(*found.irradiance, *expected.irradiance));
      CHECK(same_bytes<glm::dvec3>(found.radiance->coefficients(), expected.radiance->coefficients()));
      CHECK(found.stored_polynomial.has_value() == expected.stored_polynomial.has_value());
      CHECK(found.diagnostics.passes.front().name == "read");
      CHECK(pass_named(found, "hash").action == PassAction::run);
    }
    const BakeResult again = cache.bake(file, plan(file, {.stored_results = false}, whole_bake()));
    for (const char* pass : {"specular", "background", "background mips", "project", "irradiance"}) {
      INFO(pass);
      CHECK(pass_named(again, pass).action == PassAction::reuse);
    }
    CHECK(pass_named(again, "sanitize").action == PassAction::skip);
  }
}

TEST_CASE("A cached plan leaves out what it left out before, and says why", "[plan]") {
  const TestLatLong image = make_lat_long(Content::high_range, 64, 32, 3);
  const Plan planned = plan(image.view(), {.glossy = std::nullopt, .background = false}, whole_bake());
  ResultCache cache;
  for (int round = 0; round < 2; ++round) {
    const BakeResult found = cache.bake(image.view(), planned);
    CHECK(pass_named(found, "specular").reason == planned.pass("specular").reason);
    CHECK(pass_named(found, "project").action == (round == 0 ? PassAction::run : PassAction::reuse));
  }
  const TestLatLong other = make_lat_long(Content::high_range, 32, 16, 3);
  CHECK(thrown_by([&] { static_cast<void>(cache.bake(other.view(), planned)); }).says("plan again"));
}

TEST_CASE("A DDS cannot say what its levels are, a caller can", "[plan][codec]") {
  const TemporaryFile path("sky.dds");
  write_texture(path, odd_chain().views(), {.format = TexelFormat::rgba32f});
  const SceneNeeds needs{.glossy = std::nullopt};
  const auto action = [&](LevelContent content) {
    return plan(inspect_stored_environment(path, {}, content), needs, whole_bake()).pass("background mips").action;
  };
  CHECK(action(LevelContent::automatic) == PassAction::run);
  CHECK(action(LevelContent::radiance) == PassAction::reuse);
  CHECK(action(LevelContent::reflections) == PassAction::run);
}

TEST_CASE("A bake that reads no pixel keeps its memory limit too", "[plan][codec]") {
  const TestLatLong image = make_lat_long(Content::high_range, 32, 16, 7);
  const TemporaryFile file("sky.hdr");
  write_environment(file, image.view());
  const SceneNeeds needs{.glossy = std::nullopt, .background = false};
  BakeOptions options;
  options.irradiance->size = 512;
  options.irradiance->method = IrradianceMethod::harmonics;
  options.memory_limit_bytes = 1'000'000;
  const StoredEnvironment stored = inspect_stored_environment(file);
  const Plan planned = plan(stored, needs, options);
  REQUIRE(planned.streams);
  CHECK(thrown_by([&] { static_cast<void>(bake(stored, planned)); }).code == ErrorCode::limit_exceeded);
}

// Promise: a bake of a sky makes only the tables and the light that the scene needs and the planet has.

namespace {

SkyBakeOptions small_sky() {
  SkyBakeOptions options{.tables = tiny_tables()};
  options.tables.orders = 2;
  options.curve.nodes = 12;
  options.curve.projection.zeniths = options.curve.projection.azimuths = 4;
  options.harmonics.zeniths = options.harmonics.azimuths = 4;
  options.specular = PrefilterOptions{.size = 8, .roughness = {0.0, 0.3, 0.6, 1.0}};
  options.background_size = 8;
  options.brdf = BrdfTableOptions{.width = 4, .height = 4};
  return options;
}

PassAction action(const SkyPlan& plan, const std::string& pass) { return plan.pass(pass).action; }

}  // namespace

TEST_CASE("A panorama whose light alone is used is projected while it is read", "[plan][codec]") {
  const TemporaryDirectory directory;
  const TestLatLong image = make_lat_long(Content::high_range, 64, 32, 3);
  write_environment(directory.file("sky.pfm"), image.view());
  const StoredEnvironment file = inspect_stored_environment(directory.file("sky.pfm"));
  const BakeResult whole = bake(image.view(), whole_bake());
  const Plan light = plan(file, {.irradiance_cubemap = false, .glossy = std::nullopt, .background = false});
  CHECK(light.streams);
  CHECK(light.pass("read").bytes == 0);
  CHECK(same_bytes<glm::dvec3>(bake(file, light).radiance->coefficients(), whole.radiance->coefficients()));
  const Plan all = plan(file, {}, whole_bake());
  CHECK(!all.streams);
  BakeResult baked = bake(file, all);
  baked.diagnostics.passes.erase(baked.diagnostics.passes.begin());
  CHECK(same_bits(baked.specular->cubemap, whole.specular->cubemap));
  CHECK(same_bits(*baked.background, *whole.background));
  CHECK(same_bits(*baked.irradiance, *whole.irradiance));
  CHECK(thrown_by([&] { static_cast<void>(bake(file, plan(image.view(), {}))); }).says("plan again"));
}

TEST_CASE("What a planet has not is planned without", "[plan][sky]") {
  Atmosphere bare = without_aerosol(earth());
  bare.absorbers.clear();
  const SkyPlan planned = plan(bare, {}, small_sky());
  CHECK(action(planned, "aerosol") == PassAction::skip);
  CHECK(action(planned, "absorbers") == PassAction::skip);
  const SkyPlan all = plan(earth(), {}, small_sky());
  CHECK(action(all, "aerosol") == PassAction::run);
  CHECK(action(all, "absorbers") == PassAction::run);
  CHECK(5 * planned.pass("scattering").bytes < 3 * all.pass("scattering").bytes);
  SkyBakeOptions once = small_sky();
  once.tables.orders = 1;
  const SkyPlan single = plan(earth(), {}, once);
  CHECK(single.pass("orders").reason.find("one order has no multiple scattering") != std::string::npos);
}

TEST_CASE("Matter without any effect is as good as none, bit for bit", "[plan][sky]") {
  Atmosphere bare = without_aerosol(earth());
  bare.absorbers.clear();
  Atmosphere idle = bare;
  idle.aerosol.density = exponential_profile(1200.0);
  idle.aerosol.scattering_per_m = {0.0, 0.0, 0.0};
  idle.absorbers.push_back({tent_profile(25'000.0, 15'000.0), {}, {0.0, 0.0, 0.0}});
  const SkyTables a = precompute_sky(bare, small_sky().tables);
  const SkyTables b = precompute_sky(idle, small_sky().tables);
  CHECK(a.single_mie.empty());
  CHECK(b.single_mie.empty());
  CHECK(same_bytes<float>(a.scattering, b.scattering));
  CHECK(same_bytes<float>(a.irradiance, b.irradiance));
  CHECK(same_bytes<float>(a.transmittance, b.transmittance));
}

TEST_CASE("A planned sky has the bits of the direct calls", "[plan][sky]") {
  const glm::dvec3 sun = sun_direction(20.0, 40.0);
  const SkyBakeOptions options = small_sky();
  const SkyBake whole = bake(plan(earth(), {}, options), sun);
  const SkyPlan rough =
      plan(earth(), {.glossy = RoughnessRange{0.6, 1.0}, .brdf_table = false, .sun_moves = false}, options);
  const SkyBake still = bake(rough, sun);
  CHECK(same_bytes<float>(whole.tables->scattering, still.tables->scattering));
  const SkyView view(whole.tables, 0.0);
  REQUIRE(still.radiance);
  CHECK(same_bytes<glm::dvec3>(still.radiance->coefficients(),
                               SkyProjector(view, options.harmonics).project(sun).coefficients()));
  REQUIRE(whole.curve);
  const SphericalHarmonics on_curve = SkyCurve(view, options.curve).at(sun);
  CHECK(same_bytes<glm::dvec3>(whole.curve->at(sun).coefficients(), on_curve.coefficients()));
  REQUIRE(still.specular);
  CHECK(rough.options.specular->size == 2);  // of a sky of the size that the whole chain uses
  CHECK(rough.options.specular->roughness == std::vector<double>{0.6, 1.0});
  CHECK(rough.pass("specular").reason.find("omitted: 2 sharper, 0 rougher") != std::string::npos);
  CHECK(same_bits(still.specular->cubemap,
                  prefilter_specular(sky_cubemap(view, sun, 8).view(), *rough.options.specular).cubemap));
  CHECK(same_bits(*whole.background, *still.background));
  CHECK(!still.brdf);
  CHECK(whole.sun.irradiance == still.sun.irradiance);
}

namespace {

/// Returns the peak number of bytes that `made` takes.
template <class Make>
std::uint64_t peak_of(const Make& made) {
  const HeapWatch heap;
  const auto result = made();
  static_cast<void>(result);
  return static_cast<std::uint64_t>(std::max(0L, heap.peak_bytes()));
}

}  // namespace

// A view of compact tables has four azimuths where the tables have one; a quadrature and the solver once counted as
// nothing.
TEST_CASE("A sky's plan bounds what its passes take, and not far above it", "[plan][sky][truth]") {
  for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
    SkyBakeOptions options;
    options.tables = {.layout = layout, .heights = 12, .sun_angles = layout == ScatteringLayout::full ? 8 : 3};
    options.tables.orders = 2;
    options.specular.reset();
    const SkyPlan moving = plan(earth(), {.glossy = std::nullopt}, options);
    const SkyPlan still = plan(earth(), {.glossy = std::nullopt, .sun_moves = false}, options);
    const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth(), options.tables));
    const SkyView view(tables, 0.0);
    const glm::dvec3 sun = sun_direction(20.0, 40.0);
    const SkyCurve curve(view, options.curve);
    const auto sky = [&] { return SkyView(tables, 0.0); };
    const auto light = [&] { return SkyProjector(view, options.harmonics).project(sun); };
    const auto over_suns = [&] { return SkyCurve(view, options.curve); };
    static_cast<void>(light());  // computes tables that a process makes once
    const auto check = [](std::uint64_t planned, std::uint64_t taken) {
      CAPTURE(planned, taken);
      CHECK(planned >= taken);
      if (taken > 0) CHECK(2 * planned < 3 * taken);  // sanitizers have their own heap
    };
    CAPTURE(static_cast<int>(layout));
    check(moving.pass("view").bytes, peak_of(sky));
    check(still.pass("project").bytes, peak_of(light));
    check(moving.pass("curve").bytes, peak_of(over_suns));
    CHECK(moving.pass("orders").bytes + moving.pass("scattering").bytes + moving.pass("transmittance").bytes >=
          peak_of([&] { return precompute_sky(earth(), options.tables); }));
    const std::uint64_t background = moving.pass("background").bytes;
    CHECK(moving.result_bytes >= tables->bytes() + curve.bytes() + background);
    CHECK(moving.result_bytes < tables->bytes() + curve.bytes() + background + 512);
  }
}

}  // namespace welkin::test
