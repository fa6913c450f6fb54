// From `welkin sky`'s options to the report that `welkin sh` prints.
#pragma once

#include "tools/sh_report.h"
#include "tools/sky_options.h"

namespace welkin::tool {

/// Makes or loads tables, projects the sky, turns it to the engine's axes, windows. Shows a progress bar on a terminal.
/// Throws what the library throws.
[[nodiscard]] ShReport measure_sky(const SkyOptions& options);

}  // namespace welkin::tool
