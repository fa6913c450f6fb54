// Pictures for people: the surroundings, the mips, spheres lit by what was baked.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/preview_light.h"
#include "welkin/bake.h"
#include "welkin/core.h"

namespace welkin::tool {

/// The surroundings as a lat-long, twice as wide as high, as who stands there sees them: +z in the middle, +x to the
/// left of it. (A cubemap's own faces look mirrored: docs/explanation/orientation.md says why.) The axes are written at
/// the foot.
[[nodiscard]] PreviewPicture preview_environment(const CubeLookup& environment, const ToneMap& tone_map, int height,
                                                 const Control& control = {});

/// Every mip as a lat-long of its own, all of one size, side by side from the sharpest to the roughest, with its
/// roughness written on it. A texel is spread over many pixels as a graphics card spreads it, so that seams would show.
/// `light` must have its specular chain; `height` is that of each.
[[nodiscard]] PreviewPicture preview_mips(const BakeResult& light, const ToneMap& tone_map, int height,
                                          const Control& control = {});

/// Rows of spheres on a dark ground: a material a row, a roughness a column, both written beside them. The viewer looks
/// along -z from far away: +x is to the right, and the spheres mirror what is behind the viewer, the lat-long's centre.
///
/// A sphere shows specular(reflection, mip of its roughness) times A = f0 scale + bias from the BRDF table (f0 alone
/// without a table), and if it is no metal also (1 - A) albedo irradiance(normal) / pi. Without an irradiance cubemap
/// there are metals alone. `light` must have its specular chain; its background, if there is one, stands in for a sharp
/// mip 0 where the picture is coarser than that. `sphere`: pixels across one; they lie 9/8 of that apart, and the
/// labels take another 1/8 above and a half on the left.
[[nodiscard]] PreviewPicture preview_spheres(const BakeResult& light, const ToneMap& tone_map, int sphere,
                                             const Control& control = {});

/// What the three have in common.
struct PreviewOptions {
  ToneMap tone_map;
  int sphere = 256;  ///< pixels across one
};

/// A picture that was written.
struct WrittenPreview {
  const char* name;
  const char* what;
  int width;
  int height;
};

/// Draws preview_environment.png, preview_spheres.png and preview_mips.png into a folder, those for which `light` has
/// what they show. Throws `Error`: file_access, unsupported_file (a build without PNG), cancelled.
[[nodiscard]] std::vector<WrittenPreview> write_previews(const BakeResult& light, const PreviewOptions& options,
                                                         const std::filesystem::path& folder,
                                                         const Control& control = {});

}  // namespace welkin::tool
