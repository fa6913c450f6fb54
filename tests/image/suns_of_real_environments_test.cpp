// Promises: with default options photographs with a sun give one, of a sun's size; overcast skies, studios and night
// give none; and three bands light a scene better without the sun in them. The hidden case prints docs/sun.md's table
// (of the folder in the variable WELKIN_ENVIRONMENTS if it is set).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "image/map_flux.h"
#include "places.h"
#include "support/catch.h"
#include "support/sun_maps.h"
#include "welkin/directional_light.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> environment_files() {
  std::vector<fs::path> files;
  const char* elsewhere = std::getenv("WELKIN_ENVIRONMENTS");
  const fs::path folder = elsewhere != nullptr ? fs::path(elsewhere) : fs::path(WELKIN_SHARED) / "hdr" / "env";
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

LatLongImage lat_long_of(const Environment& environment) {
  const LatLongView view = environment.lat_long();
  const float* first = environment.pixels.get();
  return {view.width, view.height, {first, first + std::ptrdiff_t{3} * view.width * view.height}};
}

/// Each texel the mean of four.
LatLongImage halved(const LatLongImage& image) {
  LatLongImage half = grey_lat_long(image.width / 2, image.height / 2, 0.0F);
  for (int row = 0; row < half.height * 2; ++row) {
    for (int column = 0; column < half.width * 2; ++column) {
      for (int c = 0; c < 3; ++c) {
        half.pixels[static_cast<std::size_t>(3 * (row / 2 * half.width + column / 2) + c)] +=
            0.25F * image.pixels[static_cast<std::size_t>(3 * (row * image.width + column) + c)];
      }
    }
  }
  return half;
}

/// Directions spread evenly: a spiral.
std::vector<glm::dvec3> normals(int count) {
  std::vector<glm::dvec3> result;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    result.emplace_back(std::sqrt(1.0 - y * y) * std::cos(angle), y, std::sqrt(1.0 - y * y) * std::sin(angle));
  }
  return result;
}

/// Green irradiance by the plain sum over all texels.
std::vector<double> direct_irradiance(const LatLongImage& image, const std::vector<glm::dvec3>& facing) {
  const image::TexelGrid grid = grid_of(image);
  std::vector<double> result(facing.size());
  std::vector<double> steradians(static_cast<std::size_t>(image.width));
  for (std::int64_t texel = 0; texel < grid.texels(); ++texel) {
    if (texel % image.width == 0) grid.solid_angles(static_cast<int>(texel / image.width), steradians);
    const double light = steradians[0] * image.pixels[static_cast<std::size_t>(3 * texel + 1)];
    const glm::dvec3 direction = grid.direction(texel);
    for (std::size_t i = 0; i < facing.size(); ++i) result[i] += light * std::max(0.0, glm::dot(direction, facing[i]));
  }
  return result;
}

/// Root mean square error over that of the truth.
double relative_rms(const std::vector<double>& found, const std::vector<double>& truth) {
  double error = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    error += (found[i] - truth[i]) * (found[i] - truth[i]);
    square += truth[i] * truth[i];
  }
  return std::sqrt(error / square);
}

struct Improvement {
  double with_sun_in_map = 0.0;
  double with_sun_as_light = 0.0;
};

Improvement improvement(const LatLongImage& before, const LatLongImage& after, const Sun& sun, int count) {
  const std::vector<glm::dvec3> facing = normals(count);
  const std::vector<double> truth = direct_irradiance(before, facing);
  const SphericalHarmonics whole = irradiance_from_radiance(project(before.view()).radiance);
  const SphericalHarmonics rest = irradiance_from_radiance(project(after.view()).radiance);
  std::vector<double> in_map;
  std::vector<double> as_light;
  for (const glm::dvec3& n : facing) {
    in_map.push_back(evaluate(whole, n).g);
    as_light.push_back(evaluate(rest, n).g + sun.irradiance.g * std::max(0.0, glm::dot(n, sun.direction)));
  }
  return {relative_rms(in_map, truth), relative_rms(as_light, truth)};
}

void print_row(const std::string& name, const LatLongImage& before) {
  LatLongImage after = before;
  const auto sun = take_out_sun(after);
  if (!sun) {
    std::printf("| %s | %d | none | | | | | | |\n", name.c_str(), before.width);
    return;
  }
  const Improvement error = improvement(before, after, *sun, 400);
  const glm::dvec3 colour = sun->irradiance / std::max({sun->irradiance.r, sun->irradiance.g, sun->irradiance.b});
  std::printf(
      "| %s | %d | %.1f, %.1f | %.3g %.3g %.3g | %.2f %.2f %.2f | %.2e (%d) | %.2f | %.1f %% | %.1f %% -> %.1f %% |\n",
      name.c_str(), before.width, std::atan2(sun->direction.x, sun->direction.z) * 180.0 / std::numbers::pi,
      std::asin(sun->direction.y) * 180.0 / std::numbers::pi, sun->irradiance.r, sun->irradiance.g, sun->irradiance.b,
      colour.r, colour.g, colour.b, sun->solid_angle, static_cast<int>(sun->texels), sun->angular_radius_degrees,
      100.0 * image::luminance(sun->irradiance) / image::luminance(sun->flux_before), 100.0 * error.with_sun_in_map,
      100.0 * error.with_sun_as_light);
}

}  // namespace

TEST_CASE("Photographs with a sun have one, the others have none", "[image][sun][shared]") {
  // Largest radius in degrees and least share of the light; 0: no sun. The hotel room's spotlight is as good as a sun.
  const std::map<std::string, std::pair<double, double>> expected{
      {"blender_city.exr", {0.6, 0.2}},         {"blender_sunrise.exr", {0.8, 0.5}},
      {"blender_sunset.exr", {0.6, 0.02}},      {"openexr_KernerEnvLatLong.exr", {1.7, 0.2}},
      {"pmndrs_sunrise.exr", {0.9, 0.05}},      {"blender_interior.exr", {0.6, 0.1}},
      {"blender_courtyard.exr", {0.0, 0.0}},    {"blender_studio.exr", {0.0, 0.0}},
      {"openexr_WavyLinesLatLong.exr", {0, 0}}, {"pmndrs_apartment.exr", {0.0, 0.0}},
      {"pmndrs_city.exr", {0.0, 0.0}},          {"pmndrs_night.exr", {0.0, 0.0}},
      {"pmndrs_studio.exr", {0.0, 0.0}}};
  for (const auto& [name, size_and_share] : expected) {
    const fs::path file = fs::path(WELKIN_SHARED) / "hdr" / "env" / name;
    if (!fs::exists(file)) {
      WARN("left out: " << file << " is not there");
      continue;
    }
    CAPTURE(name);
    LatLongImage before = lat_long_of(read_environment(file));
    LatLongImage after = before;
    const auto sun = take_out_sun(after);
    CHECK(sun.has_value() == (size_and_share.first > 0.0));
    if (!sun || size_and_share.first == 0.0) continue;
    CHECK(sun->angular_radius_degrees > 0.25);
    CHECK(sun->angular_radius_degrees < size_and_share.first);
    CHECK(image::luminance(sun->irradiance) > size_and_share.second * image::luminance(sun->flux_before));
    CHECK(glm::length(sun->flux_before - sun->flux_after - sun->irradiance) < 1e-12 * glm::length(sun->flux_before));
    const Improvement error = improvement(before, after, *sun, 12);
    CHECK(error.with_sun_as_light < 1.001 * error.with_sun_in_map);  // no change where the sun has lost its green
  }
}

TEST_CASE("The sun of a photograph is the same at half and quarter size", "[image][sun][shared]") {
  for (const char* name : {"blender_city.exr", "blender_sunrise.exr", "blender_sunset.exr"}) {
    const fs::path file = fs::path(WELKIN_SHARED) / "hdr" / "env" / name;
    if (!fs::exists(file)) continue;
    LatLongImage image = lat_long_of(read_environment(file));
    LatLongImage half = halved(image);
    LatLongImage quarter = halved(half);
    const auto sun = take_out_sun(image);
    REQUIRE(sun);
    for (LatLongImage* smaller : {&half, &quarter}) {
      CAPTURE(name, smaller->width);
      const double texel_degrees = 360.0 / smaller->width;
      const auto found = take_out_sun(*smaller);
      REQUIRE(found);
      CHECK(degrees_between(found->direction, sun->direction) < 0.5 * texel_degrees);
      CHECK(image::luminance(found->irradiance) == Approx(image::luminance(sun->irradiance)).epsilon(0.1));
    }
  }
}

TEST_CASE("The table of suns in docs/sun.md", "[.sun-table]") {
  for (const fs::path& file : environment_files()) {
    try {
      const Environment environment = read_environment(file);
      if (environment.info.layout != Layout::lat_long) continue;
      LatLongImage image = lat_long_of(environment);
      while (image.width > 256) {
        print_row(file.stem().string(), image);
        if (std::getenv("WELKIN_ALL_SIZES") == nullptr) break;
        image = halved(image);
      }
    } catch (const Error& error) {
      std::printf("| %s | %s |\n", file.stem().c_str(), error.what());
    }
  }
}

}  // namespace welkin::test
