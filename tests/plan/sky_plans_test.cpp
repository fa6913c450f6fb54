// Promise: of a sky only the tables and the light are made that the scene needs and the planet has.
#include "bake/baked.h"
#include "support/catch.h"
#include "welkin/sky_plan.h"

namespace welkin::test {
namespace {

SkyBakeOptions small_sky() {
  SkyBakeOptions options;
  options.tables.heights = 8;
  options.tables.view_zeniths = 12;
  options.tables.sun_zeniths = 12;
  options.tables.sun_angles = 3;
  options.tables.transmittance_heights = 16;
  options.tables.transmittance_zeniths = 32;
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

TEST_CASE("A moving sun has a curve, one that stands still has one light", "[plan][sky]") {
  const SkyPlan moving = plan(earth(), {}, small_sky());
  CHECK(action(moving, "curve") == PassAction::run);
  CHECK(action(moving, "project") == PassAction::skip);
  const SkyPlan still = plan(earth(), {.sun_moves = false}, small_sky());
  CHECK(action(still, "curve") == PassAction::skip);
  CHECK(action(still, "project") == PassAction::run);
  CHECK(still.milliseconds() < moving.milliseconds());
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
  CHECK(single.pass("orders").reason.find("multiple scattering falls away") != std::string::npos);
  CHECK(single.pass("orders").predicted_milliseconds < all.pass("orders").predicted_milliseconds);
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

TEST_CASE("A scene without use for the sky makes no tables", "[plan][sky]") {
  const SkyPlan nothing = plan(earth(), {.diffuse_bands = 0, .glossy = std::nullopt, .background = false}, small_sky());
  for (const PlannedPass& pass : nothing.passes) {
    INFO(pass.name);
    CHECK(pass.action == PassAction::skip);
    CHECK(!pass.reason.empty());
  }
  const SkyBake baked = bake(nothing, sun_direction(20.0, 0.0));
  CHECK(!baked.tables);
  CHECK(!baked.radiance);
}

TEST_CASE("A planned sky has the bits of the direct calls", "[plan][sky]") {
  const glm::dvec3 sun = sun_direction(20.0, 40.0);
  const SkyBakeOptions options = small_sky();
  const SkyBake whole = bake(plan(earth(), {}, options), sun);
  const SkyBake still =
      bake(plan(earth(), {.glossy = RoughnessRange{0.6, 1.0}, .brdf_table = false, .sun_moves = false}, options), sun);
  CHECK(same_bytes<float>(whole.tables->scattering, still.tables->scattering));
  const SkyView view(whole.tables, 0.0);
  REQUIRE(still.radiance);
  CHECK(same_bytes<glm::dvec3>(still.radiance->coefficients(),
                               SkyProjector(view, options.harmonics).project(sun).coefficients()));
  REQUIRE(whole.curve);
  const SphericalHarmonics on_curve = SkyCurve(view, options.curve).at(sun);
  CHECK(same_bytes<glm::dvec3>(whole.curve->at(sun).coefficients(), on_curve.coefficients()));
  REQUIRE(still.specular);
  REQUIRE(still.specular->cubemap.levels() == 2);
  for (int level = 0; level < 2; ++level) {
    CHECK(same_bytes(level_values(still.specular->cubemap, level), level_values(whole.specular->cubemap, 2 + level)));
  }
  CHECK(same_bits(whole.background, still.background));
  CHECK(!still.brdf);
  CHECK(whole.sun.irradiance == still.sun.irradiance);
}

}  // namespace welkin::test
