// The harmonics of a bake, in the words of `welkin sh`.
#include <optional>

#include "tools/bake_files.h"
#include "tools/sh_report.h"
#include "tools/text_file.h"
#include "welkin/harmonic_transforms.h"

namespace welkin::tool {
namespace {

ShReport report_of(const Baked& baked, const BakeCommandOptions& options) {
  const SphericalHarmonics& light = *baked.light.radiance;
  TurnOptions to_engine;
  to_engine.to = options.turn.to;
  const glm::dmat3 matrix = turn_of_light(to_engine, false);

  ShReport report;
  report.source = baked.source;
  report.options = baked.options.pixels;
  report.options.bands = light.bands();
  report.projection = {transform(light, matrix), baked.light.diagnostics};
  report.projection.diagnostics.passes.clear();  // the manifest has the times; these files have no use for them
  report.axes = axes_text(options.turn);
  report.engine = options.turn.to;
  report.sky = baked.sky;
  report.sun_wanted = baked.sun_wanted;
  report.sun = baked.sun;
  if (report.sun) report.sun->direction = matrix * report.sun->direction;
  report.dominant = dominant_light(report.projection.radiance);
  report.windowed = apply_window(report.projection.radiance, Window::none);
  report.irradiance = irradiance_from_radiance(report.projection.radiance);
  report.polynomial = babylon_polynomial(report.projection.radiance);
  for (const Convention& each : conventions()) {
    if (has_engine_light(each.engine)) report.engine_lights.push_back(engine_light(light, each.engine));
  }
  return report;
}

}  // namespace

void write_harmonics(const Baked& baked, const BakeCommandOptions& options, OutputFolder& folder) {
  if (options.bake.bands == 0 || !baked.light.radiance) return;
  const ShReport report = report_of(baked, options);
  const Json details = {{"bands", report.projection.radiance.bands()}};
  write_text_file(folder.place("sh.json"), sh_json(report));
  folder.add({"sh.json", "spherical harmonics: canonical, and as each engine wants them", "JSON", 0, 0, "", details});
  write_text_file(folder.place("sh.h"), sh_c_header(report));
  folder.add({"sh.h", "the same", "C header", 0, 0, "", details});
}

}  // namespace welkin::tool
