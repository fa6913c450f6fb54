// Harmonics and engines' forms through the C interface: the bits of the C++ calls.
#include "c/c_calls.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/welkin.h"

namespace welkin::test {

TEST_CASE("C: turned and windowed harmonics have the C++ calls' bits", "[c_interface]") {
  const auto picture = make_lat_long(Content::sun_disc, 64, 32, 5);
  for (const int bands : {1, 3, 6}) {
    INFO("bands " << bands);
    const SphericalHarmonics light = project(picture.view(), {.bands = bands}).radiance;
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
  const auto picture = make_lat_long(Content::sun_disc, 64, 32, 5);
  for (const int bands : {1, 2, 3, 5}) {
    const Projection light = project(picture.view(), {.bands = bands});
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

}  // namespace welkin::test
