// The module `welkin._welkin`. People import `welkin`, which shows all of it.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstddef>
#include <string>

#include "bindings.h"
#include "welkin/core.h"

namespace welkin::python {
namespace {

void bind_machine(py::module_& module) {
  module.attr("__version__") = WELKIN_VERSION_STRING;
  module.def("available_threads", &available_threads,
             "available_threads()\n"
             "--\n\n"
             "Returns the number of threads that a call uses unless `threads` is set.");
  module.def("keep_working_memory", &keep_working_memory, py::arg("bytes"),
             "keep_working_memory(bytes)\n"
             "--\n\n"
             "Sets how many bytes of unused working memory the process keeps between calls.");
  module.def("release_working_memory", &release_working_memory,
             "release_working_memory()\n"
             "--\n\n"
             "Frees all working memory that no call uses.");
  module.def(
      "instruction_set", [] { return name(active_instruction_set()); },
      "instruction_set()\n"
      "--\n\n"
      "Returns the instruction set in use: \"sse2\", \"avx2\", \"avx512\" or \"neon\". Results do not depend on it.");
}

/// pybind11 allocates an object that no constructor has made when it is first looked at, and reads what lay there. It
/// asks this function for the memory, where a class has one.
[[noreturn]] void* refuse_unmade(std::size_t /*size*/) {
  throw py::type_error("this object was never initialized: call its class, or the function that gives such objects");
}

/// A constructor that is called again would be passed over in silence.
void refuse_second_init(const py::object& kind) {
  const py::object init = kind.attr("__init__");
  kind.attr("__init__") = py::cpp_function(
      [init, kind](const py::object& self, const py::args& words, const py::kwargs& named) {
        if (!py::isinstance(self, kind)) {
          throw py::type_error(kind.attr("__name__").cast<std::string>() + ".__init__ takes an object of that class");
        }
        auto* const instance = reinterpret_cast<py::detail::instance*>(self.ptr());
        if (instance->get_value_and_holder().holder_constructed()) {
          throw py::type_error(py::str(py::type::handle_of(self).attr("__name__")).cast<std::string>() +
                               ": the object is initialized already; make another one");
        }
        init(self, *words, **named);
      },
      py::is_method(kind), py::name("initialize"));  // of "__init__" pybind11 would do it
}

void guard_classes(py::module_& module) {
  for (const auto& [name, kind] : module.attr("__dict__").cast<py::dict>()) {
    if (!py::isinstance<py::type>(kind)) continue;
    py::detail::type_info* const info = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(kind.ptr()));
    if (info == nullptr) continue;
    info->operator_new = &refuse_unmade;
    const py::object init = kind.attr("__dict__").attr("get")("__init__");
    if (PyInstanceMethod_Check(init.ptr())) refuse_second_init(py::reinterpret_borrow<py::object>(kind));
  }
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
  welkin::python::bind_lobes(module);
  welkin::python::bind_reflections(module);
  welkin::python::bind_octahedral(module);
  welkin::python::bind_importance(module);
  welkin::python::bind_many(module);
  welkin::python::bind_probes(module);
  welkin::python::bind_bake(module);
  welkin::python::bind_plan(module);
  welkin::python::bind_sky(module);
  welkin::python::bind_files(module);
  welkin::python::bind_images(module);
  welkin::python::bind_timing(module);
  welkin::python::guard_classes(module);
}
