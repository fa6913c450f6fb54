// The class SphericalHarmonics of the module is welkin::SphericalHarmonics; what else of it other parts need.
#pragma once

#include <pybind11/pybind11.h>

#include "welkin/spherical_harmonics.h"

namespace welkin::python {

/// Coefficients by a `SphericalHarmonics`, or an array (bands^2, 3).
[[nodiscard]] SphericalHarmonics harmonics_of(const pybind11::object& value);

}  // namespace welkin::python
