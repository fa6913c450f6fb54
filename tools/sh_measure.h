// From `welkin sh`'s options to its report.
#pragma once

#include "tools/sh_options.h"
#include "tools/sh_report.h"

namespace welkin::tool {

/// Reads, projects, turns, windows. Shows a progress bar on a terminal. Throws what the library throws.
[[nodiscard]] ShReport measure_sh(const ShOptions& options);

/// Fills in what follows from `report.projection.radiance`, which is in the result's axes, and from the options:
/// window, dominant light, irradiance, the forms of engines.
void complete(ShReport& report, const ShOptions& options);

}  // namespace welkin::tool
