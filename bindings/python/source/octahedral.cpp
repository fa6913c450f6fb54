#include "octahedral.h"

#include <pybind11/stl.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "results.h"

namespace welkin::python {

OctahedralOptions octahedral_options(Options& options) {
  OctahedralOptions how;
  options.read("size", how.size);
  options.read("levels", how.levels);
  options.read("border", how.border);
  return how;
}

SharedOctahedral shared(OctahedralMap map) { return {std::make_shared<const OctahedralMap>(std::move(map))}; }

namespace {

SharedOctahedral map_of(const py::object& light, const py::kwargs& given) {
  Options options("to_octahedral", given);
  const OctahedralOptions how = octahedral_options(options);
  Call call("to_octahedral", options);
  options.finish();
  const bool is_chain = py::isinstance<Chain>(light);
  if (!is_chain && !py::isinstance<SphericalHarmonics>(light)) {
    throw py::type_error("to_octahedral: takes a Chain or SphericalHarmonics, found " +
                         py::str(py::type::handle_of(light).attr("__name__")).cast<std::string>());
  }
  const SharedChain chain = is_chain ? light.cast<const Chain&>().cubemap : nullptr;
  const SphericalHarmonics* const harmonics = is_chain ? nullptr : &light.cast<const SphericalHarmonics&>();
  return shared(call.run([&](const Control& control) {
    return chain ? to_octahedral(*chain, how, control) : to_octahedral(*harmonics, how, control);
  }));
}

py::list levels_of(const SharedOctahedral& self) {
  py::list levels;
  for (std::size_t level = 0; level < self.map->levels.size(); ++level) {
    const py::ssize_t size = self.map->level_size(static_cast<int>(level));
    levels.append(shown<float>({size, size, 3}, self.map->levels[level].data(), keeper(self.map), false));
  }
  return levels;
}

py::array places_of(const py::object& directions) {
  const Directions asked = directions_of(directions, "directions");
  std::vector<py::ssize_t> shape = asked.shape;
  shape.back() = 2;
  py::array_t<double> places(shape);
  double* out = places.mutable_data();
  for (std::size_t index = 0; index < asked.count(); ++index) {
    for (const double place : octahedral_encode(asked.at(index))) *out++ = place;
  }
  return places;
}

py::array directions_at(const py::array_t<double, py::array::c_style | py::array::forcecast>& places) {
  std::vector<py::ssize_t> shape(places.shape(), places.shape() + places.ndim());
  if (shape.empty() || shape.back() != 2) {
    throw Error(ErrorCode::invalid_argument, "places: takes numbers of shape (..., 2), found shape " +
                                                 py::str(places.attr("shape")).cast<std::string>());
  }
  shape.back() = 3;
  py::array_t<double> directions(shape);
  double* const out = directions.mutable_data();
  const double* const in = places.data();
  for (std::size_t index = 0; index < static_cast<std::size_t>(places.size()) / 2; ++index) {
    const dvec3 direction = octahedral_decode(in[2 * index], in[2 * index + 1]);
    std::copy_n(&direction.x, 3, out + 3 * index);
  }
  return directions;
}

}  // namespace

void bind_octahedral(py::module_& module) {
  py::class_<SharedOctahedral>(module, "OctahedralMap",
                               "The sphere on a square with borders: +z at the centre, +x to the right, +y down.")
      .def_property_readonly("levels", &levels_of,
                             "Arrays (n, n, 3) float32, read-only, without copies, largest first.")
      .def_property_readonly(
          "size", [](const SharedOctahedral& self) { return self.map->size; },
          "Texels along an edge of level 0, borders included.")
      .def_property_readonly(
          "border", [](const SharedOctahedral& self) { return self.map->border; },
          "Texels on each side of level 0. A shader looks a direction up at place (1 - 2 b) + b, with b = border\n"
          "/ size.")
      .def("__len__", [](const SharedOctahedral& self) { return self.map->levels.size(); })
      .def("__repr__", [](const SharedOctahedral& self) {
        return "<welkin.OctahedralMap: " + std::to_string(self.map->size) + " x " + std::to_string(self.map->size) +
               ", border " + std::to_string(self.map->border) + ", " + counted(self.map->levels.size(), "level") + ">";
      });
  module.def(
      "to_octahedral", &map_of, py::arg("light"),
      "to_octahedral(light, *, size=256, levels=1, border=0, progress=None, threads=None)\n"
      "--\n\n"
      "Converts a `Chain`, level by level, or `SphericalHarmonics` to an `OctahedralMap`, which Godot's shaders\n"
      "read and `write_texture` writes. `border`: texels of level 0 that repeat the sphere beyond the edge; 0:\n"
      "one texel of the last level. Size and border must be multiples of 2^(levels - 1).");
  module.def("octahedral_encode", &places_of, py::arg("directions"),
             "octahedral_encode(directions)\n"
             "--\n\n"
             "Encodes directions (..., 3) as positions on the square from (0, 0) to (1, 1), column first: (...,\n"
             "2).");
  module.def("octahedral_decode", &directions_at, py::arg("places"),
             "octahedral_decode(places)\n"
             "--\n\n"
             "Decodes positions (..., 2) to unit directions (..., 3).");
}

}  // namespace welkin::python
