// The files of a bake.
#pragma once

#include <string>
#include <vector>

#include "tools/bake_manifest.h"
#include "tools/baked.h"
#include "welkin/reflections.h"

namespace welkin::tool {

/// Writes cubemaps, .env, BRDF table, harmonics and previews, all but the manifest. Turns the cubemaps of `baked` to
/// the engine's faces on the way.
void write_bake(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control);

/// Of the previews: as --exposure has it, else by the environment, of which a few mips below the top tell enough.
[[nodiscard]] ToneMap tone_map_of(const Baked& baked, const BakeCommandOptions& options);

/// What its channels are, for the manifest.
[[nodiscard]] std::vector<std::string> brdf_channels(const BrdfTableOptions& options);

}  // namespace welkin::tool
