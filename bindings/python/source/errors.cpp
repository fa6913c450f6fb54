// `welkin::Error` becomes the exception of its code in welkin/_errors.py.
#include <exception>
#include <string>

#include "bindings.h"
#include "welkin/core.h"

namespace welkin::python {
void bind_errors(py::module_& module) {
  // For the tests: each has an exception.
  py::list codes;
  for (int code = 0; code <= static_cast<int>(ErrorCode::stopped); ++code)
    codes.append(name(static_cast<ErrorCode>(code)));
  module.attr("_error_codes") = py::tuple(codes);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      const py::object made = py::module_::import("welkin._errors").attr("error_of")(name(error.code()), error.what());
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
    } catch (const py::cast_error& error) {  // of what a call takes out of its arguments itself
      PyErr_SetString(PyExc_TypeError, error.what());
    }
  });
}

}  // namespace welkin::python
