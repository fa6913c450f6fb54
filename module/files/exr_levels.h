// Sizes of an OpenEXR picture's levels and how many pieces (chunks) it is stored in.
#pragma once

#include <ImfHeader.h>
#include <ImfTileDescription.h>

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <vector>

#include "files/exr_picture.h"
#include "welkin/environment_file.h"

namespace welkin::files {

/// Scanlines that a compression packs together; 0 if the compression is not known.
[[nodiscard]] int scanlines_per_block(Imf::Compression compression) noexcept;

/// "none", "zip", ..; nullptr if it is not known.
[[nodiscard]] const char* compression_name(Imf::Compression compression) noexcept;

/// The levels of a picture of width x height, full size first: of a mip map all, of a rip map those that shrink both
/// ways, else one. Each edge halves from level to level, rounded as the file says, down to 1
/// (ImfTileDescription.h; the chain ends where the longer edge of a mip map, the shorter one of a rip map is 1).
[[nodiscard]] std::vector<LevelInfo> level_sizes(const Imf::TileDescription& tiles, int width, int height);

/// Entries in the table of offsets of a part whose header is sane, as many as the library will make. A number that is
/// too large to count is large enough: the result is a double so that nothing can wrap around.
[[nodiscard]] double chunk_count(const Imf::Header& header, bool tiled);

// The colours that an OpenEXR header says its numbers mean.

/// The matrix to Rec. 709, or none if nothing is to be done: no chromaticities attribute (which means Rec. 709), the
/// numbers wanted as they are, luminance alone, which is grey in any primaries, or a matrix that would change nothing
/// but roundings. What was done is said in
/// `info.notes`.
///
/// White becomes white: the adoptedNeutral attribute's, if there is one, as in OpenEXR's own ImfAcesFile, else the
/// chromaticities'. whiteLuminance (candelas a square metre of (1, 1, 1)) changes no number.
/// Throws `Error` (corrupt_file) naming the attribute if it makes no colours.
[[nodiscard]] std::optional<glm::dmat3> exr_colour_matrix(EnvironmentInfo& info, const Imf::Header& header,
                                                          ExrChannels::Kind kind, Primaries wanted);

}  // namespace welkin::files
