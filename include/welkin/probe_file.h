// Grids of probes from files and to files.
//
//   welkin::BakedProbes probes = welkin::bake_probe_files(grid, cubes, depths);
//   welkin::write_probes("level.json", probes, {{welkin::ProbeLayout::three}});
#pragma once

#include <filesystem>
#include <span>

#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/probes.h"

namespace WELKIN_EXPORT welkin {

/// `bake_probes` of captures in files: .ktx2, .ktx or .dds cubemaps as `read_texture` takes them, of which level 0
/// counts. A depth is the first channel of a format of 32-bit floats (halves hold no more than three digits). The same
/// bits as of the pixels in memory, which are read as floats.
///
/// 128 probes are read and baked at a time, by all threads: that is all that is held of them. Throws `Error` as
/// `bake_probes` and `read_texture`; the message names the file.
[[nodiscard]] BakedProbes bake_probe_files(const ProbeGrid& grid, std::span<const FileInput> cubes,
                                           std::span<const FileInput> depths = {}, const ProbeOptions& options = {},
                                           const Control& control = {});

/// Writes probes as a description in JSON, with files beside it that the description names: NAME.bin with all arrays of
/// `BakedProbes` as they are (little-endian), and a three-dimensional KTX2 texture of halves for each texture of each
/// layout, NAME_LAYOUT.ktx2 or NAME_LAYOUT_TEXTURE.ktx2. docs/guides/probe_grids.md has the keys. All files are
/// complete or none is there. The same bytes on any number of threads. Throws `Error`: invalid_argument,
/// unsupported_file (a name that does not end in .json), file_access, cancelled.
WriteReport write_probes(const std::filesystem::path& path, const BakedProbes& probes,
                         std::span<const ProbeLayout> layouts = {}, const Control& control = {});

}  // namespace welkin
