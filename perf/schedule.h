// How long a bake would take on many cores, computed from what its tiles take on one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace welkin::perf {

/// Tables for `welkin_perf --schedule`: bakes at 1 to 64 workers, and what their regions consist of. No arguments.
[[nodiscard]] std::string schedule_tables(const std::vector<std::filesystem::path>& arguments);

}  // namespace welkin::perf
