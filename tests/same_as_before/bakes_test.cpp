// Promise: bakes, whole, planned, from files, from the cache and in a worker, are bit-identical to those on record
// (see projections_test.cpp).
#include "support/catch.h"
#include "support/chains.h"
#include "support/recorded_results.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/requests.h"
#include "welkin/resampling.h"
#include "welkin/result_cache.h"
#include "welkin/sky_light.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

/// Returns options of a small, quick bake with every pass.
BakeOptions small_bake(int size = 16) {
  BakeOptions options{.specular = PrefilterOptions{.size = size, .roughness = {0.0, 0.2, 0.5, 1.0}}};
  options.irradiance->size = 5;
  options.brdf = BrdfTableOptions{.width = 9, .height = 7};
  return options;
}

BakeOptions unusual_bake() {
  BakeOptions options = small_bake(13);
  options.background = BackgroundOptions{.size = 20, .mip_filter = MipFilter::box};
  options.irradiance = IrradianceOptions{.size = 2, .method = IrradianceMethod::direct};
  options.bands = 6;
  options.brdf.reset();
  options.pixels.clamp = RadianceClamp{200.0F, true};
  options.pixels.negative = NegativePolicy::replace;
  return options;
}

/// Three of five bands.
BakeResult light_alone(const EnvironmentView& view) {
  BakeOptions five_bands = small_bake();
  five_bands.bands = 5;
  return bake(view, plan(view, {.diffuse_bands = 3, .glossy = std::nullopt, .background = false}, five_bands));
}

LatLongImage wide_image() { return {96, 48, make_lat_long(Content::sun_disc, 96, 48, 71).pixels}; }
Cubemap cube_image() { return {24, make_cubemap(Content::high_range, 24, 3, 72).pixels}; }

struct NamedNeeds {
  const char* name;
  SceneNeeds needs;
};

const std::vector<NamedNeeds>& scenes() {
  static const std::vector<NamedNeeds> all{
      {"everything", {}},
      {"ambient_mobile",
       {.diffuse_bands = 1, .irradiance_cubemap = false, .glossy = std::nullopt, .background = false}},
      {"no_glossy", {.glossy = std::nullopt}},
      {"rough", {.glossy = RoughnessRange{0.4, 1.0}}},
      {"smooth", {.glossy = RoughnessRange{0.0, 0.3}, .background_mips = false}},
      {"backdrop", {.diffuse_bands = 0, .irradiance_cubemap = false, .glossy = std::nullopt, .brdf_table = false}},
  };
  return all;
}

/// Small files of each kind that carries something of its own.
class SomeFiles {
 public:
  SomeFiles() {
    write_environment(path("wide.pfm"), wide_image().view());
    write_environment(path("wide.hdr"), wide_image().view());
    const Cubemap chain = noisy_chain(16, 5, 4);
    const auto radiance = project(chain.view(0)).radiance;
    write_babylon_environment(path("light.env"), to_babylon(chain, radiance));
    write_texture(path("cube.ktx2"), chain.views(), {.metadata = {{"welkin.roughness", "0 0.2 0.5 0.8 1"}}});
    write_texture(path("plain.ktx2"), chain.views(), {.format = TexelFormat::rgba32f});
  }

  [[nodiscard]] std::filesystem::path path(const char* file_name) const { return folder_.file(file_name); }

 private:
  TemporaryDirectory folder_;
};

std::uint64_t bits_of_plan(const StoredEnvironment& stored, const SceneNeeds& needs) {
  return bits_of(bake(stored, plan(stored, needs, small_bake())));
}

/// Returns the bits that `call(cache)` computes. Throws if the same call then finds other bits in memory or on disk, or
/// does not find them there.
template <class Call>
std::function<std::uint64_t()> computed_and_found(Call call) {
  return [call] {
    const TemporaryDirectory folder;
    ResultCache cache({.folder = folder.file("cache")});
    const std::uint64_t computed = bits_of(call(cache));
    if (bits_of(call(cache)) != computed) throw std::runtime_error("other bits were found in memory");
    ResultCache other({.folder = folder.file("cache")});
    if (bits_of(call(other)) != computed) throw std::runtime_error("other bits were found on disk");
    if (cache.statistics().memory_hits == 0) throw std::runtime_error("nothing was found in memory");
    if (other.statistics().disk_hits == 0) throw std::runtime_error("nothing was found on disk");
    return computed;
  };
}

/// The light of a sky that has settled.
std::uint64_t bits_of_sky_light(Worker& worker, const std::shared_ptr<const SkyTables>& tables,
                                const SkyCurveOptions& curve, const PrefilterOptions& specular) {
  SkyLightOptions options{.curve = curve, .specular = specular, .blend_seconds = 0.0};
  SkyLight sky(worker, tables, options);
  sky.set_sun(17.0, 99.0);
  sky.set_intensity(1.5);
  while (!sky.update(0.1).settled) {
    if (sky.error()) std::rethrow_exception(sky.error());
    worker.wait_until_idle();
  }
  const SkyLightFrame& light = sky.light();
  BitHash hash;
  add_bits(hash, light.radiance);
  add_bits(hash, light.sun);
  for (const SkyReflections& reflections : light.reflections) {
    add_bits(hash, reflections.weight);
    if (reflections.weight == 0.0) continue;
    add_bits(hash, reflections.specular);
    add_bits(hash, reflections.rotation);
  }
  return hash.value();
}

}  // namespace

TEST_CASE("Whole bakes are the same as before", "[same_as_before]") {
  const LatLongImage wide = wide_image();
  const Cubemap cube = cube_image();
  const TestLatLongHalf half = make_lat_long_half(Content::special_values, 61, 30, 73, 4);
  const TestCubemap odd = make_cubemap(Content::special_values, 15, 4, 74);
  BakeOptions without_bands = small_bake();
  without_bands.bands = 0;
  without_bands.irradiance.reset();
  without_bands.background->mips = false;
  require_as_recorded("bake", {
                                  {"lat_long", [&] { return bake(wide.view(), small_bake()); }},
                                  {"cubemap", [&] { return bake(cube.view(), small_bake()); }},
                                  {"lat_long_unusual", [&] { return bake(half.view(), unusual_bake()); }},
                                  {"cubemap_unusual", [&] { return bake(odd.view(), unusual_bake()); }},
                                  {"lat_long_light", [&] { return light_alone(wide.view()); }},
                                  {"cubemap_light", [&] { return light_alone(cube.view()); }},
                                  {"without_bands", [&] { return bake(wide.view(), without_bands); }},
                                  {"into_older",
                                   [&] {
                                     BakeResult result = bake(cube.view(), small_bake(8));
                                     bake_into(result, wide.view(), small_bake());
                                     return result;
                                   }},
                              });
}

TEST_CASE("Planned bakes are the same as before", "[same_as_before]") {
  const LatLongImage wide = wide_image();
  const Cubemap cube = cube_image();
  std::vector<NamedResult> results;
  for (const NamedNeeds& scene : scenes()) {
    results.emplace_back(joined("lat_long_", scene.name), [&wide, needs = scene.needs] {
      return bake(wide.view(), plan(wide.view(), needs, small_bake()));
    });
    results.emplace_back(joined("cubemap_", scene.name), [&cube, needs = scene.needs] {
      return bake(cube.view(), plan(cube.view(), needs, small_bake()));
    });
  }
  require_as_recorded("planned_bake", results);
}

TEST_CASE("Bakes of files are the same as before", "[same_as_before]") {
  const SomeFiles files;
  std::vector<NamedResult> results;
  for (const char* file_name : {"wide.pfm", "wide.hdr", "light.env", "cube.ktx2", "plain.ktx2"}) {
    results.emplace_back(file_name, [&files, file_name] { return bake_file(files.path(file_name), {}, small_bake()); });
    for (const NamedNeeds& scene : {scenes()[0], scenes()[1], scenes()[3]}) {
      results.emplace_back(joined(file_name, '_', scene.name), [&files, file_name, needs = scene.needs] {
        return bits_of_plan(inspect_stored_environment(files.path(file_name)), needs);
      });
    }
  }
  require_as_recorded("file_bake", results);
}

TEST_CASE("Results of the cache, computed and found, are the same as before", "[same_as_before]") {
  const LatLongImage wide = wide_image();
  const Cubemap cube = cube_image();
  const SomeFiles files;
  const LightTransform change{
      .exposure = 1.5, .rotation = glm::mat3_cast(glm::dquat(0.5, 0.5, -0.5, 0.5)), .keep_faces = true};
  const PrefilterOptions specular{.size = 16, .roughness = {0.0, 0.3, 1.0}};
  require_as_recorded(
      "cache",
      {
          {"project_cubemap",
           computed_and_found([&](ResultCache& cache) { return cache.project(cube.view(), {.bands = 5}, change); })},
          {"project_lat_long", computed_and_found([&](ResultCache& cache) { return cache.project(wide.view()); })},
          {"project_file",
           computed_and_found([&](ResultCache& cache) { return cache.project_file(files.path("wide.hdr")); })},
          {"prefilter_lat_long",
           computed_and_found([&](ResultCache& cache) { return cache.prefilter_specular(wide.view(), specular); })},
          {"prefilter_cubemap",
           computed_and_found([&](ResultCache& cache) { return cache.prefilter_specular(cube.view(), specular); })},
          {"bake_lat_long",
           computed_and_found([&](ResultCache& cache) { return cache.bake(wide.view(), small_bake()); })},
          {"bake_cubemap",
           computed_and_found([&](ResultCache& cache) { return cache.bake(cube.view(), unusual_bake()); })},
          {"sky_tables",
           computed_and_found([](ResultCache& cache) { return cache.precompute_sky(mars(), tiny_tables()); })},
      });
}

TEST_CASE("Results of a worker are the same as before", "[same_as_before]") {
  const auto wide = std::make_shared<const LatLongImage>(wide_image());
  const auto cube = std::make_shared<const Cubemap>(cube_image());
  const SomeFiles files;
  const auto tables = std::make_shared<const SkyTables>(precompute_sky(earth_bruneton(), tiny_tables()));
  const glm::dvec3 sun = sun_direction(25.0, 60.0);
  const SkyCurveOptions curve{.nodes = 9};
  const PrefilterOptions specular{.size = 8, .roughness = {0.0, 0.4, 1.0}};
  const auto once = Repeats::once;  // a worker has threads of its own
  Worker worker({.threads = 2, .thread_priority = ThreadPriority::normal});
  const auto done = [&worker](const auto& request) {
    return [&worker, request] {
      auto posted = request;
      return worker.post(std::move(posted)).get();
    };
  };
  require_as_recorded("worker",
                      {
                          {"project_cubemap", done(Project{cube, {.bands = 4}}), once},
                          {"project_lat_long", done(Project{wide, {.bands = 4}}), once},
                          {"project_file", done(ProjectFile{files.path("wide.pfm")}), once},
                          {"read_file", done(ReadFile{files.path("cube.ktx2")}), once},
                          {"measure_file", done(MeasureFile{files.path("wide.hdr")}), once},
                          {"lat_long_to_cubemap", done(ToCubemap{wide, 11}), once},
                          {"cubemap_to_cubemap", done(ToCubemap{cube, 9}), once},
                          {"cubemap_to_lat_long", done(ToLatLong{cube, 30, 15}), once},
                          {"bake", done(Bake{EnvironmentSource(wide), small_bake()}), once},
                          {"bake_file", done(BakeFile{files.path("light.env"), {}, small_bake()}), once},
                          {"precompute_sky", done(PrecomputeSky{mars(), tiny_tables()}), once},
                          {"sky_curve",
                           [&] {
                             return done(BakeSkyCurve{tables, 100.0, curve})().at(sun);
                           },
                           once},
                          {"sky_specular", done(SkySpecular{tables, 100.0, sun, specular}), once},
                          {"continuation",
                           [&] {
                             return worker.post(Project{wide})
                                 .then([](Projection light) { return irradiance_from_radiance(light.radiance); })
                                 .get();
                           },
                           once},
                          {"sky_light", [&] { return bits_of_sky_light(worker, tables, curve, specular); }, once},
                      });
  CHECK(bits_of(*done(Bake{EnvironmentSource(wide), small_bake()})()) == bits_of(bake(wide->view(), small_bake())));
}

}  // namespace welkin::test
