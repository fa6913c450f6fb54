// How long a person waits for the command, as a process of its own.
#pragma once

#include <vector>

namespace welkin::perf {

/// Command/<bake or bake-again>/<size>/<threads>: `welkin bake` of a picture of 1024 x 512 with all its default files;
/// "again" finds them in a cache. A texel is one of the picture.
void add_command(const std::vector<int>& thread_counts);

}  // namespace welkin::perf
