// What every list of wavelengths must be.
#pragma once

#include <vector>

namespace welkin::sky {

/// Throws `Error` (invalid_argument) unless there are 3 to 96, from 1 to 1e6 nm, all rising or all falling.
void check_wavelengths(const std::vector<double>& wavelengths_nm);

}  // namespace welkin::sky
