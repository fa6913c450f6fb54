// Whether two runs came to the same light.
#pragma once

#include <string>

#include "loop.h"

namespace engine_loop {

/// What is wrong with a run's light, held against the synchronous calls' bit by bit; empty if nothing is. Only what has
/// a key may have been replaced, and never the last one of a key.
[[nodiscard]] std::string difference(const Run& synchronous, const Run& run);

}  // namespace engine_loop
