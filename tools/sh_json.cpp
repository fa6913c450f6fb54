// `welkin sh --json`. Members are only ever added: programs read this.
#include "tools/json_text.h"
#include "tools/sh_report.h"

namespace welkin::tool {
namespace {

Json source_json(const Source& source) {
  return {{"path", source.path},     {"layout", source.layout}, {"width", source.width},
          {"height", source.height}, {"format", source.format}, {"notes", source.notes}};
}

Json coefficients_json(const SphericalHarmonics& harmonics) {
  Json list = Json::array();
  for (const glm::dvec3& rgb : harmonics.coefficients()) list.push_back(json_triple(rgb));
  return list;
}

Json babylon_json(const BabylonPolynomial& polynomial) {
  return {{"x", json_triple(polynomial.x)},   {"y", json_triple(polynomial.y)},   {"z", json_triple(polynomial.z)},
          {"xx", json_triple(polynomial.xx)}, {"yy", json_triple(polynomial.yy)}, {"zz", json_triple(polynomial.zz)},
          {"yz", json_triple(polynomial.yz)}, {"zx", json_triple(polynomial.zx)}, {"xy", json_triple(polynomial.xy)}};
}

Json settings_json(const ShReport& report) {
  const ProjectionOptions& options = report.options;
  Json settings = {{"quadrature", quadrature_name(report)},
                   {"target_size", options.target_size},
                   {"clamp", nullptr},
                   {"preserve_clamped", options.clamp && options.clamp->preserve_colour},
                   {"gamma", options.gamma}};
  if (options.clamp) settings["clamp"] = options.clamp->maximum;
  return settings;
}

Json diagnostics_json(const ShReport& report) {
  const ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  Json passes = Json::array();
  for (const PassRecord& pass : diagnostics.passes) {
    passes.push_back(
        {{"name", pass.name}, {"action", pass.action}, {"reason", pass.reason}, {"ms", pass.milliseconds}});
  }
  return {{"texels", diagnostics.texels},
          {"replaced", diagnostics.nans_replaced + diagnostics.infinities_replaced + diagnostics.negatives_replaced},
          {"nans_replaced", diagnostics.nans_replaced},
          {"infinities_replaced", diagnostics.infinities_replaced},
          {"negatives_replaced", diagnostics.negatives_replaced},
          {"clamped", diagnostics.texels_clamped},
          {"flux_before_clamp", json_triple(diagnostics.flux_before_clamp)},
          {"flux", json_triple(diagnostics.flux)},
          {"average", json_triple(average_radiance(report.projection.radiance))},
          {"error_estimate", diagnostics.error_estimate},
          {"settings", settings_json(report)},
          {"passes", passes}};
}

Json axes_json(const ShReport& report) { return {{"engine", convention(report.engine).name}, {"words", report.axes}}; }

Json window_json(const ShReport& report) {
  const Windowed& windowed = report.windowed;
  return {{"name", name(report.window)},
          {"parameter", windowed.parameter},
          {"factors", windowed.factors},
          {"minimum_irradiance_before", json_triple(windowed.minimum_before)},
          {"minimum_irradiance_after", json_triple(windowed.minimum_after)}};
}

Json engine_json(const EngineLight& light) {
  Json terms = Json::object();
  for (const EngineTerm& term : light.terms) terms[term.name] = json_triple(term.rgb);
  Json json = {
      {"name", convention(light.engine).name}, {"form", light.form}, {"formula", light.formula}, {"terms", terms}};
  for (const auto& [name, value] : light.vectors) json["vectors"][name] = {value.x, value.y, value.z, value.w};
  return json;
}

/// All engines' forms; each says which axes it is in.
Json engines_json(const std::vector<EngineLight>& lights) {
  Json list = Json::array();
  for (const EngineLight& light : lights) {
    list.push_back(engine_json(light));
    list.back()["axes"] = convention(light.engine).axes;
  }
  return list;
}

Json dominant_json(const std::optional<DominantLight>& light) {
  if (!light) return nullptr;
  return {{"direction", json_triple(light->direction)}, {"irradiance", json_triple(light->irradiance)}};
}

Json sun_json(const std::optional<Sun>& sun) {
  if (!sun) return nullptr;
  return {{"direction", json_triple(sun->direction)},
          {"irradiance", json_triple(sun->irradiance)},
          {"radiance", json_triple(sun->radiance)},
          {"solid_angle", sun->solid_angle},
          {"angular_radius_degrees", sun->angular_radius_degrees},
          {"texels", sun->texels},
          {"flux_before", json_triple(sun->flux_before)},
          {"flux_after", json_triple(sun->flux_after)}};
}

Json irradiance_errors_json(const std::vector<IrradianceError>& errors) {
  Json list = Json::array();
  for (const IrradianceError& error : errors) {
    list.push_back(
        {{"bands", error.bands}, {"rms", error.rms}, {"maximum", error.maximum}, {"relative", error.relative}});
  }
  return list;
}

}  // namespace

std::string sh_json(const ShReport& report) {
  Json json = {{"source", source_json(report.source)},
               {"axes", axes_json(report)},
               {"bands", report.projection.radiance.bands()},
               {"radiance", coefficients_json(report.projection.radiance)},
               {"irradiance", coefficients_json(report.irradiance)},
               {"babylon", babylon_json(report.polynomial)},
               {"engine", report.engine_light ? engine_json(*report.engine_light) : Json(nullptr)},
               {"window", window_json(report)},
               {"dominant_light", dominant_json(report.dominant)}};
  if (!report.engine_lights.empty()) json["engines"] = engines_json(report.engine_lights);
  if (report.sky) json["sky"] = sky_json(*report.sky);
  if (report.sun_wanted) json["sun"] = sun_json(report.sun);
  if (!report.irradiance_errors.empty()) json["irradiance_errors"] = irradiance_errors_json(report.irradiance_errors);
  json["diagnostics"] = diagnostics_json(report);
  return json_text(json);
}

}  // namespace welkin::tool
