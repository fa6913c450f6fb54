// Skies through the C interface: atmospheres, tables, views, harmonics and the dynamic sky have the C++ calls' bits.
#include "c/c_calls.h"
#include "c/c_worker.h"
#include "support/catch.h"
#include "support/small_skies.h"
#include "welkin/bake.h"
#include "welkin/sky.h"
#include "welkin/sky_light.h"
#include "welkin/welkin.h"
#include "welkin/worker.h"

namespace welkin::test {
namespace {

/// The tests' tiny tables. (fields_in_c_test.cpp maps each option to C++.)
welkin_sky_table_options tiny_tables_in_c() {
  auto values = c_struct<welkin_sky_table_options>();
  values.heights = 4;
  values.view_zeniths = 16;
  values.sun_zeniths = 8;
  values.sun_angles = 4;
  values.transmittance_heights = 16;
  values.transmittance_zeniths = 64;
  values.irradiance_heights = 4;
  values.irradiance_sun_zeniths = 16;
  values.orders = 1;
  return values;
}

using CTables = Destroyed<welkin_sky_tables, welkin_sky_tables_destroy>;
using CView = Destroyed<welkin_sky_view, welkin_sky_view_destroy>;
using CCurve = Destroyed<welkin_sky_curve, welkin_sky_curve_destroy>;
using CSkyLight = Destroyed<welkin_sky_light, welkin_sky_light_destroy>;

void require_same(const welkin_sky_tables* made, const SkyTables& expected) {
  REQUIRE(made->tables->atmosphere == expected.atmosphere);
  REQUIRE(made->tables->options == expected.options);
  REQUIRE(same_texels(made->tables->transmittance, expected.transmittance));
  REQUIRE(same_texels(made->tables->scattering, expected.scattering));
  REQUIRE(same_texels(made->tables->single_mie, expected.single_mie));
  REQUIRE(same_texels(made->tables->irradiance, expected.irradiance));
}

welkin_atmosphere planet(welkin_planet which) {
  auto air = c_struct<welkin_atmosphere>();
  air.planet = which;
  return air;
}

/// As the library reads it.
Atmosphere read(const welkin_atmosphere& air) { return c_interface::atmosphere_of(&air); }

/// The tests' small sky in both languages.
struct SmallSky {
  std::shared_ptr<const SkyTables> tables = std::make_shared<const SkyTables>(precompute_sky(earth(), tiny_tables()));
  CTables c_tables;

  SmallSky() {
    const welkin_atmosphere air = planet(WELKIN_PLANET_EARTH);
    const auto wanted = tiny_tables_in_c();
    REQUIRE(welkin_sky_tables_create(&air, &wanted, nullptr, &c_tables.handle) == WELKIN_OK);
  }
};

const SmallSky& small_sky() {
  static const SmallSky sky;
  return sky;
}

std::array<double, 3> numbers(const glm::dvec3& vector) { return {vector.x, vector.y, vector.z}; }

}  // namespace

TEST_CASE("C: planets are the C++ calls'", "[c_interface]") {
  const std::vector<double> rgb{680.0, 550.0, 440.0};
  const std::array expected{earth(),
                            earth_hillaire(),
                            mars(),
                            Atmosphere{},
                            earth_bruneton(),
                            earth(rgb, AerosolKind::hazy),
                            earth(rgb, AerosolKind::dusty),
                            earth(rgb, AerosolKind::polluted)};
  for (std::size_t number = 0; number < expected.size(); ++number)
    CHECK(read(planet(static_cast<welkin_planet>(number))) == expected.at(number));

  const std::vector<double> wavelengths{700.0, 600.0, 500.0, 400.0};
  welkin_atmosphere air = planet(WELKIN_PLANET_EARTH_DUSTY);
  air.wavelengths_nm = wavelengths.data();
  air.wavelength_count = 4;
  CHECK(read(air) == earth(wavelengths, AerosolKind::dusty));
}

TEST_CASE("C: a sky's tables have the C++ call's bits, at once and as a job", "[c_interface]") {
  const CWorker worker(2);
  require_same(small_sky().c_tables.handle, *small_sky().tables);

  auto wanted = tiny_tables_in_c();
  wanted.compact = 1;
  wanted.linear_srgb = 1;
  wanted.orders = 3;
  wanted.convergence_threshold = 0.02;
  wanted.truncate_orders = 1;
  wanted.minimum_sun_elevation_degrees = -12.0;
  const SkyTables expected = precompute_sky(mars(), c_interface::table_options(&wanted));
  const welkin_atmosphere air = planet(WELKIN_PLANET_MARS);
  const CTables posted(posted_handle<welkin_sky_tables>(
      [&](welkin_job** job) { return welkin_post_sky_tables(worker.get(), &air, &wanted, nullptr, job); },
      welkin_job_get_sky_tables));
  require_same(posted.handle, expected);

  auto small = wanted;
  small.memory_limit_bytes = 1000;
  CTables none;
  REQUIRE(welkin_sky_tables_create(&air, &small, nullptr, &none.handle) == WELKIN_LIMIT_EXCEEDED);
  REQUIRE(none.handle == nullptr);
}

TEST_CASE("C: views of a sky have the C++ calls' bits", "[c_interface]") {
  const SmallSky& sky = small_sky();
  const glm::dvec3 sun = sun_direction(12.0, 70.0);
  std::array<double, 3> c_sun{};
  REQUIRE(welkin_sun_direction(12.0, 70.0, c_sun.data()) == WELKIN_OK);
  REQUIRE(same_triple(c_sun.data(), sun));
  for (const bool ground : {true, false}) {
    const SkyView expected(sky.tables, 800.0, {ground});
    CView view;
    REQUIRE(welkin_sky_view_create(sky.c_tables.handle, 800.0, ground ? 0 : 1, &view.handle) == WELKIN_OK);

    const std::vector<glm::vec3> directions{{0.0F, 1.0F, 0.0F}, {0.6F, 0.1F, -0.3F}, {0.1F, -0.8F, 0.2F}};
    std::vector<glm::vec3> wanted(3);
    std::vector<glm::vec3> found(3);
    expected.radiance(directions, sun, wanted);
    REQUIRE(welkin_sky_view_radiance(view.handle, &directions[0].x, 3, c_sun.data(), &found[0].x) == WELKIN_OK);
    REQUIRE(same_bytes(std::span<const glm::vec3>(found), std::span<const glm::vec3>(wanted)));
    REQUIRE(welkin_sky_view_radiance(view.handle, nullptr, 0, c_sun.data(), nullptr) == WELKIN_OK);

    const Sun light = expected.sun_light(sun);
    std::array<double, 3> irradiance{};
    double solid_angle = 0.0;
    REQUIRE(welkin_sky_view_sun(view.handle, c_sun.data(), irradiance.data(), &solid_angle) == WELKIN_OK);
    REQUIRE(same_triple(irradiance.data(), light.irradiance));
    REQUIRE(same_bits(solid_angle, light.solid_angle));

    for (const bool disc : {false, true}) {
      const std::int32_t sun_disc = disc ? 1 : 0;
      const Cubemap cubemap = sky_cubemap(expected, sun, 8, {disc});
      std::vector<float> texels(cubemap.pixels().size());
      const welkin_target target = c_target(texels, 8);
      REQUIRE(welkin_sky_view_image(view.handle, c_sun.data(), sun_disc, nullptr, &target, nullptr) == WELKIN_OK);
      REQUIRE(same_texels(texels, cubemap.pixels()));

      const LatLongImage lat_long = sky_lat_long(expected, sun, 8, {disc});
      texels.assign(lat_long.pixels.size(), 0.0F);
      auto image = c_struct<welkin_target>();
      image.faces[0] = texels.data();
      image.width = 16;
      image.height = 8;
      REQUIRE(welkin_sky_view_image(view.handle, c_sun.data(), sun_disc, nullptr, &image, nullptr) == WELKIN_OK);
      REQUIRE(same_texels(texels, lat_long.pixels));
      image.width = 15;
      REQUIRE(welkin_sky_view_image(view.handle, c_sun.data(), sun_disc, nullptr, &image, nullptr) ==
              WELKIN_INVALID_ARGUMENT);

      auto reflections = c_struct<welkin_prefilter_options>();
      reflections.size = 8;
      CChain chain;
      REQUIRE(welkin_sky_view_specular(view.handle, c_sun.data(), sun_disc, &reflections, nullptr, &chain.handle) ==
              WELKIN_OK);
      require_same_chain(chain.handle, sky_specular(expected, sun, {.size = 8}, {disc}).cubemap);
    }
  }
}

TEST_CASE("C: a sky's harmonics and reflections have the C++ calls' bits, at once and as jobs", "[c_interface]") {
  const CWorker worker(2);
  const SmallSky& sky = small_sky();
  const SkyView expected_view(sky.tables, 0.0);
  CView view;
  REQUIRE(welkin_sky_view_create(sky.c_tables.handle, 0.0, 0, &view.handle) == WELKIN_OK);
  auto options = c_struct<welkin_sky_harmonics_options>();
  options.bands = 4;
  options.zeniths = 8;
  options.azimuths = 12;
  options.nodes = 16;
  const SkyCurve curve(expected_view, c_interface::curve_options(&options));
  CCurve at_once;
  REQUIRE(welkin_sky_curve_create(view.handle, &options, nullptr, &at_once.handle) == WELKIN_OK);
  const CCurve posted(posted_handle<welkin_sky_curve>(
      [&](welkin_job** job) {
        return welkin_post_sky_curve(worker.get(), sky.c_tables.handle, 0.0, &options, nullptr, job);
      },
      welkin_job_get_sky_curve));
  const auto sun = numbers(sun_direction(25.0, 10.0));
  std::vector<double> coefficients(3 * 16);
  for (const auto* const made : {at_once.handle, posted.handle}) {
    std::array<double, 3> irradiance{};
    REQUIRE(welkin_sky_curve_at(made, sun.data(), coefficients.data(), irradiance.data()) == WELKIN_OK);
    REQUIRE(same_doubles(coefficients.data(), curve.at(sun_direction(25.0, 10.0))));
    REQUIRE(same_triple(irradiance.data(), curve.sun_irradiance(sun_direction(25.0, 10.0))));
  }

  auto reflections = c_struct<welkin_prefilter_options>();
  reflections.size = 16;
  const CChain chain(posted_handle<welkin_chain>(
      [&](welkin_job** job) {
        return welkin_post_sky_specular(worker.get(), sky.c_tables.handle, 100.0, sun.data(), &reflections, nullptr,
                                        job);
      },
      welkin_job_get_chain));
  require_same_chain(chain.handle,
                     sky_specular(SkyView(sky.tables, 100.0), sun_direction(25.0, 10.0), {.size = 16}).cubemap);
}

// The dynamic sky.

namespace {

/// Two dynamic skies, one per interface, that are driven alike.
struct TwoSkies {
  Worker worker;
  CWorker c_worker;
  SkyLight light;
  CSkyLight c_light;

  explicit TwoSkies(const welkin_sky_light_options& c_options)
      : worker({.threads = 1}), c_worker(1), light(worker, small_sky().tables, c_interface::light_options(&c_options)) {
    REQUIRE(welkin_sky_light_create(c_worker.get(), nullptr, small_sky().c_tables.handle, &c_options,
                                    &c_light.handle) == WELKIN_OK);
  }

  void set_sun(double elevation, double azimuth) {
    light.set_sun(elevation, azimuth);
    const auto direction = numbers(sun_direction(elevation, azimuth));
    REQUIRE(welkin_sky_light_set_sun(c_light.handle, direction.data()) == WELKIN_OK);
  }

  /// Updates both until no work is left.
  welkin_sky_frame settled() {
    auto frame = c_struct<welkin_sky_frame>();
    for (int i = 0; i < 20000 && !(light.light().settled && frame.settled == 1); ++i) {
      if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      light.update(0.25);
      REQUIRE(welkin_sky_light_update(c_light.handle, 0.25, &frame) == WELKIN_OK);
    }
    REQUIRE(light.light().settled);
    REQUIRE(frame.settled == 1);
    REQUIRE(welkin_sky_light_get_status(c_light.handle) == WELKIN_OK);
    return frame;
  }
};

void require_same(const welkin_sky_frame& frame, const SkyLightFrame& expected) {
  REQUIRE(frame.ready == (expected.ready ? 1 : 0));
  REQUIRE(frame.bands == expected.radiance.bands());
  REQUIRE(same_doubles(frame.coefficients, expected.radiance));
  REQUIRE(same_triple(frame.sun_direction, expected.sun.direction));
  REQUIRE(same_triple(frame.sun_irradiance, expected.sun.irradiance));
  REQUIRE(same_bits(frame.sun_solid_angle, expected.sun.solid_angle));
  const auto& reflections = frame.reflections[0];
  const auto& wanted = expected.reflections[0];
  REQUIRE((reflections.chain != nullptr) == (wanted.specular != nullptr));
  REQUIRE((reflections.id != 0) == (wanted.specular != nullptr));
  if (wanted.specular) require_same_chain(reflections.chain, wanted.specular->cubemap);
  REQUIRE(same_bits(reflections.weight, wanted.weight));
  for (int column = 0; column < 3; ++column) {
    REQUIRE(same_triple(reflections.rotation + 3 * column, wanted.rotation[column]));
  }
}

}  // namespace

TEST_CASE("C: the dynamic sky gives the light of SkyLight, and numbers its reflections", "[c_interface]") {
  auto curve = c_struct<welkin_sky_harmonics_options>();
  curve.bands = 4;
  curve.nodes = 16;
  curve.zeniths = 8;
  curve.azimuths = 8;
  auto specular = c_struct<welkin_prefilter_options>();
  specular.size = 8;
  auto c_options = c_struct<welkin_sky_light_options>();
  c_options.curve = &curve;
  c_options.specular = &specular;
  c_options.altitude_m = 50.0;
  c_options.specular_threshold_degrees = 1.0;
  c_options.blend_seconds = 1.0;
  TwoSkies skies(c_options);

  skies.set_sun(30.0, 100.0);
  const welkin_sky_frame first = skies.settled();
  require_same(first, skies.light.light());
  REQUIRE(first.reflections[0].id > 0);

  // A new azimuth or intensity recomputes nothing: the chain is only rotated.
  skies.set_sun(30.0, 160.0);
  skies.light.set_intensity(3.0);
  REQUIRE(welkin_sky_light_set_intensity(skies.c_light.handle, 3.0) == WELKIN_OK);
  const welkin_sky_frame rotated = skies.settled();
  require_same(rotated, skies.light.light());
  REQUIRE(rotated.reflections[0].id == first.reflections[0].id);
  REQUIRE(rotated.reflections[0].weight == 3.0);

  // A new elevation makes a new chain; the previous one keeps its number as the older one.
  skies.set_sun(10.0, 160.0);
  auto blended = c_struct<welkin_sky_frame>();
  for (int i = 0; i < 20000 && blended.reflections[0].id <= first.reflections[0].id; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    REQUIRE(welkin_sky_light_update(skies.c_light.handle, 1e-3, &blended) == WELKIN_OK);
  }
  REQUIRE(blended.reflections[0].id == first.reflections[0].id + 1);
  REQUIRE(blended.reflections[1].id == first.reflections[0].id);
  REQUIRE(blended.reflections[1].chain != nullptr);
  REQUIRE(blended.reflections[0].weight + blended.reflections[1].weight == Approx(3.0));

  // A new altitude makes a new chain as well.
  skies.set_sun(5.0, 160.0);
  skies.light.set_altitude(2000.0);
  REQUIRE(welkin_sky_light_set_altitude(skies.c_light.handle, 2000.0) == WELKIN_OK);
  const welkin_sky_frame lower = skies.settled();
  require_same(lower, skies.light.light());
  REQUIRE(lower.reflections[0].id > first.reflections[0].id);

  // A structure for fewer bands than there are is refused.
  auto small = c_struct<welkin_sky_frame>();
  small.struct_size = offsetof(welkin_sky_frame, coefficients) + 27 * sizeof(double);
  REQUIRE(welkin_sky_light_update(skies.c_light.handle, 0.0, &small) == WELKIN_INVALID_ARGUMENT);
  REQUIRE(std::string(welkin_last_error()).find("4 bands") != std::string::npos);
  REQUIRE(welkin_sky_light_update(skies.c_light.handle, -1.0, nullptr) == WELKIN_INVALID_ARGUMENT);
  auto frame = c_struct<welkin_sky_frame>();
  REQUIRE(welkin_sky_light_update(skies.c_light.handle, -1.0, &frame) == WELKIN_INVALID_ARGUMENT);
}

TEST_CASE("C: a dynamic sky that its worker lets down says so", "[c_interface]") {
  const CWorker worker(1);
  REQUIRE(welkin_worker_terminate(worker.get()) == WELKIN_OK);
  const welkin_atmosphere air = planet(WELKIN_PLANET_EARTH);
  CSkyLight light;
  REQUIRE(welkin_sky_light_create(worker.get(), &air, nullptr, nullptr, &light.handle) == WELKIN_OK);
  auto frame = c_struct<welkin_sky_frame>();
  REQUIRE(welkin_sky_light_update(light.handle, 0.1, &frame) == WELKIN_OK);
  REQUIRE(frame.ready == 0);
  REQUIRE(frame.reflections[0].chain == nullptr);
  REQUIRE(welkin_sky_light_get_status(light.handle) == WELKIN_STOPPED);
  REQUIRE(std::string(welkin_last_error()).size() > 0);
}

}  // namespace welkin::test
