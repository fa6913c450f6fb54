// The parts of the module `welkin._welkin`. Each adds its classes and functions; docstrings stand beside them.
#pragma once

#include <pybind11/pybind11.h>

namespace welkin::python {

namespace py = pybind11;

void bind_errors(py::module_& module);
void bind_harmonics(py::module_& module);
void bind_engines(py::module_& module);
void bind_projection(py::module_& module);
void bind_reflections(py::module_& module);
void bind_lobes(py::module_& module);
void bind_octahedral(py::module_& module);
void bind_importance(py::module_& module);
void bind_many(py::module_& module);
void bind_probes(py::module_& module);
void bind_bake(py::module_& module);
void bind_plan(py::module_& module);
void bind_sky(py::module_& module);
void bind_files(py::module_& module);
void bind_images(py::module_& module);
void bind_timing(py::module_& module);

}  // namespace welkin::python
