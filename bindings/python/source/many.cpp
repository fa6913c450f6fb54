// Many cubemaps at once: the probes of a level.
#include "many.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "files.h"
#include "results.h"
#include "source.h"
#include "welkin/bake.h"

namespace welkin::python {

Probes probes_of(const py::object& pixels, Options& options) {
  if (is_file(pixels) || (!py::isinstance<py::sequence>(pixels) && !py::isinstance<py::array>(pixels))) {
    throw py::type_error(options.called("probes") +
                         " takes an array (n, 6, size, size, channels) or a list of cubemaps");
  }
  Probes made;
  for (const py::handle item : pixels) {
    made.sources.push_back(source_of(py::reinterpret_borrow<py::object>(item), options));
    if (!made.sources.back().is_cubemap()) {
      throw Error(ErrorCode::invalid_argument, std::string(options.function()) + ": probe " +
                                                   std::to_string(made.views.size()) + " is a lat-long, not a cubemap");
    }
    made.views.push_back(made.sources.back().view.cubemap());
  }
  if (made.sources.empty()) {  // nobody looked
    static_cast<void>(options.take("layout"));
    static_cast<void>(options.take("encoding"));
    static_cast<void>(options.take("read"));
  }
  return made;
}

namespace {

constexpr Named<TexelFormat> kTypes[] = {{"float16", TexelFormat::rgba16f}, {"float32", TexelFormat::rgba32f}};

/// Results of a call about many cubemaps.
struct ManyLights {
  py::object coefficients = py::none();
  py::list specular;
  ProjectionDiagnostics diagnostics;
  std::uint64_t peak_bytes = 0;
  std::uint64_t values_clamped = 0;
  std::size_t count = 0;
};

/// An array (count, bands^2, 3), and its numbers as the library writes them.
std::span<dvec3> room_for(std::size_t count, int bands, py::object& array) {
  if (bands < 0 || bands > kMaximumBands) {
    throw Error(ErrorCode::invalid_argument, "bands=" + std::to_string(bands) + " is not from 0 to 16");
  }
  const std::size_t each = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  py::array_t<double> made({static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(each), py::ssize_t{3}});
  static_assert(sizeof(dvec3) == 3 * sizeof(double));
  const std::span<dvec3> numbers(reinterpret_cast<dvec3*>(made.mutable_data()), count * each);
  array = std::move(made);
  return numbers;
}

ManyLights project_all(const py::object& pixels, const py::kwargs& given) {
  Options options("project_many", given);
  const Probes probes = probes_of(pixels, options);
  const ProjectionOptions how = projection_options(options);
  Call call("project_many", options);
  options.finish();
  ManyLights made;
  made.count = probes.views.size();
  const std::span<dvec3> numbers = room_for(made.count, how.bands, made.coefficients);
  made.diagnostics =
      call.run([&](const Control& control) { return project_many(probes.views, numbers, how, control); });
  return made;
}

/// Arrays (count, 6, n, n, 4), one a mip, and the targets in them: all mips of the first probe, then of the second.
std::vector<CubemapTarget> targets_in(py::list& arrays, std::size_t count, int size, int mips, TexelFormat format) {
  const auto levels = static_cast<std::size_t>(mips);
  std::vector<CubemapTarget> targets(count * levels);
  for (std::size_t mip = 0; mip < levels; ++mip) {
    const int edge = std::max(1, size >> mip);
    const py::dtype type(format == TexelFormat::rgba16f ? "float16" : "float32");
    py::array array(
        type, {static_cast<py::ssize_t>(count), py::ssize_t{6}, py::ssize_t{edge}, py::ssize_t{edge}, py::ssize_t{4}});
    auto* place = static_cast<std::byte*>(array.mutable_data());
    const auto bytes = static_cast<std::size_t>(array.itemsize()) * 4U * static_cast<std::size_t>(edge) *
                       static_cast<std::size_t>(edge);
    for (std::size_t probe = 0; probe < count; ++probe) {
      CubemapTarget& target = targets[probe * levels + mip];
      target = {{}, edge, 0, format};
      for (void*& face : target.faces) {
        face = place;
        place += bytes;
      }
    }
    arrays.append(std::move(array));
  }
  return targets;
}

ManyLights bake_all(const py::object& pixels, const py::kwargs& given) {
  Options options("bake_many", given);
  const Probes probes = probes_of(pixels, options);
  const PrefilterOptions how = prefilter_options(options, true);
  int bands = 3;
  TexelFormat format = TexelFormat::rgba16f;
  options.read("bands", bands);
  options.read("type", format, kTypes);
  Call call("bake_many", options);
  options.finish();
  ManyLights made;
  made.count = probes.views.size();
  const std::vector<CubemapTarget> targets =
      targets_in(made.specular, made.count, how.size, default_mip_count(how), format);
  const std::span<dvec3> numbers = room_for(made.count, bands, made.coefficients);
  BakeResult result =
      call.run([&](const Control& control) { return bake_many(probes.views, targets, numbers, how, bands, control); });
  made.diagnostics = std::move(result.diagnostics);
  made.peak_bytes = result.peak_bytes;
  made.values_clamped = result.values_clamped;
  return made;
}

}  // namespace

void bind_many(py::module_& module) {
  py::class_<ManyLights>(module, "ManyLights", "What `project_many` and `bake_many` make of many cubemaps.")
      .def_readonly("coefficients", &ManyLights::coefficients,
                    "(n, bands^2, 3) float64: radiance, in the order of `SphericalHarmonics`.")
      .def_readonly("specular", &ManyLights::specular,
                    "Reflections of `bake_many`, one array (n, 6, size, size, 4) per mip; otherwise an empty\n"
                    "list.")
      .def_readonly("diagnostics", &ManyLights::diagnostics, "Of all probes together.")
      .def_readonly("peak_bytes", &ManyLights::peak_bytes, "Working memory of all threads.")
      .def_readonly("values_clamped", &ManyLights::values_clamped, "Channel values that float16 could not hold.")
      .def("__len__", [](const ManyLights& self) { return self.count; })
      .def("__repr__", [](const ManyLights& self) {
        return "<welkin.ManyLights: " + counted(self.count, "probe") +
               (self.specular.empty() ? "" : ", " + counted(self.specular.size(), "mip")) + ">";
      });
  module.def(
      "project_many", &project_all, py::arg("probes"),
      "project_many(probes, *, bands=3, quadrature='exact', target_size=None, policy=None, layout=None,\n"
      "             encoding=None, read=None, progress=None, threads=None)\n"
      "--\n\n"
      "Computes harmonics of many cubemaps, bit-identical to `project` of each. Returns `ManyLights`. `probes`:\n"
      "an array (n, 6, size, size, channels), or a list of cubemaps or files of any sizes and types. Cubemaps up\n"
      "to 129 texels per edge are projected concurrently, one thread each.");
  module.def(
      "bake_many", &bake_all, py::arg("probes"),
      ("bake_many(probes, *, " + kPrefilterSignature + ", policy=None, bands=3,\n" +
       "          type='float16', layout=None, encoding=None, read=None, progress=None, threads=None)\n--\n\n"
       "Computes reflections, with the options of `prefilter`, and harmonics (none with 0 bands) of many cubemaps.\n"
       "Returns `ManyLights`. `type`: that of the reflections, \"float16\" or \"float32\"; alpha is 1.")
          .c_str());
}

}  // namespace welkin::python
