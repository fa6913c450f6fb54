// Reflections: single roughnesses from memory, and a whole chain from a file.
#pragma once

#include <vector>

#include "report/pass_context.h"

namespace welkin::report {

[[nodiscard]] std::vector<PassRunner> prefilter_passes();

}  // namespace welkin::report
