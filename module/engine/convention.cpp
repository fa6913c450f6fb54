#include "welkin/convention.h"

#include <algorithm>
#include <array>

#include "welkin/error.h"

namespace welkin {
namespace {

// The rows of a matrix are the engine's x, y and z in terms of Welkin's, so that it reads as it is written:
// {{-1, 0, 0}, ...} is x' = -x.
struct Rows {
  glm::dvec3 x, y, z;
};

constexpr glm::dmat3 matrix(const Rows& rows) {
  return {rows.x.x, rows.y.x, rows.z.x, rows.x.y, rows.y.y, rows.z.y, rows.x.z, rows.y.z, rows.z.z};
}

constexpr glm::dmat3 kSame{1.0};
// Welkin's lat-long has +z at its centre, -x to the right of it and +y above. What follows places these three:
constexpr glm::dmat3 kCentreZRightX = matrix({{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
constexpr glm::dmat3 kCentreXRightZ = matrix({{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}});
constexpr glm::dmat3 kCentreXRightMinusZ = matrix({{0, 0, 1}, {0, 1, 0}, {1, 0, 0}});
constexpr glm::dmat3 kCentreMinusYRightXUpZ = matrix({{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}});
constexpr glm::dmat3 kCentreXRightMinusYUpZ = matrix({{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});

constexpr glm::dmat3 kMirroredX = matrix({{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}});

constexpr std::array<Convention, 10> kConventions{{
    {Engine::welkin, "welkin", "Welkin", true, "right-handed, y up", "centre +z, right -x",
     "include/welkin/image_view.h", kSame, kSame},
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
                "\"" + std::string(name) + "\" is no convention that is known here; there are " + all_names());
  }
  return *found;
}

}  // namespace welkin
