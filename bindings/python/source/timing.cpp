// What calls take without Python: bindings/python/perf/overhead.py compares them with the same calls from there.
#include <chrono>
#include <functional>
#include <map>
#include <string>

#include "bindings.h"
#include "options.h"
#include "source.h"
#include "welkin/bake.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::python {
namespace {

// Functions of another object file, whose calls no compiler leaves out.
std::map<std::string, std::function<void()>> calls_on(const CubemapView& view, const SphericalHarmonics& light) {
  const BakeOptions small{
      .background = {}, .specular = PrefilterOptions{.size = 4, .mips = 1}, .irradiance = {}, .brdf = {}};
  return {
      {"project", [=] { static_cast<void>(project(view)); }},
      {"prefilter", [=] { static_cast<void>(prefilter_specular(view, {.size = 4, .mips = 1})); }},
      {"bake", [=] { static_cast<void>(bake(view, small)); }},
      {"to_cubemap", [=] { static_cast<void>(to_cubemap(view, 4, dmat3(1.0))); }},
      {"irradiance", [&light] { static_cast<void>(irradiance_from_radiance(light)); }},
      {"rotate", [&light] { static_cast<void>(rotate(light, rotation_about_y(30.0))); }},
      {"evaluate",
       [&light] {
         static_cast<void>(evaluate(light, {0.0, 1.0, 0.0}));
       }},
      {"engine_light", [&light] { static_cast<void>(engine_light(light, Engine::three)); }},
      {"brdf_table", [] { static_cast<void>(brdf_table()); }},
  };
}

/// Seconds a call, of `count` calls one after the other.
double seconds_of(const std::string& what, const py::object& pixels, int count) {
  const Source source = source_of(pixels);
  const auto view = source.view.cubemap();
  const SphericalHarmonics light = project(view).radiance;
  const auto calls = calls_on(view, light);
  const auto found = calls.find(what);
  if (found == calls.end()) throw py::key_error(what);
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < count; ++k) found->second();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / count;
}

}  // namespace

void bind_timing(py::module_& module) {
  module.def(
      "_seconds_of", &seconds_of, py::arg("what"), py::arg("pixels"), py::arg("count"),
      "_seconds_of(what, pixels, count)\n--\n\nSeconds that a call takes in C++; of the names in perf/overhead.py.");
}

}  // namespace welkin::python
