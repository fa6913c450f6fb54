// How long a person waits for the previews of a bake.
#pragma once

#include <vector>

#include "welkin/image.h"

namespace welkin::perf {

/// A sky over ground with clouds and grain, 1024 x 512: packing has as much to do as with a photograph.
[[nodiscard]] LatLongImage picture_of_previews();

/// Previews/<balls>/<size>/<threads>: drawn, packed and written. A texel is a pixel of the pictures.
void add_previews(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
