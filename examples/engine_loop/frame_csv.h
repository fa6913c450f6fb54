// All frames of all runs in a file.
#pragma once

#include <filesystem>
#include <vector>

#include "loop.h"

namespace engine_loop {

/// One line per frame, after one that names the columns: run, frame (from 0), total_ms, and what that is made up of
/// (wake_ms, work_ms, collect_ms, ask_ms). Throws std::ios_base::failure.
void write_csv(const std::filesystem::path& path, const std::vector<Run>& runs);

}  // namespace engine_loop
