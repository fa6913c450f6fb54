// The colours that an OpenEXR header says its numbers mean.
#pragma once

#include <ImfHeader.h>

#include <glm/mat3x3.hpp>
#include <optional>

#include "codec/exr_channels.h"
#include "welkin/environment_file.h"

namespace welkin::codec {

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

}  // namespace welkin::codec
