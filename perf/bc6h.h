// How fast cubemaps become BC6H, and what is lost.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// EncodeBc6h/fast|normal|slow/<size>/<threads>: the prefiltered chain of a sky with a sun and noise.
/// DecodeBc6h/halves/<size>/<threads>.
void add_bc6h(const std::vector<int>& thread_counts);

/// The table of docs/textures.md: for each lat-long of `files`, prefiltered to a chain of `--size=N` (256), the error
/// of each mip and of all, and the largest bias of a mip's mean, of BC6H and ASTC at each effort.
[[nodiscard]] std::string block_error_table(const std::vector<std::filesystem::path>& files);

}  // namespace welkin::perf
