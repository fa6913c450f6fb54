// Grids of light probes.
#include "welkin/probes.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "files.h"
#include "many.h"
#include "results.h"
#include "source.h"
#include "welkin/bake_file.h"

namespace welkin::python {
namespace {

constexpr Named<ProbeLayout> kProbeLayouts[] = {
    {"three", ProbeLayout::three}, {"unity-l2", ProbeLayout::unity_l2}, {"unity-l1", ProbeLayout::unity_l1},
    {"plain", ProbeLayout::plain}, {"bevy", ProbeLayout::bevy},         {"rtxgi", ProbeLayout::rtxgi}};
constexpr Named<ShaderLanguage> kLanguages[] = {{"glsl", ShaderLanguage::glsl},
                                                {"hlsl", ShaderLanguage::hlsl},
                                                {"wgsl", ShaderLanguage::wgsl},
                                                {"cpp", ShaderLanguage::cpp}};

/// Without counts, a grid of none.
ProbeGrid grid_from(Options& options) {
  ProbeGrid grid{.counts = {0, 0, 0}};
  options.read("counts", grid.counts);
  if (const py::handle origin = options.take("origin")) grid.origin = vector_of(origin, "origin");
  if (const py::handle spacing = options.take("spacing")) grid.spacing = vector_of(spacing, "spacing");
  return grid;
}

/// After the options are known to be right.
void require_counts(const char* function, const ProbeGrid& grid) {
  if (grid.counts == std::array{0, 0, 0}) {
    throw py::type_error(std::string(function) + "() needs counts: the number of probes along x, y and z");
  }
}

/// Rows of three numbers. Throws `Error` (invalid_argument) that calls them `what`.
std::vector<dvec3> triples_of(const py::handle& value, const char* what) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!numbers || numbers.ndim() != 2 || numbers.shape(1) != 3) {
    PyErr_Clear();
    throw Error(ErrorCode::invalid_argument, std::string(what) + ": takes an array (n, 3)");
  }
  std::vector<dvec3> triples(static_cast<std::size_t>(numbers.shape(0)));
  if (!triples.empty()) std::memcpy(&triples[0].x, numbers.data(), triples.size() * sizeof(dvec3));
  return triples;
}

using DepthArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// An array (n, 6, size, size), which must outlive the views.
std::vector<DepthView> depths_in(const DepthArray& depths) {
  if (!depths || depths.ndim() != 4 || depths.shape(1) != 6 || depths.shape(2) != depths.shape(3)) {
    PyErr_Clear();
    throw Error(ErrorCode::invalid_argument, "depths: takes an array (n, 6, size, size)");
  }
  const auto size = static_cast<int>(std::min<py::ssize_t>(depths.shape(2), 1 << 20));
  std::vector<DepthView> views(static_cast<std::size_t>(depths.shape(0)), DepthView{{}, size, 0});
  const float* face = depths.data();
  for (DepthView& view : views) {
    for (const float*& first : view.faces) {
      first = face;
      face += depths.shape(2) * depths.shape(3);
    }
  }
  return views;
}

BakedProbes bake_grid(const py::object& pixels, const py::object& depths, const py::kwargs& given) {
  Options options("bake_probes", given);
  const ProbeGrid grid = grid_from(options);
  const py::handle offsets = options.take("offsets");
  const Probes cubes = probes_of(pixels, options);
  ProbeOptions how;
  how.projection = projection_options(options);
  options.read("near_share", how.near_share);
  options.read("valid_share", how.valid_share);
  options.read("distance_size", how.distance_size);
  options.read("distance_power", how.distance_power);
  options.read("distance_limit", how.distance_limit);
  options.read("dilation_passes", how.dilation_passes);
  options.read("environment_bands", how.environment_bands);
  Call call("bake_probes", options);
  options.finish();
  require_counts("bake_probes", grid);
  std::vector<dvec3> moved;
  if (offsets && !offsets.is_none()) moved = triples_of(offsets, "offsets");
  if (!moved.empty() && moved.size() != grid.size()) {
    throw Error(ErrorCode::invalid_argument, options.called("offsets") + " has " + counted(moved.size(), "value") +
                                                 "; the grid has " + counted(grid.size(), "probe"));
  }
  const DepthArray distances = depths.is_none() ? DepthArray() : DepthArray::ensure(depths);
  const std::vector<DepthView> views = depths.is_none() ? std::vector<DepthView>{} : depths_in(distances);
  BakedProbes made =
      call.run([&](const Control& control) { return bake_probes(grid, cubes.views, views, how, control); });
  made.offsets = std::move(moved);
  return made;
}

py::array relocate_grid(const py::object& depths, const py::kwargs& given) {
  Options options("relocate_probes", given);
  const ProbeGrid grid = grid_from(options);
  const py::handle before = options.take("offsets");
  const std::vector<dvec3> offsets = before && !before.is_none() ? triples_of(before, "offsets") : std::vector<dvec3>{};
  RelocationOptions how;
  options.read("back_share", how.back_share);
  options.read("clearance", how.clearance);
  options.read("farthest", how.farthest);
  Call call("relocate_probes", options);
  options.finish();
  require_counts("relocate_probes", grid);
  const DepthArray distances = DepthArray::ensure(depths);
  const std::vector<DepthView> views = depths_in(distances);
  return array_of(
      call.run([&](const Control& control) { return relocate_probes(grid, views, how, offsets, control); }));
}

py::array grid_irradiance(const BakedProbes& self, const py::object& positions, const py::object& normals,
                          const py::kwargs& given) {
  Options options("irradiance", given);
  ProbeSampling how;
  options.read("visibility", how.visibility);
  options.read("facing", how.facing);
  options.read("validity", how.validity);
  options.read("normal_bias", how.normal_bias);
  options.finish();
  const std::vector<dvec3> points = triples_of(positions, "positions");
  const std::vector<dvec3> facing = triples_of(normals, "normals");
  if (points.size() != facing.size()) {
    throw Error(ErrorCode::invalid_argument, "irradiance: there are " + std::to_string(points.size()) +
                                                 " positions and " + std::to_string(facing.size()) + " normals");
  }
  std::vector<dvec3> light(points.size());
  const LockReleased released(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) light[k] = probe_irradiance(self, points[k], facing[k], how);
  return array_of(light);
}

py::dict pack_grid(const BakedProbes& self, const std::string& layout) {
  py::dict made;
  for (const ProbeTexture& texture :
       pack_probes(self, value_of<ProbeLayout>("layout", layout, std::span(kProbeLayouts))).textures) {
    const auto [x, y, z] = texture.size;
    made[py::str(texture.name)] =
        py::array(py::dtype("float16"), std::vector<py::ssize_t>{z, y, x, 4}, texture.halves.data());
  }
  return made;
}

void write_grid(const BakedProbes& self, const std::filesystem::path& path, const std::vector<std::string>& layouts) {
  std::vector<ProbeLayout> wanted;
  wanted.reserve(layouts.size());
  for (const std::string& layout : layouts) {
    wanted.push_back(value_of<ProbeLayout>("layouts", layout, std::span(kProbeLayouts)));
  }
  const py::gil_scoped_release released;
  write_probes(path, self, wanted);
}

/// An array of a grid's, on its memory, with `shape` behind the number of probes.
template <class Value>
py::array view_of_grid(const py::object& self, const std::vector<Value>& values, std::vector<py::ssize_t> shape) {
  shape.insert(shape.begin(), static_cast<py::ssize_t>(self.cast<const BakedProbes&>().grid.size()));
  return shown(std::move(shape), values.data(), self, false);
}

const BakedProbes& grid_in(const py::object& self) { return self.cast<const BakedProbes&>(); }

void bind_arrays(py::class_<BakedProbes>& type) {
  type.def_property_readonly(
          "coefficients",
          [](const py::object& self) {
            const BakedProbes& grid = grid_in(self);
            const auto count = static_cast<py::ssize_t>(grid.grid.size());
            return shown<double>({count, py::ssize_t{grid.bands} * grid.bands, 3}, &grid.coefficients[0].x, self,
                                 false);
          },
          "(n, bands^2, 3) float64: radiance, in the order of `SphericalHarmonics`.")
      .def_property_readonly(
          "validity", [](const py::object& self) { return view_of_grid(self, grid_in(self).validity, {}); },
          "(n,) float32: fraction of the sphere that is neither near nor a back.")
      .def_property_readonly(
          "passes", [](const py::object& self) { return view_of_grid(self, grid_in(self).passes, {}); },
          "(n,) uint8: 0 valid, 1 to 254 filled by that pass, 255 neither.")
      .def_property_readonly(
          "distances",
          [](const py::object& self) {
            const py::ssize_t edge = grid_in(self).distance_edge();
            return view_of_grid(self, grid_in(self).distances, {edge, edge, 2});
          },
          "(n, size + 2, size + 2, 2) float32: mean distance and mean squared distance, octahedral maps.")
      .def_property_readonly(
          "sky",
          [](const py::object& self) {
            const py::ssize_t bands = grid_in(self).sky_bands;
            return view_of_grid(self, grid_in(self).sky, {bands * bands});
          },
          "(n, sky_bands^2) float64: visibility of the environment.")
      .def_property(
          "offsets",
          [](const BakedProbes& self) -> py::object {
            return self.offsets.empty() ? py::object(py::none()) : py::object(array_of(self.offsets));
          },
          [](BakedProbes& self, const py::object& offsets) {
            self.offsets = offsets.is_none() ? std::vector<dvec3>{} : triples_of(offsets, "offsets");
          },
          "(n, 3) float64: position of the capture minus that of the grid, or None.");
}

void bind_grid(py::module_& module) {
  py::class_<BakedProbes> type(module, "ProbeGrid", "A baked grid of light probes.");
  type.def_property_readonly(
          "counts",
          [](const BakedProbes& self) {
            return py::make_tuple(self.grid.counts[0], self.grid.counts[1], self.grid.counts[2]);
          },
          "Probes along x, y and z.")
      .def_property_readonly(
          "origin", [](const BakedProbes& self) { return array_of(self.grid.origin); }, "Position of probe 0.")
      .def_property_readonly(
          "spacing", [](const BakedProbes& self) { return array_of(self.grid.spacing); }, "Distance between probes.")
      .def_property_readonly(
          "positions",
          [](const BakedProbes& self) {
            std::vector<dvec3> positions;
            for (std::size_t k = 0; k < self.grid.size(); ++k) positions.push_back(self.grid.position(k));
            return array_of(positions);
          },
          "(n, 3) float64, x first, then y, then z.")
      .def("irradiance", &grid_irradiance, py::arg("positions"), py::arg("normals"),
           "irradiance(self, positions, normals, *, visibility=True, facing=True, validity=True, normal_bias=0.2)\n"
           "--\n\n"
           "Returns irradiance on surfaces at positions (m, 3) that face along normals (m, 3): (m, 3) float64.")
      .def(
          "relight",
          [](BakedProbes& self, const SphericalHarmonics& before, const SphericalHarmonics& after, int passes) {
            const py::gil_scoped_release released;
            relight(self, before, after, passes);
          },
          py::arg("before"), py::arg("after"), py::arg("dilation_passes") = 4,
          "relight(self, before, after, dilation_passes=4)\n"
          "--\n\n"
          "Changes the probes to another environment. Requires `environment_bands` of the bake.")
      .def("pack", &pack_grid, py::arg("layout"),
           "pack(self, layout)\n"
           "--\n\n"
           "Returns the textures of a layout by name, (z, y, x, 4) float16: \"three\", \"unity-l2\", \"unity-l1\",\n"
           "\"plain\", \"bevy\" or \"rtxgi\".")
      .def("write", &write_grid, py::arg("path"), py::arg("layouts") = std::vector<std::string>{},
           "write(self, path, layouts=[])\n"
           "--\n\n"
           "Writes a description, PATH.json, its arrays and KTX2 textures of layouts. `read_probes` reads it.")
      .def("__len__", [](const BakedProbes& self) { return self.grid.size(); })
      .def("__repr__", [](const BakedProbes& self) {
        const auto& counts = self.grid.counts;
        return "<welkin.ProbeGrid: " + std::to_string(counts[0]) + " x " + std::to_string(counts[1]) + " x " +
               std::to_string(counts[2]) + ", " + counted(static_cast<std::size_t>(self.bands), "band") + ">";
      });
  bind_arrays(type);
}

}  // namespace

void bind_probes(py::module_& module) {
  bind_grid(module);
  module.def(
      "bake_probes", &bake_grid, py::arg("cubemaps"), py::arg("depths") = py::none(),
      "bake_probes(cubemaps, depths=None, *, counts, origin=(0.0, 0.0, 0.0), spacing=(1.0, 1.0, 1.0), offsets=None,\n"
      "            bands=3, quadrature='exact', target_size=None, policy=None, near_share=0.1, valid_share=0.75,\n"
      "            distance_size=8, distance_power=50, distance_limit=0.0, dilation_passes=4,\n"
      "            environment_bands=0, layout=None, encoding=None, read=None, progress=None, threads=None)\n"
      "--\n\n"
      "Bakes a grid of light probes from one cubemap per probe, x first, then y, then z. Returns `ProbeGrid`.\n"
      "`depths`: (n, 6, size, size), distances along each texel's direction; negative for the back of a surface,\n"
      "infinite for the environment. `offsets`: those of the captures.");
  module.def("relocate_probes", &relocate_grid, py::arg("depths"),
             "relocate_probes(depths, *, counts, origin=(0.0, 0.0, 0.0), spacing=(1.0, 1.0, 1.0), offsets=None,\n"
             "                back_share=0.25, clearance=0.12, farthest=0.45, progress=None, threads=None)\n"
             "--\n\n"
             "Returns the offsets (n, 3) at which probes should be captured, so that none lies in a wall. `offsets`:\n"
             "those at which `depths` were captured.");
  module.def(
      "read_probes",
      [](const std::filesystem::path& path) {
        const py::gil_scoped_release released;
        return read_probes(path);
      },
      py::arg("path"),
      "read_probes(path)\n"
      "--\n\n"
      "Reads a `ProbeGrid` that `ProbeGrid.write` wrote.");
  module.def(
      "probe_sampling_code",
      [](const std::string& language) {
        return probe_sampling_code(value_of<ShaderLanguage>("language", language, std::span(kLanguages)));
      },
      py::arg("language"),
      "probe_sampling_code(language)\n"
      "--\n\n"
      "Returns the code of `ProbeGrid.irradiance` for a shader: \"glsl\", \"hlsl\", \"wgsl\" or \"cpp\".");
}

}  // namespace welkin::python
