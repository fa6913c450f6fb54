// The files of `--for ENGINE`, which the engine loads as they are, and the lines of code that load them.
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

/// Returns whether there are files that the engine loads as they are. (There are none for Welkin and for OpenEXR.)
[[nodiscard]] bool has_folder(Engine engine) noexcept;

/// Returns the files that the engine loads, without further selected ones. For engines that `has_folder`.
[[nodiscard]] std::vector<OutputFile> files_for(Engine engine);

/// Returns whether their loader takes .ktx2 files of every texel format. For engines that `has_folder`.
[[nodiscard]] bool takes_any_texture(Engine engine) noexcept;

/// Returns the text of README.md: how the engine loads each written file, and the source of that. `written`: the names
/// in the folder; lines that name another file are left out.
[[nodiscard]] std::string readme_text(Engine engine, const std::vector<std::string>& written);

/// Returns a stage with a dome light, whose texture is in the same folder.
[[nodiscard]] std::string usd_stage(const std::string& lat_long);

/// Returns nine lines of three numbers, as Filament's cmgen writes them into its .ktx files.
[[nodiscard]] std::string filament_harmonics(const SphericalHarmonics& radiance);

/// Returns the texels along an edge of the light's cubemap: the largest power of two up to the specular cubemap's size,
/// and at least 2, because the loader divides by its logarithm.
[[nodiscard]] int gltf_light_size(int specular_size) noexcept;

/// Returns the number of mips of such a cubemap: down to 8 texels, and at least 2. The loader spreads roughness over
/// all of them.
[[nodiscard]] int gltf_light_mips(int size) noexcept;

/// Returns the roughness of each mip k of n: 0 at mip 0, else alpha = size^(k / (n - 1) - 1), where the loader's
/// `lodGenerationScale` makes the shader look. The last mip has roughness 1.
[[nodiscard]] std::vector<double> gltf_light_roughness(int size, int mips);

struct GltfLight {
  std::string bytes;                 ///< the .glb file
  std::uint64_t values_clamped = 0;  ///< by RGBD, which ends at 255
};

/// Returns the file: one scene, which refers to one light of intensity 1, and its images. `specular` and `radiance` are
/// in Welkin's axes, the chain with `gltf_light_roughness`. Throws the errors of `rgbd_images`.
[[nodiscard]] GltfLight gltf_light(const Cubemap& specular, const SphericalHarmonics& radiance, const Control& control);

// PlayCanvas' envAtlas: sharp and rough reflections and diffuse light as lat-longs on one square image.

struct PlayCanvasAtlas {
  int size = 0;                      ///< texels per edge
  std::vector<std::uint8_t> rgba;    ///< RGBP: (c (8 - 7 a))^2 is radiance
  std::uint64_t values_clamped = 0;  ///< channel values below 0 or above 64, the range of RGBP
};

/// The number of mips of the chain in the atlas.
inline constexpr int kAtlasMips = 6;

/// The radiance above which RGBP clamps.
inline constexpr double kLargestRgbp = 64.0;

/// Returns the texels along an edge of the atlas: the largest multiple of 512 that is at most twice the specular
/// cubemap's size, and at least 512.
[[nodiscard]] int atlas_size(int specular_size) noexcept;

/// Lays out a chain whose mip k has roughness k / 5 as EnvLighting.generateAtlas does. `diffuse`: radiance of a white
/// surface. Both are in Welkin's axes. `ends_in_diffuse`: the last mip has roughness 1, whose lobe is the cosine lobe,
/// so that the finer of the two serves for both. Throws the errors of `to_lat_long`.
[[nodiscard]] PlayCanvasAtlas playcanvas_atlas(const Cubemap& specular, const CubemapView& diffuse,
                                               bool ends_in_diffuse, const Control& control);

/// Returns the asset that makes PlayCanvas load the image `file` so.
[[nodiscard]] std::string playcanvas_asset(const std::string& file);

}  // namespace welkin::tool
