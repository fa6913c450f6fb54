// `welkin::Error` becomes the exception of its code in welkin/_errors.py.
#include <exception>
#include <string>

#include "bindings.h"
#include "welkin/core.h"

namespace welkin::python {
namespace {

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_argument: return "invalid_argument";
    case ErrorCode::rejected_pixel: return "rejected_pixel";
    case ErrorCode::file_access: return "file_access";
    case ErrorCode::corrupt_file: return "corrupt_file";
    case ErrorCode::unsupported_file: return "unsupported_file";
    case ErrorCode::limit_exceeded: return "limit_exceeded";
    case ErrorCode::cancelled: return "cancelled";
    case ErrorCode::replaced: return "replaced";
    case ErrorCode::queue_full: return "queue_full";
    case ErrorCode::stopped: return "stopped";
  }
  return "invalid_argument";
}

}  // namespace

void bind_errors(py::module_& /*module*/) {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      const py::object made =
          py::module_::import("welkin._errors").attr("error_of")(name_of(error.code()), error.what());
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
    }
  });
}

}  // namespace welkin::python
