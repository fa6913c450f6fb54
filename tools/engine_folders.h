// What `--for ENGINE` writes: the files that the engine loads as they are, and the lines of code that load them.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "tools/output_files.h"
#include "welkin/core.h"
#include "welkin/engines.h"
#include "welkin/image.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

inline constexpr const char* kReadmeName = "README.md";
inline constexpr const char* kAtlasName = "env_atlas.png";

/// Whether files are known that the engine loads as they are. (Not of Welkin itself and of OpenEXR, which is none.)
[[nodiscard]] bool has_folder(Engine engine) noexcept;

/// Those files, without what else the options ask for. Of an engine that `has_folder`.
[[nodiscard]] std::vector<OutputFile> files_for(Engine engine);

/// Whether what loads those files takes .ktx2 files of every texel format. Of an engine that `has_folder`.
[[nodiscard]] bool takes_any_texture(Engine engine) noexcept;

/// The text of README.md: for each file that was written how the engine loads it, and how that is known. `written`: the
/// names in the folder; lines that would name another file are left out.
[[nodiscard]] std::string readme_text(Engine engine, const std::vector<std::string>& written);

/// Whether a README.md that begins like this is one of ours, which may be written over.
[[nodiscard]] bool is_own_readme(const std::string& first_line) noexcept;

/// A stage with a dome light, whose texture lies beside it.
[[nodiscard]] std::string usd_stage(const std::string& lat_long);

/// Nine lines of three numbers, as Filament's cmgen writes them into its .ktx files.
[[nodiscard]] std::string filament_harmonics(const SphericalHarmonics& radiance);

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
