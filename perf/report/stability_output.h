// `welkin report --stability`: the stability suite as a table for people or as JSON.
#pragma once

#include <string>
#include <vector>

#include "perf/report/stability.h"

namespace welkin::tool {

enum class StabilityFormat { table, json, markdown };

struct StabilityRequest {
  report::StabilityOptions suite{};
  StabilityFormat format = StabilityFormat::table;
  report::StabilityOrigin origin{};  ///< stated by JSON and markdown; the table needs none
};

/// Runs the suite with a progress bar (on a terminal) and gives the text to print. Throws what `run_stability` throws.
[[nodiscard]] std::string stability_text(const StabilityRequest& request);

}  // namespace welkin::tool
