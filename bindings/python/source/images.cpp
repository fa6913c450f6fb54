// Images of another shape, and previews for people.
#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "results.h"
#include "source.h"
#include "tools/preview_light.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::python {
namespace {

constexpr Named<ResampleFilter> kFilters[] = {{"area", ResampleFilter::area}, {"bilinear", ResampleFilter::bilinear}};

dmat3 read_rotation(Options& options) {
  const py::handle given = options.take("rotation");
  return given ? rotation_from(py::reinterpret_borrow<py::object>(given), "rotation") : dmat3(1.0);
}

py::array cubemap_from(const py::object& pixels, int size, const py::kwargs& given) {
  Options options("to_cubemap", given);
  const Source source = source_of(pixels, options);
  const dmat3 rotation = read_rotation(options);
  ResampleFilter filter = ResampleFilter::area;
  options.read("filter", filter, kFilters);
  Call call("to_cubemap", options);
  options.finish();
  return array_of(
      call.run([&](const Control& control) { return to_cubemap(source.view, size, rotation, filter, control); }));
}

py::array lat_long_from(const py::object& pixels, int height, const py::kwargs& given) {
  Options options("to_lat_long", given);
  const Source source = source_of(pixels, options);
  const dmat3 rotation = read_rotation(options);
  ResampleFilter filter = ResampleFilter::area;
  options.read("filter", filter, kFilters);
  Call call("to_lat_long", options);
  options.finish();
  return array_of(call.run(
      [&](const Control& control) { return to_lat_long(source.view, 2 * height, height, rotation, filter, control); }));
}

constexpr int kExposureSize = 32;  // texels of the faces by which an exposure is chosen

/// What a preview shows: linear, in [0, 1], and the exposure that made it so.
struct Shown {
  LatLongImage image;
  double exposure;
};

Shown shown_as(const Source& source, int height, double exposure, const Control& control) {
  Shown made{to_lat_long(source.view, 2 * height, height, dmat3(1.0)), exposure};
  if (exposure <= 0.0) {
    const Cubemap small = to_cubemap(made.image.view(), kExposureSize, dmat3(1.0), ResampleFilter::area, control);
    made.exposure = exposure_of(small.view());
  }
  const tool::ToneMap curve{made.exposure};
  for (std::size_t texel = 0; texel + 2 < made.image.pixels.size(); texel += 3) {
    float* const rgb = made.image.pixels.data() + texel;
    const glm::vec3 light = curve(glm::vec3(rgb[0], rgb[1], rgb[2]));
    std::copy_n(&light.x, 3, rgb);
  }
  return made;
}

py::bytes preview(const py::object& pixels, int height, double exposure, const py::kwargs& given) {
  Options options("preview", given);
  const Source source = source_of(pixels, options);
  Call call("preview", options);
  options.finish();
  std::vector<std::byte> bytes;
  call.run([&](const Control& control) {
    const Shown made = shown_as(source, height, exposure, control);
    write_environment({bytes, "preview.png"}, made.image.view());
  });
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

py::array tone_mapped(const py::object& pixels, int height, double exposure, const py::kwargs& given) {
  Options options("tone_mapped", given);
  const Source source = source_of(pixels, options);
  Call call("tone_mapped", options);
  options.finish();
  return array_of(call.run([&](const Control& control) { return shown_as(source, height, exposure, control).image; }));
}

}  // namespace

void bind_images(py::module_& module) {
  module.def(
      "to_cubemap", &cubemap_from, py::arg("pixels"), py::arg("size"),
      "to_cubemap(pixels, size, *, rotation=None, filter='area', layout=None, encoding=None, read=None, "
      "progress=None,\n"
      "           threads=None)\n"
      "--\n\n"
      "Resamples to six faces, (6, size, size, 3) float32, optionally rotated: direction d of the pixels becomes\n"
      "direction rotation @ d of the result.");
  module.def("to_lat_long", &lat_long_from, py::arg("pixels"), py::arg("height"),
             "to_lat_long(pixels, height, *, rotation=None, filter='area', layout=None, encoding=None, read=None, "
             "progress=None,\n"
             "            threads=None)\n"
             "--\n\n"
             "Resamples to a lat-long, (height, 2 height, 3) float32, optionally rotated.");
  module.def(
      "rotation_about_y", [](double degrees) { return array_of(rotation_about_y(degrees)); }, py::arg("degrees"),
      "rotation_about_y(degrees)\n"
      "--\n\n"
      "Returns a rotation about y, from +z towards +x: (3, 3).");
  module.def(
      "preview", &preview, py::arg("pixels"), py::arg("height") = 128, py::arg("exposure") = 0.0,
      "preview(pixels, height=128, exposure=0.0, *, layout=None, encoding=None, read=None, progress=None, "
      "threads=None)\n"
      "--\n\n"
      "Returns a small tone-mapped lat-long as the bytes of a PNG. `exposure`: factor of radiance; 0 selects one\n"
      "that suits the lit surroundings.");
  module.def("tone_mapped", &tone_mapped, py::arg("pixels"), py::arg("height") = 128, py::arg("exposure") = 0.0,
             "tone_mapped(pixels, height=128, exposure=0.0, *, layout=None, encoding=None, read=None, progress=None, "
             "threads=None)\n"
             "--\n\n"
             "Returns the image of `preview` as an array (height, 2 height, 3) float32, linear in [0, 1].");
}

}  // namespace welkin::python
