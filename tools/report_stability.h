// `welkin report --stability`: the stability suite as a table for people or as JSON.
#pragma once

#include <string>
#include <vector>

#include "report/stability.h"

namespace welkin::tool {

enum class StabilityFormat { table, json, markdown };

struct StabilityRequest {
  report::StabilityOptions suite{};
  StabilityFormat format = StabilityFormat::table;
  report::StabilityOrigin origin{};  ///< stated by JSON and markdown; the table needs none
};

/// Runs the suite with a progress bar (on a terminal) and gives the text to print. Throws what `run_stability` throws.
[[nodiscard]] std::string report_stability(const StabilityRequest& request);

/// Plain ASCII, a line a case, subject after subject; then what to do about those that do not hold.
[[nodiscard]] std::string stability_table(const std::vector<report::StabilityResult>& results);

/// {"date", "machine", "holding", "cases": [{"name", "subject", "promise", "truth", "measured", "unit", "bound",
/// "holds", "advice", "failure"}]}. An infinite error is null; advice and failure are there where there is one.
[[nodiscard]] std::string stability_json(const std::vector<report::StabilityResult>& results,
                                         const report::StabilityOrigin& origin);

}  // namespace welkin::tool
