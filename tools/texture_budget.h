// Face size, mips and texel format of the reflections, by what the environment forgives: --budget and --error-budget.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/bake_options.h"
#include "tools/json.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::tool {

/// A way to write the folder that was looked at.
struct TriedTextures {
  int size = 0;             ///< texels along an edge of the specular cubemap's faces
  int mips = 0;             ///< of it
  int background_size = 0;  ///< texels along an edge of the background's faces
  TexelFormat format{};     ///< as --ktx2-format names it
  std::string formats;      ///< of the files with the specular cubemap, with commas between them
  std::uint64_t bytes = 0;  ///< of the texels of all files in the folder, before any compression
  double error = 0.0;       ///< see `ChosenTextures`
  double roughness = 0.0;   ///< at which it is that large
};

/// What was chosen, and what else was looked at.
///
/// The error is that of what a shader reads, which interpolates between texels and between mips: rms over 1024
/// directions of the difference from the reflections of that very roughness, over their rms; of the worst of ten
/// roughnesses among the scene's glossy materials. Below roughness 0.1 reflections show the picture itself, where any
/// smaller size is seen: those are not judged.
struct ChosenTextures {
  TriedTextures chosen;
  bool met = false;                  ///< whether it is within all budgets
  std::vector<TriedTextures> tried;  ///< by bytes
};

/// Texels along an edge of the smallest faces that show all of the source, a power of two.
[[nodiscard]] int resolution_of(const LatLongView& source) noexcept;
[[nodiscard]] int resolution_of(const CubemapView& source) noexcept;

/// Whether there is a budget and something that was not named and that it may choose.
[[nodiscard]] bool chooses_textures(const BakeCommandOptions& options) noexcept;

/// Chooses, and sets the options accordingly. Under an error budget: the fewest bytes with an error below it, or the
/// least error where none is. Under a budget of bytes alone: the least error among what takes at least a sixteenth of
/// the bytes, and of the background the largest size that is left room for. A texel format is that of all .ktx2 files,
/// as --ktx2-format has it; the error is that of the reflections. Sizes are --size, or else the larger of its default
/// and of the source's resolution up to 1024, halved down to 16. Costs a bake of each size and number of mips that is
/// looked at, in what memory --memory-limit leaves. Throws `Error`: invalid_argument where a budget of bytes is too
/// small for anything; limit_exceeded; as `prefilter_specular`.
[[nodiscard]] ChosenTextures choose_textures(const LatLongView& source, BakeCommandOptions& options,
                                             const Control& control);
[[nodiscard]] ChosenTextures choose_textures(const CubemapView& source, BakeCommandOptions& options,
                                             const Control& control);

/// A table for a person, what was chosen marked.
[[nodiscard]] std::string choice_text(const ChosenTextures& choice);

/// For the manifest.
[[nodiscard]] Json choice_json(const ChosenTextures& choice);

}  // namespace welkin::tool
