// What a job of a batch is predicted to cost.
#pragma once

#include "tools/bake_options.h"
#include "tools/baked.h"

namespace welkin::tool {

/// Returns the predicted processor time of a job in seconds, from the texels of its input and the bytes of its results.
[[nodiscard]] double seconds_of_job(const Prediction& prediction, const BakeCommandOptions& options);

}  // namespace welkin::tool
