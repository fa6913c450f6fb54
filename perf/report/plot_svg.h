// Error over time as a picture.
#pragma once

#include <span>
#include <string>

#include "perf/report/measurement.h"

namespace welkin::report {

/// Where a plot goes: a file needs its namespace named, a page does not and is to have nothing that looks like an
/// address.
enum class PlotUse { page, file };

/// A log-log plot of rms error over time as SVG, 860 units wide, without script, style sheet or anything from
/// elsewhere: it stands alone as a file and inline in a page. A method's settings are joined; those on the front are
/// ringed, named and joined by a step; peers are hollow. Each point is a <g class="point"> with its words as <title>.
/// Errors below 1e-9 are drawn there. Empty if no measurement has two numbers.
[[nodiscard]] std::string plot_svg(const Pass& pass, std::span<const Measurement> measurements, const Machine& machine,
                                   PlotUse use);

}  // namespace welkin::report
