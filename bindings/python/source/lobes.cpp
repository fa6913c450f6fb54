#include "lobes.h"

#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <cstdio>
#include <functional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"

namespace welkin::python {
namespace {

std::string with_number(const char* name, const char* what, double number) {
  char words[96];
  std::snprintf(words, sizeof(words), "%s, %s %.4g", name, what, number);
  return words;
}

py::array values_at(const NamedLobe& self,
                    const py::array_t<double, py::array::c_style | py::array::forcecast>& cosines) {
  py::array_t<double> values(std::vector<py::ssize_t>(cosines.shape(), cosines.shape() + cosines.ndim()));
  double* const out = values.mutable_data();
  for (py::ssize_t index = 0; index < cosines.size(); ++index) out[index] = self.lobe.value(cosines.data()[index]);
  return values;
}

}  // namespace

void bind_lobes(py::module_& module) {
  py::class_<NamedLobe>(module, "ZonalLobe",
                        "A radially symmetric lobe, by the cosine to its axis; its integral over the sphere is\n"
                        "1. `prefilter(pixels, lobes=[...])` takes one per mip.")
      .def_static(
          "charlie",
          [](double roughness) {
            return NamedLobe{ZonalLobe::charlie(roughness), with_number("charlie", "roughness", roughness)};
          },
          py::arg("roughness"),
          "charlie(roughness)\n"
          "--\n\n"
          "Returns sheen (Estevez and Kulla 2017) with N = V = R; roughness 0.01 to 1.")
      .def_static(
          "lambert",
          [] {
            return NamedLobe{ZonalLobe::lambert(), "lambert"};
          },
          "lambert()\n--\n\nThe cosine: irradiance over pi.")
      .def_static(
          "phong",
          [](double power) {
            return NamedLobe{ZonalLobe::phong(power), with_number("phong", "power", power)};
          },
          py::arg("power"), "phong(power)\n--\n\ncosine^power, power from 0.5 to 1e6.")
      .def_static(
          "blinn",
          [](double power) {
            return NamedLobe{ZonalLobe::blinn(power), with_number("blinn", "power", power)};
          },
          py::arg("power"),
          "blinn(power)\n"
          "--\n\n"
          "Returns cosine times the half vector's cosine^power; power 0 to 1e6.")
      .def_static(
          "from_function",
          [](const std::function<double(double)>& value, const std::vector<double>& breaks) {
            return NamedLobe{ZonalLobe::from_function(value, breaks), "a function of the cosine"};
          },
          py::arg("value"), py::arg("breaks") = std::vector{0.0},
          "from_function(value, breaks=[0.0])\n"
          "--\n\n"
          "Returns the lobe of any function of the cosine, from -1 to 1, that is smooth between `breaks`.\n"
          "`value` is called during this call only, hundreds to tens of thousands of times.")
      .def_static(
          "from_spectrum",
          [](const std::vector<double>& factors) {
            return NamedLobe{ZonalLobe::from_spectrum(factors),
                             "a spectrum of " + std::to_string(factors.size()) + " degrees"};
          },
          py::arg("factors"),
          "from_spectrum(factors)\n"
          "--\n\n"
          "Returns the lobe that multiplies degree l by factors[l] / factors[0]; factors[0] must be above 0.")
      .def("value", &values_at, py::arg("cosines"),
           "value(self, cosines)\n"
           "--\n\n"
           "Returns the density per steradian at cosines (...): (...).")
      .def(
          "spectrum",
          [](const NamedLobe& self, int bands) {
            std::vector<double> factors = self.lobe.spectrum(bands);
            const auto count = static_cast<py::ssize_t>(factors.size());
            return owning(std::move(factors), {count});
          },
          py::arg("bands"),
          "spectrum(self, bands)\n"
          "--\n\n"
          "Returns the factors of the degrees below `bands`: (bands,).")
      .def_property_readonly(
          "roughness", [](const NamedLobe& self) { return self.lobe.roughness(); }, "Of `charlie`; 0 of others.")
      .def("__repr__", [](const NamedLobe& self) { return "<welkin.ZonalLobe: " + self.words + ">"; });
}

}  // namespace welkin::python
