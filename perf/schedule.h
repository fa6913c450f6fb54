// How long a bake would take on many cores, computed from what its tiles take on one.
#pragma once

#include <filesystem>
#include <string>

namespace welkin::perf {

/// Tables for `welkin_perf --schedule`: bakes at 1 to 64 workers, warm and as the first call of a process of its own
/// (`program`, which is this one), and what the regions of the warm ones consist of.
[[nodiscard]] std::string schedule_tables(const std::filesystem::path& program);

/// The child process of a first call: seconds at each number of workers and of the critical path, on one line.
[[nodiscard]] std::string first_schedule(const std::string& name);

}  // namespace welkin::perf
