#include "report/environment.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "welkin/environment_file.h"
#include "welkin/resampling.h"

namespace welkin::report {
namespace {

constexpr double kSunRadius = 0.6;  // degrees
constexpr double kSunRadiance = 2e4;
constexpr double kWindowRadiance = 12.0;
constexpr int kGrain = 64;  // patches along the equator

const glm::dvec3 kSun = glm::normalize(glm::dvec3(0.55, 0.6, 0.58));

/// 1 inside, 0 outside, a ramp of one texel between: `inside` in degrees from the edge inwards.
double coverage(double inside, double texel) { return std::clamp(inside / texel + 0.5, 0.0, 1.0); }

/// A rectangle of longitudes and latitudes, degrees.
struct Window {
  double left, right, bottom, top;

  [[nodiscard]] double covers(double longitude, double latitude, double texel) const {
    return coverage(std::min(longitude - left, right - longitude), texel) *
           coverage(std::min(latitude - bottom, top - latitude), texel);
  }
};

constexpr Window kWindows[] = {{-120.0, -95.0, 5.0, 50.0}, {150.0, 158.0, -30.0, 35.0}};

/// Grain of the ground: a value in [0, 1) for each patch, the same at every resolution.
class Grain {
 public:
  Grain() {
    std::mt19937 random(17);
    for (double& value : values_) value = static_cast<double>(random()) * 0x1p-32;
  }
  [[nodiscard]] double at(double longitude, double latitude) const {
    const int column = static_cast<int>((longitude + 180.0) / 360.0 * kGrain) % kGrain;
    const int row = std::clamp(static_cast<int>((latitude + 90.0) / 180.0 * kGrain), 0, kGrain - 1);
    return values_[static_cast<std::size_t>(row * kGrain + column)];
  }

 private:
  double values_[kGrain * kGrain] = {};
};

glm::dvec3 light(const glm::dvec3& direction, double longitude, double latitude, double texel, const Grain& grain) {
  const double y = direction.y;
  const glm::dvec3 sky = glm::mix(glm::dvec3(0.75, 0.8, 0.85), glm::dvec3(0.15, 0.3, 0.7), std::sqrt(std::max(y, 0.0)));
  const glm::dvec3 ground = glm::dvec3(0.12, 0.1, 0.07) * (0.3 + grain.at(longitude, latitude));
  glm::dvec3 sum = glm::mix(ground, sky, coverage(latitude, texel));
  for (const Window& window : kWindows) {
    sum = glm::mix(sum, kWindowRadiance * glm::dvec3(1.0, 0.95, 0.85), window.covers(longitude, latitude, texel));
  }
  // Twice the arcsine of half the chord: exact for small angles too.
  const double from_sun = 2.0 * std::asin(0.5 * glm::length(direction - kSun)) * 180.0 / std::numbers::pi;
  return sum + kSunRadiance * coverage(kSunRadius - from_sun, texel) * glm::dvec3(1.0, 0.9, 0.75);
}

}  // namespace

ReportEnvironment built_in_environment(int width) {
  const int height = width / 2;
  const Grain grain;
  const double texel = 360.0 / width;
  ReportEnvironment result{"the built-in test light, " + std::to_string(width) + " x " + std::to_string(height),
                           {width, height, {}}};
  result.image.pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int row = 0; row < height; ++row) {
    const double latitude = 90.0 - (row + 0.5) * texel;
    const double y = std::sin(latitude * std::numbers::pi / 180.0);
    const double level = std::cos(latitude * std::numbers::pi / 180.0);
    for (int column = 0; column < width; ++column) {
      const double longitude = 180.0 - (column + 0.5) * texel;
      const double turn = longitude * std::numbers::pi / 180.0;
      const glm::dvec3 rgb =
          light({level * std::sin(turn), y, level * std::cos(turn)}, longitude, latitude, texel, grain);
      for (int c = 0; c < 3; ++c) result.image.pixels.push_back(static_cast<float>(rgb[c]));
    }
  }
  return result;
}

ReportEnvironment environment_from(const std::filesystem::path& path, int width) {
  const Environment environment = read_environment(path);
  const int height = width / 2;
  const bool flat = environment.info.layout == Layout::lat_long;
  LatLongImage image =
      flat ? to_lat_long(environment.lat_long(), width, height)
           : to_lat_long(environment.cubemap(), width, height, glm::dmat3(1.0), {}, ResampleFilter::area);
  return {path.filename().string() + ", " + std::to_string(width) + " x " + std::to_string(height), std::move(image)};
}

}  // namespace welkin::report
