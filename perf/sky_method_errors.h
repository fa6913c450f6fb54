#pragma once

#include <string>

namespace welkin::perf {

/// Nine coefficients of singly scattered light on the ground, black ground, by every method and sun elevation: Markdown
/// tables of errors against the truth in double (the tables' own included) and against the converged integral of the
/// same view, then lines of tabs: method, setting, directions, microseconds, rms and worst error against the truth over
/// elevations, the worst one's elevation.
[[nodiscard]] std::string sky_method_table(double altitude_m);

}  // namespace welkin::perf
