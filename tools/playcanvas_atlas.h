// PlayCanvas' envAtlas: sharp and rough reflections and diffuse light as lat-longs on one square image.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::tool {

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
