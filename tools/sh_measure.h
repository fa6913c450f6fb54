// From `welkin sh`'s options to its report.
#pragma once

#include "tools/sh_options.h"
#include "tools/sh_report.h"

namespace welkin::tool {

/// Reads, projects, turns, windows. Shows a progress bar on a terminal. Throws what the library throws.
[[nodiscard]] ShReport measure_sh(const ShOptions& options);

}  // namespace welkin::tool
