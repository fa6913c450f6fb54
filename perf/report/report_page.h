// A report as a page to look at.
#pragma once

#include <optional>
#include <string>

#include "perf/report/comparison.h"
#include "perf/report/measurement.h"

namespace welkin::report {

/// One HTML file that needs nothing else: plots as inline SVG, tables, style and script inside, nothing from a network
/// or another file. Without script it is complete but for the highlighting; printed, it is all there.
[[nodiscard]] std::string to_html(const Report& report, const std::optional<Comparison>& comparison = std::nullopt);

}  // namespace welkin::report
