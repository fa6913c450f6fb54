// How long a person waits for the previews of a bake.
#pragma once

#include <vector>

namespace welkin::perf {

/// Previews/<balls>/<size>/<threads>: drawn, packed and written. A texel is a pixel of the pictures.
void add_previews(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
