// `welkin report --calibrate`: what work costs on this machine, for the plans of `welkin bake --costs`.
#pragma once

#include <string>

namespace welkin::tool {

/// Measures for some four seconds, with a progress bar (on a terminal), and writes the costs as JSON: into `file`, and
/// gives its name to print; or, where that is empty, gives the JSON itself. Throws `Error`: file_access, cancelled.
[[nodiscard]] std::string report_costs(const std::string& file);

}  // namespace welkin::tool
