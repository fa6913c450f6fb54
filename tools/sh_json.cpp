// `welkin sh --json`. Members are only ever added: programs read this.
#include "tools/json_text.h"
#include "tools/sh_report.h"

namespace welkin::tool {
namespace {

Json source_json(const Source& source) {
  return {{"path", source.path},
          {"layout", source.layout},
          {"width", source.width},
          {"height", source.height},
          {"format", source.format}};
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

Json settings_json(const ProjectionOptions& options) {
  Json settings = {{"quadrature", quadrature_name(options.quadrature)},
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
          {"settings", settings_json(report.options)},
          {"passes", passes}};
}

}  // namespace

std::string sh_json(const ShReport& report) {
  return json_text({{"source", source_json(report.source)},
                    {"bands", report.projection.radiance.bands()},
                    {"radiance", coefficients_json(report.projection.radiance)},
                    {"irradiance", coefficients_json(report.irradiance)},
                    {"babylon", babylon_json(report.polynomial)},
                    {"diagnostics", diagnostics_json(report)}});
}

}  // namespace welkin::tool
