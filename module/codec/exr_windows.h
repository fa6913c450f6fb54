// Which rectangle of an OpenEXR file is the picture.
#pragma once

#include <ImfHeader.h>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// The picture's rectangle and that of the stored texels, in one frame of coordinates: x right, y down, both
/// inclusive. Texels of the picture that are not stored are black.
struct ExrWindows {
  Imath::Box2i picture;
  Imath::Box2i data;
};

/// The picture is the data window, wherever it lies, unless the file says that it is a frame around or inside of it:
/// the display window is the picture if
/// - the header has no envmap attribute, which makes the data window the map (ImfEnvmap.h), and no mip chain, which
///   belongs to the data window,
/// - the windows differ in size and overlap,
/// - it has the shape of a layout (2:1, 1:6, 6:1, 4:3, 3:4): of the one that is asked for, if one is, and
/// - the data window has not the shape of another layout, if none is asked for.
/// So overscan is cut off and a cropped render is put back in its place; either is said in `info.notes`.
///
/// Both windows are then at most kMaximumWidth x kMaximumHeight, and of a picture above 16384 x 8192 texels at least
/// a 64th is stored, so that a few bytes cannot make hours of work.
/// Throws `Error`: corrupt_file for an empty data window, unsupported_file for what is too large.
[[nodiscard]] ExrWindows choose_exr_windows(EnvironmentInfo& info, const Imf::Header& header, bool has_levels,
                                            Layout asked_for);

}  // namespace welkin::codec
