// Many cubemaps of Python's.
#pragma once

#include <pybind11/pybind11.h>

#include <vector>

#include "options.h"
#include "source.h"
#include "welkin/image.h"

namespace welkin::python {

/// The cubemaps of an array (n, 6, size, size, channels), or of a list of whatever is one cubemap.
struct Probes {
  std::vector<Source> sources;
  std::vector<CubemapView> views;
};

/// Takes how pixels are laid out and read. Throws TypeError and `Error` that name the probe.
[[nodiscard]] Probes probes_of(const py::object& pixels, Options& options);

}  // namespace welkin::python
