// Conventions of engines: where a lat-long and a cubemap lie in their axes, and what their shaders make of our terms.
#include "welkin/engines.h"

#include <glm/matrix.hpp>

#include "image/geometry.h"
#include "support/catch.h"
#include "support/random_harmonics.h"
#include "support/thrown_error.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {

// Promises: a lat-long lies in each engine's axes as that engine's own code lays it out, and its cube faces where it
// looks for them. The formulas are those of the engines, as `Convention::source` names them.

namespace {

constexpr double kPi = std::numbers::pi;

// (u, v) in [0, 1), from the left and from the top.
using ToImage = std::function<glm::dvec2(const glm::dvec3&)>;

glm::dvec2 wrapped(double u, double v) { return {u - std::floor(u), v}; }

// LatLongView: direction = (sin lon cos lat, sin lat, cos lon cos lat), lon = pi - 2 pi u, lat = pi/2 - pi v.
glm::dvec2 welkin_image(const glm::dvec3& d) {
  return wrapped(0.5 - std::atan2(d.x, d.z) / (2.0 * kPi), 0.5 - std::asin(d.y) / kPi);
}

// Three of these measure v from the bottom, as textures do; it is flipped here.
glm::dvec2 babylon_image(const glm::dvec3& d) {
  return wrapped(0.5 + std::atan2(d.x, d.z) / (2.0 * kPi), std::acos(d.y) / kPi);
}

glm::dvec2 three_image(const glm::dvec3& d) {
  return wrapped(std::atan2(d.z, d.x) / (2.0 * kPi) + 0.5, 1.0 - (std::asin(d.y) / kPi + 0.5));
}

// cmgen: longitude from atan2(x, z), right +x, into a cubemap that is then mirrored in x.
glm::dvec2 filament_image(const glm::dvec3& d) {
  return wrapped(0.5 * (std::atan2(-d.x, d.z) / kPi + 1.0), 0.5 - std::asin(d.y) / kPi);
}

glm::dvec2 gltf_image(const glm::dvec3& d) {
  return wrapped(0.5 + 0.5 * std::atan2(d.z, d.x) / kPi, std::acos(d.y) / kPi);
}

glm::dvec2 unity_image(const glm::dvec3& d) {
  const double from_bottom = 1.0 - std::acos(d.y) / kPi;
  return wrapped(0.5 - std::atan2(d.z, d.x) * 0.5 / kPi, 1.0 - from_bottom);
}

// LookupLongLat(X, Y, Z) of the world's direction with y and z exchanged, for cube faces too.
glm::dvec2 unreal_image(const glm::dvec3& world) {
  const glm::dvec3 d(world.x, world.z, world.y);
  return wrapped((1.0 + std::atan2(d.x, -d.z) / kPi) / 2.0, std::acos(d.y) / kPi);
}

glm::dvec2 blender_image(const glm::dvec3& d) {
  const double from_bottom = (std::acos(d.z) - kPi) / -kPi;
  return wrapped((std::atan2(d.y, d.x) - kPi) / (-2.0 * kPi), 1.0 - from_bottom);
}

glm::dvec2 godot_image(const glm::dvec3& d) {
  return wrapped(std::atan2(d.x, -d.z) / (2.0 * kPi), std::acos(d.y) / kPi);
}

// Where the engine's own code looks into a lat-long for a texel of a cube face; u, v in [-1, 1] from the left and top.
using FaceToImage = glm::dvec2 (*)(int face, double u, double v);

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

// PlayCanvas: calcReflection, which negates x, and toSphericalUv.
glm::dvec2 playcanvas_image(const glm::dvec3& d) {
  return wrapped(std::atan2(-d.x, d.z) / (2.0 * kPi) + 0.5, 0.5 - std::asin(d.y) / kPi);
}

struct Case {
  Engine engine;
  ToImage image;
  bool right_handed;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {Engine::welkin, welkin_image, true},         {Engine::openexr, welkin_image, true},
      {Engine::babylon, babylon_image, false},      {Engine::three, three_image, true},
      {Engine::filament, filament_image, true},     {Engine::gltf, gltf_image, true},
      {Engine::unity, unity_image, false},          {Engine::unreal, unreal_image, false},
      {Engine::blender, blender_image, true},       {Engine::godot, godot_image, true},
      {Engine::bevy, welkin_image, true},           {Engine::usd, welkin_image, true},
      {Engine::playcanvas, playcanvas_image, true}, {Engine::qt, three_image, true}};
  return all;
}

std::vector<glm::dvec3> directions() {
  RandomLight light(7);
  std::vector<glm::dvec3> all;
  while (all.size() < 500) all.push_back(light.direction());
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

}  // namespace

TEST_CASE("a lat-long lies in an engine's axes where the engine's own formula puts it", "[engine]") {
  REQUIRE(cases().size() == conventions().size());
  for (const Case& each : cases()) {
    const Convention& engine = convention(each.engine);
    INFO(engine.name);
    for (const glm::dvec3& direction : directions()) {
      const glm::dvec2 by_engine = each.image(engine.from_welkin * direction);
      const glm::dvec2 by_welkin = welkin_image(direction);
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

TEST_CASE("cube faces are looked up by the world's direction, but for x in three.js and PlayCanvas and Bevy's z",
          "[engine]") {
  for (const Convention& engine : conventions()) {
    INFO(engine.name);
    if (engine.engine == Engine::blender || engine.engine == Engine::usd) {
      CHECK(!engine.faces_from_engine);
      continue;
    }
    REQUIRE(engine.faces_from_engine.has_value());
    const glm::dvec3 x = *engine.faces_from_engine * glm::dvec3(1, 0, 0);
    const bool is_x_mirrored = engine.engine == Engine::three || engine.engine == Engine::playcanvas;
    CHECK(x == glm::dvec3(is_x_mirrored ? -1 : 1, 0, 0));
    CHECK(*engine.faces_from_engine * glm::dvec3(0, 1, 0) == glm::dvec3(0, 1, 0));
    const glm::dvec3 z = *engine.faces_from_engine * glm::dvec3(0, 0, 1);
    CHECK(z == glm::dvec3(0, 0, engine.engine == Engine::bevy ? -1 : 1));
  }
}

TEST_CASE("an engine's own code fills the cube faces of a lat-long as the convention says", "[engine]") {
  const std::pair<Engine, FaceToImage> engines[] = {{Engine::gltf, gltf_face}, {Engine::unreal, unreal_face}};
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
      const glm::dvec2 expected = welkin_image(from_faces * direction);
      const glm::dvec2 found = by_engine(face, 2.0 * column / kSize - 1.0, 2.0 * row / kSize - 1.0);
      REQUIRE(glm::length(found - expected) < 1e-12);
    }
  }
}

TEST_CASE("conventions go by their names", "[engine]") {
  for (const Convention& engine : conventions()) CHECK(&convention(std::string_view(engine.name)) == &engine);
  const ThrownError error = thrown_by([] { (void)convention("Babylon"); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("\"Babylon\" is not the name of a convention"));
  for (const Convention& engine : conventions()) CHECK(error.says(engine.name));
}

// Promises: what an engine's shader makes of the terms is the irradiance (or that over pi, as the form says) of the
// same light in the engine's axes. The shaders' formulas are transcribed from their sources: with the engines' own
// constants, cut to five to seven digits, and where a constant stands for a root of a fraction of pi, with that too.

namespace {

SphericalHarmonics some_light(int bands, unsigned seed) {
  return add(RandomLight(seed).harmonics(bands), constant_radiance(glm::dvec3(1.5), bands));
}

std::vector<glm::dvec3> normals() {
  std::vector<glm::dvec3> all = directions();
  all.insert(all.end(), {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
  return all;
}

using Terms = std::map<std::string, glm::dvec3>;

Terms terms_of(const EngineLight& light) {
  Terms terms;
  for (const EngineTerm& term : light.terms) terms[term.name] = term.rgb;
  REQUIRE(terms.size() == light.terms.size());
  return terms;
}

std::vector<glm::dvec3> nine(const EngineLight& light, const std::string& name) {
  const Terms terms = terms_of(light);
  std::vector<glm::dvec3> values;
  values.reserve(9);
  for (int i = 0; i < 9; ++i) values.push_back(terms.at(name + '[' + std::to_string(i) + ']'));
  return values;
}

// Constants that the engines write as decimals: sqrt(1/pi)/2 = 0.282095, sqrt(3/pi)/2 = 0.488603,
// sqrt(15/pi)/2 = 1.092548, sqrt(5/pi)/4 = 0.315392, sqrt(15/pi)/4 = 0.546274.
struct Constants {
  double k0, k1, k2, k20, k22;
};

const Constants kExact = {std::sqrt(1.0 / kPi) / 2.0, std::sqrt(3.0 / kPi) / 2.0, std::sqrt(15.0 / kPi) / 2.0,
                          std::sqrt(5.0 / kPi) / 4.0, std::sqrt(15.0 / kPi) / 4.0};
const Constants kCut = {0.282095, 0.488603, 1.092548, 0.315392, 0.546274};

// Babylon.js: SphericalHarmonics.FromPolynomial, preScaleForRendering, then computeEnvironmentIrradiance.
glm::dvec3 babylon_shader(const EngineLight& light, const glm::dvec3& n) {
  const Terms t = terms_of(light);
  const auto& [x, y, z] = std::tie(t.at("x"), t.at("y"), t.at("z"));
  const auto& [xx, yy, zz] = std::tie(t.at("xx"), t.at("yy"), t.at("zz"));
  std::vector<glm::dvec3> h = {0.376127 * (xx + yy) + 0.376126 * zz,
                               -0.977204 * y,
                               0.977204 * z,
                               -0.977204 * x,
                               1.16538 * t.at("xy"),
                               -1.16538 * t.at("yz"),
                               1.34567 * zz - 0.672834 * (xx + yy),
                               -1.16538 * t.at("zx"),
                               1.16538 * (xx - yy)};
  for (glm::dvec3& each : h) each *= kPi;
  const double k1 = std::sqrt(3.0 / (4.0 * kPi));
  const double k2 = std::sqrt(15.0 / (4.0 * kPi));
  return std::sqrt(1.0 / (4.0 * kPi)) * h[0] - k1 * n.y * h[1] + k1 * n.z * h[2] - k1 * n.x * h[3] +
         k2 * n.y * n.x * h[4] - k2 * n.y * n.z * h[5] +
         std::sqrt(5.0 / (16.0 * kPi)) * (3.0 * n.z * n.z - 1.0) * h[6] - k2 * n.z * n.x * h[7] +
         std::sqrt(15.0 / (16.0 * kPi)) * (n.x * n.x - n.y * n.y) * h[8];
}

// Nine numbers over the basis without signs, each function's constant times the cosine lobe's: of band 2's zonal one
// the factor of z^2 and what is taken away.
glm::dvec3 nine_sum(const std::vector<glm::dvec3>& h, const glm::dvec3& n, const double (&c)[6]) {
  return c[0] * h[0] + c[1] * (h[1] * n.y + h[2] * n.z + h[3] * n.x) +
         c[2] * (h[4] * n.x * n.y + h[5] * n.y * n.z + h[7] * n.x * n.z) + h[6] * (c[3] * n.z * n.z - c[4]) +
         c[5] * h[8] * (n.x * n.x - n.y * n.y);
}

// Evaluates `nine_sum` with the exact constants.
glm::dvec3 nine_sum_exact(const std::vector<glm::dvec3>& h, const glm::dvec3& n) {
  const double a1 = 2.0 * kPi / 3.0;
  const double a2 = kPi / 4.0;
  return nine_sum(
      h, n, {kPi * kExact.k0, a1 * kExact.k1, a2 * kExact.k2, 3.0 * a2 * kExact.k20, a2 * kExact.k20, a2 * kExact.k22});
}

// three.js: shGetIrradianceAt.
glm::dvec3 three_shader(const EngineLight& light, const glm::dvec3& n) {
  return nine_sum(nine(light, "coefficients"), n,
                  {0.886227, 2.0 * 0.511664, 2.0 * 0.429043, 0.743125, 0.247708, 0.429043});
}
glm::dvec3 three_shader_exact(const EngineLight& light, const glm::dvec3& n) {
  return nine_sum_exact(nine(light, "coefficients"), n);
}

// Filament: irradianceSH.
glm::dvec3 filament_shader(const EngineLight& light, const glm::dvec3& n) {
  const auto sh = nine(light, "sh");
  return sh[0] + sh[1] * n.y + sh[2] * n.z + sh[3] * n.x + sh[4] * (n.y * n.x) + sh[5] * (n.y * n.z) +
         sh[6] * (3.0 * n.z * n.z - 1.0) + sh[7] * (n.z * n.x) + sh[8] * (n.x * n.x - n.y * n.y);
}

// Unity: SHEvalLinearL0L1 + SHEvalLinearL2. Unreal: GetSkySHDiffuse. They read the same seven vectors.
glm::dvec3 vector_shader(const EngineLight& light, const glm::dvec3& n) {
  REQUIRE(light.vectors.size() == 7);
  const glm::dvec4 linear(n, 1.0);
  const glm::dvec4 quadratic(n.x * n.y, n.y * n.z, n.z * n.z, n.z * n.x);
  glm::dvec3 sum = glm::dvec3(light.vectors[6].value) * (n.x * n.x - n.y * n.y);
  for (int rgb = 0; rgb < 3; ++rgb) {
    const auto channel = static_cast<std::size_t>(rgb);
    sum[rgb] += glm::dot(light.vectors[channel].value, linear) + glm::dot(light.vectors[channel + 3].value, quadratic);
  }
  return sum;
}

// The basis with the Condon-Shortley sign, as Unreal's SHBasisFunction and Babylon.js's SphericalHarmonics have it.
glm::dvec3 signed_sum(const std::vector<glm::dvec3>& c, const glm::dvec3& n, const Constants& k) {
  return k.k0 * c[0] - k.k1 * n.y * c[1] + k.k1 * n.z * c[2] - k.k1 * n.x * c[3] + k.k2 * n.x * n.y * c[4] -
         k.k2 * n.y * n.z * c[5] + k.k20 * (3.0 * n.z * n.z - 1.0) * c[6] - k.k2 * n.x * n.z * c[7] +
         k.k22 * (n.x * n.x - n.y * n.y) * c[8];
}

// Unreal: Dot(V, CalcDiffuseTransfer(n)), which multiplies the bands by pi, 2 pi/3, pi/4.
glm::dvec3 unreal_sum(const EngineLight& light, const glm::dvec3& n, const Constants& constants) {
  auto v = nine(light, "V");
  for (std::size_t i = 0; i < 9; ++i) v[i] *= i == 0 ? kPi : i < 4 ? 2.0 * kPi / 3.0 : kPi / 4.0;
  return signed_sum(v, n, constants);
}
glm::dvec3 unreal_transfer(const EngineLight& light, const glm::dvec3& n) { return unreal_sum(light, n, kCut); }
glm::dvec3 unreal_transfer_exact(const EngineLight& light, const glm::dvec3& n) { return unreal_sum(light, n, kExact); }

// Unreal's vectors by its own formulas from its own V: SetupSkyIrradianceEnvironmentMapConstantsFromSkyIrradiance.
glm::dvec3 unreal_packed(const EngineLight& light, const glm::dvec3& n) {
  const auto v = nine(light, "V");
  const double c0 = 1.0 / (2.0 * std::sqrt(kPi));
  const double c1 = std::sqrt(3.0) / (3.0 * std::sqrt(kPi));
  const double c2 = std::sqrt(15.0) / (8.0 * std::sqrt(kPi));
  const double c3 = std::sqrt(5.0) / (16.0 * std::sqrt(kPi));
  EngineLight packed = light;
  for (int rgb = 0; rgb < 3; ++rgb) {
    const auto channel = static_cast<std::size_t>(rgb);
    packed.vectors.at(channel).value = {-c1 * v[3][rgb], -c1 * v[1][rgb], c1 * v[2][rgb],
                                        c0 * v[0][rgb] - c3 * v[6][rgb]};
    packed.vectors.at(channel + 3).value = {c2 * v[4][rgb], -c2 * v[5][rgb], 3.0 * c3 * v[6][rgb], -c2 * v[7][rgb]};
    packed.vectors.at(6).value[rgb] = 0.5 * c2 * v[8][rgb];
  }
  return vector_shader(packed, n);
}

// glTF, as Babylon.js reads it: coefficients over the signed basis.
glm::dvec3 gltf_sum(const EngineLight& light, const glm::dvec3& n) {
  return signed_sum(nine(light, "irradianceCoefficients"), n, kCut);
}
glm::dvec3 gltf_sum_exact(const EngineLight& light, const glm::dvec3& n) {
  return signed_sum(nine(light, "irradianceCoefficients"), n, kExact);
}

// Godot: lightmap captures.
glm::dvec3 godot_shader(const EngineLight& light, const glm::dvec3& n) {
  return nine_sum(nine(light, "sh"), n, {0.886227, 1.023327, 0.858086, 3.0 * 0.247708, 0.247708, 0.429043});
}
glm::dvec3 godot_shader_exact(const EngineLight& light, const glm::dvec3& n) {
  return nine_sum_exact(nine(light, "sh"), n);
}

struct ShaderCase {
  Engine engine;
  glm::dvec3 (*shader)(const EngineLight&, const glm::dvec3&);
  double times;      // of the irradiance
  double tolerance;  // of the largest coefficient
};

constexpr double kRounding = 1e-14;

const ShaderCase kCases[] = {{Engine::welkin, filament_shader, 1.0 / kPi, kRounding},  // the same polynomial
                             {Engine::babylon, babylon_shader, 1.0 / kPi, 1e-4},
                             {Engine::three, three_shader, 1.0, 5e-6},
                             {Engine::three, three_shader_exact, 1.0, kRounding},
                             {Engine::filament, filament_shader, 1.0 / kPi, kRounding},
                             {Engine::unity, vector_shader, 1.0 / kPi, kRounding},
                             // its nine numbers without the vectors: GetShaderConstantsFromNormalizedSH
                             {Engine::unity, filament_shader, 1.0 / kPi, kRounding},
                             {Engine::unreal, vector_shader, 1.0 / kPi, kRounding},
                             {Engine::unreal, unreal_packed, 1.0 / kPi, kRounding},
                             {Engine::unreal, unreal_transfer, 1.0, 5e-6},
                             {Engine::unreal, unreal_transfer_exact, 1.0, kRounding},
                             {Engine::gltf, gltf_sum, 1.0, 5e-6},
                             {Engine::gltf, gltf_sum_exact, 1.0, kRounding},
                             {Engine::godot, godot_shader, 1.0 / kPi, 5e-6},
                             {Engine::godot, godot_shader_exact, 1.0 / kPi, kRounding}};

double largest(const SphericalHarmonics& light) {
  double size = 0.0;
  for (const glm::dvec3& rgb : light.coefficients()) size = std::max(size, glm::length(rgb));
  return size;
}

}  // namespace

TEST_CASE("an engine's shader gets the irradiance of the light in the engine's axes", "[engine]") {
  for (const ShaderCase& each : kCases) {
    for (const int bands : {1, 2, 3, 5}) {
      INFO(convention(each.engine).name << ", " << bands << " bands");
      const SphericalHarmonics light = some_light(bands, 3U + static_cast<unsigned>(bands));
      const SphericalHarmonics irradiance =
          irradiance_from_radiance(resized(rotate(light, convention(each.engine).from_welkin), std::min(bands, 3)));
      const EngineLight form = engine_light(light, each.engine);
      for (const glm::dvec3& normal : normals()) {
        const glm::dvec3 expected = each.times * evaluate(irradiance, normal);
        REQUIRE(glm::length(each.shader(form, normal) - expected) < each.tolerance * largest(light));
      }
    }
  }
}

TEST_CASE("the same surroundings light the same side in every engine", "[engine]") {
  // A light at the lat-long's centre and one above it; the engine's own name for these directions.
  const glm::dvec3 centre(0, 0, 1);
  SphericalHarmonics light(3);
  double basis[9];
  evaluate_basis(glm::normalize(centre + glm::dvec3(0, 0.5, 0)), 3, basis);
  for (std::size_t i = 0; i < 9; ++i) light.coefficients()[i] = glm::dvec3(basis[i]);
  for (const ShaderCase& each : kCases) {
    INFO(convention(each.engine).name);
    const glm::dmat3& axes = convention(each.engine).from_welkin;
    const EngineLight form = engine_light(light, each.engine);
    const double at_centre = each.shader(form, axes * centre).x;
    for (const glm::dvec3& other : {glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
      CHECK(at_centre > 2.0 * each.shader(form, axes * other).x);
    }
  }
}

TEST_CASE("Unity's and Unreal's vectors are named and packed as their shaders declare them", "[engine]") {
  const SphericalHarmonics light = some_light(3, 7);
  const EngineLight unity = engine_light_unrotated(light, Engine::unity);
  const char* const names[] = {"unity_SHAr", "unity_SHAg", "unity_SHAb", "unity_SHBr",
                               "unity_SHBg", "unity_SHBb", "unity_SHC"};
  REQUIRE(unity.vectors.size() == 7);
  for (std::size_t i = 0; i < 7; ++i) CHECK(unity.vectors[i].name == names[i]);
  const auto sh = nine(unity, "sh");
  CHECK(unity.vectors[1].value == glm::dvec4(sh[3].y, sh[1].y, sh[2].y, sh[0].y - sh[6].y));
  CHECK(unity.vectors[5].value == glm::dvec4(sh[4].z, sh[5].z, 3.0 * sh[6].z, sh[7].z));
  CHECK(unity.vectors[6].value == glm::dvec4(sh[8], 1.0));
  const EngineLight unreal = engine_light_unrotated(light, Engine::unreal);
  REQUIRE(unreal.vectors.size() == 7);
  for (std::size_t i = 0; i < 7; ++i) {
    CHECK(unreal.vectors[i].name == "SkyIrradianceEnvironmentMap[" + std::to_string(i) + "]");
    CHECK(unreal.vectors[i].value == unity.vectors[i].value);
  }
  for (const Engine engine : {Engine::babylon, Engine::three, Engine::filament, Engine::gltf, Engine::godot}) {
    CHECK(engine_light_unrotated(light, engine).vectors.empty());
  }
}

TEST_CASE("engines without a form are refused, and those with one named", "[engine]") {
  for (const Engine engine :
       {Engine::openexr, Engine::blender, Engine::bevy, Engine::usd, Engine::playcanvas, Engine::qt}) {
    CHECK_FALSE(has_engine_light(engine));
    const ThrownError error = thrown_by([&] { (void)engine_light(SphericalHarmonics(3), engine); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("has no form of its own"));
    CHECK(error.says("welkin, babylon, three, filament, gltf, unity, unreal and godot"));
  }
  for (const ShaderCase& each : kCases) CHECK(has_engine_light(each.engine));
}

}  // namespace welkin::test
