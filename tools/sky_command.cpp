// `welkin sky`: the light of a computed sky.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "embedded_texts.h"
#include "tools/bake_options.h"
#include "tools/baked.h"
#include "tools/commands.h"
#include "tools/sh_command.h"
#include "tools/sky_sweep.h"
#include "tools/terminal.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

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

struct SkyOptions {
  SkyParameters sky;
  SkyHarmonicsOptions quadrature;
  ShOptions sh;  ///< threads, memory, bands, window, whose axes, form of the result
  bool print_atmosphere = false;

  bool wants_folder = false;  ///< -o
  BakeCommandOptions bake;
  int picture_height = 256;
  bool sun_disc = false;

  SweepOptions sweep;  ///< its path empty: no sweep
};

void add_sun_place(Options& table, SkyParameters& sky) {
  table.push_back({.names = "--sun-elevation",
                   .target = &sky.sun_elevation_degrees,
                   .text =
                       "The sun's elevation above the horizon, -90 to 90; default 40. With --sweep that of the first "
                       "picture, default 90",
                   .type = "DEGREES",
                   .bounds = finite_between(-90.0, 90.0)});
  table.push_back({.names = "--sun-azimuth",
                   .target = &sky.sun_azimuth_degrees,
                   .text = "The sun's azimuth, counted from +z towards +x; default 0",
                   .type = "DEGREES",
                   .bounds = finite_between(-kFullTurns, kFullTurns)});
  table.push_back({.names = "--altitude",
                   .target = &sky.altitude_m,
                   .text = "The observer's height above the ground; default 0",
                   .type = "METRES",
                   .bounds = finite_between(0.0, kHighest)});
  table.push_back({.names = "--no-ground",
                   .target = OnFlag([&sky] { sky.view.ground = false; }),
                   .text = "Show below the horizon only the air in front of the ground, and not the ground"});
}

void set_table_size(SkyTableOptions& tables, const std::vector<int>& sizes) {
  if (sizes.size() < 3 || sizes.size() > 4) {
    throw BadValue{"--table-size", "needs three numbers, HEIGHTS,VIEWS,SUNS, or a fourth, AZIMUTHS"};
  }
  tables.heights = sizes[0];
  tables.view_zeniths = sizes[1];
  tables.sun_zeniths = sizes[2];
  if (sizes.size() > 3) tables.sun_angles = sizes[3];
}

void add_table_options(Options& table, SkyOptions& options) {
  SkyTableOptions& tables = options.sky.tables;
  table.push_back({.names = "--orders",
                   .target = &tables.orders,
                   .text = "Orders of scattering, ground reflections included, 1 to 64; default 4",
                   .type = "N",
                   .bounds = whole_between(1, kMostOrders)});
  table.push_back(
      {.names = "--until-change",
       .target = &tables.until_change,
       .text = "Stop before --orders when an order adds less than this fraction of the light before it; default "
               "0: never",
       .type = "SHARE",
       .bounds = finite_between(0.0, 1.0)});
  table.push_back({.names = "--exact-orders",
                   .target = OnFlag([&tables] { tables.exact_orders = true; }),
                   .text = "Omit light of more than --orders orders, which is otherwise estimated"});
  table.push_back(choice<SkyColour>(
      "--colour", tables.colour, {{"spectral", SkyColour::spectral}, {"srgb", SkyColour::linear_srgb}},
      "What r, g and b are: radiance at three wavelengths, W/m2/sr/nm, or luminance in linear sRGB, cd/m2; default "
      "spectral, but srgb with --sweep"));
  table.push_back(choice<ScatteringLayout>(
      "--layout", tables.layout, {{"full", ScatteringLayout::full}, {"compact", ScatteringLayout::compact}},
      "Scattering tables with four dimensions (default) or, smaller and less exact, three"));
  const auto set_size = [&tables](const std::vector<int>& sizes) { set_table_size(tables, sizes); };
  table.push_back(
      {.names = "--table-size",
       .target = On<std::vector<int>>(set_size),
       .text = "The size of the tables: HEIGHTS,VIEWS,SUNS and, with --layout full, AZIMUTHS; default 32,64,64,8",
       .type = "LIST",
       .list = List::commas});
  table.push_back(
      {.names = "--tables",
       .target = &options.sky.tables_file,
       .text = "Keep the tables in this file. They are loaded if they are the ones asked for, else computed and "
               "saved",
       .type = "FILE"});
}

void add_quadrature_options(Options& table, SkyHarmonicsOptions& options) {
  table.push_back(choice<SkyQuadrature>(
      "--quadrature", options.quadrature,
      {{name(SkyQuadrature::uniform), SkyQuadrature::uniform},
       {name(SkyQuadrature::gauss), SkyQuadrature::gauss},
       {name(SkyQuadrature::gauss_split), SkyQuadrature::gauss_split}},
      "Directions of the projection: uniform in angles; Gauss nodes; or those with the glow around "
      "the sun integrated separately (default)"));
  const auto set_counts = [&options](const std::vector<int>& counts) {
    options.zeniths = counts[0];
    options.azimuths = counts[1];
  };
  table.push_back(
      {.names = "--directions",
       .target = On<std::vector<int>>(set_counts),
       .text = "The number of directions: ZENITHS on either side of the horizon (uniform: over both), 2 to 128, and "
               "AZIMUTHS over half the circle, 2 to 256; the other half is its mirror image; default 16,16",
       .type = "Z,A",
       .list = List::commas_or_spaces,
       .count = 2});
}

/// Options that make no sense together are refused rather than one of them ignored.
void add_sweep_options(Options& table, SweepOptions& sweep) {
  constexpr const char* kSweep = "--sweep";
  table.push_back(
      {.names = kSweep,
       .target = &sweep.path,
       .text = "Draw a day as pictures side by side, to a PNG; a text file next to it lists the sun of each picture",
       .type = "FILE.png",
       .excludes = {"--format", "--json", "--sun-azimuth", "--quadrature", "--directions", "--bands", "--window",
                    "--for"}});
  table.push_back({.names = "--sweep-to",
                   .target = &sweep.last_degrees,
                   .text = "Sun elevation of the last picture; default -18",
                   .type = "DEGREES",
                   .bounds = finite_between(-90.0, 90.0),
                   .needs = {kSweep}});
  table.push_back({.names = "--sweep-tiles",
                   .target = &sweep.tiles,
                   .text = "How many pictures, 1 to 256; default 16",
                   .type = "N",
                   .bounds = whole_between(1, kMostTiles),
                   .needs = {kSweep}});
  table.push_back({.names = "--sweep-size",
                   .target = &sweep.size,
                   .text = "Height of each in pixels, 8 to 2048; default 192",
                   .type = "N",
                   .bounds = whole_between(8, kLargestTile),
                   .needs = {kSweep}});
  table.push_back(choice<SweepView>("--sweep-view", sweep.view,
                                    {{"panorama", SweepView::panorama}, {"fisheye", SweepView::fisheye}},
                                    "Half way round with the sun in the middle (default), or all of the sky above"));
  table.back().needs = {kSweep};
}

void add_folder_options(Options& table, SkyOptions& options) {
  options.bake.specular.size = kSkySize;
  options.bake.background_size = kSkyBackground;
  table.push_back({.names = "-o,--output",
                   .target = &options.bake.directory,
                   .text =
                       "A folder to bake the sky to, as 'welkin bake' does, with its picture sky.exr; default none; "
                       "--json then prints the manifest",
                   .type = "DIR",
                   .excludes = {"--format", "--window", "--sweep", "--quadrature", "--directions"}});
  const std::size_t before = table.size();
  table.push_back(
      {.names = "--picture-height",
       .target = &options.picture_height,
       .text = "The height of sky.exr, from which everything else is made; it is twice as wide; default 256",
       .type = "N",
       .bounds = whole_between(1, kLargestPicture)});
  table.push_back({.names = "--sun-disc",
                   .target = &options.sun_disc,
                   .text = "Draw the sun's disc into the picture; by default it is left out"});
  in_group(table, "A folder, as 'welkin bake' makes it");
  add_result_options(table, options.bake);
  for (std::size_t i = before; i < table.size(); ++i) table[i].needs.emplace_back("-o");
}

void add_sky_options(Options& table, SkyOptions& options) {
  add_sun_place(table, options.sky);
  in_group(table, "Sun and observer");
  add_atmosphere_options(table, options.sky.atmosphere);
  table.push_back(
      {.names = "--print-atmosphere",
       .target = &options.print_atmosphere,
       .text = "Print the atmosphere as JSON, which you can change and give to --atmosphere, and do nothing else"});
  in_group(table, "Air and ground");
  add_table_options(table, options);
  in_group(table, "Tables of the scattering");
  add_quadrature_options(table, options.quadrature);
  add_format_options(table, options.sh);
  add_bands_option(table, options.sh);
  add_window_options(table, options.sh);
  add_engine_option(table, options.sh.turn);
  option(table, "--for").text += ". With -o the folder holds what that engine loads, as of 'welkin bake'";
  in_group(table, "Harmonics and output");
  add_sweep_options(table, options.sweep);
  in_group(table, "A day");
  add_folder_options(table, options);
  add_memory_limit_option(table, options.sh.common);
  add_threads_option(table, options.sh.common);
}

/// What the options mean together; called once they are all read.
void settle(SkyOptions& options, const Given& given) {
  SkyTableOptions& tables = options.sky.tables;
  tables.memory_limit_bytes = options.sh.common.read.memory_limit_bytes;
  options.quadrature.bands = options.sh.projection.bands;
  if (!options.sweep.path.empty()) {
    if (!given("--colour")) tables.colour = SkyColour::linear_srgb;
    if (given("--sun-elevation")) options.sweep.first_degrees = options.sky.sun_elevation_degrees;
  }
  options.wants_folder = given("-o");
  options.bake.common = options.sh.common;
  options.bake.common.json = options.sh.format == ShFormat::json;
  options.bake.turn.to = options.sh.turn.to;
  options.bake.bake.bands = options.sh.projection.bands;
  options.bake.picture_name = "sky.exr";
  settle_files(options.bake);
}

constexpr int kMostZeniths = 128;
constexpr int kMostAzimuths = 256;

double relative_difference(const SphericalHarmonics& coarse, const SphericalHarmonics& fine) {
  double difference = 0.0;
  double power = 0.0;
  for (std::size_t i = 0; i < fine.coefficients().size(); ++i) {
    const glm::dvec3 change = coarse.coefficients()[i] - fine.coefficients()[i];
    difference += glm::dot(change, change);
    power += glm::dot(fine.coefficients()[i], fine.coefficients()[i]);
  }
  return power > 0.0 ? std::sqrt(difference / power) : 0.0;
}

/// What a quadrature of twice as many nodes each way says otherwise. Of the tables' own error it knows nothing.
double error_estimate(const Sky& sky, const SkyHarmonicsOptions& options, const SphericalHarmonics& radiance) {
  SkyHarmonicsOptions finer = options;
  finer.quadrature = SkyQuadrature::gauss_split;
  finer.zeniths = std::min(2 * options.zeniths, kMostZeniths);
  finer.azimuths = std::min(2 * options.azimuths, kMostAzimuths);
  return relative_difference(radiance, SkyProjector(sky.view, finer).project(sky.sun));
}

/// Of the sky, and of sky and sun together.
void describe_light(const Sky& sky, ShReport& report) {
  const double sphere = std::sqrt(4.0 * std::numbers::pi);  // band 0 is the mean radiance times that
  ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  diagnostics.total_radiance = sphere * report.projection.radiance.coefficients().front();
  diagnostics.total_radiance_before_clamp = diagnostics.total_radiance;
  report.sun_wanted = true;
  report.sun = sky.view.sun(sky.sun);
  report.sun->total_radiance_after = diagnostics.total_radiance;
  report.sun->total_radiance_before = diagnostics.total_radiance + report.sun->irradiance;
}

/// Makes or loads tables, projects the sky, turns it to the engine's axes, windows. Shows a progress bar on a terminal.
/// Throws what the library throws.
ShReport measure_sky(const SkyOptions& options) {
  ProgressBar bar;
  const Control control = bar.control();
  begin_stage("tables");
  const Sky sky = make_sky(options.sky, control);
  ShReport report;
  report.source = {"computed sky", "directions", 0, 0, "computed", "from tables of the scattering", {}};
  report.options = options.sh.projection;
  report.sky = sky.report;
  report.sky->quadrature = options.quadrature;
  ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  diagnostics.passes = sky.passes;
  report.projection.radiance = timed(diagnostics.passes, "project", "the sky along the quadrature's directions", [&] {
    const SkyProjector projector(sky.view, options.quadrature);
    report.sky->directions = projector.directions();
    return projector.project(sky.sun);
  });
  diagnostics.texels = static_cast<std::uint64_t>(report.sky->directions);
  diagnostics.error_estimate = error_estimate(sky, options.quadrature, report.projection.radiance);
  describe_light(sky, report);
  const glm::dmat3 matrix = turn_of_light(options.sh.turn, false);
  if (matrix != glm::dmat3(1.0)) {
    report.projection.radiance = turned(report.projection.radiance, matrix);
    report.sun->direction = matrix * report.sun->direction;
  }
  complete(report, options.sh);
  return report;
}

std::string sweep(const SkyOptions& options) {
  ProgressBar bar;
  return write_sweep(options.sky, options.sweep, bar.control());
}

/// The sky as a picture, and all else from that.
std::string bake_sky(const SkyOptions& options) {
  constexpr double kTables = 0.9;
  BakeCommandOptions bake = options.bake;
  for (const std::optional<std::string>& file : {options.sky.atmosphere.file, options.sky.tables_file}) {
    if (file) bake.also_read.push_back(*file);
  }
  bake.compute = [&options](const Control& control) {
    const Sky sky = make_sky(options.sky, part_of(control, 0.0, kTables));
    return sky_picture(sky, options.picture_height, options.sun_disc, part_of(control, kTables, 1.0));
  };
  return bake_to_folder(bake);
}

std::string answer(const SkyOptions& options) {
  if (options.print_atmosphere) {
    return json_text(atmosphere_json(chosen_atmosphere(options.sky.atmosphere, options.sky.tables.colour)));
  }
  if (!options.sweep.path.empty()) return sweep(options);
  if (options.wants_folder) return bake_sky(options);
  return sh_formatted(measure_sky(options), options.sh.format);
}

void run(SkyOptions& options, const Given& given) {
  settle(options, given);
  std::string text;
  run_with_threads(options.sh.common.threads, [&] { text = answer(options); });
  const bool to_files = options.wants_folder || !options.sweep.path.empty();
  if (to_files && options.sh.format != ShFormat::json && !options.print_atmosphere) {
    print_summary(text);
  } else {
    print_result(text);
  }
}

}  // namespace

Command sky_command() {
  const auto options = std::make_shared<SkyOptions>();
  Command command{"sky", "The light of a computed sky", embedded_text("help/sky.txt")};
  add_sky_options(command.options, *options);
  command.everyday = {"--sun-elevation", "--sun-azimuth", "--altitude", "--preset", "--ground-albedo",
                      "--colour",        "--json",        "--for",      "--tables", "--sweep",
                      "--output",        "--size",        "--threads",  "--quiet"};
  command.run = [options](const Given& given) { run(*options, given); };
  return command;
}

}  // namespace welkin::tool
