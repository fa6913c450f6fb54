#include "call.h"

#include <utility>

namespace welkin::python {

Call::Call(const char* name, Options& options) : name_(name), caller_(std::this_thread::get_id()) {
  const py::handle progress = options.take("progress");
  options.read("threads", threads_);
  if (!progress || progress.is(py::handle(Py_False))) return;
  if (progress.is(py::handle(Py_True))) {
    progress_ = py::module_::import("welkin._progress").attr("Bar")(name_);
  } else if (PyCallable_Check(progress.ptr()) != 0) {
    progress_ = py::reinterpret_borrow<py::object>(progress);
  } else {
    throw py::type_error(options.called("progress") + " takes True or a function of the share that is done");
  }
}

Call::~Call() {
  if (!progress_ || !py::hasattr(progress_, "close")) return;
  try {
    progress_.attr("close")();
  } catch (py::error_already_set& error) {
    error.discard_as_unraisable(name_);
  }
}

void Call::begin() { next_ = std::chrono::steady_clock::now() + kPause; }

void Call::report(double share) {
  if (std::this_thread::get_id() != caller_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_ || raised_) return;
  const py::gil_scoped_acquire acquired;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (progress_ && share < 1.0) progress_(share);
  } catch (py::error_already_set& error) {
    raised_.emplace(std::move(error));
    stop_.request_stop();
  }
  next_ = std::chrono::steady_clock::now() + kPause;
}

void Call::end() {
  if (raised_) throw_what_was_raised();
  if (progress_) progress_(1.0);
}

void Call::throw_what_was_raised() {
  if (raised_) throw py::error_already_set(std::move(*raised_));
}

}  // namespace welkin::python
