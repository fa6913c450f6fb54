// Which way a picture holds its sphere.
#pragma once

#include <optional>
#include <string>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// Fills in `info.layout` and `info.layout_reason` from what was asked for, else from what the header says,
/// else from the shape (2:1 is a lat-long, 1:6 a vertical strip).
///
/// A layout that is asked for or that the header states is taken at any lat-long ratio; a vertical strip
/// must be 1:6 all the same. Needs `info.path`, `width` and `height`.
/// Throws `Error` (unsupported_file) if nothing tells, if a strip is not 1:6, or if the picture is larger
/// than the views of `image_view.h` can be.
void decide_layout(EnvironmentInfo& info, Layout asked_for, std::optional<Layout> stated_by_header);

}  // namespace welkin::codec
