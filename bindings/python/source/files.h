// Files of Python's paths and bytes.
#pragma once

#include <pybind11/pybind11.h>

#include "options.h"
#include "welkin/environment_file.h"

namespace welkin::python {

/// Whether it is a file: `str`, `os.PathLike` or `bytes`.
[[nodiscard]] bool is_file(pybind11::handle value);
/// Bytes must outlive what reads them.
[[nodiscard]] FileInput input_of(const pybind11::object& file);
/// Takes how a file is read.
[[nodiscard]] ReadOptions read_options(Options& options);
/// The same in the dictionary `read`.
[[nodiscard]] ReadOptions read_group(Options& options);

}  // namespace welkin::python
