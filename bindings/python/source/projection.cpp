// Pixels to coefficients, and irradiance.
#include "welkin/projection.h"

#include <pybind11/stl.h>

#include <cstdio>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "files.h"
#include "harmonics.h"
#include "results.h"
#include "source.h"

namespace welkin::python {
namespace {

constexpr Named<Quadrature> kQuadratures[] = {{"exact", Quadrature::exact}, {"midpoint", Quadrature::midpoint}};
constexpr Named<NonFinitePolicy> kNonFinite[] = {{"replace", NonFinitePolicy::replace},
                                                 {"reject", NonFinitePolicy::reject}};
constexpr Named<NegativePolicy> kNegative[] = {
    {"keep", NegativePolicy::keep}, {"replace", NegativePolicy::replace}, {"reject", NegativePolicy::reject}};

PixelPolicy policy_of(const py::kwargs& given) {
  Options options("PixelPolicy", given);
  PixelPolicy policy;
  RadianceClamp clamp;
  const bool clamps = static_cast<bool>(options.take("clamp"));
  options.read("clamp", clamp.maximum);
  options.read("preserve_colour", clamp.preserve_colour);
  if (clamps) policy.clamp = clamp;
  options.read("gamma", policy.gamma);
  options.read("nan", policy.nan, kNonFinite);
  options.read("infinity", policy.infinity, kNonFinite);
  options.read("negative", policy.negative, kNegative);
  options.finish();
  return policy;
}

std::string words(const PixelPolicy& policy) {
  std::string text = "welkin.PixelPolicy(";
  if (policy.clamp) {
    text += "clamp=" + py::repr(py::float_(policy.clamp->maximum)).cast<std::string>();
    text += policy.clamp->preserve_colour ? ", preserve_colour=True, " : ", ";
  }
  if (policy.gamma) text += "gamma=True, ";
  return text + "nan='" + name_of<NonFinitePolicy>(policy.nan, kNonFinite) + "', infinity='" +
         name_of<NonFinitePolicy>(policy.infinity, kNonFinite) + "', negative='" +
         name_of<NegativePolicy>(policy.negative, kNegative) + "')";
}

/// The levels of a cubemap that brings its mips, of which a target size picks one: a `Chain` (of reflections the first
/// level alone is the environment), or a list of arrays of four dimensions. Empty of all else.
std::vector<Source> levels_of(const py::object& pixels, Options& options) {
  std::vector<Source> levels;
  py::object list;
  if (py::isinstance<Chain>(pixels) && !py::isinstance<Reflections>(pixels)) {
    list = pixels.attr("levels");
  } else if (py::isinstance<py::list>(pixels) && py::len(pixels) > 0 &&
             py::isinstance<py::array>(pixels[py::int_(0)]) &&
             py::reinterpret_borrow<py::array>(pixels[py::int_(0)]).ndim() == 4) {
    list = pixels;
  } else {
    return levels;
  }
  for (const py::handle level : list) {
    levels.push_back(source_of(py::reinterpret_borrow<py::object>(level), options));
    if (!levels.back().is_cubemap()) throw Error(ErrorCode::invalid_argument, "project: a level is not a cubemap");
  }
  return levels;
}

Projection project_source(const py::object& pixels, const py::kwargs& given) {
  Options options("project", given);
  if (is_file(pixels)) {
    const FileInput input = input_of(pixels);
    const ReadOptions read = read_group(options);
    const ProjectionOptions how = projection_options(options);
    Call call("project", options);
    options.finish();
    return call.run([&](const Control& control) { return project_file(input, read, how, control); });
  }
  if (const std::vector<Source> levels = levels_of(pixels, options); !levels.empty()) {
    const ProjectionOptions how = projection_options(options);
    Call call("project", options);
    options.finish();
    std::vector<CubemapView> views;
    views.reserve(levels.size());
    for (const Source& level : levels) views.push_back(level.view.cubemap());
    return call.run([&](const Control& control) { return project(views, how, control); });
  }
  const Source source = source_of(pixels, options);
  const ProjectionOptions how = projection_options(options);
  Call call("project", options);
  options.finish();
  return call.run([&](const Control& control) { return project(source.view, how, control); });
}

enum class Integral { harmonics, direct };
constexpr Named<Integral> kIntegrals[] = {{"harmonics", Integral::harmonics}, {"direct", Integral::direct}};

Irradiance irradiance_of(const py::object& light, const py::kwargs& given) {
  Options options("irradiance", given);
  std::optional<int> size;
  Integral integral = Integral::harmonics;
  options.read("size", size);
  options.read("method", integral, kIntegrals);
  const bool has_pixels = !py::isinstance<SphericalHarmonics>(light);
  std::optional<Source> source;
  ProjectionOptions how;
  if (has_pixels) {
    source = source_of(light, options);
    how = projection_options(options);
  }
  Call call("irradiance", options);
  options.finish();
  if (integral == Integral::direct && (!size || !source)) {
    throw Error(ErrorCode::invalid_argument,
                "irradiance(method=\"direct\") makes a cubemap of pixels: it takes them, and a size");
  }
  Cubemap cubemap;
  SphericalHarmonics harmonics = call.run([&](const Control& control) {
    SphericalHarmonics made = irradiance_from_radiance(source ? project(source->view, how, control).radiance
                                                              : light.cast<const SphericalHarmonics&>());
    if (!size) return made;
    cubemap = integral == Integral::harmonics ? irradiance_cubemap(made, *size, control)
                                              : direct_irradiance_cubemap(source->view, *size, control);
    return made;
  });
  return {std::move(harmonics), size ? py::object(array_of(std::move(cubemap))) : py::none()};
}

py::array direct_irradiance_at(const py::object& pixels, const py::object& normals, const py::kwargs& given) {
  Options options("direct_irradiance", given);
  const Source source = source_of(pixels, options);
  PixelPolicy policy;
  options.read("policy", policy);
  Call call("direct_irradiance", options);
  options.finish();
  const Directions asked = directions_of(normals, "normals");
  std::vector<dvec3> directions(asked.count());
  for (std::size_t index = 0; index < directions.size(); ++index) directions[index] = asked.at(index);
  const std::vector<dvec3> values =
      call.run([&](const Control& control) { return direct_irradiance(source.view, directions, policy, control); });
  return array_of(values).reshape(asked.shape);
}

std::string words(const ProjectionDiagnostics& of) {
  char text[200];
  std::snprintf(
      text, sizeof(text),
      "<welkin.Diagnostics: %llu texels, %llu NaN, %llu infinities and %llu negatives replaced, %llu clamped, "
      "error estimate %.2g>",
      static_cast<unsigned long long>(of.texels), static_cast<unsigned long long>(of.nans_replaced),
      static_cast<unsigned long long>(of.infinities_replaced), static_cast<unsigned long long>(of.negatives_replaced),
      static_cast<unsigned long long>(of.texels_clamped), of.error_estimate);
  return text;
}

void bind_diagnostics(py::module_& module) {
  py::class_<PassRecord>(module, "PassRecord", "One step of a call: what was done, or why it was not.")
      .def_readonly("name", &PassRecord::name, "\"read\", \"project\", \"specular\", ...")
      .def_property_readonly(
          "action", [](const PassRecord& self) { return name(self.action); }, "\"run\", \"reuse\", \"skip\"")
      .def_readonly("reason", &PassRecord::reason, "Why that action.")
      .def_readonly("milliseconds", &PassRecord::milliseconds, "Wall time; 0 of what was skipped.")
      .def("__repr__", [](const PassRecord& self) {
        char time[48];
        std::snprintf(time, sizeof(time), "%.3g ms", self.milliseconds);
        return "<welkin.PassRecord: " + self.name + ", " + name(self.action) + ", " + time + ">";
      });
  using Diagnostics = ProjectionDiagnostics;
  py::class_<Diagnostics>(module, "Diagnostics", "How good a result is, and what was done to get it.")
      .def_readonly("texels", &Diagnostics::texels, "Texels read.")
      .def_readonly("nans_replaced", &Diagnostics::nans_replaced, "Channel values.")
      .def_readonly("infinities_replaced", &Diagnostics::infinities_replaced, "Channel values.")
      .def_readonly("negatives_replaced", &Diagnostics::negatives_replaced, "Channel values.")
      .def_readonly("texels_clamped", &Diagnostics::texels_clamped, "Texels that the clamp changed.")
      .def_property_readonly(
          "total_radiance", [](const Diagnostics& self) { return array_of(self.total_radiance); },
          "Integral over the sphere: (3,).")
      .def_property_readonly(
          "total_radiance_before_clamp",
          [](const Diagnostics& self) { return array_of(self.total_radiance_before_clamp); },
          "The same before the clamp: (3,).")
      .def_readonly("error_estimate", &Diagnostics::error_estimate, "Relative, of the radiance coefficients.")
      .def_readonly("passes", &Diagnostics::passes, "A `PassRecord` for each step.")
      .def("__repr__", [](const Diagnostics& self) { return words(self); });
}

}  // namespace

ProjectionOptions projection_options(Options& options) {
  ProjectionOptions how;
  options.read("bands", how.bands);
  options.read("quadrature", how.quadrature, kQuadratures);
  options.read("target_size", how.target_size);
  options.read("policy", how.pixels);
  return how;
}

void bind_projection(py::module_& module) {
  py::class_<PixelPolicy>(
      module, "PixelPolicy",
      "PixelPolicy(*, clamp=None, preserve_colour=False, gamma=False, nan='replace', infinity='replace', "
      "negative='keep')\n"
      "--\n\n"
      "Treatment of pixel values before they are used as radiance. `clamp`: an upper bound, for each channel or,\n"
      "with `preserve_colour`, for all three by one factor. `gamma`: clamps values to [0, 1] and raises them to\n"
      "the power of 2.2. NaN becomes 0 and an infinity becomes the clamp's maximum or 65504; with \"reject\" they\n"
      "raise `RejectedPixel`.")
      .def(py::init(&policy_of))
      .def(
          "__eq__", [](const PixelPolicy& a, const PixelPolicy& b) { return a == b; }, py::is_operator())
      .def("__repr__", [](const PixelPolicy& self) { return words(self); });
  bind_diagnostics(module);
  py::class_<Projection>(module, "Projection",
                         "Coefficients of an environment's radiance, with counts and an\n"
                         "error estimate.")
      .def_readonly("radiance", &Projection::radiance, "`SphericalHarmonics` of radiance, W/m2/sr.")
      .def_property_readonly(
          "irradiance", [](const Projection& self) { return irradiance_from_radiance(self.radiance); },
          "`SphericalHarmonics` of irradiance, W/m2.")
      .def_readonly("diagnostics", &Projection::diagnostics, "Counts, total radiance, error estimate, times.")
      .def("__repr__", [](const Projection& self) {
        return "<welkin.Projection: " + counted(static_cast<std::size_t>(self.radiance.bands()), "band") + " of " +
               counted(self.diagnostics.texels, "texel") + ">";
      });
  py::class_<Irradiance>(module, "Irradiance",
                         "Irradiance as coefficients and, if a size was requested, as a\n"
                         "cubemap.")
      .def_readonly("harmonics", &Irradiance::harmonics, "`SphericalHarmonics`, W/m2; call it with normals.")
      .def_readonly("cubemap", &Irradiance::cubemap, "(6, size, size, 3) float32, W/m2; None without a size.")
      .def_readonly("pixels", &Irradiance::cubemap, "The cubemap, as other calls take it.")
      .def("__repr__", [](const Irradiance& self) {
        return "<welkin.Irradiance: " + counted(static_cast<std::size_t>(self.harmonics.bands()), "band") +
               (self.cubemap.is_none() ? "" : " and a cubemap") + ">";
      });
  module.def(
      "project", &project_source, py::arg("pixels"),
      "project(pixels, *, bands=3, quadrature='exact', target_size=None, policy=None, layout=None, encoding=None,\n"
      "        read=None, progress=None, threads=None)\n"
      "--\n\n"
      "Projects an environment to spherical harmonics. Returns a `Projection`. Pixels are read in place; a file\n"
      "(its path or bytes; `read`: options of `read`) is streamed. 0.3 ns per texel on one thread, relative error\n"
      "below 5e-7. `bands`: 1 to 16. `target_size`: texels per edge of the cubemap to which pixels are reduced\n"
      "first; from a cubemap with its mips (a `Chain` of `build_mips`, or a list of arrays (6, n, n, channels))\n"
      "the nearest level is read.");
  module.def("irradiance", &irradiance_of, py::arg("light"),
             "irradiance(light, *, size=None, method='harmonics', bands=3, quadrature='exact', target_size=None,\n"
             "           policy=None, layout=None, encoding=None, read=None, progress=None, threads=None)\n"
             "--\n\n"
             "Computes irradiance by normal from pixels or from `SphericalHarmonics` of radiance. Returns an\n"
             "`Irradiance`. `size`: texels per edge of a cubemap, 1 to 4096. `method=\"direct\"` computes it by\n"
             "direct integration of the pixels, the slow reference.");
  module.def("direct_irradiance", &direct_irradiance_at, py::arg("pixels"), py::arg("normals"),
             "direct_irradiance(pixels, normals, *, policy=None, layout=None, encoding=None, read=None, progress=None, "
             "threads=None)\n"
             "--\n\n"
             "Computes irradiance by direct integration over all texels, the reference, for normals (..., 3):\n"
             "(..., 3). 5 ns per texel and normal on one thread.");
}

}  // namespace welkin::python
