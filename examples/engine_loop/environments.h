// The files that are streamed in.
#pragma once

#include <filesystem>
#include <vector>

namespace engine_loop {

/// The .exr and .hdr files of a folder, by name. None if it is not there.
[[nodiscard]] std::vector<std::filesystem::path> environments_in(const std::filesystem::path& folder);

/// Files for those who have none: skies and test maps of several sizes and formats, written to a folder.
/// `height` is that of the largest one's lat-long, in texels.
[[nodiscard]] std::vector<std::filesystem::path> write_environments(const std::filesystem::path& folder, int height);

}  // namespace engine_loop
