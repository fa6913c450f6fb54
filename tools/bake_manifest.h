// What is said of a bake: its manifest, and a table for a person.
#pragma once

#include "tools/baked.h"
#include "tools/output_folder.h"
#include "tools/tone_map.h"

namespace welkin::tool {

/// manifest.json, and what `welkin bake --json` prints. Members are only ever added: programs read this.
[[nodiscard]] std::string bake_manifest(const Baked& baked, const BakeCommandOptions& options,
                                        const OutputFolder& folder, const ToneMap& tone_map);

[[nodiscard]] std::string bake_table(const Baked& baked, const BakeCommandOptions& options, const OutputFolder& folder);

/// What a person should know of it: values replaced and clamped, by the policies and by the formats.
[[nodiscard]] std::vector<std::string> bake_notes(const Baked& baked, const OutputFolder& folder);

}  // namespace welkin::tool
