// A page on which a person turns spheres and a knot in the light that was baked.
#pragma once

#include <filesystem>

#include "tools/preview_light.h"
#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin::tool {

inline constexpr const char* kPreviewPage = "preview.html";

/// Writes preview.html into a folder: one file that needs no other and no network, for browsers with WebGL 2. It shades
/// by the split sum from what it holds of the bake: mips of the specular chain from 128 texels down, a sharp
/// environment of at most 256, irradiance and the BRDF table, colours with shared exponents (within 0.4 % of the
/// brightest channel). With an environment of 256 it takes 3 MB. `light` is in Welkin's axes and must have its specular
/// chain. Throws `Error`: file_access, cancelled.
void write_preview_page(const BakeResult& light, const ToneMap& tone_map, const std::filesystem::path& file,
                        const Control& control = {});

}  // namespace welkin::tool
