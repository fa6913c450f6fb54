// environment.glb: a light of EXT_lights_image_based in one file, its chain of reflections as pictures of RGBD.
//
// (KhronosGroup/glTF, extensions/2.0/Vendor/EXT_lights_image_based; Babylon.js's loader of the same name,
// @babylonjs/loaders 9.28, which is what reads such files. docs/guides/engine_files.md says where the two differ.)
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

/// Texels along an edge of the light's cubemap: the largest power of two that is not above the specular cubemap's
/// size, and at least 2, because the loader divides by its logarithm.
[[nodiscard]] int gltf_light_size(int specular_size) noexcept;

/// How many mips such a cubemap has: down to 8 texels, and at least 2. The loader spreads roughness over as many as
/// there are.
[[nodiscard]] int gltf_light_mips(int size) noexcept;

/// Roughness of each mip k of n: 0 at mip 0, else alpha = size^(k / (n - 1) - 1), which is where the loader's
/// `lodGenerationScale` has the shader look. The last one has roughness 1.
[[nodiscard]] std::vector<double> gltf_light_roughness(int size, int mips);

/// The `irradianceCoefficients` of `engine_light` for glTF, in the axes in which the loader evaluates them: x is
/// glTF's -x, so indices 3, 4 and 7 have the other sign.
[[nodiscard]] std::array<glm::dvec3, 9> gltf_light_coefficients(const SphericalHarmonics& radiance);

struct GltfLight {
  std::string bytes;                 ///< the .glb file
  std::uint64_t values_clamped = 0;  ///< by RGBD, which ends at 255
};

/// The file: one scene, which refers to one light of intensity 1, and its pictures. `specular` and `radiance` in
/// Welkin's axes, the chain with `gltf_light_roughness`. Throws `Error`: as `rgbd_pictures`.
[[nodiscard]] GltfLight gltf_light(const Cubemap& specular, const SphericalHarmonics& radiance, const Control& control);

}  // namespace welkin::tool
