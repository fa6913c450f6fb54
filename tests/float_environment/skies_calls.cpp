// Atmospheres, tables of scattered light, views, curves and bakes of the sky.
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "calls.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/result_cache.h"
#include "welkin/sky.h"

namespace welkin::test {
namespace {

void call_atmospheres(Calls& calls) {
  calls.call("exponential_profile(", [] { return exponential_profile(7300.0); });
  calls.call("tent_profile(", [] { return tent_profile(24'700.0, 15'300.0); });
  const Atmosphere air = calls.call("earth(", [] { return earth({612.3, 549.1, 451.7}); });
  calls.call("earth_bruneton(", [] { return earth_bruneton({612.3, 549.1, 451.7}); });
  calls.call("aerosol_model(", [] { return with_aerosol(earth(), aerosol_model(AerosolKind::dusty)); });
  calls.call("with_aerosol(", [] { return with_aerosol(earth(), {.optical_depth = 0.137, .angstrom_exponent = 1.1}); });
  calls.call("earth_hillaire(", [] { return earth_hillaire(); });
  calls.call("mars(", [] { return mars(); });
  calls.call("without_aerosol(", [&] { return without_aerosol(air); });
  calls.call("with_ground_albedo(", [&] { return with_ground_albedo(air, 0.37); });
  calls.call("check(Atmosphere", [&] {
    check(air);
    return 0;
  });
  calls.call("sun_direction(", [] { return sun_direction(12.34, 56.78); });
  calls.call("unix_seconds(", [] { return unix_seconds("2031-05-17T03:21:09.7Z"); });
  const SunObserver observer{.latitude_degrees = 47.3, .longitude_degrees = -11.9, .refraction = true};
  calls.call("sun_position(double", [&] { return sun_position(1.9e9, observer).direction; });
  calls.call("sun_position(basic_string_view", [&] { return sun_position("1987-11-05T07:21Z", observer).direction; });
}

void call_tables(Calls& calls, const Atmosphere& air) {
  SkyTableOptions options = tiny_tables();
  options.orders = 2;
  const SkyTables tables = calls.call("precompute_sky(", [&] { return precompute_sky(air, options); });
  calls.call("interpolate_sky(", [&] {
    const std::vector<SkyTables> both{tables, tables};
    const std::array positions{0.0, 1.0};
    return interpolate_sky(air, both, positions, 0.3);
  });
  options.colour = SkyColour::linear_srgb;
  options.layout = ScatteringLayout::compact;
  calls.call("precompute_sky(", [&] { return precompute_sky(earth({400.0, 500.0, 600.0, 700.0}), options); });
  const TemporaryDirectory folder;
  ResultCache cache({.folder = folder.file("cache")});
  calls.call("ResultCache::precompute_sky(", [&] { return cache.precompute_sky(air, options); });
  const std::filesystem::path path = folder.file("tables.sky");
  calls.call("save_sky_tables(", [&] {
    save_sky_tables(tables, path);
    return read_bytes(path);
  });
  calls.call("load_sky_tables(", [&] { return load_sky_tables(path); });
}

void call_views(Calls& calls, const std::shared_ptr<const SkyTables>& tables) {
  const glm::dvec3 sun = sun_direction(7.3, 41.0);
  const glm::dvec3 direction(0.36, 0.48, -0.8);
  // The object itself has no numbers to compare, but its functions' results have.
  calls.call("SkyView::SkyView(shared_ptr", [&] { return SkyView(tables, 1234.5).radiance(direction, sun); });
  const SkyView view(tables, 1234.5);
  calls.call("SkyView::radiance(dvec3", [&] { return view.radiance(direction, sun); });
  const std::vector<glm::vec3> directions{{0.36F, 0.48F, -0.8F}, {0.0F, 1.0F, 0.0F}, {0.6F, -0.8F, 0.0F}};
  std::vector<glm::vec3> rgb(directions.size());
  calls.call("SkyView::radiance(span<", [&] {
    view.radiance(directions, sun, rgb);
    return std::cref(rgb);
  });
  calls.call("SkyView::sun_light(", [&] { return view.sun_light(sun); });
  calls.call("SkyView::irradiance(", [&] { return view.irradiance(sun); });
  calls.call("sky_cubemap(", [&] { return sky_cubemap(view, sun, 5, {.sun_disc = true}); });
  calls.call("sky_lat_long(", [&] { return sky_lat_long(view, sun, 6, {.sun_disc = true}); });
  calls.call("sky_specular(", [&] { return sky_specular(view, sun, {.size = 8, .roughness = {0.3, 0.9}}); });

  const SkyHarmonicsOptions harmonics{.bands = 3, .zeniths = 4, .azimuths = 4};
  calls.call("SkyProjector::SkyProjector(", [&] { return SkyProjector(view, harmonics).project(sun); });
  const SkyProjector projector(view, harmonics);
  std::vector<glm::dvec3> coefficients(9);
  calls.call("SkyProjector::project(dvec3 const&) ", [&] { return projector.project(sun); });
  calls.call("SkyProjector::project(dvec3 const&, ", [&] {
    projector.project(sun, coefficients);
    return std::cref(coefficients);
  });
  const SkyCurveOptions curve_options{.bands = 3, .nodes = 16, .projection = {.bands = 3, .zeniths = 4, .azimuths = 4}};
  calls.call("SkyCurve::SkyCurve(", [&] { return SkyCurve(view, curve_options).at(sun); });
  const SkyCurve curve(view, curve_options);
  calls.call("SkyCurve::at(dvec3 const&) ", [&] { return curve.at(sun); });
  calls.call("SkyCurve::at(dvec3 const&, ", [&] {
    curve.at(sun, coefficients);
    return std::cref(coefficients);
  });
  calls.refused("SkyCurve::at(dvec3 const&, ", [&] { curve.at(sun, std::span(coefficients).first(3)); });
  calls.call("SkyCurve::sun_irradiance(", [&] { return curve.sun_irradiance(sun); });
}

void call_bakes(Calls& calls, const Atmosphere& air) {
  SkyBakeOptions options{.tables = tiny_tables(),
                         .curve = {.bands = 3, .nodes = 8, .projection = {.bands = 3, .zeniths = 4, .azimuths = 4}},
                         .specular = PrefilterOptions{.size = 8, .roughness = {0.3, 0.9}},
                         .background_size = 4};
  options.brdf.reset();
  const SceneNeeds needs{.brdf_table = false};
  calls.call("plan(Atmosphere", [&] { return plan(air, needs, options).passes; });
  const SkyPlan planned = plan(air, needs, options);
  calls.call("plan_text(SkyPlan", [&] { return plan_text(planned); });
  const glm::dvec3 sun = sun_direction(7.3, 41.0);
  calls.call("bake(SkyPlan", [&] { return bake(planned, sun); });
}

}  // namespace

void call_skies(Calls& calls) {
  const Atmosphere air = earth();
  call_atmospheres(calls);
  call_tables(calls, air);
  SkyTableOptions options = tiny_tables();
  options.orders = 2;
  call_views(calls, std::make_shared<const SkyTables>(precompute_sky(air, options)));
  call_bakes(calls, air);
}

}  // namespace welkin::test
