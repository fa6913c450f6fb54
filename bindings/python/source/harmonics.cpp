// Coefficients of spherical harmonics: values, turns, products, windows.
#include "harmonics.h"

#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "options.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::python {
namespace {

constexpr Named<Window> kWindows[] = {{"none", Window::none},
                                      {"hanning", Window::hanning},
                                      {"lanczos", Window::lanczos},
                                      {"min-laplacian", Window::min_laplacian}};

SphericalHarmonics from_array(const py::object& value) {
  if (py::hasattr(value, "radiance")) {
    throw Error(ErrorCode::invalid_argument,
                "coefficients: found a " + py::str(py::type::handle_of(value).attr("__name__")).cast<std::string>() +
                    "; pass its .radiance");
  }
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!numbers) PyErr_Clear();
  const py::ssize_t rows = numbers && numbers.ndim() == 2 && numbers.shape(1) == 3 ? numbers.shape(0) : 0;
  const int bands = static_cast<int>(std::lround(std::sqrt(static_cast<double>(rows))));
  if (rows == 0 || py::ssize_t{bands} * bands != rows) {
    throw Error(ErrorCode::invalid_argument, "coefficients: takes numbers of shape (bands^2, 3)");
  }
  SphericalHarmonics made(bands);
  std::copy_n(numbers.data(), 3 * rows, &made.coefficients()[0].x);
  return made;
}

/// The coefficients themselves: who writes to them changes the object.
py::array coefficients_of(const py::object& self) {
  auto& harmonics = self.cast<SphericalHarmonics&>();
  const auto count = static_cast<py::ssize_t>(harmonics.coefficients().size());
  return shown<double>({count, 3}, &harmonics.coefficients()[0].x, self, true);
}

/// Takes `directions` alone, which pybind11 would say in its own words.
py::array values_at(const SphericalHarmonics& harmonics, const py::args& words, const py::kwargs& named) {
  const bool is_named = named.contains("directions");
  if (words.size() + named.size() != 1 || is_named != words.empty()) {
    throw py::type_error("harmonics are called with directions of shape (..., 3), as in light((0, 1, 0)); found " +
                         std::to_string(words.size() + named.size()) + " arguments");
  }
  const Directions asked = directions_of(is_named ? py::object(named["directions"]) : words[0], "directions");
  py::array_t<double> values(asked.shape);
  double* const out = values.mutable_data();
  const LockReleased released(asked.count());
  std::vector<dvec3> directions(asked.count());
  for (std::size_t index = 0; index < asked.count(); ++index) directions[index] = asked.at(index);
  std::vector<dvec3> sums(asked.count());
  evaluate(harmonics, directions, sums);
  for (std::size_t index = 0; index < asked.count(); ++index) std::copy_n(&sums[index].x, 3, out + 3 * index);
  return values;
}

/// A number, or one for each channel.
dvec3 factor_of(const py::object& factor) {
  if (py::isinstance<py::float_>(factor) || py::isinstance<py::int_>(factor)) return dvec3(factor.cast<double>());
  return vector_of(factor, "factor");
}

SphericalHarmonics scaled(const SphericalHarmonics& harmonics, const py::object& factor) {
  return scale(harmonics, factor_of(factor));
}

SphericalHarmonics divided(const SphericalHarmonics& harmonics, const py::object& divisor) {
  const dvec3 by = factor_of(divisor);
  SphericalHarmonics result = harmonics;
  for (dvec3& value : result.coefficients()) value /= by;
  return result;
}

/// 0 + light, with which `sum` begins.
py::object added_to(const SphericalHarmonics& harmonics, const py::object& other) {
  const bool is_zero = py::isinstance<py::int_>(other) && other.equal(py::int_(0));
  return is_zero ? py::cast(harmonics) : py::reinterpret_borrow<py::object>(Py_NotImplemented);
}

bool are_equal(const SphericalHarmonics& a, const SphericalHarmonics& b) {
  return std::equal(a.coefficients().begin(), a.coefficients().end(), b.coefficients().begin(), b.coefficients().end());
}

py::tuple minimum_of(const SphericalHarmonics& harmonics) {
  const HarmonicMinimum found = minimum(harmonics);
  return py::make_tuple(array_of(found.value),
                        array_of(std::vector<dvec3>(std::begin(found.direction), std::end(found.direction))));
}

py::object dominant_of(const SphericalHarmonics& harmonics) {
  const std::optional<DominantLight> light = dominant_light(harmonics);
  if (!light) return py::none();
  return py::make_tuple(array_of(light->direction), array_of(light->irradiance));
}

std::string text(const dvec3& value) {
  char words[96];
  std::snprintf(words, sizeof(words), "(%.4g, %.4g, %.4g)", value.x, value.y, value.z);
  return words;
}

void bind_windowed(py::module_& module) {
  py::class_<WindowResult>(module, "WindowResult", "Windowed coefficients, and what the window did.")
      .def_readonly("harmonics", &WindowResult::radiance, "The windowed coefficients of radiance.")
      .def_readonly("parameter", &WindowResult::parameter,
                    "Width in bands (hanning, lanczos), or lambda (min-laplacian).")
      .def_property_readonly(
          "minimum_before", [](const WindowResult& self) { return array_of(self.minimum_before); },
          "Least irradiance over all normals, by channel: (3,).")
      .def_property_readonly(
          "minimum_after", [](const WindowResult& self) { return array_of(self.minimum_after); },
          "The same of the windowed light.")
      .def_readonly("factors", &WindowResult::factors, "By what each band was multiplied.")
      .def("__repr__", [](const WindowResult& self) {
        return "<welkin.WindowResult: least irradiance " + text(self.minimum_before) + " -> " +
               text(self.minimum_after) + ">";
      });
}

}  // namespace

SphericalHarmonics harmonics_of(const py::object& value) {
  if (py::isinstance<SphericalHarmonics>(value)) return value.cast<const SphericalHarmonics&>();
  return from_array(value);
}

void bind_harmonics(py::module_& module) {
  bind_windowed(module);
  py::class_<SphericalHarmonics>(
      module, "SphericalHarmonics",
      "RGB coefficients over real, orthonormal spherical harmonics without Condon-Shortley phase. Coefficient (l,\n"
      "m) has the index l (l + 1) + m; Y(1, -1), Y(1, 0), Y(1, 1) are proportional to y, z, x.\n\n"
      "SphericalHarmonics(bands) is zero; SphericalHarmonics(array) copies an array of shape (bands^2, 3).\n"
      "light[i] is coefficient i, (3,), and len(light) is bands^2. + - * / take numbers or arrays (3,) as\n"
      "factors, sum() adds a list, and == compares coefficients.")
      .def(py::init<int>())
      .def(py::init(&from_array))
      .def_property_readonly("bands", &SphericalHarmonics::bands, "How many bands: 1 to 16.")
      .def_property_readonly("coefficients", &coefficients_of,
                             "(bands^2, 3), float64, a view of the object's memory: writing to it changes the\n"
                             "object.")
      .def("__array__", [](const py::object& self, const py::args& words,
                           const py::kwargs& named) { return as_asked(coefficients_of(self), words, named); })
      .def("__call__", &values_at,
           "__call__(self, directions)\n"
           "--\n\n"
           "Evaluates the sum at directions (..., 3) of any length above 0: radiance or irradiance, (..., 3).")
      .def_property_readonly(
          "mean", [](const SphericalHarmonics& self) { return array_of(mean_radiance(self)); },
          "Mean over the sphere: (3,).")
      .def("irradiance", &irradiance_from_radiance,
           "irradiance(self)\n"
           "--\n\n"
           "Converts radiance to irradiance, W/m2 where radiance is W/m2/sr: multiplies band l by the cosine\n"
           "lobe's factor. A uniform radiance of 1 gives pi.")
      .def("lambertian", &lambertian_from_irradiance, "lambertian(self)\n--\n\nOf irradiance: times 1/pi.")
      .def(
          "rotate",
          [](const SphericalHarmonics& self, const py::object& rotation) {
            return rotate(self, rotation_from(rotation, "rotation"));
          },
          py::arg("rotation"),
          "rotate(self, rotation)\n"
          "--\n\n"
          "Returns the light rotated: light from direction d then comes from rotation @ d. `rotation`: an orthogonal 3 "
          "x\n"
          "3 matrix (also a mirror), or a quaternion (w, x, y, z). Takes microseconds for three bands.")
      .def("resized", &resized, py::arg("bands"),
           "resized(self, bands)\n"
           "--\n\n"
           "Returns the coefficients with bands truncated, or added as zero.")
      .def(
          "lerp", [](const SphericalHarmonics& a, const SphericalHarmonics& b, double t) { return lerp(a, b, t); },
          py::arg("other"), py::arg("t"), "lerp(self, other, t)\n--\n\n(1 - t) self + t other.")
      .def(
          "product",
          [](const SphericalHarmonics& a, const SphericalHarmonics& b, int bands) { return product(a, b, bands); },
          py::arg("other"), py::arg("bands") = 0,
          "product(self, other, bands=0)\n"
          "--\n\n"
          "Returns coefficients of the pointwise product. 0 bands: all that the product has, at most 16.")
      .def("minimum", &minimum_of,
           "minimum(self)\n"
           "--\n\n"
           "Returns (values (3,), directions (3, 3)): the minimum of each channel and its direction.")
      .def("dominant_light", &dominant_of,
           "dominant_light(self)\n"
           "--\n\n"
           "Returns (direction (3,), irradiance (3,)) of the directional light that best approximates the\n"
           "radiance, or None if it has no direction.")
      .def(
          "window",
          [](const SphericalHarmonics& self, const std::string& window, double width) {
            return apply_window(self, value_of<Window>("window", window, kWindows), width);
          },
          py::arg("window") = "min-laplacian", py::arg("width") = 0.0,
          "window(self, window='min-laplacian', width=0.0)\n"
          "--\n\n"
          "Applies a window against ringing to radiance. Returns a `WindowResult`. `window`: \"none\", \"hanning\",\n"
          "\"lanczos\" (`width` in bands, 0: the number of bands) or \"min-laplacian\", the minimum for which no\n"
          "irradiance is negative.")
      .def(
          "__add__", [](const SphericalHarmonics& a, const SphericalHarmonics& b) { return add(a, b); },
          py::is_operator())
      .def(
          "__sub__",
          [](const SphericalHarmonics& a, const SphericalHarmonics& b) { return add(a, scale(b, dvec3(-1.0))); },
          py::is_operator())
      .def("__radd__", &added_to)
      .def("__mul__", &scaled, py::is_operator())
      .def("__rmul__", &scaled, py::is_operator())
      .def("__truediv__", &divided, py::is_operator())
      .def("__neg__", [](const SphericalHarmonics& self) { return scale(self, dvec3(-1.0)); })
      .def("__eq__", &are_equal, py::is_operator())
      .def("__len__", [](const SphericalHarmonics& self) { return self.coefficients().size(); })
      .def("__getitem__",
           [](const py::object& self, const py::object& index) { return py::object(coefficients_of(self)[index]); })
      .def("__iter__", [](const py::object& self) { return py::iter(coefficients_of(self)); })
      .def("__copy__", [](const SphericalHarmonics& self) { return SphericalHarmonics(self); })
      .def("__deepcopy__", [](const SphericalHarmonics& self, const py::object&) { return SphericalHarmonics(self); })
      .def("__reduce__",
           [](const py::object& self) {
             return py::make_tuple(py::type::of(self), py::make_tuple(coefficients_of(self).attr("copy")()));
           })
      .def("__repr__", [](const SphericalHarmonics& self) {
        return "<welkin.SphericalHarmonics: " + std::to_string(self.bands()) + " bands, mean " +
               text(mean_radiance(self)) + ">";
      });
  module.def("cosine_lobe", &cosine_lobe, py::arg("l"),
             "cosine_lobe(l)\n"
             "--\n\n"
             "Returns the cosine lobe's factor for band l: pi, 2 pi/3, pi/4, 0, -pi/24, ...");
  module.def(
      "basis",
      [](const py::object& directions, int bands) {
        const Directions asked = directions_of(directions, "directions");
        std::vector<py::ssize_t> shape = asked.shape;
        const std::size_t count = static_cast<std::size_t>(std::clamp(bands, 1, kMaximumBands)) *
                                  static_cast<std::size_t>(std::clamp(bands, 1, kMaximumBands));
        shape.back() = static_cast<py::ssize_t>(count);
        py::array_t<double> values(shape);
        double* const out = values.mutable_data();
        {
          const LockReleased released(asked.count());
          for (std::size_t index = 0; index < asked.count(); ++index) {
            evaluate_basis(asked.at(index), bands, {out + index * count, count});
          }
        }
        return values;
      },
      py::arg("directions"), py::arg("bands") = 3,
      "basis(directions, bands=3)\n"
      "--\n\n"
      "Returns Y(l, m) at directions (..., 3) of any length above 0: (..., bands^2).");
}

}  // namespace welkin::python
