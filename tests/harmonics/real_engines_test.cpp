// Compares Welkin with results of the real Babylon.js and three.js, recorded or shared.
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>

#include "support/catch.h"
#include "support/images.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promises: the real Babylon.js and three.js make of our coefficients what the forms say, and of the same surroundings
// the coefficients that we have for them, the right way round. What they said is in tests/data/engines.json
// (tests/engine/record.mjs); the ctest engine_live asks them again.

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

/// Its texels hold `formula(direction, face, column, row)`.
template <class Formula>
Cubemap cubemap(int size, const Formula& formula) {
  int texel = 0;
  return cubemap_of(size, [&](const glm::dvec3& direction) {
    const int row = texel / size;
    return formula(direction, row / size, texel++ % size, row % size);
  });
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
  const EngineLight light = engine_light_unrotated(coefficients(), Engine::babylon);
  CHECK(deviation(light.terms, recorded().at("babylon").at("of_coefficients").at("terms")) < 1e-14);
}

TEST_CASE("what Babylon.js hands its shader is Filament's and Unity's form, to its own digits", "[engine]") {
  const json& expected = recorded().at("babylon").at("of_coefficients").at("pre_scaled");
  CHECK(deviation(engine_light_unrotated(coefficients(), Engine::filament).terms, expected) < 1e-4);
  CHECK(deviation(engine_light_unrotated(coefficients(), Engine::unity).terms, expected) < 1e-4);
}

TEST_CASE("a panorama that Babylon.js loads has the polynomial that is made for it", "[engine]") {
  const json& panorama = recorded().at("babylon").at("of_panorama");
  const LatLongImage image = lat_long_of(panorama.at("width").get<int>(), panorama.at("height").get<int>(), radiance);
  const SphericalHarmonics light = project(image.view()).radiance;
  // Its way to the cube takes the nearest pixel, half a pixel off: about 1 %.
  CHECK(deviation(engine_light(light, Engine::babylon).terms, panorama.at("terms")) < 0.015);
  // Mirrored or rotated by 90 degrees it would be far off.
  CHECK(deviation(engine_light(light, Engine::three).terms, panorama.at("terms")) > 0.2);
  CHECK(deviation(engine_light_unrotated(light, Engine::babylon).terms, panorama.at("terms")) > 0.2);
}

TEST_CASE("three.js gets radiance and irradiance of its light probe's coefficients", "[engine]") {
  const SphericalHarmonics light = coefficients();
  const SphericalHarmonics irradiance = irradiance_from_radiance(light);
  const json& three = recorded().at("three").at("of_coefficients");
  const EngineLight probe = engine_light_unrotated(light, Engine::three);
  for (std::size_t i = 0; i < 9; ++i) CHECK(probe.terms.at(i).rgb == light.coefficients()[i]);
  for (std::size_t i = 0; i < recorded().at("normals").size(); ++i) {
    const glm::dvec3 normal = triple(recorded().at("normals").at(i));
    CHECK(glm::length(evaluate(light, normal) - triple(three.at("radiance").at(i))) < 1e-5);
    CHECK(glm::length(evaluate(irradiance, normal) - triple(three.at("irradiance").at(i))) < 1e-5);
  }
}

TEST_CASE("a panorama that three.js loads gives its light probe what is made for it", "[engine]") {
  const json& panorama = recorded().at("three").at("of_panorama");
  const LatLongImage image = lat_long_of(panorama.at("width").get<int>(), panorama.at("height").get<int>(), radiance);
  const SphericalHarmonics light = project(image.view()).radiance;
  // Linear filtering and the midpoint rule at 64 texels.
  CHECK(deviation(engine_light(light, Engine::three).terms, panorama.at("coefficients")) < 3e-4);
  // Mirrored or rotated by 90 degrees it would be far off.
  for (const Engine other : {Engine::welkin, Engine::babylon, Engine::unity}) {
    const SphericalHarmonics wrong = rotate(light, convention(other).from_welkin);
    CHECK(deviation(engine_light_unrotated(wrong, Engine::three).terms, panorama.at("coefficients")) > 0.1);
  }
}

TEST_CASE("three.js's own generator reads a cube texture as the convention says", "[engine]") {
  const json& texture = recorded().at("three").at("of_cube_texture");
  const Convention& three = convention(Engine::three);
  const ProjectionOptions midpoint{.quadrature = Quadrature::midpoint};
  const SphericalHarmonics faces =
      project(cubemap_of(texture.at("size").get<int>(), radiance).view(), midpoint).radiance;
  // From the faces' frames to three.js's world.
  const SphericalHarmonics light = rotate(faces, glm::transpose(*three.faces_from_engine));
  CHECK(deviation(engine_light_unrotated(light, Engine::three).terms, texture.at("coefficients")) < 2e-4);
}

// Promises: for the cubemaps of ../shared/oracles/web, the recorded results of the real Babylon.js and three.js are
// those that `--from ENGINE --for ENGINE` gives for the same faces. Skipped where that folder is missing.

namespace {

// Texel of a cubemap of gen_cases.mjs that is a polynomial of the direction d, or of face f, column x and row y.
using Formula = glm::dvec3 (*)(const glm::dvec3& d, int f, int x, int y);

struct Case {
  const char* name;
  int size;
  Formula formula;
};

const Case kCases[] = {
    {"uniform_8", 8, [](const glm::dvec3&, int, int, int) { return glm::dvec3(0.5, 1.0, 2.0); }},
    {"linear_64", 64, [](const glm::dvec3& d, int, int, int) { return 1.0 + d; }},
    {"quad_off_64", 64,
     [](const glm::dvec3& d, int, int, int) { return 1.0 + glm::dvec3(d.x * d.y, d.y * d.z, d.z * d.x); }},
    {"quad_diag_64", 64, [](const glm::dvec3& d, int, int, int) { return d * d; }},
    {"orient_16", 16, [](const glm::dvec3&, int f, int x, int y) { return glm::dvec3(f + 1, x, 2 * y); }}};

// Rotates light as the command does: from the frames of CubemapView, in which the engine's faces lie, into its axes.
EngineLight light_of_faces(const SphericalHarmonics& faces, Engine engine) {
  const Convention& of = convention(engine);
  return engine_light(rotate(faces, glm::transpose(*of.faces_from_engine * of.from_welkin)), engine);
}

json babylon_terms(const json& polynomial) {
  json terms = json::array();
  for (const char* const name : {"x", "y", "z", "xx", "yy", "zz", "yz", "zx", "xy"})
    terms.push_back(polynomial.at(name));
  return terms;
}

}  // namespace

TEST_CASE("Babylon.js's and three.js's numbers for shared cubemaps are those of --from and --for", "[engine]") {
  const std::filesystem::path folder = WELKIN_SHARED "/oracles/web/expected";
  if (!std::filesystem::is_directory(folder)) {
    WARN("nothing to compare with: " << folder << " is not there");
    return;
  }
  const ProjectionOptions midpoint{.quadrature = Quadrature::midpoint};
  for (const Case& each : kCases) {
    INFO(each.name);
    const json expected = json::parse(std::ifstream(folder / (std::string(each.name) + ".json")));
    const SphericalHarmonics faces = project(cubemap(each.size, each.formula).view(), midpoint).radiance;
    CHECK(deviation(light_of_faces(faces, Engine::babylon).terms,
                    babylon_terms(expected.at("runs").at("default").at("polynomial"))) < 1e-6);
    // three.js weighs a texel by 4 / distance^3 instead of its solid angle, and cuts its constants at six digits.
    const double tolerance = each.size >= 64 ? 2e-4 : 1.2 / (each.size * each.size);
    const json& three = expected.at("three");
    CHECK(deviation(light_of_faces(faces, Engine::three).terms, three.at("cubeTexture").at("coefficients")) <
          tolerance);
    // A render target that three.js reads back is not mirrored: the frames of CubemapView are its own axes.
    CHECK(deviation(engine_light_unrotated(faces, Engine::three).terms, three.at("webgl").at("coefficients")) <
          tolerance);
  }
}

// Promise: the polynomial that the real Babylon.js stored in .env files, when it baked them from the photographs of
// ../shared, is the one that we have for the same photographs: orientation, signs and factors, over its whole way.

namespace {

using Terms = std::map<std::string, glm::dvec3>;

double deviation(const EngineLight& light, const Terms& stored) {
  double worst = 0.0;
  double largest = 0.0;
  for (const EngineTerm& term : light.terms) {
    worst = std::max(worst, glm::length(term.rgb - stored.at(term.name)));
    largest = std::max(largest, glm::length(stored.at(term.name)));
  }
  return worst / largest;
}

}  // namespace

TEST_CASE("the .env files that Babylon.js baked hold the polynomials of their photographs", "[engine][shared]") {
  const auto stored = recorded_harmonics("env polynomial (as stored)");
  if (stored.empty()) {
    WARN("left out: the shared environments are not at " << kImages);
    return;
  }
  const std::pair<const char*, const char*> pairs[] = {{"babylon_dikhololo_night_64.env", "dikhololo_night_1k.hdr"},
                                                       {"babylon_lebombo_64_webp.env", "lebombo_1k.hdr"},
                                                       {"babylon_potsdamer_platz_256.env", "potsdamer_platz_1k.hdr"},
                                                       {"babylon_spruit_sunrise_128.env", "spruit_sunrise_1k.hdr"},
                                                       {"babylon_studio_small_03_128.env", "studio_small_03_1k.hdr"},
                                                       {"babylon_venice_sunset_128.env", "venice_sunset_1k.hdr"}};
  for (const auto& [baked, photograph] : pairs) {
    INFO(baked);
    const Terms terms(stored.at(baked).begin(), stored.at(baked).end());
    ProjectionOptions options;
    options.pixels.clamp = RadianceClamp{};  // 4096, as Babylon.js has it
    const SphericalHarmonics light = project_file(kImages / "env" / photograph, {}, options).radiance;
    // It goes through cube faces of 64 to 256 texels, each the nearest pixel's: up to 3 % off.
    CHECK(deviation(engine_light(light, Engine::babylon), terms) < 0.04);
    const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
    CHECK(deviation(engine_light(rotate(light, mirror), Engine::babylon), terms) > 0.05);
  }
}

}  // namespace welkin::test
