// What `--for ENGINE` writes: the files that the engine loads as they are, and the lines of code that load them.
#pragma once

#include <array>
#include <cstdint>
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
inline constexpr std::array kReadmeSigns{"# Light for ", ", made by Welkin\n"};  ///< both ends of its first line
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

struct GltfLight {
  std::string bytes;                 ///< the .glb file
  std::uint64_t values_clamped = 0;  ///< by RGBD, which ends at 255
};

/// The file: one scene, which refers to one light of intensity 1, and its images. `specular` and `radiance` in
/// Welkin's axes, the chain with `gltf_light_roughness`. Throws `Error`: as `rgbd_images`.
[[nodiscard]] GltfLight gltf_light(const Cubemap& specular, const SphericalHarmonics& radiance, const Control& control);

// PlayCanvas' envAtlas: sharp and rough reflections and diffuse light as lat-longs on one square image.

struct PlayCanvasAtlas {
  int size = 0;                      ///< texels per edge
  std::vector<std::uint8_t> rgba;    ///< RGBP: (c (8 - 7 a))^2 is radiance
  std::uint64_t values_clamped = 0;  ///< channel values below 0 or above 64, the range of RGBP
};

/// Mips of the chain that the atlas has a place for.
inline constexpr int kAtlasMips = 6;

/// The radiance above which RGBP clamps.
inline constexpr double kLargestRgbp = 64.0;

/// Texels along an edge of the atlas: the largest multiple of 512 that is at most twice the specular cubemap's size,
/// and at least 512.
[[nodiscard]] int atlas_size(int specular_size) noexcept;

/// Lays a chain whose mip k has roughness k / 5 out as EnvLighting.generateAtlas does. `diffuse`: radiance of a white
/// surface. Both in Welkin's axes. `ends_in_diffuse`: the last mip has roughness 1, whose lobe is the cosine's, so that
/// the finer of the two stands for both. Throws `Error`: as `to_lat_long`.
[[nodiscard]] PlayCanvasAtlas playcanvas_atlas(const Cubemap& specular, const CubemapView& diffuse,
                                               bool ends_in_diffuse, const Control& control);

/// The asset that makes PlayCanvas load the image `file` so.
[[nodiscard]] std::string playcanvas_asset(const std::string& file);

}  // namespace welkin::tool
