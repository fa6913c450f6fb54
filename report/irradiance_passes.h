// Diffuse light by a few bands.
#pragma once

#include <vector>

#include "report/pass_context.h"

namespace welkin::report {

[[nodiscard]] std::vector<PassRunner> irradiance_passes();

}  // namespace welkin::report
