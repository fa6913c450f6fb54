#include "tools/sky_options.h"

#include <initializer_list>
#include <limits>
#include <vector>

#include "tools/options.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

constexpr double kFullTurns = 1e6;
constexpr double kHighest = 1e9;
constexpr int kMostOrders = 64;
constexpr int kLargestPicture = 16384;
constexpr int kMostTiles = 256;
constexpr int kLargestTile = 2048;
constexpr int kSkySize = 32;         // a sky is smooth: the prefilter's mips need no more
constexpr int kSkyBackground = 128;  // as many texels round the horizon as the picture has

void add_sun_place(CLI::App& command, SkyParameters& sky) {
  command
      .add_option("--sun-elevation", sky.sun_elevation_degrees,
                  "Degrees of the sun above the horizon, -90 to 90; default 40. With --sweep the first picture's, "
                  "default 90")
      ->check(finite_between(-90.0, 90.0))
      ->type_name("DEGREES");
  command
      .add_option("--sun-azimuth", sky.sun_azimuth_degrees,
                  "Where the sun stands round the vertical: from +z towards +x; default 0")
      ->check(finite_between(-kFullTurns, kFullTurns))
      ->type_name("DEGREES");
  command.add_option("--altitude", sky.altitude_m, "Metres above the ground; above the air is space; default 0")
      ->check(finite_between(0.0, kHighest))
      ->type_name("METRES");
  command.add_flag_callback(
      "--no-ground", [&sky] { sky.view.ground = false; },
      "Below the horizon only the air before the ground, not the ground itself");
}

void set_table_size(SkyTableOptions& tables, const std::vector<int>& sizes) {
  if (sizes.size() < 3 || sizes.size() > 4) {
    throw CLI::ValidationError("--table-size", "wants three numbers, HEIGHTS,VIEWS,SUNS, or a fourth, AZIMUTHS");
  }
  tables.heights = sizes[0];
  tables.view_zeniths = sizes[1];
  tables.sun_zeniths = sizes[2];
  if (sizes.size() > 3) tables.sun_angles = sizes[3];
}

void add_table_options(CLI::App& command, SkyOptions& options) {
  SkyTableOptions& tables = options.sky.tables;
  command
      .add_option("--orders", tables.orders, "Orders of scattering, ground reflections included, 1 to 64; default 4")
      ->check(CLI::Range(1, kMostOrders).description(""))
      ->type_name("N");
  command
      .add_option("--until-change", tables.until_change,
                  "Stop before --orders when one added less than this share of all light before it; default 0: never")
      ->check(finite_between(0.0, 1.0))
      ->type_name("SHARE");
  add_choice<SkyColour>(
      command, "--colour", tables.colour, {{"spectral", SkyColour::spectral}, {"srgb", SkyColour::linear_srgb}},
      "What r, g and b are: radiance at three wavelengths, W/m2/sr/nm (default), or luminance in linear sRGB, cd/m2 "
      "(default with --sweep)");
  add_choice<ScatteringLayout>(command, "--layout", tables.layout,
                               {{"full", ScatteringLayout::full}, {"compact", ScatteringLayout::compact}},
                               "Scattering tables with four dimensions (default) or, smaller and less exact, three");
  command
      .add_option_function<std::vector<int>>(
          "--table-size", [&tables](const std::vector<int>& sizes) { set_table_size(tables, sizes); },
          "Their size: HEIGHTS,VIEWS,SUNS and of full ones AZIMUTHS; default 32,64,64,8")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST");
  command
      .add_option("--tables", options.sky.tables_file,
                  "Keep the tables in this file: taken from there if they are those asked for, else made and saved")
      ->type_name("FILE");
}

void add_quadrature_options(CLI::App& command, SkyHarmonicsOptions& options) {
  add_choice<SkyQuadrature>(
      command, "--quadrature", options.quadrature,
      {{name(SkyQuadrature::article), SkyQuadrature::article},
       {name(SkyQuadrature::gauss), SkyQuadrature::gauss},
       {name(SkyQuadrature::gauss_split), SkyQuadrature::gauss_split}},
      "Directions that the harmonics are summed over: evenly in angles; by Gauss nodes; the same with the "
      "glow about the sun apart (default)");
  command
      .add_option_function<std::vector<int>>(
          "--directions",
          [&options](const std::vector<int>& counts) {
            options.zeniths = counts[0];
            options.azimuths = counts[1];
          },
          "How many: ZENITHS on either side of the horizon (article: over both), 2 to 128, and AZIMUTHS over half the "
          "circle, 2 to 256, the other half being its mirror image; default 16,16")
      ->delimiter(',')
      ->expected(2)
      ->type_name("Z,A");
}

/// Two that make no sense together are refused rather than one of them ignored.
void exclude(CLI::Option& option, std::initializer_list<const char*> others) {
  for (const char* other : others) option.excludes(other);
}

void add_sweep_options(CLI::App& command, SweepOptions& sweep) {
  CLI::Option* path = command
                          .add_option("--sweep", sweep.path,
                                      "Draw a day as pictures side by side, to a PNG and a text beside it that has "
                                      "each one's sun")
                          ->type_name("FILE.png");
  exclude(*path,
          {"--format", "--json", "--sun-azimuth", "--quadrature", "--directions", "--bands", "--window", "--for"});
  command.add_option("--sweep-to", sweep.last_degrees, "Sun elevation of the last picture; default -18")
      ->check(finite_between(-90.0, 90.0))
      ->type_name("DEGREES")
      ->needs(path);
  command.add_option("--sweep-tiles", sweep.tiles, "How many pictures, 1 to 256; default 16")
      ->check(CLI::Range(1, kMostTiles).description(""))
      ->type_name("N")
      ->needs(path);
  command.add_option("--sweep-size", sweep.size, "Height of each in pixels, 8 to 2048; default 192")
      ->check(CLI::Range(8, kLargestTile).description(""))
      ->type_name("N")
      ->needs(path);
  add_choice<SweepView>(command, "--sweep-view", sweep.view,
                        {{"panorama", SweepView::panorama}, {"fisheye", SweepView::fisheye}},
                        "Half way round with the sun in the middle (default), or all of the sky above")
      ->needs(path);
}

void add_folder_options(CLI::App& command, SkyOptions& options) {
  options.bake.specular.size = kSkySize;
  options.bake.bake.background_size = kSkyBackground;
  options.bake.all_mips = true;  // 32 texels down to 16 would be two
  CLI::Option* folder =
      command
          .add_option("-o,--output", options.bake.directory,
                      "A folder to bake the sky to, as 'welkin bake' does, sky.exr beside; --json then prints its "
                      "manifest")
          ->type_name("DIR");
  exclude(*folder, {"--format", "--window", "--sweep", "--quadrature", "--directions"});
  const std::size_t before = command.get_options().size();
  command
      .add_option("--picture-height", options.picture_height,
                  "Height of sky.exr, from which all else is made; its width is twice that; default 256")
      ->check(CLI::Range(1, kLargestPicture).description(""))
      ->type_name("N");
  command.add_flag("--sun-disc", options.sun_disc, "The sun's disc in the picture; else it is apart");
  add_result_options(command, options.bake);
  const std::vector<CLI::Option*> all = command.get_options({});
  for (std::size_t i = before; i < all.size(); ++i) all[i]->needs(folder);
}

}  // namespace

void add_sky_options(CLI::App& command, SkyOptions& options) {
  add_sun_place(command, options.sky);
  add_atmosphere_options(command, options.sky.atmosphere);
  command.add_flag("--print-atmosphere", options.print_atmosphere,
                   "Print the air as JSON, to be changed and read by --atmosphere, and do nothing else");
  add_table_options(command, options);
  add_quadrature_options(command, options.quadrature);
  add_format_options(command, options.sh);
  add_bands_option(command, options.sh);
  add_window_options(command, options.sh);
  add_engine_option(command, options.sh.turn);
  add_sweep_options(command, options.sweep);
  add_folder_options(command, options);
  add_memory_limit_option(command, options.sh.common);
  add_threads_option(command, options.sh.common);
}

void settle(SkyOptions& options, const CLI::App& command) {
  SkyTableOptions& tables = options.sky.tables;
  tables.memory_limit_bytes = options.sh.common.read.memory_limit_bytes;
  options.quadrature.bands = options.sh.projection.bands;
  if (!options.sweep.path.empty()) {
    if (command.count("--colour") == 0) tables.colour = SkyColour::linear_srgb;
    if (command.count("--sun-elevation") > 0) options.sweep.first_degrees = options.sky.sun_elevation_degrees;
  }
  if (command.count("--mips") == 0 && !options.bake.roughness.table.empty()) options.bake.all_mips = false;
  options.wants_folder = command.count("-o") > 0;
  options.bake.common = options.sh.common;
  options.bake.common.json = options.sh.format == ShFormat::json;
  options.bake.turn.to = options.sh.turn.to;
  options.bake.bake.bands = options.sh.projection.bands;
  options.bake.picture_name = "sky.exr";
}

}  // namespace welkin::tool
