// All of image-based lighting in one call.
#include "bake.h"

#include <pybind11/stl.h>

#include <memory>
#include <string>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "files.h"
#include "octahedral.h"
#include "results.h"
#include "source.h"

namespace welkin::python {
namespace {

constexpr Named<IrradianceMethod> kIrradiance[] = {{"automatic", IrradianceMethod::automatic},
                                                   {"direct", IrradianceMethod::direct},
                                                   {"harmonics", IrradianceMethod::harmonics}};
constexpr Named<MipFilter> kMipFilters[] = {{"solid-angle", MipFilter::solid_angle}, {"box", MipFilter::box}};

BackgroundOptions background_options(const py::dict& given) {
  Options options("bake", given, "background");
  BackgroundOptions how;
  options.read("size", how.size);
  options.read("mips", how.mips);
  options.read("mip_filter", how.mip_filter, kMipFilters);
  options.finish();
  return how;
}

IrradianceOptions irradiance_options(const py::dict& given, Quality quality) {
  Options options("bake", given, "irradiance");
  IrradianceOptions how = *BakeOptions::at(options.has("rms_error") ? Quality::normal : quality).irradiance;
  options.read("size", how.size);
  options.read("method", how.method, kIrradiance);
  options.read("rms_error", how.rms_error);
  options.finish();
  return how;
}

PrefilterOptions specular_options(const py::dict& given, Quality quality) {
  Options options("bake", given, "specular");
  const PrefilterOptions how = prefilter_options(options, false, quality);
  options.finish();
  return how;
}

OctahedralOptions map_options(const py::dict& given) {
  Options options("bake", given, "octahedral");
  const OctahedralOptions how = octahedral_options(options);
  options.finish();
  return how;
}

BrdfTableOptions table_options(const py::dict& given) {
  Options options("bake", given, "brdf");
  const BrdfTableOptions how = brdf_options(options);
  options.finish();
  return how;
}

/// A bake's result, taken apart into what Python holds.
struct Baked {
  std::optional<Chain> background;
  std::optional<Reflections> specular;
  std::optional<SharedOctahedral> octahedral;
  py::object irradiance;
  std::optional<MipRecord> irradiance_record;
  std::optional<SphericalHarmonics> radiance;
  std::optional<SharedBrdf> brdf;
  ProjectionDiagnostics diagnostics;
  std::uint64_t peak_bytes;

  explicit Baked(BakeResult made)
      : irradiance_record(made.irradiance_record),
        radiance(std::move(made.radiance)),
        diagnostics(std::move(made.diagnostics)),
        peak_bytes(made.peak_bytes) {
    if (made.background) background.emplace(std::move(*made.background));
    if (made.specular) specular.emplace(std::move(*made.specular));
    if (made.octahedral) octahedral = shared(std::move(*made.octahedral));
    if (made.brdf) brdf = SharedBrdf{std::move(made.brdf)};
    irradiance = made.irradiance ? py::object(array_of(std::move(*made.irradiance))) : py::none();
  }
};

std::string words(const Baked& baked) {
  std::string parts;
  const auto part = [&](bool there, const std::string& what) {
    if (there) parts += (parts.empty() ? "" : ", ") + what;
  };
  part(baked.background.has_value(), "background");
  if (baked.background) parts += " of " + std::to_string(baked.background->cubemap->size());
  part(baked.specular.has_value(), "specular");
  if (baked.specular) {
    parts += " of " + std::to_string(baked.specular->cubemap->size()) + " with " +
             counted(baked.specular->mips.size(), "mip");
  }
  part(baked.octahedral.has_value(), "octahedral map");
  part(!baked.irradiance.is_none(), "irradiance");
  if (baked.radiance) part(true, counted(static_cast<std::size_t>(baked.radiance->bands()), "band"));
  part(baked.brdf.has_value(), "BRDF table");
  return "<welkin.Bake: " + (parts.empty() ? std::string("nothing") : parts) + ">";
}

Baked bake_by_plan(const py::object& pixels, const PlanOfSource& plan, Options& options) {
  std::optional<Source> source;
  if (!plan.file) source = source_of(pixels, options);
  Call call("bake", options);
  options.finish();
  return Baked(call.run([&](const Control& control) {
    if (plan.file) return bake(*plan.file, plan.plan, control);
    return bake(source->view, plan.plan, control);
  }));
}

Baked bake_source(const py::object& pixels, const py::kwargs& given) {
  Options options("bake", given);
  if (const py::handle plan = options.take("plan"); plan) {
    return bake_by_plan(pixels, plan.cast<const PlanOfSource&>(), options);
  }
  std::optional<Source> source;
  std::optional<FileInput> input;
  ReadOptions read;
  if (is_file(pixels)) {
    input = input_of(pixels);
    read = read_group(options);
  } else {
    source = source_of(pixels, options);
  }
  const BakeOptions how = bake_options(options);
  Call call("bake", options);
  options.finish();
  return Baked(call.run([&](const Control& control) {
    if (input) return bake_file(*input, read, how, control);
    return bake(source->view, how, control);
  }));
}

}  // namespace

BakeOptions bake_options(Options& options) {
  const Quality quality = read_quality(options, Quality::normal);
  BakeOptions how = BakeOptions::at(quality);
  const auto read = [&](const char* name, auto& member, auto parse) {
    const std::optional<py::dict> given = options.group(name, member.has_value());
    if (given) {
      member = parse(*given);
    } else {
      member.reset();
    }
  };
  read("background", how.background, background_options);
  read("specular", how.specular, [&](const py::dict& given) { return specular_options(given, quality); });
  read("octahedral", how.octahedral, map_options);
  read("irradiance", how.irradiance, [&](const py::dict& given) { return irradiance_options(given, quality); });
  read("brdf", how.brdf, table_options);
  options.read("bands", how.bands);
  options.read("policy", how.pixels);
  options.read("memory_limit", how.memory_limit_bytes);
  return how;
}

void bind_bake(py::module_& module) {
  py::class_<Baked>(module, "Bake", "What a bake made; None for parts that were not requested.")
      .def_readonly("background", &Baked::background,
                    "Radiance, W/m2/sr, sharp: a `Chain` of (6, n, n, 3) float32, n halving.")
      .def_readonly(
          "specular", &Baked::specular,
          "Mean radiance in GGX lobes, W/m2/sr: `Reflections`, a level (6, n, n, 3) float32 for each roughness.")
      .def_readonly("octahedral", &Baked::octahedral, "`specular` as an `OctahedralMap` as well.")
      .def_readonly("irradiance", &Baked::irradiance, "(6, n, n, 3) float32: W/m2 where radiance is W/m2/sr.")
      .def_readonly("irradiance_record", &Baked::irradiance_record,
                    "`MipRecord` of how irradiance was made, with its estimated error.")
      .def_readonly("radiance", &Baked::radiance, "`SphericalHarmonics` of radiance, W/m2/sr: bands^2 coefficients.")
      .def_readonly("brdf", &Baked::brdf, "`BrdfTable`: (64, 64, 3) float32 by default.")
      .def_readonly("diagnostics", &Baked::diagnostics, "Counts, total radiance, and each pass with its time.")
      .def_readonly("peak_bytes", &Baked::peak_bytes, "Bound on results and working memory together.")
      .def_property_readonly(
          "pixels",
          [](const Baked& self) -> py::object {
            if (self.background) return level_of(self.background->cubemap, 0);
            if (self.specular) return level_of(self.specular->cubemap, 0);
            return self.irradiance;
          },
          "The sharpest cubemap that there is.")
      .def("__repr__", [](const Baked& self) { return words(self); });
  module.def(
      "bake", &bake_source, py::arg("pixels"),
      "bake(pixels, *, background=True, specular=True, octahedral=False, irradiance=True, brdf=True, bands=3,\n"
      "     quality='normal', policy=None, memory_limit=8589934592, plan=None, layout=None, encoding=None, read=None,\n"
      "     progress=None, threads=None)\n"
      "--\n\n"
      "Bakes everything that a renderer loads and returns a `Bake`. `pixels`: an array (height, width, channels)\n"
      "or (6, n, n, channels), or a file (its path or bytes; `read`: options of `read`). Each part is True, False\n"
      "or a dictionary of options:\n\n"
      "background  size=None (texels per edge; None: as the reflections), mips, mip_filter\n"
      "specular    the options of `prefilter` except `lobes` and `policy`\n"
      "octahedral  map of the reflections, as in `to_octahedral`: size=256, levels, border\n"
      "irradiance  size=64, method=\"automatic\", \"direct\" or \"harmonics\" (from `bands`), rms_error=1e-3\n"
      "brdf        as in `brdf_table`: width=64, height=64, model, sheen\n\n"
      "Radiance is in the pixels' unit, such as W/m2/sr; irradiance is then in W/m2. `quality` applies to\n"
      "reflections and irradiance, as in `prefilter`. `memory_limit`: bytes. `plan`: a `Plan` for the same\n"
      "pixels, in place of the options.");
}

}  // namespace welkin::python
