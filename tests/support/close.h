// Nearly equal numbers.
#pragma once

#include <cmath>

namespace welkin::test {

/// Whether two numbers differ by no more than `relative` times the second.
inline bool close(double found, double wanted, double relative = 1e-12) {
  return std::abs(found - wanted) <= relative * std::abs(wanted);
}

}  // namespace welkin::test
