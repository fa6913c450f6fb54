#include "arrays.h"

#include <array>
#include <cmath>
#include <cstring>
#include <glm/matrix.hpp>

namespace welkin::python {

py::array array_of(Cubemap cubemap) { return level_of(std::make_shared<Cubemap>(std::move(cubemap)), 0); }

py::array array_of(LatLongImage image) {
  const py::ssize_t height = image.height;
  const py::ssize_t width = image.width;
  return owning(std::move(image.pixels), {height, width, 3});
}

py::array array_of(const dvec3& value) { return py::array_t<double>(3, &value.x); }

py::array array_of(const std::vector<dvec3>& values) {
  return py::array_t<double>({static_cast<py::ssize_t>(values.size()), py::ssize_t{3}},
                             values.empty() ? nullptr : &values.front().x);
}

py::array array_of(const dmat3& matrix) {
  const dmat3 rows = glm::transpose(matrix);
  return py::array_t<double>({py::ssize_t{3}, py::ssize_t{3}}, &rows[0].x);
}

py::object as_asked(const py::array& array, const py::args& words, const py::kwargs& named) {
  const auto word = [&](const char* name) -> py::object {
    return named.contains(name) ? py::object(named[name]) : py::object(py::none());
  };
  const py::object dtype = words.empty() ? word("dtype") : py::object(words[0]);
  const py::object copy = word("copy");
  const bool is_cast = !dtype.is_none() && !array.dtype().equal(py::dtype::from_args(dtype));
  if (is_cast && !copy.is_none() && !copy.cast<bool>()) {
    throw py::value_error("another dtype takes a copy, which copy=False does not allow");
  }
  if (is_cast) return array.attr("astype")(dtype);
  if (!copy.is_none() && copy.cast<bool>()) return array.attr("copy")();
  return array;
}

Directions directions_of(const py::object& value, const char* what) {
  Directions found{decltype(Directions::values)::ensure(value), {}};
  if (!found.values) {
    PyErr_Clear();
    throw Error(ErrorCode::invalid_argument, std::string(what) + ": takes numbers of shape (..., 3)");
  }
  found.shape.assign(found.values.shape(), found.values.shape() + found.values.ndim());
  if (found.shape.empty() || found.shape.back() != 3) {
    throw Error(ErrorCode::invalid_argument, std::string(what) + ": takes numbers of shape (..., 3), found shape " +
                                                 py::str(found.values.attr("shape")).cast<std::string>());
  }
  return found;
}

dvec3 vector_of(py::handle value, const char* what) {
  const Directions found = directions_of(py::reinterpret_borrow<py::object>(value), what);
  if (found.shape.size() != 1) {
    throw Error(ErrorCode::invalid_argument, std::string(what) + ": takes three numbers, found an array of " +
                                                 std::to_string(found.shape.size()) + " dimensions");
  }
  return found.at(0);
}

namespace {

dmat3 matrix_of_quaternion(const double* q, const char* what) {
  const double squared = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(squared > 0.0) || !std::isfinite(squared)) {
    throw Error(ErrorCode::invalid_argument, std::string(what) + ": a quaternion without length");
  }
  const double s = 2.0 / squared;
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  return {{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},   // where x goes,
          {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},   // y
          {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}};  // and z
}

}  // namespace

dmat3 rotation_from(const py::object& value, const char* what) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (numbers && numbers.ndim() == 1 && numbers.shape(0) == 4) return matrix_of_quaternion(numbers.data(), what);
  if (numbers && numbers.ndim() == 2 && numbers.shape(0) == 3 && numbers.shape(1) == 3) {
    dmat3 rows(1.0);
    std::memcpy(&rows[0].x, numbers.data(), sizeof(rows));
    return glm::transpose(rows);
  }
  PyErr_Clear();
  throw Error(ErrorCode::invalid_argument, std::string(what) + ": takes a 3 x 3 matrix, or a quaternion (w, x, y, z)");
}

py::array level_of(const SharedChain& chain, int level) {
  const py::ssize_t size = chain->level_size(level);
  return shown<float>({6, size, size, 3}, chain->face(level, 0), keeper(chain), true);
}

bool is_path(py::handle value) { return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__"); }

}  // namespace welkin::python
