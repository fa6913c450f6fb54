// The options and the result of a bake, for plans too.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "options.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"

namespace welkin::python {

/// Takes what is made: `background`, `specular`, `irradiance`, `brdf` (True, False or options of their own), `bands`,
/// `policy`, `memory_limit`.
[[nodiscard]] BakeOptions bake_options(Options& options);

/// A plan, and of a file the file.
struct PlanOfSource {
  Plan plan;
  std::optional<StoredEnvironment> file;
  pybind11::object keeps;  ///< the bytes of a file in memory
};

}  // namespace welkin::python
