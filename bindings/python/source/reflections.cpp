// Reflections: chains of mips, and the BRDF table.
#include "welkin/reflections.h"

#include <pybind11/stl.h>

#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "lobes.h"
#include "results.h"
#include "source.h"
#include "welkin/resampling.h"

namespace welkin::python {
namespace {

constexpr Named<PrefilterMethod> kMethods[] = {{"automatic", PrefilterMethod::automatic},
                                               {"spectral", PrefilterMethod::spectral},
                                               {"reference", PrefilterMethod::reference}};
constexpr Named<Quality> kQualities[] = {
    {"normal", Quality::normal}, {"fast", Quality::fast}, {"reference", Quality::reference}};
constexpr Named<RoughnessSchedule> kSchedules[] = {{"linear", RoughnessSchedule::linear},
                                                   {"filament", RoughnessSchedule::filament},
                                                   {"babylon", RoughnessSchedule::babylon},
                                                   {"unity", RoughnessSchedule::unity},
                                                   {"unreal", RoughnessSchedule::unreal}};
constexpr Named<bool> kFitted[] = {{"fitted", true}};
constexpr Named<LobeFamily> kLobes[] = {{"ggx", LobeFamily::ggx},         {"charlie", LobeFamily::charlie},
                                        {"lambert", LobeFamily::lambert}, {"phong", LobeFamily::phong},
                                        {"blinn", LobeFamily::blinn},     {"spectra", LobeFamily::spectra}};
constexpr Named<BrdfModel> kModels[] = {{"split-sum", BrdfModel::split_sum},
                                        {"multiple-scattering", BrdfModel::multiple_scattering}};
constexpr Named<MipFilter> kMipFilters[] = {{"solid-angle", MipFilter::solid_angle}, {"box", MipFilter::box}};

/// `roughness`: a list, or the name of a schedule. `lobe_roughness`: a list, or "fitted" to lookups by that schedule.
void read_roughness(Options& options, PrefilterOptions& how) {
  const py::handle roughness = options.take("roughness");
  const py::handle lobes = options.take("lobe_roughness");
  const bool listed = roughness && !py::isinstance<py::str>(roughness);
  const bool fitted = lobes && py::isinstance<py::str>(lobes);
  if (fitted) static_cast<void>(value_of<bool>(options.called("lobe_roughness"), lobes.cast<std::string>(), kFitted));
  if (fitted && listed)
    throw Error(ErrorCode::invalid_argument,
                options.called("lobe_roughness") + " is \"fitted\", and roughness is a list; name a schedule");
  if (!fitted) options.read("lobe_roughness", how.lobe_roughness);
  if (listed) {
    options.read("roughness", how.roughness);
  } else if (roughness || fitted) {
    auto schedule = RoughnessSchedule::filament;
    options.read("roughness", schedule, kSchedules);
    how.use_schedule(schedule, fitted);
  }
}

py::list levels_of(const Chain& chain) {
  py::list levels;
  for (int level = 0; level < chain.cubemap->levels(); ++level) levels.append(level_of(chain.cubemap, level));
  return levels;
}

/// A level by its number, from the end below 0, or a list of levels by a slice.
py::object level_at(const Chain& chain, const py::object& index) {
  if (py::isinstance<py::slice>(index)) return levels_of(chain)[index];
  if (PyIndex_Check(index.ptr()) == 0) {
    throw py::type_error("a chain's levels are numbers or slices, found " + py::repr(index).cast<std::string>());
  }
  const int count = chain.cubemap->levels();
  const py::ssize_t asked = PyNumber_AsSsize_t(index.ptr(), nullptr);
  const py::ssize_t level = asked < 0 ? asked + count : asked;
  if (level < 0 || level >= count) {
    throw py::index_error("level " + std::to_string(asked) + " of a chain of " +
                          counted(static_cast<std::size_t>(count), "level"));
  }
  return level_of(chain.cubemap, static_cast<int>(level));
}

py::object pixels_of(const Chain& chain) {
  return chain.cubemap->levels() > 0 ? py::object(level_of(chain.cubemap, 0)) : py::none();
}

std::string text(const MipRecord& mip) {
  char error[32] = "unknown error";
  if (mip.error_estimate) std::snprintf(error, sizeof(error), "error %.2g", *mip.error_estimate);
  char words[160];
  std::snprintf(words, sizeof(words), "<welkin.MipRecord: size %d, roughness %.3g, %s, %s, %.3g ms>", mip.size,
                mip.roughness, name(mip.method), error, mip.milliseconds);
  return words;
}

std::string words(const Chain& chain) {
  return "cubemap of " + std::to_string(chain.cubemap->size()) + ", " +
         counted(static_cast<std::size_t>(chain.cubemap->levels()), "level");
}

/// `lobes`: a chain by these in place of GGX's lobes, with size, method, rms_error and policy of `how`.
std::optional<LobeChainOptions> kernel_options(Options& options, const PrefilterOptions& how) {
  const py::handle given = options.take("lobes");
  if (!given) return std::nullopt;
  std::vector<NamedLobe> lobes;
  options.read("lobes", lobes);
  for (const char* const name : {"mips", "roughness", "lobe_roughness", "lobe", "spectra", "maximum_error"}) {
    if (!options.has(name)) continue;
    throw Error(ErrorCode::invalid_argument, options.called(name) + " is for GGX's lobes, and not for `lobes`");
  }
  LobeChainOptions chain{how.size, {}, how.method, how.rms_error, how.pixels};
  for (NamedLobe& each : lobes) chain.lobes.push_back(std::move(each.lobe));
  return chain;
}

Reflections prefilter(const py::object& pixels, const py::kwargs& given) {
  Options options("prefilter", given);
  const Source source = source_of(pixels, options);
  const PrefilterOptions how = prefilter_options(options, true);
  const std::optional<LobeChainOptions> lobes = kernel_options(options, how);
  Call call("prefilter", options);
  options.finish();
  if (lobes) {
    return Reflections(
        call.run([&](const Control& control) { return prefilter_by_lobes(source.view, *lobes, control); }));
  }
  return Reflections(call.run([&](const Control& control) { return prefilter_specular(source.view, how, control); }));
}

/// By a roughness, or by a lobe.
py::array reference(const py::object& pixels, const py::object& lobe, const py::object& directions,
                    const py::kwargs& given) {
  Options options("reference_specular", given);
  std::optional<ZonalLobe> zonal;
  double roughness = 0.0;
  if (py::isinstance<NamedLobe>(lobe)) {
    zonal = lobe.cast<const NamedLobe&>().lobe;
  } else if (py::isinstance<py::float_>(lobe) || PyNumber_Check(lobe.ptr()) != 0) {
    roughness = py::float_(lobe);
  } else {
    throw py::type_error("reference_specular: the lobe is a roughness or a ZonalLobe");
  }
  const Source source = source_of(pixels, options);
  Call call("reference_specular", options);
  options.finish();
  const Directions asked = directions_of(directions, "directions");
  std::vector<dvec3> list(asked.count());
  for (std::size_t index = 0; index < list.size(); ++index) list[index] = asked.at(index);
  const std::vector<dvec3> values = call.run([&](const Control& control) {
    return zonal ? reference_by_lobe(source.view, *zonal, list, control)
                 : reference_specular(source.view, roughness, list, control);
  });
  return array_of(values).reshape(asked.shape);
}

SharedBrdf table_of(const py::kwargs& given) {
  Options options("brdf_table", given);
  const BrdfTableOptions how = brdf_options(options);
  Call call("brdf_table", options);
  options.finish();
  return {call.run([&](const Control& control) { return brdf_table(how, control); })};
}

Chain mips_of(const py::object& pixels, const py::kwargs& given) {
  Options options("build_mips", given);
  const Source source = source_of(pixels, options);
  MipFilter filter = MipFilter::solid_angle;
  std::optional<int> levels;
  options.read("filter", filter, kMipFilters);
  options.read("levels", levels);
  Call call("build_mips", options);
  options.finish();
  if (!source.is_cubemap()) throw Error(ErrorCode::invalid_argument, "build_mips: takes a cubemap, found a lat-long");
  return Chain(
      call.run([&](const Control& control) { return build_mips(source.view.cubemap(), filter, levels, control); }));
}

void bind_chains(py::module_& module) {
  py::class_<MipRecord>(module, "MipRecord", "How one mip was made, and how good it is.")
      .def_readonly("size", &MipRecord::size, "Texels along an edge.")
      .def_readonly("roughness", &MipRecord::roughness, "Perceptual, 0 to 1; GGX's alpha is its square.")
      .def_property_readonly(
          "method", [](const MipRecord& self) { return name(self.method); },
          "\"copy\", \"spectral\", \"reference\", \"stored\", \"near_far\"")
      .def_readonly("bands", &MipRecord::bands, "Harmonic bands that were used.")
      .def_readonly("bright_texels", &MipRecord::bright_texels, "Texels whose lobes were added one by one.")
      .def_readonly("lobe_roughness", &MipRecord::lobe_roughness,
                    "Roughness of the mip's lobe: `roughness`, unless it is fitted to lookups.")
      .def_readonly("error_between", &MipRecord::error_between,
                    "Predicted relative rms error of lookups between this mip and the next, or None.")
      .def_readonly("error_estimate", &MipRecord::error_estimate, "Predicted rms error over the mip's rms, or None.")
      .def_property_readonly(
          "mean", [](const MipRecord& self) { return array_of(self.mean); },
          "Mean of the texels by solid angle, (3,). It is nearly the same on every mip, except where a lamp is\n"
          "narrower than the texels, because a texel holds the value at its centre.")
      .def_readonly("milliseconds", &MipRecord::milliseconds, "Wall time.")
      .def("__repr__", [](const MipRecord& self) { return text(self); });
  py::class_<Chain>(module, "Chain", "A cubemap with its mips. Arrays are views of the chain's memory.")
      .def_property_readonly("levels", &levels_of, "Arrays (6, n, n, 3) float32, largest first, without copies.")
      .def_property_readonly("pixels", &pixels_of, "The first level.")
      .def_property_readonly(
          "size", [](const Chain& self) { return self.cubemap->size(); }, "Texels along an edge of level 0.")
      .def_property_readonly(
          "nbytes", [](const Chain& self) { return self.cubemap->bytes(); }, "Bytes of all levels.")
      .def("__len__", [](const Chain& self) { return self.cubemap->levels(); })
      .def("__getitem__", &level_at)
      .def("__repr__", [](const Chain& self) { return "<welkin.Chain: " + words(self) + ">"; });
  py::class_<Reflections, Chain>(module, "Reflections", "A chain of reflections: a mip for each roughness.")
      .def_readonly("mips", &Reflections::mips, "A `MipRecord` for each level.")
      .def_readonly("diagnostics", &Reflections::diagnostics, "What was read, replaced and clamped.")
      .def_readonly("peak_bytes", &Reflections::peak_bytes, "Working memory in bytes, without source and result.")
      .def("__repr__", [](const Reflections& self) {
        char range[64] = "";
        if (!self.mips.empty()) {
          std::snprintf(range, sizeof(range), ", roughness %.3g to %.3g", self.mips.front().roughness,
                        self.mips.back().roughness);
        }
        return "<welkin.Reflections: " + words(self) + range + ">";
      });
}

}  // namespace

std::string counted(std::size_t count, const char* one) {
  return std::to_string(count) + ' ' + one + (count == 1 ? "" : "s");
}

Quality read_quality(Options& options, Quality otherwise) {
  options.read("quality", otherwise, kQualities);
  return otherwise;
}

const std::string kPrefilterSignature =
    "size=256, mips=None, roughness=None, lobe_roughness=None, lobe='ggx', spectra=None, method='automatic',\n"
    "          quality='normal', rms_error=1e-3, maximum_error=None";

PrefilterOptions prefilter_options(Options& options, bool policy, Quality otherwise) {
  const Quality quality = read_quality(options, otherwise);
  PrefilterOptions how = PrefilterOptions::at(options.has("rms_error") ? Quality::normal : quality);
  options.read("size", how.size);
  options.read("mips", how.mips);
  read_roughness(options, how);
  options.read("lobe", how.lobe, kLobes);
  options.read("spectra", how.spectra);
  options.read("method", how.method, kMethods);
  options.read("rms_error", how.rms_error);
  options.read("maximum_error", how.maximum_error);
  if (policy) options.read("policy", how.pixels);
  return how;
}

BrdfTableOptions brdf_options(Options& options) {
  BrdfTableOptions how;
  options.read("width", how.width);
  options.read("height", how.height);
  options.read("model", how.model, kModels);
  options.read("sheen", how.sheen);
  return how;
}

py::array array_of(const SharedBrdf& brdf) {
  const BrdfTable& table = *brdf.table;
  return shown<float>({table.options.height, table.options.width, table.channels}, table.values.data(),
                      keeper(brdf.table), false);
}

void bind_reflections(py::module_& module) {
  bind_chains(module);
  py::class_<SharedBrdf>(module, "BrdfTable",
                         "Reflectance of a surface in a uniform environment, by cosine and roughness.")
      .def_property_readonly(
          "values", [](const SharedBrdf& self) { return array_of(self); },
          "(height, width, channels) float32, read-only: row j at roughness (j + 0.5) / height, column i at N.V =\n"
          "(i + 0.5) / width. Channels: scale, bias and, with sheen, the sheen's albedo.")
      .def("__array__", [](const SharedBrdf& self, const py::args& words,
                           const py::kwargs& named) { return as_asked(array_of(self), words, named); })
      .def_property_readonly(
          "model", [](const SharedBrdf& self) { return name_of<BrdfModel>(self.table->options.model, kModels); },
          "\"split-sum\" or \"multiple-scattering\".")
      .def("__repr__", [](const SharedBrdf& self) {
        const BrdfTableOptions& how = self.table->options;
        return "<welkin.BrdfTable: " + std::to_string(how.width) + " x " + std::to_string(how.height) + ", " +
               name_of<BrdfModel>(how.model, kModels) + (how.sheen ? ", sheen>" : ">");
      });
  module.def(
      "prefilter", &prefilter, py::arg("pixels"),
      ("prefilter(pixels, *, " + kPrefilterSignature + ", lobes=None, policy=None,\n" +
       "          layout=None, encoding=None, read=None, progress=None, threads=None)\n--\n\n"
       "Prefilters reflections, one roughness per mip. Returns `Reflections`. `roughness`: a list, or a schedule:\n"
       "\"linear\", \"filament\" (the default), \"babylon\", \"unity\", \"unreal\". `lobe_roughness`: that of the "
       "mips'\n"
       "lobes, a list, or \"fitted\" to shaders that interpolate between mips by the schedule's formula. `lobe`:\n"
       "\"ggx\", \"charlie\" (sheen), \"lambert\", \"phong\", \"blinn\", or \"spectra\", with a list in `spectra` per "
       "mip: the\n"
       "factors of harmonic degrees 0, 1, ... `method`: \"automatic\", \"spectral\", \"reference\" (slow). "
       "`rms_error`\n"
       "bounds a mip's relative rms error, `maximum_error` the relative error of any texel (None: ten times\n"
       "`rms_error`). `quality`: \"normal\", \"fast\" (rms_error 1e-2), \"reference\" (the integral, minutes);\n"
       "`rms_error` takes precedence. `lobes`: a list of `ZonalLobe`, one per mip, in place of `lobe`.")
          .c_str());
  module.def("reference_specular", &reference, py::arg("pixels"), py::arg("lobe"), py::arg("directions"),
             "reference_specular(pixels, lobe, directions, *, layout=None, encoding=None, read=None, progress=None,\n"
             "                   threads=None)\n"
             "--\n\n"
             "Computes the reference for `prefilter` at directions (..., 3), in double over all texels: (..., 3).\n"
             "`lobe`: the roughness of a GGX lobe, or a `ZonalLobe`.");
  module.def(
      "brdf_table", &table_of,
      "brdf_table(*, width=64, height=64, model='split-sum', sheen=True, progress=None, threads=None)\n"
      "--\n\n"
      "Computes the second part of the split sum. Returns a `BrdfTable`; absolute error below 1e-5. Recent tables\n"
      "are cached and shared.");
  module.def(
      "build_mips", &mips_of, py::arg("pixels"),
      "build_mips(pixels, *, filter='solid-angle', levels=None, layout=None, encoding=None, read=None, progress=None,\n"
      "           threads=None)\n"
      "--\n\n"
      "Computes the mips of a cubemap. Returns a `Chain`. `filter`: \"solid-angle\" preserves the total radiance,\n"
      "\"box\" is that of graphics APIs.");
  module.def(
      "mip_roughness",
      [](const std::string& schedule, int mips, int size) {
        return mip_roughness(value_of<RoughnessSchedule>("schedule", schedule, kSchedules), mips, size);
      },
      py::arg("schedule"), py::arg("mips"), py::arg("size"),
      "mip_roughness(schedule, mips, size)\n"
      "--\n\n"
      "Returns the perceptual roughness of each mip for a schedule.");
  module.def(
      "fitted_mip_roughness",
      [](const std::string& schedule, int mips, int size) {
        return fitted_mip_roughness(value_of<RoughnessSchedule>("schedule", schedule, kSchedules), mips, size);
      },
      py::arg("schedule"), py::arg("mips"), py::arg("size"),
      "fitted_mip_roughness(schedule, mips, size)\n"
      "--\n\n"
      "Returns the roughness of lobes that minimizes the error of linear lookups between mips.");
  module.def("mip_for_roughness", &mip_for_roughness, py::arg("table"), py::arg("roughness"),
             "mip_for_roughness(table, roughness)\n"
             "--\n\n"
             "Returns the fractional mip at which a shader finds a roughness.");
}

}  // namespace welkin::python
