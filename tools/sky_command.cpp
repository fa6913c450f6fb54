// `welkin sky`: the light of a computed sky.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "embedded_texts.h"
#include "platform/text.h"
#include "tools/bake_options.h"
#include "tools/baked.h"
#include "tools/chain_check.h"
#include "tools/commands.h"
#include "tools/preview_light.h"
#include "tools/sh_command.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

// --sweep: a day as a strip of images.

enum class SweepView {
  fisheye,   ///< the sky above: zenith in the middle, horizon at the rim, the sun's azimuth up
  panorama,  ///< 180 degrees wide, the sun's azimuth in the middle, from a little below the horizon to the zenith
};

struct SweepOptions {
  std::string path;
  double first_degrees = 90.0;  ///< sun elevation of the first tile
  double last_degrees = -18.0;
  int tiles = 16;
  int size = 192;  ///< height of a tile, pixels
  SweepView view = SweepView::panorama;
};

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kBelowHorizon = 6.0;  // degrees of a panorama
constexpr double kPanoramaHeight = 90.0 + kBelowHorizon;
constexpr double kPanoramaWidth = 180.0;
constexpr int kSampling = 3;
constexpr int kGap = 4;
constexpr double kSweepTables = 0.5;  // of the progress
constexpr double kCloseToHorizon = 6.0;
constexpr glm::dvec3 kBackground(0.0);

/// Eyes and cameras adapt to most of the change between noon and night, but not to all of it: exposure follows this
/// power of the brightness.
constexpr double kAdaptation = 0.85;
constexpr double kNoonBrightness = 0.2;  ///< of the first tile, before the tone curve

struct Tile {
  double elevation = 0.0;
  glm::dvec3 sun{};
  ToneMap tone_map;
};

/// The directions of a tile's points; a round tile has none outside of its circle.
class Lens {
 public:
  Lens(SweepView view, int size) : view_(view), size_(size) {}

  [[nodiscard]] int width() const {
    if (view_ == SweepView::fisheye) return size_;
    return static_cast<int>(std::lround(size_ * kPanoramaWidth / kPanoramaHeight));
  }
  [[nodiscard]] int tiles_per_row() const { return view_ == SweepView::fisheye ? 8 : 4; }

  /// `x`: to the right, `y`: down, in pixels. Returns false if the point has no direction.
  [[nodiscard]] bool direction(double x, double y, glm::vec3& towards) const {
    if (view_ == SweepView::panorama) {
      const double azimuth = (0.5 - x / width()) * kPanoramaWidth * kDegree;
      const double elevation = (90.0 - y / size_ * kPanoramaHeight) * kDegree;
      towards = {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
      return true;
    }
    // As seen lying down, feet away from the sun: its azimuth is up, +x to the left.
    const double u = 1.0 - 2.0 * x / size_;
    const double v = 1.0 - 2.0 * y / size_;
    const double radius = std::sqrt(u * u + v * v);
    if (radius > 1.0) return false;
    const double zenith = radius * 0.5 * std::numbers::pi;
    const double share = radius > 0.0 ? std::sin(zenith) / radius : 0.0;
    towards = {share * u, std::cos(zenith), share * v};
    return true;
  }

 private:
  SweepView view_;
  int size_;
};

/// Returns the mean luminance of the sky above the horizon. (A mean without the brightest parts, as for the previews,
/// would leave the glow of dusk white.)
double brightness(const Sky& sky, const glm::dvec3& sun) {
  constexpr int kRows = 64;
  const LatLongImage around = sky_lat_long(sky.view, sun, kRows);
  double sum = 0.0;
  double weights = 0.0;
  const float* rgb = around.pixels.data();
  for (int row = 0; row < kRows / 2; ++row) {
    const double weight = std::cos((0.5 - (row + 0.5) / kRows) * std::numbers::pi);
    for (int column = 0; column < around.width; ++column, rgb += 3) {
      const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
      sum += weight * luminance;
      weights += weight;
    }
  }
  return sum / weights;
}

/// `noon`: brightness of the first tile.
Tile tile_at(const Sky& sky, double elevation, double noon) {
  Tile tile{elevation, sun_direction(elevation, 0.0), {}};
  const double here = brightness(sky, tile.sun);
  if (noon > 0.0 && here > 0.0) tile.tone_map.exposure = kNoonBrightness / noon * std::pow(noon / here, kAdaptation);
  return tile;
}

/// Returns the sine of the elevation at which the ground begins: below 0 from a height.
double horizon_sine(const SkyReport& report) {
  const double away = report.altitude_m / (report.atmosphere.bottom_radius_m + report.altitude_m);
  return -std::sqrt(away * (2.0 - away));  // 1 - (bottom / distance)^2, without cancellation
}

/// Returns the sun's radiance in directions within its radius and above the horizon; else 0.
glm::dvec3 disc(const Sun& sun, double horizon, const glm::dvec3& towards) {
  const double rim = std::cos(sun.angular_radius_degrees * kDegree);
  return towards.y > horizon && glm::dot(towards, sun.direction) > rim ? sun.radiance : glm::dvec3(0.0);
}

/// Draws one row of pixels at a time, with all its directions in one call.
void draw(const Sky& sky, const Tile& tile, const Lens& lens, int size, int left, int top, PreviewImage& image) {
  const Sun sun = sky.view.sun_light(tile.sun);
  const double horizon = horizon_sine(sky.report);
  const auto samples = static_cast<std::size_t>(lens.width()) * kSampling * kSampling;
  std::vector<glm::vec3> directions(samples);
  std::vector<glm::vec3> radiance(samples);
  std::vector<bool> seen(samples);
  for (int row = 0; row < size; ++row) {
    for (std::size_t i = 0; i < samples; ++i) {
      const std::size_t pixel = i / (kSampling * kSampling);
      const double x = static_cast<double>(pixel) + (static_cast<double>(i % kSampling) + 0.5) / kSampling;
      const double y = row + (static_cast<double>(i / kSampling % kSampling) + 0.5) / kSampling;
      directions[i] = {0.0F, 1.0F, 0.0F};
      seen[i] = lens.direction(x, y, directions[i]);
    }
    sky.view.radiance(directions, tile.sun, radiance);
    for (int column = 0; column < lens.width(); ++column) {
      glm::dvec3 sum(0.0);
      for (std::size_t k = 0; k < kSampling * kSampling; ++k) {
        const std::size_t i = static_cast<std::size_t>(column) * kSampling * kSampling + k;
        const glm::dvec3 light = glm::dvec3(radiance[i]) + disc(sun, horizon, glm::dvec3(directions[i]));
        sum += seen[i] ? tile.tone_map(light) : kBackground;
      }
      image.set(left + column, top + row, glm::vec3(sum / static_cast<double>(kSampling * kSampling)));
    }
  }
}

std::string tile_line(const Sky& sky, const Tile& tile, std::size_t number) {
  constexpr double kJustUp = 0.5;
  const auto cells = [](const glm::dvec3& rgb) {
    return pad_left(significant(rgb.x, 3), 11) + pad_left(significant(rgb.y, 3), 11) +
           pad_left(significant(rgb.z, 3), 11);
  };
  return pad_left(std::to_string(number + 1), 5) + pad_left(significant(tile.elevation, 3), 11) +
         cells(sky.view.radiance({0.0, 1.0, 0.0}, tile.sun)) +
         cells(sky.view.radiance(sun_direction(kJustUp, 0.0), tile.sun)) +
         cells(sky.view.radiance(sun_direction(kJustUp, 180.0), tile.sun)) +
         cells(sky.view.sun_light(tile.sun).irradiance) + pad_left(significant(tile.tone_map.exposure, 3), 11) + '\n';
}

std::string head_lines(const Sky& sky, const SweepOptions& options) {
  return printable(platform::utf8(platform::path_of(options.path).filename())) + ": " +
         printable(sky.report.atmosphere.name) + ", altitude " + significant(sky.report.altitude_m) +
         " m; tiles row by row from the left\n" + "  r, g, b in " + sky_unit(sky.report) +
         "; the sun's light is its irradiance on a surface facing it\n\n" + " tile  elevation" +
         pad_right("     zenith", 33) + pad_right("     horizon below the sun", 33) +
         pad_right("     horizon opposite", 33) + pad_right("     sun", 33) + "   exposure\n";
}

std::filesystem::path text_path(const SweepOptions& options) {
  return platform::path_of(options.path).replace_extension(".txt");
}

void check(const SkyParameters& parameters, const SweepOptions& options) {
  const std::filesystem::path path = platform::path_of(options.path);
  if (path.extension() != ".png") {
    throw Error(ErrorCode::invalid_argument, options.path + ": --sweep draws a PNG; give a name that ends with .png");
  }
  for (const std::optional<std::string>& read : {parameters.atmosphere.file, parameters.tables_file}) {
    for (const std::filesystem::path& written : {path, text_path(options)}) {
      if (read) require_kept(*read, written, "--sweep", "give the image another name");
    }
  }
}

/// Sun elevations of the tiles, degrees to a tenth: closer together near the horizon, where the sky changes fast.
std::vector<double> sweep_elevations(const SweepOptions& options) {
  const double first = std::asinh(options.first_degrees / kCloseToHorizon);
  const double last = std::asinh(options.last_degrees / kCloseToHorizon);
  std::vector<double> elevations;
  for (int i = 0; i < options.tiles; ++i) {
    const double share = options.tiles > 1 ? static_cast<double>(i) / (options.tiles - 1) : 0.0;
    elevations.push_back(std::round(10.0 * kCloseToHorizon * std::sinh(first + share * (last - first))) / 10.0);
  }
  return elevations;
}

/// Draws and writes the image, a PNG, and a text next to it with the sun's elevation and the sky's brightness for each
/// tile; returns the text. Throws `Error`: file_access if one of them would overwrite a file that is read.
std::string write_sweep(const SkyParameters& parameters, const SweepOptions& options, const Control& control) {
  check(parameters, options);
  begin_stage("tables");
  const Sky sky = make_sky(parameters, part_of(control, 0.0, kSweepTables));
  const Control drawing = part_of(control, kSweepTables, 1.0);
  begin_stage("draw");
  const std::vector<double> elevations = sweep_elevations(options);
  const Lens lens(options.view, options.size);
  const int columns = std::min(options.tiles, lens.tiles_per_row());
  const int rows = (options.tiles + columns - 1) / columns;
  PreviewImage image(columns * (lens.width() + kGap) - kGap, rows * (options.size + kGap) - kGap,
                     glm::vec3(kBackground));
  std::string text = head_lines(sky, options);
  const double noon = brightness(sky, sun_direction(elevations.front(), 0.0));
  for (std::size_t i = 0; i < elevations.size(); ++i) {
    const Tile tile = tile_at(sky, elevations[i], noon);
    const auto point = static_cast<int>(i);
    draw(sky, tile, lens, options.size, point % columns * (lens.width() + kGap),
         point / columns * (options.size + kGap), image);
    text += tile_line(sky, tile, i);
    if (drawing.progress) drawing.progress(static_cast<double>(i + 1) / static_cast<double>(elevations.size()));
  }
  image.save(platform::path_of(options.path));
  write_text_file(text_path(options), text);
  return text;
}

// The command.

constexpr double kFullTurns = 1e6;
constexpr double kHighest = 1e9;
constexpr int kMaxOrders = 64;
constexpr int kLargestImage = 16384;
constexpr int kMaxTiles = 256;
constexpr int kLargestTile = 2048;
constexpr int kSkySize = 32;         // a sky is smooth: the prefilter needs no more for its mips
constexpr int kSkyBackground = 128;  // as many texels around the horizon as the image

struct SkyOptions {
  SkyParameters sky;
  DatedSun dated;  ///< --date and its observer
  SkyHarmonicsOptions quadrature;
  ShOptions sh;  ///< threads, memory, bands, window, axes, form of the result
  bool print_atmosphere = false;

  bool wants_folder = false;  ///< -o
  BakeCommandOptions bake;
  int image_height = 256;
  bool sun_disc = false;

  SweepOptions sweep;  ///< no sweep if its path is empty
};

void add_sun_place(Options& table, SkyOptions& options) {
  SkyParameters& sky = options.sky;
  add_option(table, "--sun-elevation", &sky.sun_elevation_degrees, "DEGREES",
             "The sun's elevation above the horizon, -90 to 90; default 40. With --sweep that of the first image, "
             "default 90",
             {.bounds = number_between(-90.0, 90.0)});
  add_option(table, "--sun-azimuth", &sky.sun_azimuth_degrees, "DEGREES",
             "The sun's azimuth, counted from +z towards +x; default 0",
             {.bounds = number_between(-kFullTurns, kFullTurns)});
  add_option(
      table, "--date", &options.dated.date, "DATE",
      "Place the sun by date and time, with time zone: 2026-06-21T18:30Z or 2026-06-21T20:30+02:00, 1900 to 2099",
      {.needs = {"--at"}, .excludes = {"--sun-elevation", "--sun-azimuth", "--sweep"}});
  const auto set_place = [&options](const std::vector<double>& point) {
    options.dated.observer.latitude_degrees = point[0];
    options.dated.observer.longitude_degrees = point[1];
  };
  add_option(table, "--at", On<std::vector<double>>(set_place), "LATITUDE,LONGITUDE",
             "The place of --date, degrees, positive in the north and in the east",
             {.list = List::commas, .count = 2, .needs = {"--date"}});
  add_option(table, "--refraction", &options.dated.observer.refraction, "",
             "Raise the sun of --date by the refraction of air, half a degree on the horizon", {.needs = {"--date"}});
  add_option(table, "--north", &options.dated.observer.north_azimuth_degrees, "DEGREES",
             "The azimuth of north for --date; default 180: north is -z and east +x",
             {.bounds = number_between(-kFullTurns, kFullTurns), .needs = {"--date"}});
  add_option(table, "--altitude", &sky.altitude_m, "METRES", "The observer's height above the ground; default 0",
             {.bounds = number_between(0.0, kHighest)});
  add_option(table, "--no-ground", OnFlag([&sky] { sky.view.ground = false; }), "",
             "Show below the horizon only the air in front of the ground, and not the ground");
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
  add_option(table, "--orders", &tables.orders, "N",
             "Orders of scattering, ground reflections included, 1 to 64; default 4",
             {.bounds = whole_between(1, kMaxOrders)});
  add_option(table, "--convergence-threshold", &tables.convergence_threshold, "SHARE",
             "Stop before --orders when an order adds less than this fraction of the light before it; default "
             "0: never",
             {.bounds = number_between(0.0, 1.0)});
  add_option(table, "--truncate-orders", OnFlag([&tables] { tables.truncate_orders = true; }), "",
             "Omit light of more than --orders orders, which is otherwise estimated");
  table.push_back(choice<SkyColour>(
      "--colour", tables.colour, {{"spectral", SkyColour::spectral}, {"srgb", SkyColour::linear_srgb}},
      "What r, g and b are: radiance at three wavelengths, W/m2/sr/nm, or luminance in linear sRGB, cd/m2; default "
      "spectral, but srgb with --sweep"));
  table.push_back(choice<ScatteringLayout>(
      "--layout", tables.layout, {{"full", ScatteringLayout::full}, {"compact", ScatteringLayout::compact}},
      "Scattering tables with four dimensions (default) or, smaller and less exact, three"));
  const auto set_size = [&tables](const std::vector<int>& sizes) { set_table_size(tables, sizes); };
  add_option(table, "--table-size", On<std::vector<int>>(set_size), "LIST",
             "The size of the tables: HEIGHTS,VIEWS,SUNS and, with --layout full, AZIMUTHS; default 32,64,64,8",
             {.list = List::commas});
  add_option(
      table, "--tables", &options.sky.tables_file, "FILE",
      "Keep the tables in this file. They are loaded if they have the requested parameters, else computed and saved");
}

void add_quadrature_options(Options& table, SkyHarmonicsOptions& options) {
  table.push_back(choice<SkyQuadrature>(
      "--quadrature", options.quadrature,
      by_name({SkyQuadrature::uniform, SkyQuadrature::gauss, SkyQuadrature::gauss_split}),
      "Directions of the projection: uniform in angles; Gauss nodes; or those with the glow around "
      "the sun integrated separately (default)"));
  const auto set_counts = [&options](const std::vector<int>& counts) {
    options.zeniths = counts[0];
    options.azimuths = counts[1];
  };
  add_option(table, "--directions", On<std::vector<int>>(set_counts), "Z,A",
             "The number of directions: ZENITHS on either side of the horizon (uniform: over both), 2 to 128, and "
             "AZIMUTHS over half the circle, 2 to 256; the other half is its mirror image; default 16,16",
             {.list = List::commas_or_spaces, .count = 2});
}

/// Refuses contradictory options, none of which is silently ignored.
void add_sweep_options(Options& table, SweepOptions& sweep) {
  constexpr const char* kSweep = "--sweep";
  add_option(table, kSweep, &sweep.path, "FILE.png",
             "Draw a day as images side by side, to a PNG; a text file next to it lists the sun of each image",
             {.excludes = {"--format", "--json", "--sun-azimuth", "--quadrature", "--directions", "--bands", "--window",
                           "--for"}});
  add_option(table, "--sweep-to", &sweep.last_degrees, "DEGREES", "Sun elevation of the last image; default -18",
             {.bounds = number_between(-90.0, 90.0), .needs = {kSweep}});
  add_option(table, "--sweep-tiles", &sweep.tiles, "N", "Number of images, 1 to 256; default 16",
             {.bounds = whole_between(1, kMaxTiles), .needs = {kSweep}});
  add_option(table, "--sweep-size", &sweep.size, "N", "Height of each in pixels, 8 to 2048; default 192",
             {.bounds = whole_between(8, kLargestTile), .needs = {kSweep}});
  table.push_back(choice<SweepView>("--sweep-view", sweep.view,
                                    {{"panorama", SweepView::panorama}, {"fisheye", SweepView::fisheye}},
                                    "Half way round with the sun in the middle (default), or all of the sky above"));
  table.back().needs = {kSweep};
}

void add_folder_options(Options& table, SkyOptions& options) {
  options.bake.specular.size = kSkySize;
  options.bake.background_size = kSkyBackground;
  add_option(table, "-o,--output", &options.bake.directory, "DIR",
             "A folder to bake the sky to, as 'welkin bake' does, with its image sky.exr; default none; --json then "
             "prints the manifest",
             {.excludes = {"--format", "--window", "--sweep", "--quadrature", "--directions"}});
  const std::size_t before = table.size();
  add_option(table, "--image-height", &options.image_height, "N",
             "The height of sky.exr, from which everything else is made; it is twice as wide; default 256",
             {.bounds = whole_between(1, kLargestImage)});
  add_option(table, "--sun-disc", &options.sun_disc, "",
             "Draw the sun's disc into the image; by default it is left out");
  in_group(table, "A folder, as 'welkin bake' makes it");
  add_result_options(table, options.bake);
  for (std::size_t i = before; i < table.size(); ++i) table[i].needs.emplace_back("-o");
}

void add_sky_options(Options& table, SkyOptions& options) {
  add_sun_place(table, options);
  in_group(table, "Sun and observer");
  add_atmosphere_options(table, options.sky.atmosphere);
  add_option(table, "--print-atmosphere", &options.print_atmosphere, "",
             "Print the atmosphere as JSON, to edit and pass to --atmosphere, and exit");
  in_group(table, "Air and ground");
  add_table_options(table, options);
  in_group(table, "Tables of the scattering");
  add_quadrature_options(table, options.quadrature);
  add_format_options(table, options.sh);
  add_bands_option(table, options.sh);
  add_window_options(table, options.sh);
  add_engine_option(table, options.sh.orientation);
  option(table, "--for").text += ". With -o the folder holds what that engine loads, as of 'welkin bake'";
  in_group(table, "Harmonics and output");
  add_sweep_options(table, options.sweep);
  in_group(table, "A day");
  add_folder_options(table, options);
  add_memory_limit_option(table, options.sh.common);
  add_threads_option(table, options.sh.common);
}

/// Combines the options; called once all are read.
void settle(SkyOptions& options, const Given& given) {
  SkyTableOptions& tables = options.sky.tables;
  tables.memory_limit_bytes = options.sh.common.read.memory_limit_bytes;
  options.quadrature.bands = options.sh.projection.bands;
  if (!options.sweep.path.empty()) {
    if (!given("--colour")) tables.colour = SkyColour::linear_srgb;
    if (given("--sun-elevation")) options.sweep.first_degrees = options.sky.sun_elevation_degrees;
  }
  if (given("--date")) {
    options.dated.position = sun_position(options.dated.date, options.dated.observer);
    options.sky.sun_elevation_degrees = options.dated.position.elevation_degrees;
    options.sky.sun_azimuth_degrees = options.dated.position.azimuth_degrees;
    options.sky.dated = options.dated;
  }
  options.wants_folder = given("-o");
  options.bake.common = options.sh.common;
  options.bake.common.json = options.sh.format == sh_json;
  options.bake.orientation.to = options.sh.orientation.to;
  options.bake.bake.bands = options.sh.projection.bands;
  options.bake.image_name = "sky.exr";
  settle_files(options.bake);
}

constexpr int kMaxZeniths = 128;
constexpr int kMaxAzimuths = 256;

/// Compares with a quadrature of twice as many nodes in each angle. The tables' own error is not part of it.
double error_estimate(const Sky& sky, const SkyHarmonicsOptions& options, const SphericalHarmonics& radiance) {
  SkyHarmonicsOptions finer = options;
  finer.quadrature = SkyQuadrature::gauss_split;
  finer.zeniths = std::min(2 * options.zeniths, kMaxZeniths);
  finer.azimuths = std::min(2 * options.azimuths, kMaxAzimuths);
  return relative_difference(radiance, SkyProjector(sky.view, finer).project(sky.sun));
}

/// Adds the sums of the sky's light, and of sky and sun together.
void describe_light(const Sky& sky, ShReport& report) {
  const double sphere = std::sqrt(4.0 * std::numbers::pi);  // band 0 is the mean radiance times this
  ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  diagnostics.total_radiance = sphere * report.projection.radiance.coefficients().front();
  diagnostics.total_radiance_before_clamp = diagnostics.total_radiance;
  report.sun_wanted = true;
  report.sun = sky.view.sun_light(sky.sun);
  report.sun->total_radiance_after = diagnostics.total_radiance;
  report.sun->total_radiance_before = diagnostics.total_radiance + report.sun->irradiance;
}

/// Makes or loads tables, projects the sky, rotates it to the engine's axes, windows. Throws the library's errors.
ShReport measure_sky(const SkyOptions& options, const Control& control) {
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
  complete(report, options.sh, false);
  return report;
}

/// Makes the sky's image and bakes everything from it.
std::string bake_sky(const SkyOptions& options, const Control& control) {
  constexpr double kTables = 0.9;
  BakeCommandOptions bake = options.bake;
  for (const std::optional<std::string>& file : {options.sky.atmosphere.file, options.sky.tables_file}) {
    if (file) bake.also_read.push_back(*file);
  }
  bake.compute = [&options](const Control& computing) {
    const Sky sky = make_sky(options.sky, part_of(computing, 0.0, kTables));
    return sky_image(sky, options.image_height, options.sun_disc, part_of(computing, kTables, 1.0));
  };
  return bake_to_folder(bake, control);
}

std::string answer(const SkyOptions& options, const Control& control) {
  if (options.print_atmosphere) {
    return json_text(atmosphere_json(chosen_atmosphere(options.sky.atmosphere, options.sky.tables.colour)));
  }
  if (!options.sweep.path.empty()) return write_sweep(options.sky, options.sweep, control);
  if (options.wants_folder) return bake_sky(options, control);
  return options.sh.format(measure_sky(options, control));
}

void run(SkyOptions& options, const Given& given) {
  settle(options, given);
  const std::string text =
      with_bar(options.sh.common, [&](const Control& control) { return answer(options, control); });
  const bool to_files = options.wants_folder || !options.sweep.path.empty();
  to_files&& options.sh.format != sh_json && !options.print_atmosphere ? print_summary(text) : print_result(text);
}

}  // namespace

Command sky_command() {
  const auto options = std::make_shared<SkyOptions>();
  Command command{"sky", "The light of a computed sky", embedded_text("help/sky.txt")};
  add_sky_options(command.options, *options);
  command.everyday = {"--sun-elevation", "--sun-azimuth", "--date",    "--at",   "--altitude", "--preset",
                      "--ground-albedo", "--colour",      "--json",    "--for",  "--tables",   "--sweep",
                      "--output",        "--size",        "--threads", "--quiet"};
  command.run = [options](const Given& given) { run(*options, given); };
  return command;
}

}  // namespace welkin::tool
