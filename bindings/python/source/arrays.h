// Numbers of the library's as numpy arrays, without copies, and small ones of numpy's as vectors of ours.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::python {

namespace py = pybind11;

/// An array over memory that `owner` keeps.
template <class Value>
[[nodiscard]] py::array shown(std::vector<py::ssize_t> shape, const Value* first, py::handle owner, bool writeable) {
  py::array array(py::dtype::of<Value>(), std::move(shape), first, owner);
  if (!writeable) array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// An object of Python's that keeps `kept` until it is collected.
template <class Kept>
[[nodiscard]] py::capsule keeper(Kept kept) {
  return py::capsule(new Kept(std::move(kept)), [](void* held) { delete static_cast<Kept*>(held); });
}

/// An array that takes over a vector.
template <class Value>
[[nodiscard]] py::array owning(std::vector<Value> values, std::vector<py::ssize_t> shape) {
  auto kept = std::make_unique<std::vector<Value>>(std::move(values));
  const Value* const first = kept->data();
  const py::capsule owner = keeper(std::move(kept));
  return shown(std::move(shape), first, owner, true);
}

/// What `__array__(dtype=None, copy=None)` gives of an array: itself, unless another dtype or a copy is asked for
/// (NumPy 2 relies on that). Raises ValueError where copy=False cannot be.
[[nodiscard]] py::object as_asked(const py::array& array, const py::args& words, const py::kwargs& named);

/// (6, size, size, 3), float32.
[[nodiscard]] py::array array_of(Cubemap cubemap);
/// (height, width, 3), float32.
[[nodiscard]] py::array array_of(LatLongImage image);
/// (3,), float64.
[[nodiscard]] py::array array_of(const dvec3& value);
/// (n, 3), float64.
[[nodiscard]] py::array array_of(const std::vector<dvec3>& values);
/// (3, 3), float64, row by row.
[[nodiscard]] py::array array_of(const dmat3& matrix);

/// Three numbers: a list, a tuple, an array. Throws `Error` (invalid_argument) that calls them `what`.
[[nodiscard]] dvec3 vector_of(py::handle value, const char* what);

/// Directions of shape (..., 3).
struct Directions {
  py::array_t<double, py::array::c_style | py::array::forcecast> values;
  std::vector<py::ssize_t> shape;  ///< of the array, the last 3 included

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(values.size()) / 3; }
  [[nodiscard]] dvec3 at(std::size_t index) const {
    const double* const first = values.data() + 3 * index;
    return {first[0], first[1], first[2]};
  }
};
[[nodiscard]] Directions directions_of(const py::object& value, const char* what);

/// A rotation (or a mirror): an orthogonal 3 x 3 matrix, or a quaternion (w, x, y, z) of any length but 0.
[[nodiscard]] dmat3 rotation_from(const py::object& value, const char* what);

/// A chain that several objects of Python's look at.
using SharedChain = std::shared_ptr<Cubemap>;

/// One level, (6, n, n, 3), float32, on the chain's own memory.
[[nodiscard]] py::array level_of(const SharedChain& chain, int level);

/// Text from a path of Python's (`str` or `os.PathLike`), in UTF-8; nothing of what is no path.
[[nodiscard]] bool is_path(py::handle value);

}  // namespace welkin::python
