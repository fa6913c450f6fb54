// What a job of a batch is predicted to cost.
#pragma once

#include "tools/bake_options.h"
#include "tools/baked.h"

namespace welkin::tool {

/// Returns the predicted processor time of a job in seconds: the passes of its plan, reading the input, previews,
/// other lobes, and encoding the files that `options` list.
[[nodiscard]] double seconds_of_job(const Prediction& prediction, const BakeCommandOptions& options);

}  // namespace welkin::tool
