// Promises: for the cubemaps that ../shared/oracles/web asked the real Babylon.js and three.js about, their numbers are
// those that `--from ENGINE --for ENGINE` gives of the same faces. Skipped where that folder is not.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <string>
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

// Those of its cubemaps (gen_cases.mjs) that are a polynomial of the direction d, or of face f, column x and row y.
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

CubemapImage cubemap(const Case& of) {
  CubemapImage cube{of.size, {}};
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < of.size; ++row) {
      for (int column = 0; column < of.size; ++column) {
        const glm::dvec3 direction = image::face_direction(of.size, face, column + 0.5, row + 0.5);
        const glm::dvec3 rgb = of.formula(glm::normalize(direction), face, column, row);
        for (int channel = 0; channel < 3; ++channel) cube.pixels.push_back(static_cast<float>(rgb[channel]));
      }
    }
  }
  return cube;
}

// As the command turns light: out of the frames of CubemapView in which the engine's faces lie, into its axes.
EngineLight light_of_faces(const SphericalHarmonics& faces, Engine engine) {
  const Convention& of = convention(engine);
  return engine_light(transform(faces, glm::transpose(*of.faces_from_engine * of.from_welkin)), engine);
}

double deviation(const EngineLight& light, const std::vector<json>& expected) {
  double worst = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const json& value = expected[i];
    const glm::dvec3 rgb(value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>());
    worst = std::max(worst, glm::length(light.terms.at(i).rgb - rgb));
    largest = std::max(largest, glm::length(rgb));
  }
  return worst / largest;
}

std::vector<json> babylon_terms(const json& polynomial) {
  std::vector<json> terms;
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
  ProjectionOptions midpoint;
  midpoint.quadrature = Quadrature::midpoint;
  for (const Case& each : kCases) {
    INFO(each.name);
    const json expected = json::parse(std::ifstream(folder / (std::string(each.name) + ".json")));
    const SphericalHarmonics faces = project(cubemap(each).view(), midpoint).radiance;
    CHECK(deviation(light_of_faces(faces, Engine::babylon),
                    babylon_terms(expected.at("runs").at("default").at("polynomial"))) < 1e-6);
    // three.js weighs a texel by 4 / distance^3 instead of its solid angle, and cuts its constants at six digits.
    const double tolerance = each.size >= 64 ? 2e-4 : 1.2 / (each.size * each.size);
    const json& three = expected.at("three");
    CHECK(deviation(light_of_faces(faces, Engine::three), three.at("cubeTexture").at("coefficients")) < tolerance);
    // What three.js reads back from a render target is not mirrored: the frames of CubemapView are its own axes.
    CHECK(deviation(engine_light_in_place(faces, Engine::three), three.at("webgl").at("coefficients")) < tolerance);
  }
}

}  // namespace welkin
