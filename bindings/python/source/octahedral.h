// Octahedral maps as objects of Python's.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "call.h"
#include "welkin/resampling.h"

namespace welkin::python {

/// A map that arrays look at, too.
struct SharedOctahedral {
  std::shared_ptr<const OctahedralMap> map;
};

[[nodiscard]] OctahedralOptions octahedral_options(Options& options);
[[nodiscard]] SharedOctahedral shared(OctahedralMap map);

}  // namespace welkin::python
