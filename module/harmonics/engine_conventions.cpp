// Sources of the forms:
//   Babylon.js  @babylonjs/core, Maths/sphericalPolynomial
//   three.js    math/SphericalHarmonics3, shaders/ShaderChunk/lights_pars_begin, shGetIrradianceAt
//   Filament    libs/ibl CubemapSH.cpp, preprocessSHForShader; shaders light_indirect.fs, irradianceSH
//   Unity       CGIncludes/UnityCG.cginc, ShadeSH9; Rendering.SphericalHarmonicsL2; the vectors: the editor's
//               LookDevView, GetShaderConstantsFromNormalizedSH
//   Unreal      Core Math/SHMath.h, TSHVector::SHBasisFunction, CalcDiffuseTransfer (signs: GetMaximumDirection);
//   Renderer
//               ReflectionEnvironment.cpp, SetupSkyIrradianceEnvironmentMapConstantsFromSkyIrradiance
//   glTF        EXT_lights_image_based, irradianceCoefficients ("spherical harmonic coefficients to define
//   irradiance");
//               sign and pi derived from @babylonjs/loaders, EXT_lights_image_based, and cmgen --sh-irradiance
//   Godot       scene_forward_clustered.glsl, lightmap captures
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "platform/float_environment.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {
namespace {

// The rows of a matrix are the engine's x, y and z in terms of Welkin's, so that it reads as it is written:
// {{-1, 0, 0}, ...} is x' = -x.
struct Rows {
  glm::dvec3 x, y, z;
};

// GLM's constructor takes columns.
constexpr glm::dmat3 matrix(const Rows& rows) {
  return {rows.x.x, rows.y.x, rows.z.x, rows.x.y, rows.y.y, rows.z.y, rows.x.z, rows.y.z, rows.z.z};
}

constexpr glm::dmat3 kSame{1.0};
// Welkin's lat-long has +z at its centre, -x to the right of it and +y above. What follows places these three:
// For example kCentreXRightZ: the engine's x is Welkin's z (the centre), its z Welkin's -x (the right), y stays.
constexpr glm::dmat3 kCentreZRightX = matrix({{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
constexpr glm::dmat3 kCentreXRightZ = matrix({{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}});
constexpr glm::dmat3 kCentreXRightMinusZ = matrix({{0, 0, 1}, {0, 1, 0}, {1, 0, 0}});
constexpr glm::dmat3 kCentreMinusYRightXUpZ = matrix({{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}});
constexpr glm::dmat3 kCentreXRightMinusYUpZ = matrix({{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});

constexpr glm::dmat3 kMirroredX = matrix({{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
constexpr glm::dmat3 kMirroredZ = matrix({{1, 0, 0}, {0, 1, 0}, {0, 0, -1}});

constexpr std::array<Convention, 14> kConventions{{
    {Engine::welkin, "welkin", "Welkin", true, "right-handed, y up", "centre +z, right -x", "include/welkin/image.h",
     kSame, kSame},
    {Engine::openexr, "openexr", "OpenEXR", true, "right-handed, y up", "centre +z, right -x",
     "ImfEnvmap.h, LatLongMap and CubeMap (its cube faces are taken to CubemapView's when they are read)", kSame,
     kSame},
    {Engine::babylon, "babylon", "Babylon.js", false, "left-handed, y up", "centre +z, right +x",
     "@babylonjs/core, Misc/HighDynamicRange/panoramaToCubemap, PanoramaToCubeMapTools.CalcProjectionSpherical",
     kCentreZRightX, kSame},
    {Engine::three, "three", "three.js", true, "right-handed, y up", "centre +x, right +z",
     "three, shaders/ShaderChunk/common, equirectUv; envmap fragments, flipEnvMap = -1 for CubeTexture", kCentreXRightZ,
     kMirroredX},
    {Engine::filament, "filament", "Filament", true, "right-handed, y up", "centre +z, right -x",
     "libs/ibl CubemapUtils.cpp, equirectangularToCubemap (right +x), then mirrorCubemap, which cmgen applies unless "
     "--no-mirror",
     kSame, kSame},
    {Engine::gltf, "gltf", "glTF", true, "right-handed, y up", "centre +x, right +z",
     "glTF-IBL-Sampler, lib/shaders/filter.frag, dirToUV and uvToXYZ with its y turned over (glTF itself knows no "
     "lat-longs; EXT_lights_image_based names the faces alone)",
     kCentreXRightZ, kSame},
    {Engine::unity, "unity", "Unity", false, "left-handed, y up", "centre +x, right -z",
     "DefaultResourcesExtra/Skybox-Panoramic.shader, ToRadialCoords; faces derived: Skybox-Cubed.shader looks up the "
     "world's direction as it is",
     kCentreXRightMinusZ, kSame},
    {Engine::unreal, "unreal", "Unreal Engine", false, "left-handed, z up", "centre -y, right +x",
     "derived: TextureCompressorModule.cpp, LookupLongLatDouble of TransformSideToWorldSpace, whose faces shaders look "
     "up by the world's direction as it is (ReflectionEnvironmentShared.ush, GetSkyLightReflection)",
     kCentreMinusYRightXUpZ, kSame},
    {Engine::blender, "blender", "Blender", true, "right-handed, z up", "centre +x, right -y",
     "intern/cycles/kernel/camera/projection.h, direction_to_equirectangular", kCentreXRightMinusYUpZ, std::nullopt},
    {Engine::godot, "godot", "Godot", true, "right-handed, y up", "centre +z, right -x",
     "servers/rendering/renderer_rd/shaders/environment/sky.glsl, panorama_coords; faces derived: a samplerCube is "
     "looked up by EYEDIR as it is",
     kSame, kSame},
    {Engine::bevy, "bevy", "Bevy", true, "right-handed, y up", "centre +z, right -x",
     "crates/bevy_pbr/src/light_probe/environment_map.wgsl, compute_cubemap_sample_dir, which negates z; derived: Bevy "
     "has no lat-longs, so that its +z is Welkin's",
     kSame, kMirroredZ},
    {Engine::usd, "usd", "OpenUSD", true, "right-handed, y up", "centre +z, right -x",
     "UsdLuxDomeLight, which has OpenEXR's LatLongMap; of a stage whose up axis is y", kSame, std::nullopt},
    {Engine::playcanvas, "playcanvas", "PlayCanvas", true, "right-handed, y up", "centre +z, right -x",
     "playcanvas, shader-lib chunks reflectionEnv, which negates x, and spherical, toSphericalUv", kSame, kMirroredX},
    {Engine::qt, "qt", "Qt Quick 3D", true, "right-handed, y up", "centre +x, right +z",
     "sampleprobe.glsllib, which looks faces up by the world's direction as it is; derived: faces that balsam 6.4 "
     "makes of a lat-long",
     kCentreXRightZ, kSame},
}};

std::string all_names() {
  std::string names;
  for (const Convention& each : kConventions) names += (names.empty() ? "" : ", ") + std::string(each.name);
  return names;
}

}  // namespace

const Convention& convention(Engine engine) noexcept { return kConventions[static_cast<std::size_t>(engine)]; }

std::span<const Convention> conventions() noexcept { return kConventions; }

const Convention& convention(std::string_view name) {
  const auto found =
      std::find_if(kConventions.begin(), kConventions.end(), [&](const Convention& each) { return each.name == name; });
  if (found == kConventions.end()) {
    throw Error(ErrorCode::invalid_argument,
                "\"" + std::string(name) + "\" is not the name of a convention; the names are " + all_names());
  }
  return *found;
}

namespace {

constexpr std::size_t kCoefficients = 9;
using Nine = std::array<glm::dvec3, kCoefficients>;

constexpr int band_of(std::size_t index) { return index == 0 ? 0 : index < 4 ? 1 : 2; }

// U: the first three bands, in canonical order and signs; what is missing is zero.
Nine canonical(const SphericalHarmonics& radiance) {
  Nine nine{};
  const auto coefficients = radiance.coefficients();
  for (std::size_t i = 0; i < std::min(kCoefficients, coefficients.size()); ++i) nine[i] = coefficients[i];
  return nine;
}

// R: with the Condon-Shortley sign, (-1)^m.
// Index l (l + 1) + m has m's parity, as l (l + 1) is even: odd indices change sign.
Nine with_phase(Nine nine) {
  for (std::size_t i = 1; i < kCoefficients; i += 2) nine[i] = -nine[i];
  return nine;
}

// The basis functions' constants: Y(l, m) = K times 1; y, z, x; xy, yz, 3zz - 1, xz, xx - yy.
std::array<double, kCoefficients> basis_constants() {
  const double inverse_pi = std::numbers::inv_pi;
  // Each polynomial's square integrates to 1 with K: the means over the sphere of z^2, (x y)^2, (3 z^2 - 1)^2 and
  // (x^2 - y^2)^2 are 1/3, 1/15, 4/5 and 4/15, and K^2 4 pi mean = 1.
  const double k1 = std::sqrt(3.0 * inverse_pi) / 2.0;
  const double k2 = std::sqrt(15.0 * inverse_pi) / 2.0;
  return {std::sqrt(inverse_pi) / 2.0, k1, k1, k1, k2, k2, std::sqrt(5.0 * inverse_pi) / 4.0, k2, k2 / 2.0};
}

Nine times_lobe(Nine nine, double factor) {
  for (std::size_t i = 0; i < kCoefficients; ++i) nine[i] *= cosine_lobe(band_of(i)) * factor;
  return nine;
}

// A/pi K U: a polynomial of the normal whose value is E/pi.
Nine pre_scaled(const SphericalHarmonics& radiance) {
  Nine nine = times_lobe(canonical(radiance), std::numbers::inv_pi);
  const std::array<double, kCoefficients> constants = basis_constants();
  for (std::size_t i = 0; i < kCoefficients; ++i) nine[i] *= constants[i];
  return nine;
}

std::vector<EngineTerm> indexed(std::string_view name, const Nine& nine) {
  std::vector<EngineTerm> terms;
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    terms.push_back({std::string(name) + '[' + std::to_string(i) + ']', nine[i]});
  }
  return terms;
}

EngineLight own_form(const SphericalHarmonics& radiance) {
  return {
      Engine::welkin,
      "polynomial of the normal, in GLSL",
      "// sh is U(l, m) A(l)/pi K(l, m), A = (pi, 2pi/3, pi/4) by band, K the basis functions' constants, signs\n"
      "// unchanged. Returns irradiance over pi on a surface that faces n, of length 1: multiply it by the albedo.\n"
      "vec3 diffuse_light(vec3 n) {\n"
      "  return sh[0] + sh[1] * n.y + sh[2] * n.z + sh[3] * n.x + sh[4] * (n.x * n.y) + sh[5] * (n.y * n.z) +\n"
      "         sh[6] * (3.0 * n.z * n.z - 1.0) + sh[7] * (n.x * n.z) + sh[8] * (n.x * n.x - n.y * n.y);\n"
      "}",
      indexed("sh", pre_scaled(radiance)),
      {}};
}

EngineLight babylon(const SphericalHarmonics& radiance) {
  const BabylonPolynomial p = babylon_polynomial(radiance);
  return {Engine::babylon,
          "SphericalPolynomial",
          "P(n) = x nx + y ny + z nz + xx nx nx + yy ny ny + zz nz nz + yz ny nz + zx nz nx + xy nx ny.\n"
          "Radiance coefficients times A = (pi, 2pi/3, pi/4) by band, times 1/pi, then Babylon.js's\n"
          "FromHarmonics with its own rounded constants: the lobe's factor is in it twice and another 1/pi.\n"
          "Its shader does not evaluate P: it goes back to harmonics (preScaledHarmonics), whose value is\n"
          "E(n)/pi, to be multiplied by the albedo.",
          {{"x", p.x},
           {"y", p.y},
           {"z", p.z},
           {"xx", p.xx},
           {"yy", p.yy},
           {"zz", p.zz},
           {"yz", p.yz},
           {"zx", p.zx},
           {"xy", p.xy}},
          {}};
}

EngineLight three(const SphericalHarmonics& radiance) {
  return {Engine::three,
          "SphericalHarmonics3, as in LightProbe.sh",
          "Radiance coefficients U(l, m) at l (l + 1) + m: no factor, signs unchanged (real, orthonormal, no\n"
          "Condon-Shortley phase). The shader's shGetIrradianceAt multiplies by A = (pi, 2pi/3, pi/4) and Y:\n"
          "  E(n) = 0.886227 c0 + 1.023328 (c1 y + c2 z + c3 x) + 0.858086 (c4 xy + c5 yz + c7 xz)\n"
          "         + c6 (0.743125 zz - 0.247708) + 0.429043 c8 (xx - yy);  BRDF_Lambert then divides by pi.",
          indexed("coefficients", canonical(radiance)),
          {}};
}

EngineLight filament(const SphericalHarmonics& radiance) {
  return {Engine::filament,
          "float3 sh[9], IndirectLight::Builder::irradiance(3, sh)",
          "U(l, m) A(l)/pi K(l, m), K the basis functions' constants: pre-scaled for the shader, signs unchanged.\n"
          "  E(n)/pi = sh0 + sh1 y + sh2 z + sh3 x + sh4 xy + sh5 yz + sh6 (3zz - 1) + sh7 xz + sh8 (xx - yy)\n"
          "As cmgen --sh-shader --sh-window=no prints it; cmgen applies a window by default.",
          indexed("sh", pre_scaled(radiance)),
          {}};
}

// A polynomial of the normal as four-vectors, a channel at a time: three of (x, y, z, 1), three of (xy, yz, zz, zx),
// and one of xx - yy for all channels. The -1 of 3zz - 1 is in the constant.
std::vector<EngineVector> packed(const Nine& c, const std::array<const char*, 7>& names) {
  std::vector<EngineVector> vectors;
  vectors.reserve(names.size());
  for (int rgb = 0; rgb < 3; ++rgb) {
    vectors.push_back(
        {names.at(static_cast<std::size_t>(rgb)), {c[3][rgb], c[1][rgb], c[2][rgb], c[0][rgb] - c[6][rgb]}});
  }
  for (int rgb = 0; rgb < 3; ++rgb) {
    vectors.push_back(
        {names.at(static_cast<std::size_t>(3 + rgb)), {c[4][rgb], c[5][rgb], 3.0 * c[6][rgb], c[7][rgb]}});
  }
  vectors.push_back({names[6], {c[8], 1.0}});
  return vectors;
}

EngineLight unity(const SphericalHarmonics& radiance) {
  const Nine c = pre_scaled(radiance);
  return {Engine::unity, "SphericalHarmonicsL2, and its shader vectors",
          "sh[channel, i] = U(l, m) A(l)/pi K(l, m), K the basis functions' constants; i = l (l + 1) + m.\n"
          "The shader's vectors, for red: SHAr = (sh3, sh1, sh2, sh0 - sh6), SHBr = (sh4, sh5, 3 sh6, sh7), and\n"
          "SHC = sh8 of red, green, blue, and 1. ShadeSH9(n) is E(n)/pi, to be multiplied by the albedo:\n"
          "  red = dot(SHAr, (x, y, z, 1)) + dot(SHBr, (xy, yz, zz, zx)) + SHC.r (xx - yy)",
          indexed("sh", c),
          packed(c, {"unity_SHAr", "unity_SHAg", "unity_SHAb", "unity_SHBr", "unity_SHBg", "unity_SHBb", "unity_SHC"})};
}

EngineLight unreal(const SphericalHarmonics& radiance) {
  // SetupSkyIrradianceEnvironmentMapConstantsFromSkyIrradiance: its factors are A(l)/pi K(l, m), and it undoes the
  // signs of R, so that its vectors are those of Unity.
  return {
      Engine::unreal, "FSHVectorRGB3, and the vectors of its sky light",
      "V[i] of R, G, B: radiance coefficients R(l, m) = (-1)^m U(l, m) in z-up axes, i = l (l + 1) + m, no factor.\n"
      "SHBasisFunction has the same signs: Y = 0.282095; -0.488603 y, 0.488603 z, -0.488603 x; 1.092548 xy,\n"
      "-1.092548 yz, 0.315392 (3zz - 1), -1.092548 xz, 0.546274 (xx - yy). The sum of V Y is radiance.\n"
      "For its shader the engine packs V times A(l)/pi K(l, m), without the signs; GetSkySHDiffuse(n) is E(n)/pi:\n"
      "  red = dot(Map[0], (x, y, z, 1)) + dot(Map[3], (xy, yz, zz, zx)) + Map[6].r (xx - yy)",
      indexed("V", with_phase(canonical(radiance))),
      packed(pre_scaled(radiance),
             {"SkyIrradianceEnvironmentMap[0]", "SkyIrradianceEnvironmentMap[1]", "SkyIrradianceEnvironmentMap[2]",
              "SkyIrradianceEnvironmentMap[3]", "SkyIrradianceEnvironmentMap[4]", "SkyIrradianceEnvironmentMap[5]",
              "SkyIrradianceEnvironmentMap[6]"})};
}

EngineLight gltf(const SphericalHarmonics& radiance) {
  return {Engine::gltf,
          "EXT_lights_image_based irradianceCoefficients",
          "R(l, m) A(l): irradiance coefficients, A = (pi, 2pi/3, pi/4) by band, R(l, m) = (-1)^m U(l, m); at\n"
          "l (l + 1) + m. The specification fixes neither sign nor pi: this is what Babylon.js's loader takes back\n"
          "and what cmgen 1.9.25 --sh-irradiance writes. The sum of them times the basis with the same signs is E(n).",
          indexed("irradianceCoefficients", with_phase(times_lobe(canonical(radiance), 1.0))),
          {}};
}

EngineLight godot(const SphericalHarmonics& radiance) {
  Nine nine = canonical(radiance);
  for (glm::dvec3& rgb : nine) rgb *= std::numbers::inv_pi;
  return {Engine::godot,
          "lightmap probe",
          "U(l, m)/pi at l (l + 1) + m, signs unchanged. (Godot's sky lights through mip maps and has no harmonics.)\n"
          "  E(n)/pi = 0.886227 c0 + 1.023327 (c1 y + c2 z + c3 x) + 0.858086 (c4 xy + c5 yz + c7 xz)\n"
          "            + 0.247708 c6 (3zz - 1) + 0.429043 c8 (xx - yy)",
          indexed("sh", nine),
          {}};
}

}  // namespace

bool has_engine_light(Engine engine) noexcept {
  constexpr std::array kWithout{Engine::openexr, Engine::blender,    Engine::bevy,
                                Engine::usd,     Engine::playcanvas, Engine::qt};
  return std::find(kWithout.begin(), kWithout.end(), engine) == kWithout.end();
}

EngineLight engine_light_unrotated(const SphericalHarmonics& radiance, Engine engine) {
  const platform::FloatingPointScope floating_point;
  switch (engine) {
    case Engine::welkin: return own_form(radiance);
    case Engine::babylon: return babylon(radiance);
    case Engine::three: return three(radiance);
    case Engine::filament: return filament(radiance);
    case Engine::gltf: return gltf(radiance);
    case Engine::unity: return unity(radiance);
    case Engine::unreal: return unreal(radiance);
    case Engine::godot: return godot(radiance);
    case Engine::openexr:
    case Engine::blender:
    case Engine::bevy:
    case Engine::usd:
    case Engine::playcanvas:
    case Engine::qt: break;
  }
  throw Error(ErrorCode::invalid_argument,
              std::string(convention(engine).title) +
                  " has no form of its own for the coefficients; welkin, babylon, three, filament, gltf, unity, unreal "
                  "and godot have");
}

EngineLight engine_light(const SphericalHarmonics& radiance, Engine engine) {
  const platform::FloatingPointScope floating_point;
  return engine_light_unrotated(rotate(radiance, convention(engine).from_welkin), engine);
}

}  // namespace welkin
