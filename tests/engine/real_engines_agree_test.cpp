// Promises: the real Babylon.js and three.js make of our coefficients what the forms say, and of the same surroundings
// the coefficients that we have for them, the right way round. What they said is in tests/data/engines.json
// (record.mjs); the ctest engine_live asks them again.
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "image/texel_geometry.h"
#include "places.h"
#include "support/catch.h"
#include "welkin/engine_light.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin {
namespace {

using nlohmann::json;

const json& recorded() {
  static const json all = json::parse(std::ifstream(std::string(WELKIN_TEST_DATA) + "/engines.json"));
  return all;
}

glm::dvec3 triple(const json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

SphericalHarmonics coefficients() {
  SphericalHarmonics harmonics(3);
  for (std::size_t i = 0; i < 9; ++i) harmonics.coefficients()[i] = triple(recorded().at("coefficients").at(i));
  return harmonics;
}

// As in record.mjs.
glm::dvec3 radiance(const glm::dvec3& d) {
  return {2.0 + d.x + 0.5 * d.y - 0.7 * d.z + 0.3 * d.x * d.z + 0.2 * d.x * d.y,
          2.0 - 0.4 * d.x + 0.8 * d.y + 0.6 * d.z - 0.5 * d.y * d.z,
          2.0 + 0.3 * d.x - 0.9 * d.y + 0.2 * d.z + 0.4 * (d.x * d.x - d.y * d.y)};
}

void append(std::vector<float>& pixels, const glm::dvec3& rgb) {
  for (int channel = 0; channel < 3; ++channel) pixels.push_back(static_cast<float>(rgb[channel]));
}

LatLongImage lat_long(int width, int height) {
  LatLongImage image{width, height, {}};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      append(image.pixels, radiance(image::lat_long_direction(width, height, column + 0.5, row + 0.5)));
    }
  }
  return image;
}

CubemapImage cubemap(int size) {
  CubemapImage cube{size, {}};
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        append(cube.pixels, radiance(image::face_direction(size, face, column + 0.5, row + 0.5)));
      }
    }
  }
  return cube;
}

// Largest distance between the first nine terms and what is recorded, over the largest recorded one.
double deviation(const std::vector<EngineTerm>& terms, const json& expected) {
  double worst = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < 9; ++i) {
    worst = std::max(worst, glm::length(terms.at(i).rgb - triple(expected.at(i))));
    largest = std::max(largest, glm::length(triple(expected.at(i))));
  }
  return worst / largest;
}

}  // namespace

TEST_CASE("Babylon.js makes the same polynomial of the same coefficients", "[engine]") {
  const EngineLight light = engine_light_in_place(coefficients(), Engine::babylon);
  CHECK(deviation(light.terms, recorded().at("babylon").at("of_coefficients").at("terms")) < 1e-14);
}

TEST_CASE("what Babylon.js hands its shader is Filament's and Unity's form, to its own digits", "[engine]") {
  const json& expected = recorded().at("babylon").at("of_coefficients").at("pre_scaled");
  CHECK(deviation(engine_light_in_place(coefficients(), Engine::filament).terms, expected) < 1e-4);
  CHECK(deviation(engine_light_in_place(coefficients(), Engine::unity).terms, expected) < 1e-4);
}

TEST_CASE("a panorama that Babylon.js loads has the polynomial that is made for it", "[engine]") {
  const json& panorama = recorded().at("babylon").at("of_panorama");
  const LatLongImage image = lat_long(panorama.at("width").get<int>(), panorama.at("height").get<int>());
  const SphericalHarmonics light = project(image.view()).radiance;
  // Its way to the cube takes the nearest pixel, half a pixel off: about 1 %.
  CHECK(deviation(engine_light(light, Engine::babylon).terms, panorama.at("terms")) < 0.015);
  // Mirrored or turned by a quarter it would be far off.
  CHECK(deviation(engine_light(light, Engine::three).terms, panorama.at("terms")) > 0.2);
  CHECK(deviation(engine_light_in_place(light, Engine::babylon).terms, panorama.at("terms")) > 0.2);
}

TEST_CASE("three.js gets radiance and irradiance of its light probe's coefficients", "[engine]") {
  const SphericalHarmonics light = coefficients();
  const SphericalHarmonics irradiance = irradiance_from_radiance(light);
  const json& three = recorded().at("three").at("of_coefficients");
  const EngineLight probe = engine_light_in_place(light, Engine::three);
  for (std::size_t i = 0; i < 9; ++i) CHECK(probe.terms.at(i).rgb == light.coefficients()[i]);
  for (std::size_t i = 0; i < recorded().at("normals").size(); ++i) {
    const glm::dvec3 normal = triple(recorded().at("normals").at(i));
    CHECK(glm::length(evaluate(light, normal) - triple(three.at("radiance").at(i))) < 1e-5);
    CHECK(glm::length(evaluate(irradiance, normal) - triple(three.at("irradiance").at(i))) < 1e-5);
  }
}

TEST_CASE("a panorama that three.js loads gives its light probe what is made for it", "[engine]") {
  const json& panorama = recorded().at("three").at("of_panorama");
  const LatLongImage image = lat_long(panorama.at("width").get<int>(), panorama.at("height").get<int>());
  const SphericalHarmonics light = project(image.view()).radiance;
  // Linear filtering and the midpoint rule at 64 texels.
  CHECK(deviation(engine_light(light, Engine::three).terms, panorama.at("coefficients")) < 3e-4);
  // Mirrored or turned by a quarter it would be far off.
  for (const Engine other : {Engine::welkin, Engine::babylon, Engine::unity}) {
    const SphericalHarmonics turned = transform(light, convention(other).from_welkin);
    CHECK(deviation(engine_light_in_place(turned, Engine::three).terms, panorama.at("coefficients")) > 0.1);
  }
}

TEST_CASE("three.js's own generator reads a cube texture as the convention says", "[engine]") {
  const json& texture = recorded().at("three").at("of_cube_texture");
  const Convention& three = convention(Engine::three);
  ProjectionOptions midpoint;
  midpoint.quadrature = Quadrature::midpoint;
  const SphericalHarmonics faces = project(cubemap(texture.at("size").get<int>()).view(), midpoint).radiance;
  // From the faces' frames to three.js's world.
  const SphericalHarmonics light = transform(faces, glm::transpose(*three.faces_from_engine));
  CHECK(deviation(engine_light_in_place(light, Engine::three).terms, texture.at("coefficients")) < 2e-4);
}

}  // namespace welkin
