#include "tools/sky_sweep.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "platform/text.h"
#include "tools/preview_light.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::tool {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kBelowHorizon = 6.0;  // degrees of a panorama
constexpr double kPanoramaHeight = 90.0 + kBelowHorizon;
constexpr double kPanoramaWidth = 180.0;
constexpr int kSampling = 3;
constexpr int kGap = 4;
constexpr double kTables = 0.5;  // of the progress
constexpr double kCloseToHorizon = 6.0;
constexpr glm::dvec3 kBackground(0.0);

/// Eyes and cameras adapt to most of the change between noon and night, but not to all of it: exposure goes with that
/// power of the brightness.
constexpr double kAdaptation = 0.85;
constexpr double kNoonBrightness = 0.2;  ///< of the first tile, before the tone curve

struct Tile {
  double elevation = 0.0;
  glm::dvec3 sun{};
  ToneMap tone_map;
};

/// Where a point of a tile looks; y is negative for what lies outside of a round one.
class Lens {
 public:
  Lens(SweepView view, int size) : view_(view), size_(size) {}

  [[nodiscard]] int width() const {
    if (view_ == SweepView::fisheye) return size_;
    return static_cast<int>(std::lround(size_ * kPanoramaWidth / kPanoramaHeight));
  }
  [[nodiscard]] int tiles_in_a_row() const { return view_ == SweepView::fisheye ? 8 : 4; }

  /// x to the right and y down, in pixels; false: it looks nowhere.
  [[nodiscard]] bool direction(double x, double y, glm::vec3& towards) const {
    if (view_ == SweepView::panorama) {
      const double azimuth = (0.5 - x / width()) * kPanoramaWidth * kDegree;
      const double elevation = (90.0 - y / size_ * kPanoramaHeight) * kDegree;
      towards = {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), std::cos(azimuth) * std::cos(elevation)};
      return true;
    }
    // Lying on one's back, feet away from the sun: its azimuth is up, +x to the left.
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

/// Mean luminance of the sky above the horizon. (One that leaves out what is bright, as the previews', would leave a
/// dusk's glow white.)
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

/// Sine of the elevation at which the ground begins: below 0 from a height.
double horizon_sine(const SkyReport& report) {
  const double away = report.altitude_m / (report.atmosphere.bottom_radius_m + report.altitude_m);
  return -std::sqrt(away * (2.0 - away));  // 1 - (bottom / distance)^2, without cancellation
}

/// The sun's disc where its centre is no farther than its radius.
glm::dvec3 disc(const Sun& sun, double horizon, const glm::dvec3& towards) {
  const double rim = std::cos(sun.angular_radius_degrees * kDegree);
  return towards.y > horizon && glm::dot(towards, sun.direction) > rim ? sun.radiance : glm::dvec3(0.0);
}

/// A row of pixels at a time: its directions in one call.
void draw(const Sky& sky, const Tile& tile, const Lens& lens, int size, int left, int top, PreviewPicture& picture) {
  const Sun sun = sky.view.sun(tile.sun);
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
      picture.set(left + column, top + row, glm::vec3(sum / static_cast<double>(kSampling * kSampling)));
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
         cells(sky.view.radiance(sun_direction(kJustUp, 180.0), tile.sun)) + cells(sky.view.sun(tile.sun).irradiance) +
         pad_left(significant(tile.tone_map.exposure, 3), 11) + '\n';
}

std::string head_lines(const Sky& sky, const SweepOptions& options) {
  return printable(platform::utf8(platform::path_of(options.path).filename())) + ": " +
         printable(sky.report.atmosphere.name) + ", altitude " + significant(sky.report.altitude_m) +
         " m; tiles row by row from the left\n" + "  r, g, b in " + sky_unit(sky.report) +
         "; the sun's light is what falls on a surface that faces it\n\n" + " tile  elevation" +
         pad_right("     zenith", 33) + pad_right("     horizon below the sun", 33) +
         pad_right("     horizon opposite", 33) + pad_right("     sun", 33) + "   exposure\n";
}

std::filesystem::path text_beside(const SweepOptions& options) {
  return platform::path_of(options.path).replace_extension(".txt");
}

void check(const SkyParameters& parameters, const SweepOptions& options) {
  const std::filesystem::path path = platform::path_of(options.path);
  if (path.extension() != ".png") {
    throw Error(ErrorCode::invalid_argument, options.path + ": --sweep draws a PNG; give a name that ends with .png");
  }
  for (const std::optional<std::string>& read : {parameters.atmosphere.file, parameters.tables_file}) {
    for (const std::filesystem::path& written : {path, text_beside(options)}) {
      if (read) require_kept(*read, written, "--sweep", "give the picture another name");
    }
  }
}

}  // namespace

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

std::string write_sweep(const SkyParameters& parameters, const SweepOptions& options, const Control& control) {
  check(parameters, options);
  begin_stage("tables");
  const Sky sky = make_sky(parameters, part_of(control, 0.0, kTables));
  const Control drawing = part_of(control, kTables, 1.0);
  begin_stage("draw");
  const std::vector<double> elevations = sweep_elevations(options);
  const Lens lens(options.view, options.size);
  const int columns = std::min(options.tiles, lens.tiles_in_a_row());
  const int rows = (options.tiles + columns - 1) / columns;
  PreviewPicture picture(columns * (lens.width() + kGap) - kGap, rows * (options.size + kGap) - kGap,
                         glm::vec3(kBackground));
  std::string text = head_lines(sky, options);
  const double noon = brightness(sky, sun_direction(elevations.front(), 0.0));
  for (std::size_t i = 0; i < elevations.size(); ++i) {
    const Tile tile = tile_at(sky, elevations[i], noon);
    const auto place = static_cast<int>(i);
    draw(sky, tile, lens, options.size, place % columns * (lens.width() + kGap),
         place / columns * (options.size + kGap), picture);
    text += tile_line(sky, tile, i);
    if (drawing.progress) drawing.progress(static_cast<double>(i + 1) / static_cast<double>(elevations.size()));
  }
  picture.save(platform::path_of(options.path));
  write_text_file(text_beside(options), text);
  return text;
}

}  // namespace welkin::tool
