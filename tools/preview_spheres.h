// Balls lit by what was baked, as a renderer would light them.
#pragma once

#include <vector>

#include "tools/preview_picture.h"
#include "tools/tone_map.h"
#include "welkin/bake.h"

namespace welkin::tool {

/// Roughness of the metal balls, from left to right. A white matte one stands behind them.
[[nodiscard]] const std::vector<double>& preview_roughness();

/// A row of metal balls by roughness and a white matte one, before the environment. The viewer looks along -z from far
/// away: +x is to the right, and the balls mirror what is behind the viewer, the lat-long's centre.
///
/// A metal ball shows specular(reflection, mip of its roughness) times its albedo, f0 scale + bias from the BRDF table
/// (f0 alone without a table); the white one irradiance(normal) / pi (and is left out without an irradiance cubemap).
/// `light` must have its specular chain. `ball`: pixels across one.
[[nodiscard]] PreviewPicture preview_spheres(const BakeResult& light, const ToneMap& tone_map, int ball = 128);

}  // namespace welkin::tool
