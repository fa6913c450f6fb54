#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// A Markdown table of error and time over target sizes for the lat-longs in `files`: each becomes a cubemap of
/// 1024 x 1024 faces by area and projected at every target, exact and midpoint, and from a mip chain. Errors are those
/// of the radiance coefficients against the double-precision projection of all texels, times the fastest of a few runs
/// on this machine, as multiples of reading the cubemap once.
[[nodiscard]] std::string target_size_table(const std::vector<std::filesystem::path>& files);

}  // namespace welkin::perf
