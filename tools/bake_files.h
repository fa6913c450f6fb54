// The files of a bake.
#pragma once

#include "tools/baked.h"
#include "tools/output_folder.h"
#include "tools/tone_map.h"

namespace welkin::tool {

/// Writes cubemaps, .env, BRDF table, harmonics and previews, all but the manifest. Turns the cubemaps of `baked` to
/// the engine's faces on the way.
void write_bake(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control);

/// A few mips below the top: enough to tell how bright the environment is.
[[nodiscard]] ToneMap tone_map_of(const Baked& baked);

/// Draws and writes the previews.
void write_previews(const Baked& baked, OutputFolder& folder);

/// sh.json and sh.h.
void write_harmonics(const Baked& baked, const BakeCommandOptions& options, OutputFolder& folder);

/// environment.env, in Babylon.js's axes.
void write_env(const Baked& baked, OutputFolder& folder, const Control& control);

}  // namespace welkin::tool
