// Coefficients on record, as hexadecimal doubles.
#pragma once

#include <string>
#include <vector>

#include "welkin/spherical_harmonics.h"

namespace welkin::test {

/// Requires every bit of `results` to be as tests/data/golden_NAME.txt has it. With the environment variable
/// WELKIN_RECORD_GOLDEN set, writes that file instead: for a change that alters bits and says why.
void require_golden(const std::string& name, const std::vector<SphericalHarmonics>& results);

}  // namespace welkin::test
