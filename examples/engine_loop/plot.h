// The frames as a picture.
#pragma once

#include <filesystem>
#include <vector>

#include "loop.h"

namespace engine_loop {

/// Has gnuplot draw frame time over frame number, one panel for each run, from what `write_csv` wrote.
/// False if that did not work, as where there is no gnuplot.
[[nodiscard]] bool draw_plot(const std::filesystem::path& csv, const std::filesystem::path& png,
                             const std::vector<Run>& runs);

}  // namespace engine_loop
