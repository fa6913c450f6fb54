// The forms in which engines want diffuse light.
#include "welkin/engines.h"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "harmonics.h"
#include "options.h"

namespace welkin::python {
namespace {

/// Returns the engine of a name, whatever its case.
Engine engine_of(const std::string& name) {
  const auto lowered = py::str(name).attr("lower")().cast<std::string>();
  std::vector<const char*> names;
  for (const Convention& each : conventions()) {
    if (lowered == each.name) return each.engine;
    names.push_back(each.name);
  }
  throw_unknown_name("engine", name, names);
}

EngineLight light_of(const py::object& radiance, const std::string& engine, bool in_place) {
  const SphericalHarmonics harmonics = harmonics_of(radiance);
  const Engine whose = engine_of(engine);
  return in_place ? engine_light_unrotated(harmonics, whose) : engine_light(harmonics, whose);
}

py::dict terms_of(const EngineLight& light) {
  py::dict terms;
  for (const EngineTerm& term : light.terms) terms[py::str(term.name)] = array_of(term.rgb);
  return terms;
}

py::dict vectors_of(const EngineLight& light) {
  py::dict vectors;
  for (const EngineVector& vector : light.vectors) {
    vectors[py::str(vector.name)] = py::array_t<double>(4, &vector.value.x);
  }
  return vectors;
}

void bind_conventions(py::module_& module) {
  py::class_<Convention>(module, "Convention", "Where things lie in one engine.")
      .def_property_readonly(
          "name", [](const Convention& self) { return self.name; }, "\"babylon\", \"three\", ...")
      .def_property_readonly(
          "title", [](const Convention& self) { return self.title; }, "\"Babylon.js\", ...")
      .def_readonly("right_handed", &Convention::right_handed, "Whether its axes are.")
      .def_property_readonly(
          "axes", [](const Convention& self) { return self.axes; }, "In words.")
      .def_property_readonly(
          "lat_long", [](const Convention& self) { return self.lat_long; }, "In words.")
      .def_property_readonly(
          "source", [](const Convention& self) { return self.source; }, "Where that can be checked.")
      .def_property_readonly(
          "from_welkin", [](const Convention& self) { return array_of(self.from_welkin); },
          "(3, 3): takes a direction in Welkin's axes to the engine's.")
      .def_property_readonly(
          "faces_from_engine",
          [](const Convention& self) -> py::object {
            if (!self.faces_from_engine) return py::none();
            return array_of(*self.faces_from_engine);
          },
          "(3, 3): matrix from directions in the engine's axes to the axes of its cube faces, or None.")
      .def("__repr__", [](const Convention& self) {
        return "<welkin.Convention: " + std::string(self.title) + ", " + self.axes + ">";
      });
  module.def(
      "conventions",
      [] {
        py::dict all;
        for (const Convention& each : conventions()) {
          all[each.name] = py::cast(&each, py::return_value_policy::reference);
        }
        return all;
      },
      "conventions()\n"
      "--\n\n"
      "Returns the known engines: a dictionary from name to `Convention`.");
}

}  // namespace

void bind_engines(py::module_& module) {
  bind_conventions(module);
  py::class_<EngineLight>(module, "EngineLight", "Diffuse light in an engine's own form.")
      .def_property_readonly(
          "engine", [](const EngineLight& self) { return convention(self.engine).name; }, "Its name.")
      .def_readonly("form", &EngineLight::form, "The engine's type: \"SphericalPolynomial\", ...")
      .def_readonly("formula", &EngineLight::formula, "What the numbers are and how the shader evaluates them.")
      .def_property_readonly("terms", &terms_of, "Triples (3,) by the engine's names, in its order.")
      .def_property_readonly("vectors", &vectors_of,
                             "Vectors (4,) by the shader's names; for Unity and Unreal\n"
                             "only.")
      .def("__repr__", [](const EngineLight& self) {
        return "<welkin.EngineLight: " + std::string(convention(self.engine).title) + ", " + self.form + ", " +
               std::to_string(self.terms.size()) + " terms>";
      });
  module.def("engine_light", &light_of, py::arg("radiance"), py::arg("engine"), py::arg("in_place") = false,
             "engine_light(radiance, engine, in_place=False)\n"
             "--\n\n"
             "Converts radiance coefficients to the form of \"babylon\", \"three\", \"filament\", \"gltf\", \"unity\", "
             "\"unreal\",\n"
             "\"godot\" or \"welkin\", rotated to the engine's axes unless `in_place`.");
}

}  // namespace welkin::python
