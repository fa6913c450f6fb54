// Which way a picture holds its sphere.
#pragma once

#include <optional>
#include <string>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// Fills in `info.layout` and `info.layout_reason` from what was asked for, else from what the header says,
/// else from the shape (2:1 is a lat-long, 1:6 and 6:1 are strips, 4:3 and 3:4 crosses), else from the name
/// (1:1 is one of six files if all six are there).
///
/// A lat-long that is asked for or that the header states is taken at any ratio; faces must be square all the
/// same. Needs `info.path`, `width` and `height`.
/// Throws `Error` (unsupported_file) if nothing tells, if a strip or cross has not its shape, or if the picture
/// is larger than the views of `image_view.h` can be.
void decide_layout(EnvironmentInfo& info, Layout asked_for, std::optional<Layout> stated_by_header);

/// Texels along the edge of a face in a picture of this shape and layout; 0 for a lat-long, and where the shape
/// is not the layout's. Six files are taken as the strip that they make up.
[[nodiscard]] int face_size(Layout layout, int width, int height) noexcept;

}  // namespace welkin::codec
