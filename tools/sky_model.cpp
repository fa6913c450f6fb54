#include "tools/sky_model.h"

#include <utility>

#include "tools/progress_bar.h"
#include "tools/sky_tables_file.h"

namespace welkin::tool {
namespace {

constexpr int kBuiltInHeight = 512;
constexpr double kTables = 0.9;  // of the progress; the rest is the picture

/// Small tables: the command's first picture shall not keep anybody waiting.
SkyParameters built_in_parameters() {
  SkyParameters parameters;
  parameters.sun_azimuth_degrees = 25.0;
  parameters.tables.heights = 8;
  parameters.tables.view_zeniths = 64;
  parameters.tables.sun_zeniths = 16;
  return parameters;
}

}  // namespace

Sky make_sky(const SkyParameters& parameters, const Control& control) {
  Atmosphere atmosphere = chosen_atmosphere(parameters.atmosphere, parameters.tables.colour);
  const ReadyTables ready = ready_tables(atmosphere, parameters.tables, parameters.tables_file, control);
  Sky sky{SkyView(ready.tables, parameters.altitude_m, parameters.view),
          sun_direction(parameters.sun_elevation_degrees, parameters.sun_azimuth_degrees),
          {},
          {ready.pass}};
  if (ready.pass.action == "run") {
    sky.passes.insert(sky.passes.end(), ready.tables->passes.begin(), ready.tables->passes.end());
  }
  SkyReport& report = sky.report;
  report.atmosphere = std::move(atmosphere);
  report.sun_elevation_degrees = parameters.sun_elevation_degrees;
  report.sun_azimuth_degrees = parameters.sun_azimuth_degrees;
  report.altitude_m = parameters.altitude_m;
  report.ground = parameters.view.ground;
  report.tables = ready.tables->options;
  report.table_bytes = ready.tables->bytes();
  report.orders = ready.tables->orders;
  report.last_change = ready.tables->last_change;
  report.sky_irradiance = sky.view.irradiance(sky.sun);
  return sky;
}

ComputedPicture sky_picture(const Sky& sky, int height, bool sun_disc, const Control& control) {
  ComputedPicture picture;
  picture.image = sky_lat_long(sky.view, sky.sun, height, {.sun_disc = sun_disc}, control);
  picture.source = {"sky",
                    name(Layout::lat_long),
                    picture.image.width,
                    picture.image.height,
                    "computed",
                    "from tables of the scattering",
                    {}};
  picture.sky = sky.report;
  if (!sun_disc) picture.sun = sky.view.sun(sky.sun);
  return picture;
}

ComputedPicture built_in_sky(const Control& control) {
  const Sky sky = make_sky(built_in_parameters(), part_of(control, 0.0, kTables));
  ComputedPicture picture = sky_picture(sky, kBuiltInHeight, true, part_of(control, kTables, 1.0));
  picture.source.path = "built-in sky";
  picture.source.detail = "no input file was named";
  return picture;
}

}  // namespace welkin::tool
