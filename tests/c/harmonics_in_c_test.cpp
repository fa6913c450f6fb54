// Harmonics, engines' forms, grids of probes and the sun's position through the C interface: the bits of the C++ calls.
#include "c/c_calls.h"
#include "probes/probe_captures.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

namespace welkin::test {

TEST_CASE("C: turned and windowed harmonics have the C++ calls' bits", "[c_interface]") {
  const auto image = make_lat_long(Content::sun_disc, 64, 32, 5);
  for (const int bands : {1, 3, 6}) {
    INFO("bands " << bands);
    const SphericalHarmonics light = project(image.view(), {.bands = bands}).radiance;
    const auto radiance = plain(light);
    std::vector<double> made(radiance.size());

    const glm::dmat3& matrix = convention(Engine::unreal).from_welkin;
    std::array<double, 9> numbers{};
    for (int i = 0; i < 9; ++i) numbers.at(static_cast<std::size_t>(i)) = matrix[i / 3][i % 3];
    made = radiance;  // in place
    REQUIRE(welkin_rotate(bands, made.data(), numbers.data(), made.data()) == WELKIN_OK);
    REQUIRE(same_doubles(made.data(), rotate(light, matrix)));

    for (const auto window : {Window::none, Window::hanning, Window::lanczos, Window::min_laplacian}) {
      const WindowResult expected = apply_window(light, window, 5.0);
      made = radiance;
      REQUIRE(welkin_apply_window(bands, made.data(), static_cast<welkin_window>(window), 5.0, made.data()) ==
              WELKIN_OK);
      REQUIRE(same_doubles(made.data(), expected.radiance));
    }

    double exposure = 0.0;
    REQUIRE(welkin_exposure_of(bands, radiance.data(), &exposure) == WELKIN_OK);
    REQUIRE(exposure == exposure_of(light));

    const auto dominant = dominant_light(light);
    double direction[3];
    double irradiance[3];
    std::int32_t found = -1;
    REQUIRE(welkin_dominant_light(bands, radiance.data(), direction, irradiance, &found) == WELKIN_OK);
    REQUIRE(found == (dominant ? 1 : 0));
    REQUIRE(same_triple(direction, dominant ? dominant->direction : glm::dvec3(0.0)));
    REQUIRE(same_triple(irradiance, dominant ? dominant->irradiance : glm::dvec3(0.0)));

    Sun expected_sun;
    expected_sun.direction = {0.6, 0.8, 0.0};
    expected_sun.irradiance = {3.0, 2.0, 1.0};
    expected_sun.solid_angle = 6e-5;
    const double towards[3] = {0.6, 0.8, 0.0};
    const double power[3] = {3.0, 2.0, 1.0};
    REQUIRE(welkin_sun_harmonics(towards, power, 6e-5, bands, made.data()) == WELKIN_OK);
    REQUIRE(same_doubles(made.data(), sun_harmonics(expected_sun, bands)));
  }
}

TEST_CASE("C: what is made of coefficients has the C++ calls' bits", "[c_interface]") {
  const auto image = make_lat_long(Content::sun_disc, 64, 32, 5);
  for (const int bands : {1, 2, 3, 5}) {
    const Projection light = project(image.view(), {.bands = bands});
    const std::vector<double> radiance = plain(light.radiance);
    const SphericalHarmonics expected = irradiance_from_radiance(light.radiance);
    std::vector<double> irradiance(radiance.size());
    REQUIRE(welkin_irradiance_from_radiance(bands, radiance.data(), irradiance.data()) == WELKIN_OK);
    REQUIRE(same_doubles(irradiance.data(), expected));

    const double direction[3] = {0.6, 0.0, -0.8};
    double value[3];
    REQUIRE(welkin_evaluate(bands, irradiance.data(), direction, value) == WELKIN_OK);
    REQUIRE(same_triple(value, evaluate(expected, {0.6, 0.0, -0.8})));

    for (const Convention& convention : conventions()) {
      auto form = c_struct<welkin_engine_light>();
      const auto number = static_cast<welkin_engine>(convention.engine);
      for (const bool rotated : {false, true}) {
        const welkin_status status =
            welkin_engine_light_from_radiance(bands, radiance.data(), number, rotated ? 0 : 1, &form);
        INFO(convention.name);
        REQUIRE((status == WELKIN_OK) == has_engine_light(convention.engine));
        if (status != WELKIN_OK) continue;
        const EngineLight engine = rotated ? engine_light(light.radiance, convention.engine)
                                           : engine_light_unrotated(light.radiance, convention.engine);
        REQUIRE(form.engine == number);
        REQUIRE(static_cast<std::size_t>(form.term_count) == engine.terms.size());
        REQUIRE(static_cast<std::size_t>(form.vector_count) == engine.vectors.size());
        for (std::size_t i = 0; i < engine.terms.size(); ++i) REQUIRE(same_triple(form.terms[i], engine.terms[i].rgb));
        for (std::size_t i = 0; i < engine.vectors.size(); ++i) {
          REQUIRE(same_triple(form.vectors[i], glm::dvec3(engine.vectors[i].value)));
          REQUIRE(same_bits(form.vectors[i][3], engine.vectors[i].value.w));
        }
      }
    }
  }
}

TEST_CASE("C: engines' axes are the C++ calls'", "[c_interface]") {
  for (const Convention& expected : conventions()) {
    double from_welkin[9];
    double faces_from_engine[9];
    REQUIRE(welkin_get_axes(static_cast<welkin_engine>(expected.engine), from_welkin, faces_from_engine) == WELKIN_OK);
    for (int column = 0; column < 3; ++column) {
      REQUIRE(same_triple(from_welkin + 3 * column, expected.from_welkin[column]));
      const glm::dmat3 faces = expected.faces_from_engine.value_or(glm::dmat3(0.0));
      REQUIRE(same_triple(faces_from_engine + 3 * column, faces[column]));
    }
  }
}

// Probes and the sun's position.

namespace {

using GridOfC = Destroyed<welkin_probes, welkin_probes_destroy>;

constexpr int kFace = 4;

Captures small_captures() {
  return {6, kFace,
          [](std::size_t probe, const dvec3& d) {
            return dvec3(2.0 + d.y, 1.0 + 0.1 * static_cast<double>(probe), 1.0 - d.x);
          },
          kFace, [](std::size_t probe, const dvec3& d) { return probe == 2  ? -0.3F
                                                                : d.y > 0.6 ? kNothing
                                                                            : 1.0F; }};
}

std::string message() { return welkin_last_error(); }

}  // namespace

TEST_CASE("C: probes have the C++ calls' bits", "[c_interface][probes]") {
  const Captures captures = small_captures();
  const ProbeGrid grid{.counts = {3, 1, 2}, .origin = {0.5, 1.5, -2.5}, .spacing = {1.0, 2.0, 3.0}};
  const ProbeOptions how{.projection = {.bands = 2}, .near_share = 0.2, .distance_size = 4, .environment_bands = 2};
  BakedProbes expected = bake_probes(grid, captures.cubes, captures.depths, how);

  welkin_probe_grid c_grid;
  WELKIN_INIT(c_grid);
  for (int axis = 0; axis < 3; ++axis) {
    c_grid.counts[axis] = grid.counts[static_cast<std::size_t>(axis)];
    c_grid.origin[axis] = grid.origin[axis];
    c_grid.spacing[axis] = grid.spacing[axis];
  }
  welkin_probe_options options;
  WELKIN_INIT(options);
  options.bands = 2;
  options.distance_size = 4;
  options.environment_bands = 2;
  options.near_share = 0.2;
  std::vector<welkin_environment> cubes;
  for (const CubemapView& cube : captures.cubes) cubes.push_back(c_view(cube));
  std::vector<const float*> depths;
  for (const std::vector<float>& distances : captures.distances) depths.push_back(distances.data());
  GridOfC probes;
  REQUIRE(welkin_probes_bake(&c_grid, cubes.data(), depths.data(), kFace, &options, nullptr, &probes.handle) ==
          WELKIN_OK);
  const double* numbers = nullptr;
  std::size_t count = 0;
  REQUIRE(welkin_probes_coefficients(probes.handle, &numbers, &count) == WELKIN_OK);
  REQUIRE(count == 3 * expected.coefficients.size());
  CHECK(std::memcmp(numbers, expected.coefficients.data(), count * sizeof(double)) == 0);

  std::vector<double> offsets(18);
  REQUIRE(welkin_probes_relocate(&c_grid, depths.data(), kFace, offsets.data()) == WELKIN_OK);
  expected.offsets = relocate_probes(grid, captures.depths);
  CHECK(std::memcmp(offsets.data(), expected.offsets.data(), sizeof(double) * 18) == 0);
  CHECK(expected.offsets[2] != dvec3(0.0));
  REQUIRE(welkin_probes_set_offsets(probes.handle, offsets.data()) == WELKIN_OK);

  SphericalHarmonics sky(2);
  sky.coefficients()[0] = dvec3(0.4, 0.5, 0.6);
  sky.coefficients()[2] = dvec3(0.1, 0.2, 0.3);
  const SphericalHarmonics dark(2);
  relight(expected, dark, sky);
  REQUIRE(welkin_probes_relight(probes.handle, 2, &dark.coefficients()[0].x, &sky.coefficients()[0].x) == WELKIN_OK);

  const std::array<double, 6> positions{1.0, 1.6, -2.0, 2.2, 1.5, 0.1};
  const std::array<double, 6> normals{0.0, 1.0, 0.0, 0.6, 0.0, -0.8};
  std::array<double, 6> light{};
  REQUIRE(welkin_probes_irradiance(probes.handle, positions.data(), normals.data(), 2, light.data()) == WELKIN_OK);
  CHECK(probe_irradiance(expected, {1.0, 1.6, -2.0}, {0.0, 1.0, 0.0}) == dvec3(light[0], light[1], light[2]));
  CHECK(probe_irradiance(expected, {2.2, 1.5, 0.1}, {0.6, 0.0, -0.8}) == dvec3(light[3], light[4], light[5]));

  for (const auto& [name, layout] : {std::pair{"bevy", ProbeLayout::bevy}, std::pair{"rtxgi", ProbeLayout::rtxgi},
                                     std::pair{"three", ProbeLayout::three}}) {
    const PackedProbes packed = pack_probes(expected, layout);
    for (std::size_t k = 0; k < packed.textures.size(); ++k) {
      std::array<std::int32_t, 3> size{};
      std::vector<std::uint16_t> halves(packed.textures[k].halves.size());
      const auto index = static_cast<std::int32_t>(k);
      REQUIRE(welkin_probes_pack(probes.handle, name, index, size.data(), nullptr, 0) == WELKIN_OK);
      CHECK(std::equal(size.begin(), size.end(), packed.textures[k].size.begin()));
      REQUIRE(welkin_probes_pack(probes.handle, name, index, size.data(), halves.data(), halves.size()) == WELKIN_OK);
      CHECK(halves == packed.textures[k].halves);
      CHECK(welkin_probes_pack(probes.handle, name, index, size.data(), halves.data(), 3) == WELKIN_INVALID_ARGUMENT);
    }
  }

  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "level.json").string();
  REQUIRE(welkin_probes_write(probes.handle, path.c_str(), "bevy,rtxgi") == WELKIN_OK);
  CHECK(std::filesystem::exists(folder.path() / "level_rtxgi_distance.ktx2"));
  GridOfC again;
  REQUIRE(welkin_probes_read(path.c_str(), &again.handle) == WELKIN_OK);
  REQUIRE(welkin_probes_coefficients(again.handle, &numbers, &count) == WELKIN_OK);
  CHECK(std::memcmp(numbers, expected.coefficients.data(), count * sizeof(double)) == 0);

  CHECK(welkin_probes_write(probes.handle, path.c_str(), "bevy,unity") == WELKIN_INVALID_ARGUMENT);
  CHECK(message().find("unity-l2") != std::string::npos);
  GridOfC none;
  none.handle = again.handle;  // overwritten, not owned
  CHECK(welkin_probes_bake(&c_grid, cubes.data(), depths.data(), 0, nullptr, nullptr, &none.handle) ==
        WELKIN_INVALID_ARGUMENT);
  CHECK(none.handle == nullptr);
  depths[1] = nullptr;
  CHECK(welkin_probes_relocate(&c_grid, depths.data(), kFace, offsets.data()) == WELKIN_INVALID_ARGUMENT);
  CHECK(message().find("depths[1]") != std::string::npos);
  CHECK(welkin_probes_relight(nullptr, 2, &dark.coefficients()[0].x, &sky.coefficients()[0].x) ==
        WELKIN_INVALID_ARGUMENT);
}

TEST_CASE("C: the sun by date has the C++ call's bits", "[c_interface][sun_position]") {
  double elevation = 0.0;
  double azimuth = 0.0;
  std::array<double, 3> direction{};
  for (const bool refraction : {false, true}) {
    const SunPosition sun = sun_position(
        "2026-06-21T18:30Z", {.latitude_degrees = 52.5, .longitude_degrees = 13.4, .refraction = refraction});
    REQUIRE(welkin_sun_position("2026-06-21T20:30+02:00", 52.5, 13.4, refraction ? 1 : 0, &elevation, &azimuth,
                                direction.data()) == WELKIN_OK);
    CHECK(elevation == sun.elevation_degrees);
    CHECK(azimuth == sun.azimuth_degrees);
    CHECK(dvec3(direction[0], direction[1], direction[2]) == sun.direction);
  }
  CHECK(welkin_sun_position("2026-06-21T20:30", 52.5, 13.4, 0, &elevation, &azimuth, nullptr) ==
        WELKIN_INVALID_ARGUMENT);
  CHECK(message().find("no time zone") != std::string::npos);
  CHECK(welkin_sun_position(nullptr, 52.5, 13.4, 0, &elevation, &azimuth, nullptr) == WELKIN_INVALID_ARGUMENT);
}

}  // namespace welkin::test
