// Promises: a lat-long lies in each engine's axes as that engine's own code lays it out, and its cube faces where it
// looks for them. The formulas are those of the engines, as `Convention::source` names them.
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "image/texel_geometry.h"
#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/convention.h"

namespace welkin {
namespace {

constexpr double kPi = std::numbers::pi;

// (u, v) in [0, 1), from the left and from the top.
using ToPicture = std::function<glm::dvec2(const glm::dvec3&)>;

glm::dvec2 wrapped(double u, double v) { return {u - std::floor(u), v}; }

// LatLongView: direction = (sin lon cos lat, sin lat, cos lon cos lat), lon = pi - 2 pi u, lat = pi/2 - pi v.
glm::dvec2 welkin_picture(const glm::dvec3& d) {
  return wrapped(0.5 - std::atan2(d.x, d.z) / (2.0 * kPi), 0.5 - std::asin(d.y) / kPi);
}

// v from the bottom in three of these, as textures have it: turned over here.
glm::dvec2 babylon_picture(const glm::dvec3& d) {
  return wrapped(0.5 + std::atan2(d.x, d.z) / (2.0 * kPi), std::acos(d.y) / kPi);
}

glm::dvec2 three_picture(const glm::dvec3& d) {
  return wrapped(std::atan2(d.z, d.x) / (2.0 * kPi) + 0.5, 1.0 - (std::asin(d.y) / kPi + 0.5));
}

// cmgen: longitude from atan2(x, z), right +x, into a cubemap that is then mirrored in x.
glm::dvec2 filament_picture(const glm::dvec3& d) {
  return wrapped(0.5 * (std::atan2(-d.x, d.z) / kPi + 1.0), 0.5 - std::asin(d.y) / kPi);
}

glm::dvec2 gltf_picture(const glm::dvec3& d) {
  return wrapped(0.5 + 0.5 * std::atan2(d.z, d.x) / kPi, std::acos(d.y) / kPi);
}

glm::dvec2 unity_picture(const glm::dvec3& d) {
  const double from_bottom = 1.0 - std::acos(d.y) / kPi;
  return wrapped(0.5 - std::atan2(d.z, d.x) * 0.5 / kPi, 1.0 - from_bottom);
}

// LookupLongLat(X, Y, Z) of the world's direction with y and z exchanged, and of cube faces likewise.
glm::dvec2 unreal_picture(const glm::dvec3& world) {
  const glm::dvec3 d(world.x, world.z, world.y);
  return wrapped((1.0 + std::atan2(d.x, -d.z) / kPi) / 2.0, std::acos(d.y) / kPi);
}

glm::dvec2 blender_picture(const glm::dvec3& d) {
  const double from_bottom = (std::acos(d.z) - kPi) / -kPi;
  return wrapped((std::atan2(d.y, d.x) - kPi) / (-2.0 * kPi), 1.0 - from_bottom);
}

glm::dvec2 godot_picture(const glm::dvec3& d) {
  return wrapped(std::atan2(d.x, -d.z) / (2.0 * kPi), std::acos(d.y) / kPi);
}

// Where the engine's own code looks into a lat-long for a texel of a cube face; u, v in [-1, 1] from the left and top.
using FaceToPicture = glm::dvec2 (*)(int face, double u, double v);

// glTF-IBL-Sampler: panoramaToCubeMap, which has y downwards in its directions and 0 on top in its textures.
glm::dvec2 gltf_face(int face, double u, double v) {
  const glm::dvec3 scans[6] = {{1, v, -u}, {-1, v, u}, {u, -1, v}, {u, 1, -v}, {u, v, 1}, {-u, v, -1}};
  const glm::dvec3 d = glm::normalize(scans[face]);
  return wrapped(0.5 + 0.5 * std::atan2(d.z, d.x) / kPi, 1.0 - std::acos(d.y) / kPi);
}

// Unreal: LookupLongLatDouble of TransformSideToWorldSpace of (u, v, 1), which exchanges y and z at its end.
glm::dvec2 unreal_face(int face, double u, double v) {
  const glm::dvec3 sides[6] = {{1, -v, -u}, {-1, -v, u}, {u, 1, v}, {u, -1, -v}, {u, -v, 1}, {-u, -v, -1}};
  const glm::dvec3 side = glm::normalize(sides[face]);
  const glm::dvec3 d(side.x, side.z, side.y);
  return wrapped((1.0 + std::atan2(d.x, -d.z) / kPi) / 2.0, std::acos(d.y) / kPi);
}

struct Case {
  Engine engine;
  ToPicture picture;
  bool right_handed;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {Engine::welkin, welkin_picture, true},     {Engine::openexr, welkin_picture, true},
      {Engine::babylon, babylon_picture, false},  {Engine::three, three_picture, true},
      {Engine::filament, filament_picture, true}, {Engine::gltf, gltf_picture, true},
      {Engine::unity, unity_picture, false},      {Engine::unreal, unreal_picture, false},
      {Engine::blender, blender_picture, true},   {Engine::godot, godot_picture, true}};
  return all;
}

std::vector<glm::dvec3> directions() {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> all;
  all.reserve(500);
  for (int i = 0; i < 500; ++i) {
    all.push_back(glm::normalize(glm::dvec3(normal(generator), normal(generator), normal(generator))));
  }
  return all;
}

bool is_signed_permutation(const glm::dmat3& matrix) {
  for (int column = 0; column < 3; ++column) {
    double sum = 0.0;
    for (int row = 0; row < 3; ++row) {
      const double size = std::abs(matrix[column][row]);
      if (size != 0.0 && size != 1.0) return false;
      sum += size;
    }
    if (sum != 1.0) return false;
  }
  return matrix * glm::transpose(matrix) == glm::dmat3(1.0);
}

// "centre +z, right -x" to the two directions.
glm::dvec3 axis_behind(const std::string& text, const std::string& word) {
  const std::size_t place = text.find(word + ' ');
  REQUIRE(place != std::string::npos);
  const char sign = text.at(place + word.size() + 1);
  glm::dvec3 axis{};
  axis[text.at(place + word.size() + 2) - 'x'] = sign == '+' ? 1.0 : -1.0;
  return axis;
}

}  // namespace

TEST_CASE("a lat-long lies in an engine's axes where the engine's own formula puts it", "[engine]") {
  REQUIRE(cases().size() == conventions().size());
  for (const Case& each : cases()) {
    const Convention& engine = convention(each.engine);
    INFO(engine.name);
    for (const glm::dvec3& direction : directions()) {
      const glm::dvec2 by_engine = each.picture(engine.from_welkin * direction);
      const glm::dvec2 by_welkin = welkin_picture(direction);
      REQUIRE(glm::length(by_engine - by_welkin) < 1e-12);
    }
  }
}

TEST_CASE("axes are signed permutations, mirrored for left-handed engines alone", "[engine]") {
  for (const Case& each : cases()) {
    const Convention& engine = convention(each.engine);
    INFO(engine.name);
    CHECK(engine.engine == each.engine);
    CHECK(engine.right_handed == each.right_handed);
    CHECK(is_signed_permutation(engine.from_welkin));
    CHECK(glm::determinant(engine.from_welkin) == (engine.right_handed ? 1.0 : -1.0));
    const bool says_right = std::string(engine.axes).find("right-handed") == 0;
    CHECK(says_right == engine.right_handed);
    const glm::dvec3 up =
        std::string(engine.axes).find("z up") != std::string::npos ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    CHECK(engine.from_welkin * glm::dvec3(0, 1, 0) == up);
  }
}

TEST_CASE("the words about a lat-long are those of the matrix", "[engine]") {
  for (const Convention& engine : conventions()) {
    INFO(engine.name);
    CHECK(engine.from_welkin * glm::dvec3(0, 0, 1) == axis_behind(engine.lat_long, "centre"));
    CHECK(engine.from_welkin * glm::dvec3(-1, 0, 0) == axis_behind(engine.lat_long, "right"));
  }
}

TEST_CASE("cube faces are looked up by the world's direction, but for three.js, which mirrors x", "[engine]") {
  for (const Convention& engine : conventions()) {
    INFO(engine.name);
    if (engine.engine == Engine::blender) {
      CHECK(!engine.faces_from_engine);
      continue;
    }
    REQUIRE(engine.faces_from_engine.has_value());
    const glm::dvec3 x = *engine.faces_from_engine * glm::dvec3(1, 0, 0);
    CHECK(x == glm::dvec3(engine.engine == Engine::three ? -1 : 1, 0, 0));
    CHECK(*engine.faces_from_engine * glm::dvec3(0, 1, 0) == glm::dvec3(0, 1, 0));
    CHECK(*engine.faces_from_engine * glm::dvec3(0, 0, 1) == glm::dvec3(0, 0, 1));
  }
}

TEST_CASE("an engine's own code fills the cube faces of a lat-long as the convention says", "[engine]") {
  const std::pair<Engine, FaceToPicture> engines[] = {{Engine::gltf, gltf_face}, {Engine::unreal, unreal_face}};
  constexpr int kSize = 6;
  for (const auto& [engine, by_engine] : engines) {
    const Convention& of = convention(engine);
    INFO(of.name);
    const glm::dmat3 from_faces = glm::transpose(*of.faces_from_engine * of.from_welkin);
    for (int texel = 0; texel < 6 * kSize * kSize; ++texel) {
      const int face = texel / (kSize * kSize);
      const double column = texel % kSize + 0.5;
      const double row = texel / kSize % kSize + 0.5;
      const glm::dvec3 direction = glm::normalize(image::face_direction(kSize, face, column, row));
      const glm::dvec2 expected = welkin_picture(from_faces * direction);
      const glm::dvec2 found = by_engine(face, 2.0 * column / kSize - 1.0, 2.0 * row / kSize - 1.0);
      REQUIRE(glm::length(found - expected) < 1e-12);
    }
  }
}

TEST_CASE("conventions go by their names", "[engine]") {
  for (const Convention& engine : conventions()) CHECK(&convention(std::string_view(engine.name)) == &engine);
  const test::ThrownError error = test::thrown_by([] { (void)convention("Babylon"); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("\"Babylon\" is no convention"));
  for (const Convention& engine : conventions()) CHECK(error.says(engine.name));
}

}  // namespace welkin
