// Promise: computed skies are bit-identical to those on record (see projections_test.cpp).
#include "cache/recipe.h"
#include "sky/spectrum.h"
#include "support/catch.h"
#include "support/recorded_results.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/sky.h"

namespace welkin::test {
namespace {

SkyTableOptions tables_of(int orders, ScatteringLayout layout = ScatteringLayout::full) {
  SkyTableOptions options = tiny_tables();
  options.orders = orders;
  options.layout = layout;
  return options;
}

SkyTableOptions folded(int orders) {
  SkyTableOptions options = tables_of(orders);
  options.colour = SkyColour::linear_srgb;
  return options;
}

/// An unusual planet: small, with a layered aerosol that also absorbs and scatters backwards, and a point sun.
Atmosphere custom_atmosphere() {
  Atmosphere air;
  air.name = "custom";
  air.wavelengths_nm = {450.0, 520.0, 610.0};
  air.bottom_radius_m = 900'000.0;
  air.top_radius_m = 960'000.0;
  air.rayleigh = {exponential_profile(6500.0), {4e-5, 2e-5, 1e-5}, {}};
  air.aerosol = {
      {{4000.0, 0.0, 0.0, 0.0, 1.0}, {0.0, 1.0, -1.0 / 3000.0, 0.0, 0.0}}, {2e-6, 3e-6, 4e-6}, {1e-6, 0.0, 2e-6}};
  air.aerosol_phase = AerosolPhase::henyey_greenstein;
  air.aerosol_asymmetry = -0.3;
  air.absorbers = {{tent_profile(20'000.0, 9000.0), {}, {1e-6, 2e-6, 3e-6}}};
  air.ground_albedo = {0.3, 0.2, 0.6};
  air.solar_irradiance = {1.5, 1.4, 1.3};
  air.sun_angular_radius_degrees = 0.0;
  return air;
}

/// Returns the Earth at four wavelengths, to be folded to colours.
Atmosphere earth_of_four() { return earth_bruneton({400.0, 500.0, 600.0, 700.0}); }

std::vector<glm::dvec3> suns() {
  return {sun_direction(90.0, 0.0), sun_direction(31.0, 70.0), sun_direction(2.0, 200.0), sun_direction(-7.0, -30.0),
          sun_direction(-60.0, 10.0)};
}

/// Radiance from many directions under several suns, one by one and in lanes; sun and irradiance.
std::uint64_t bits_of_lookups(const SkyView& view) {
  std::vector<glm::vec3> directions;
  for (int i = 0; i < 61; ++i) {
    directions.emplace_back(sun_direction(-90.0 + 3.0 * i, 47.0 * i));
  }
  std::vector<glm::vec3> rgb(directions.size());
  BitHash hash;
  for (const glm::dvec3& sun : suns()) {
    view.radiance(directions, sun, rgb);
    add_bits(hash, rgb);
    for (const glm::vec3& direction : directions) add_bits(hash, view.radiance(glm::dvec3(direction), sun));
    add_bits(hash, view.sun_light(sun));
    add_bits(hash, view.irradiance(sun));
  }
  return hash.value();
}

std::uint64_t bits_of_projections(const SkyView& view, const SkyHarmonicsOptions& options) {
  const SkyProjector projector(view, options);
  BitHash hash;
  add_bits(hash, projector.directions());
  for (const glm::dvec3& sun : suns()) add_bits(hash, projector.project(sun));
  return hash.value();
}

std::uint64_t bits_of_curve(const SkyCurve& curve) {
  BitHash hash;
  for (const glm::dvec3& sun : suns()) {
    add_bits(hash, curve.at(sun));
    add_bits(hash, curve.sun_irradiance(sun));
  }
  return hash.value();
}

SkyCurveOptions small_curve(int bands, int nodes) {
  SkyCurveOptions options{.bands = bands, .nodes = nodes};
  options.projection.zeniths = options.projection.azimuths = 6;
  return options;
}

SkyBakeOptions small_sky() {
  SkyBakeOptions options{.tables = tables_of(2), .curve = small_curve(3, 12)};
  options.harmonics.zeniths = options.harmonics.azimuths = 4;
  options.specular = PrefilterOptions{.size = 8, .roughness = {0.0, 0.3, 0.6, 1.0}};
  options.background_size = 8;
  options.brdf = BrdfTableOptions{.width = 4, .height = 4};
  return options;
}

std::uint64_t bits_of_bake(const SkyPlan& plan) {
  const SkyBake sky = bake(plan, sun_direction(12.0, 33.0));
  return bits_of(sky.tables, sky.radiance, sky.sun, sky.specular, sky.background.value_or(Cubemap()), sky.brdf,
                 sky.curve ? bits_of_curve(*sky.curve) : std::uint64_t{0});
}

}  // namespace

TEST_CASE("Atmospheres are the same as before", "[same_as_before]") {
  require_as_recorded(
      "atmosphere",
      {
          {"presets",
           [] {
             BitHash hash;
             for (const Atmosphere& air : {earth_bruneton(), earth_of_four(), earth_hillaire(), mars(),
                                           with_ground_albedo(without_aerosol(mars()), 0.4), custom_atmosphere()}) {
               add_bits(hash, cache::hash_options(air));
             }
             return hash.value();
           }},
          {"srgb_weights",
           [] {
             return sky::srgb_weights({400.0, 470.0, 530.0, 610.0, 680.0});
           }},
          {"sun_direction", [] { return bits_of(suns(), sun_direction(12.3, 456.7)); }},
      });
}

TEST_CASE("Tables of skies are the same as before", "[same_as_before]") {
  const auto compact = ScatteringLayout::compact;
  SkyTableOptions until = tables_of(12);
  until.convergence_threshold = 0.1;
  const auto made = [](const Atmosphere& air, const SkyTableOptions& options) {
    return [=] { return precompute_sky(air, options); };
  };
  require_as_recorded("sky_tables", {
                                        {"earth_1", made(earth_bruneton(), tables_of(1))},
                                        {"earth_4", made(earth_bruneton(), tables_of(4)), Repeats::once},
                                        {"earth_compact", made(earth_bruneton(), tables_of(2, compact))},
                                        {"earth_until", made(earth_bruneton(), until), Repeats::once},
                                        {"earth_folded", made(earth_of_four(), folded(2))},
                                        {"clear", made(earth(), tables_of(2))},
                                        {"dusty", made(earth({680.0, 550.0, 440.0}, AerosolKind::dusty), tables_of(2))},
                                        {"earth_of_hillaire", made(earth_hillaire(), tables_of(2))},
                                        {"mars", made(mars(), tables_of(3))},
                                        {"without_aerosol", made(without_aerosol(earth_bruneton()), tables_of(2))},
                                        {"custom", made(custom_atmosphere(), tables_of(2))},
                                        {"file_bytes",
                                         [] {
                                           const TemporaryDirectory folder;
                                           save_sky_tables(precompute_sky(mars(), tables_of(1)), folder.file("mars"));
                                           return bits_of(read_bytes(folder.file("mars")),
                                                          load_sky_tables(folder.file("mars")));
                                         }},
                                    });
}

TEST_CASE("Views of skies and their images are the same as before", "[same_as_before]") {
  const auto earth_tables = sky_tables_of(earth_bruneton(), tables_of(2));
  const SkyView ground(earth_tables, 0.0);
  const SkyView high(earth_tables, 10'000.0);
  const SkyView space(earth_tables, 400'000.0);
  const SkyView without_ground(earth_tables, 2.0, {.ground = false});
  const SkyView compact(sky_tables_of(earth_bruneton(), tables_of(2, ScatteringLayout::compact)), 0.0);
  const SkyView mars_view(sky_tables_of(mars(), tables_of(2)), 100.0);
  const SkyView custom(sky_tables_of(custom_atmosphere(), tables_of(1)), 5000.0);
  const SkyView colours(sky_tables_of(earth_of_four(), folded(1)), 0.0);
  const glm::dvec3 noon = sun_direction(50.0, 20.0);
  const glm::dvec3 evening = sun_direction(0.1, 130.0);
  require_as_recorded(
      "sky_view",
      {
          {"ground", [&] { return bits_of_lookups(ground); }},
          {"high", [&] { return bits_of_lookups(high); }},
          {"space", [&] { return bits_of_lookups(space); }},
          {"without_ground", [&] { return bits_of_lookups(without_ground); }},
          {"compact", [&] { return bits_of_lookups(compact); }},
          {"mars", [&] { return bits_of_lookups(mars_view); }},
          {"custom", [&] { return bits_of_lookups(custom); }},
          {"colours", [&] { return bits_of_lookups(colours); }},
          {"cubemap", [&] { return sky_cubemap(ground, noon, 17); }},
          {"cubemap_with_disc", [&] { return sky_cubemap(high, noon, 32, {.sun_disc = true}); }},
          {"cubemap_with_setting_disc", [&] { return sky_cubemap(ground, evening, 32, {.sun_disc = true}); }},
          {"lat_long", [&] { return sky_lat_long(mars_view, evening, 20); }},
          {"lat_long_with_disc", [&] { return sky_lat_long(space, noon, 33, {.sun_disc = true}); }},
          {"specular",
           [&] {
             return sky_specular(ground, noon, {.size = 16, .roughness = {0.0, 0.3, 0.6, 1.0}});
           }},
          {"specular_with_disc",
           [&] {
             return sky_specular(custom, noon, {.size = 8, .roughness = {0.2, 0.7}}, {.sun_disc = true});
           }},
      });
}

TEST_CASE("Harmonics and curves of skies are the same as before", "[same_as_before]") {
  const auto earth_tables = sky_tables_of(earth_bruneton(), tables_of(2));
  const SkyView ground(earth_tables, 0.0);
  const SkyView high(earth_tables, 30'000.0);
  const SkyView space(earth_tables, 200'000.0);
  const SkyView custom(sky_tables_of(custom_atmosphere(), tables_of(1)), 0.0);
  std::vector<NamedResult> results;
  for (const SkyQuadrature quadrature : {SkyQuadrature::uniform, SkyQuadrature::gauss, SkyQuadrature::gauss_split}) {
    for (const auto& [view_name, view] : {std::pair{"_ground", &ground}, std::pair{"_high", &high}}) {
      // Its hashes were recorded under its former name.
      results.emplace_back(
          joined(quadrature == SkyQuadrature::uniform ? "article" : name(quadrature), view_name),
          [view = view, quadrature] { return bits_of_projections(*view, {.quadrature = quadrature}); });
    }
  }
  results.emplace_back("seven_bands",
                       [&] { return bits_of_projections(ground, {.bands = 7, .zeniths = 9, .azimuths = 12}); });
  results.emplace_back("space", [&] { return bits_of_projections(space, {.zeniths = 8, .azimuths = 8}); });
  results.emplace_back("custom", [&] { return bits_of_projections(custom, {.zeniths = 5, .azimuths = 7}); });
  results.emplace_back("curve_ground", [&] { return bits_of_curve(SkyCurve(ground, small_curve(3, 24))); });
  results.emplace_back("curve_high", [&] { return bits_of_curve(SkyCurve(high, small_curve(5, 17))); });
  results.emplace_back("curve_custom", [&] { return bits_of_curve(SkyCurve(custom, small_curve(1, 8))); });
  require_as_recorded("sky_harmonics", results);
}

TEST_CASE("Planned skies are the same as before", "[same_as_before]") {
  const auto baked = [](const Atmosphere& air, const SceneNeeds& needs) {
    return [=] { return bits_of_bake(plan(air, needs, small_sky())); };
  };
  require_as_recorded(
      "sky_bake",
      {
          {"everything", baked(earth_bruneton(), {}), Repeats::once},
          {"still_sun", baked(mars(), {.sun_moves = false}), Repeats::once},
          {"light_alone", baked(custom_atmosphere(), {.glossy = std::nullopt, .background = false}), Repeats::once},
          {"background_alone",
           baked(earth_bruneton(), {.diffuse_bands = 0, .irradiance_cubemap = false, .glossy = std::nullopt}),
           Repeats::once},
      });
}

}  // namespace welkin::test
