// Promises: what an engine's shader makes of the terms is the irradiance (or that over pi, as the form says) of the
// same light in the engine's axes. The shaders' formulas are transcribed from their sources: with the engines' own
// constants, cut to five to seven digits, and where a constant stands for a root of a fraction of pi, with that too.
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

#include "support/catch.h"
#include "support/thrown_error.h"
#include "welkin/engine_light.h"
#include "welkin/harmonic_transforms.h"

namespace welkin {
namespace {

constexpr double kPi = std::numbers::pi;

SphericalHarmonics some_light(int bands, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  SphericalHarmonics light(bands);
  for (glm::dvec3& rgb : light.coefficients()) rgb = {normal(generator), normal(generator), normal(generator)};
  light.at(0, 0) += 5.0;
  return light;
}

std::vector<glm::dvec3> normals() {
  std::mt19937 generator(11);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> all = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < 100; ++i) {
    all.push_back(glm::normalize(glm::dvec3(normal(generator), normal(generator), normal(generator))));
  }
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

// What the engines' decimals stand for: sqrt(1/pi)/2 = 0.282095, sqrt(3/pi)/2 = 0.488603, sqrt(15/pi)/2 = 1.092548,
// sqrt(5/pi)/4 = 0.315392, sqrt(15/pi)/4 = 0.546274.
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

// three.js: shGetIrradianceAt.
glm::dvec3 three_shader(const EngineLight& light, const glm::dvec3& n) {
  const auto c = nine(light, "coefficients");
  return 0.886227 * c[0] + 2.0 * 0.511664 * (c[1] * n.y + c[2] * n.z + c[3] * n.x) +
         2.0 * 0.429043 * (c[4] * n.x * n.y + c[5] * n.y * n.z + c[7] * n.x * n.z) +
         c[6] * (0.743125 * n.z * n.z - 0.247708) + 0.429043 * c[8] * (n.x * n.x - n.y * n.y);
}

// The same with what its decimals stand for: A(l) times the basis functions' constants.
glm::dvec3 three_shader_exact(const EngineLight& light, const glm::dvec3& n) {
  const auto c = nine(light, "coefficients");
  const double a1 = 2.0 * kPi / 3.0;
  const double a2 = kPi / 4.0;
  return kPi * kExact.k0 * c[0] + a1 * kExact.k1 * (c[1] * n.y + c[2] * n.z + c[3] * n.x) +
         a2 * kExact.k2 * (c[4] * n.x * n.y + c[5] * n.y * n.z + c[7] * n.x * n.z) +
         c[6] * (3.0 * a2 * kExact.k20 * n.z * n.z - a2 * kExact.k20) +
         a2 * kExact.k22 * c[8] * (n.x * n.x - n.y * n.y);
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

// Unity's nine numbers without its vectors: what they mean in GetShaderConstantsFromNormalizedSH is Filament's sum.
glm::dvec3 unity_sum(const EngineLight& light, const glm::dvec3& n) { return filament_shader(light, n); }

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

// Godot: lightmap captures. Its decimals are pi, 2 pi/3, pi/4 times the basis functions' constants.
glm::dvec3 godot_sum(const EngineLight& light, const glm::dvec3& n, const double (&c)[5]) {
  const auto sh = nine(light, "sh");
  return c[0] * sh[0] + c[1] * (sh[1] * n.y + sh[2] * n.z + sh[3] * n.x) +
         c[2] * (sh[4] * n.x * n.y + sh[5] * n.y * n.z + sh[7] * n.x * n.z) + c[3] * sh[6] * (3.0 * n.z * n.z - 1.0) +
         c[4] * sh[8] * (n.x * n.x - n.y * n.y);
}
glm::dvec3 godot_shader(const EngineLight& light, const glm::dvec3& n) {
  return godot_sum(light, n, {0.886227, 1.023327, 0.858086, 0.247708, 0.429043});
}
glm::dvec3 godot_shader_exact(const EngineLight& light, const glm::dvec3& n) {
  return godot_sum(light, n,
                   {kPi * kExact.k0, 2.0 * kPi / 3.0 * kExact.k1, kPi / 4.0 * kExact.k2, kPi / 4.0 * kExact.k20,
                    kPi / 4.0 * kExact.k22});
}

struct Case {
  Engine engine;
  glm::dvec3 (*shader)(const EngineLight&, const glm::dvec3&);
  double times;      // of the irradiance
  double tolerance;  // of the largest coefficient
};

constexpr double kRounding = 1e-14;

const Case kCases[] = {{Engine::babylon, babylon_shader, 1.0 / kPi, 1e-4},
                       {Engine::three, three_shader, 1.0, 5e-6},
                       {Engine::three, three_shader_exact, 1.0, kRounding},
                       {Engine::filament, filament_shader, 1.0 / kPi, kRounding},
                       {Engine::unity, vector_shader, 1.0 / kPi, kRounding},
                       {Engine::unity, unity_sum, 1.0 / kPi, kRounding},
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
  for (const Case& each : kCases) {
    for (const int bands : {1, 2, 3, 5}) {
      INFO(convention(each.engine).name << ", " << bands << " bands");
      const SphericalHarmonics light = some_light(bands, 3U + static_cast<unsigned>(bands));
      const SphericalHarmonics irradiance = irradiance_from_radiance(
          with_bands(transform(light, convention(each.engine).from_welkin), std::min(bands, 3)));
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
  for (const Case& each : kCases) {
    INFO(convention(each.engine).name);
    const glm::dmat3& axes = convention(each.engine).from_welkin;
    const EngineLight form = engine_light(light, each.engine);
    const double at_centre = each.shader(form, axes * centre).x;
    for (const glm::dvec3& other : {glm::dvec3(1, 0, 0), {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}}) {
      CHECK(at_centre > 2.0 * each.shader(form, axes * other).x);
    }
  }
}

TEST_CASE("forms without the turn are those of light that is turned already", "[engine]") {
  const SphericalHarmonics light = some_light(3, 5);
  for (const Case& each : kCases) {
    INFO(convention(each.engine).name);
    const EngineLight turned = engine_light(light, each.engine);
    const EngineLight in_place =
        engine_light_in_place(transform(light, convention(each.engine).from_welkin), each.engine);
    CHECK(turned.engine == each.engine);
    CHECK(turned.form == in_place.form);
    REQUIRE(turned.terms.size() == in_place.terms.size());
    for (std::size_t i = 0; i < turned.terms.size(); ++i) CHECK(turned.terms[i].rgb == in_place.terms[i].rgb);
    REQUIRE(turned.vectors.size() == in_place.vectors.size());
    for (std::size_t i = 0; i < turned.vectors.size(); ++i) CHECK(turned.vectors[i].value == in_place.vectors[i].value);
  }
}

TEST_CASE("Unity's and Unreal's vectors are named and packed as their shaders declare them", "[engine]") {
  const SphericalHarmonics light = some_light(3, 7);
  const EngineLight unity = engine_light_in_place(light, Engine::unity);
  const char* const names[] = {"unity_SHAr", "unity_SHAg", "unity_SHAb", "unity_SHBr",
                               "unity_SHBg", "unity_SHBb", "unity_SHC"};
  REQUIRE(unity.vectors.size() == 7);
  for (std::size_t i = 0; i < 7; ++i) CHECK(unity.vectors[i].name == names[i]);
  const auto sh = nine(unity, "sh");
  CHECK(unity.vectors[1].value == glm::dvec4(sh[3].y, sh[1].y, sh[2].y, sh[0].y - sh[6].y));
  CHECK(unity.vectors[5].value == glm::dvec4(sh[4].z, sh[5].z, 3.0 * sh[6].z, sh[7].z));
  CHECK(unity.vectors[6].value == glm::dvec4(sh[8], 1.0));
  const EngineLight unreal = engine_light_in_place(light, Engine::unreal);
  REQUIRE(unreal.vectors.size() == 7);
  for (std::size_t i = 0; i < 7; ++i) {
    CHECK(unreal.vectors[i].name == "SkyIrradianceEnvironmentMap[" + std::to_string(i) + "]");
    CHECK(unreal.vectors[i].value == unity.vectors[i].value);
  }
  for (const Engine engine : {Engine::babylon, Engine::three, Engine::filament, Engine::gltf, Engine::godot}) {
    CHECK(engine_light_in_place(light, engine).vectors.empty());
  }
}

TEST_CASE("engines without a form are refused, and those with one named", "[engine]") {
  for (const Engine engine : {Engine::welkin, Engine::openexr, Engine::blender}) {
    CHECK_FALSE(has_engine_light(engine));
    const test::ThrownError error = test::thrown_by([&] { (void)engine_light(SphericalHarmonics(3), engine); });
    CHECK(error.code == ErrorCode::invalid_argument);
    CHECK(error.says("has no form of its own"));
    CHECK(error.says("babylon, three, filament, gltf, unity, unreal and godot"));
  }
  for (const Case& each : kCases) CHECK(has_engine_light(each.engine));
}

}  // namespace welkin
