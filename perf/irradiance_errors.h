#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// Markdown tables for the environments in `files`: how far the irradiance cubemap of a bake is from direct cosine
/// integration, from three bands and by default, how far the irradiance of some bands is from direct cosine
/// integration, the least irradiance of three bands with each window, and for environments with a sun the first errors
/// beside those with the sun as a directional light. Every number is the same on every machine.
[[nodiscard]] std::string irradiance_error_tables(const std::vector<std::filesystem::path>& files);

}  // namespace welkin::perf
