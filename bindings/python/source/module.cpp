// The module `welkin._welkin`. People import `welkin`, which shows all of it.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "welkin/core.h"

namespace welkin::python {
namespace {

void bind_machine(py::module_& module) {
  module.attr("__version__") = WELKIN_VERSION_STRING;
  module.def("available_threads", &available_threads,
             "available_threads()\n--\n\nHow many threads a call uses unless `threads` says otherwise.");
  module.def(
      "instruction_set", [] { return name(active_instruction_set()); },
      "instruction_set()\n--\n\n"
      "The kernels in use: \"sse2\", \"avx2\", \"avx512\" or \"neon\". All give the same bits.");
}

}  // namespace
}  // namespace welkin::python

PYBIND11_MODULE(_welkin, module) {
  namespace py = pybind11;
  py::options options;
  options.disable_function_signatures();  // docstrings have their own, which inspect.signature reads
  module.doc() = "The extension behind the package welkin.";
  welkin::python::bind_machine(module);
  welkin::python::bind_errors(module);
  welkin::python::bind_harmonics(module);
  welkin::python::bind_engines(module);
  welkin::python::bind_projection(module);
  welkin::python::bind_kernels(module);
  welkin::python::bind_reflections(module);
  welkin::python::bind_octahedral(module);
  welkin::python::bind_importance(module);
  welkin::python::bind_many(module);
  welkin::python::bind_bake(module);
  welkin::python::bind_plan(module);
  welkin::python::bind_sky(module);
  welkin::python::bind_files(module);
  welkin::python::bind_pictures(module);
  welkin::python::bind_timing(module);
}
