// Less work for scenes that need less.
#include <pybind11/stl.h>

#include <string>
#include <utility>

#include "bake.h"
#include "bindings.h"
#include "call.h"
#include "files.h"
#include "results.h"
#include "source.h"
#include "welkin/bake.h"

namespace welkin::python {
namespace {

/// `glossy`: (least, greatest) roughness, True for all, or False for no glossy material.
void read_glossy(Options& options, SceneNeeds& needs) {
  const bool given = options.has("glossy");
  const py::handle value = options.take("glossy");
  if (!given) return;
  if (!value || value.is(py::handle(Py_False))) {
    needs.glossy.reset();
  } else if (!value.is(py::handle(Py_True))) {
    std::pair<double, double> range;
    options.read("glossy", range);
    needs.glossy = RoughnessRange{range.first, range.second};
  }
}

SceneNeeds needs_of(const py::dict& given) {
  Options options("plan", given, "needs");
  SceneNeeds needs;
  options.read("diffuse_bands", needs.diffuse_bands);
  options.read("irradiance_cubemap", needs.irradiance_cubemap);
  read_glossy(options, needs);
  options.read("background", needs.background);
  options.read("background_mips", needs.background_mips);
  options.read("brdf_table", needs.brdf_table);
  options.read("stored_results", needs.stored_results);
  options.finish();
  return needs;
}

PlanOfSource plan_of(const py::object& pixels, const py::kwargs& given) {
  Options options("plan", given);
  std::optional<Source> source;
  std::optional<SourceShape> shape;
  std::optional<StoredEnvironment> file;
  const bool is_shape = py::isinstance<py::tuple>(pixels) && !pixels.cast<py::tuple>().empty() &&
                        py::isinstance<py::int_>(pixels.cast<py::tuple>()[0]);
  if (is_file(pixels)) {
    file = inspect_stored_environment(input_of(pixels), read_group(options));
  } else if (is_shape) {
    shape = shape_of_tuple(pixels.cast<py::tuple>());
  } else {
    source = source_of(pixels, options);
  }
  const SceneNeeds needs = needs_of(options.group("needs", true).value_or(py::dict()));
  const BakeOptions whole = bake_options(options);
  Call call("plan", options);
  options.finish();
  PlanOfSource made{call.run([&](const Control& /*control*/) {
                      if (file) return plan(*file, needs, whole);
                      if (shape) return plan(*shape, needs, whole);
                      return plan(source->view, needs, whole);
                    }),
                    file, py::none()};
  if (file) made.keeps = pixels;
  return made;
}

void bind_passes(py::module_& module) {
  py::class_<PlannedPass>(module, "PlannedPass", "What becomes of one pass, and why.")
      .def_readonly("name", &PlannedPass::name, "As in the diagnostics of the bake.")
      .def_property_readonly(
          "action", [](const PlannedPass& self) { return name(self.action); }, "\"run\", \"reuse\", \"skip\"")
      .def_readonly("reason", &PlannedPass::reason, "What is done, or why it is not.")
      .def_readonly("bytes", &PlannedPass::bytes, "Memory in bytes that it holds at most, without the source.")
      .def("__repr__", [](const PlannedPass& self) {
        return "<welkin.PlannedPass: " + self.name + ", " + name(self.action) + ", " + self.reason + ">";
      });
}

}  // namespace

void bind_plan(py::module_& module) {
  bind_passes(module);
  py::class_<PlanOfSource>(module, "Plan", "The passes of a bake, planned before it runs: `bake(pixels, plan=...)`.")
      .def_property_readonly(
          "source", [](const PlanOfSource& self) { return self.plan.source; }, "In words.")
      .def_property_readonly(
          "passes", [](const PlanOfSource& self) { return self.plan.passes; }, "A `PlannedPass` each.")
      .def_property_readonly(
          "result_bytes", [](const PlanOfSource& self) { return self.plan.result_bytes; }, "Of the results.")
      .def_property_readonly(
          "working_bytes", [](const PlanOfSource& self) { return self.plan.working_bytes; },
          "Working memory in bytes at most, without results and source.")
      .def("__str__", [](const PlanOfSource& self) { return plan_text(self.plan); })
      .def("__repr__", [](const PlanOfSource& self) {
        std::size_t running = 0;
        for (const PlannedPass& pass : self.plan.passes) running += pass.action == PassAction::run ? 1 : 0;
        return "<welkin.Plan: " + self.plan.source + ", " + std::to_string(running) + " of " +
               counted(self.plan.passes.size(), "step") + " to run>";
      });
  module.def(
      "plan", &plan_of, py::arg("pixels"),
      "plan(pixels, *, needs=None, background=True, specular=True, octahedral=False, irradiance=True, brdf=True,\n"
      "     bands=3, quality='normal', policy=None, memory_limit=8589934592, layout=None, encoding=None, read=None,\n"
      "     progress=None, threads=None)\n"
      "--\n\n"
      "Plans which passes a scene needs, with reasons and memory. Returns a `Plan`. `pixels`: an array, a file,\n"
      "or a shape (height, width, channels). `needs`: a dictionary of diffuse_bands, irradiance_cubemap, glossy\n"
      "(a range of roughness, or False), background, background_mips, brdf_table, stored_results. The other\n"
      "options are those of the whole bake.");
}

}  // namespace welkin::python
