// The BRDF table by its size.
#pragma once

#include <vector>

#include "report/pass_context.h"

namespace welkin::report {

[[nodiscard]] std::vector<PassRunner> brdf_passes();

}  // namespace welkin::report
