#include "welkin/analytic_sky.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>

#include "tables/trigonometry.h"
#include "welkin/error.h"

namespace welkin {
namespace {

constexpr glm::dvec3 kZenith(0.12, 0.28, 0.75);
constexpr glm::dvec3 kHorizon(0.85, 0.95, 1.05);
constexpr glm::dvec3 kGround(0.11, 0.09, 0.07);
constexpr glm::dvec3 kSun(5200.0, 4700.0, 3900.0);  // of its centre; fades to nothing at its rim
constexpr double kSunElevationTurns = 40.0 / 360.0;
constexpr double kSunAzimuthTurns = 25.0 / 360.0;  // from +z towards +x
constexpr double kSunRadiusTurns = 1.2 / 360.0;    // larger than the real one, so that small pictures have it

/// Unit direction of a longitude and a latitude, both in turns.
glm::dvec3 direction(double longitude, double latitude) {
  const tables::SineCosine lon = tables::sine_cosine_of_turns(longitude);
  const tables::SineCosine lat = tables::sine_cosine_of_turns(latitude);
  return {lon.sine * lat.cosine, lat.sine, lon.cosine * lat.cosine};
}

glm::dvec3 radiance(const glm::dvec3& towards, const glm::dvec3& sun, double cosine_of_rim) {
  if (towards.y < 0.0) return kGround * (1.0 + 0.5 * towards.y);
  const double low = 1.0 - towards.y;
  const double haze = low * low * low * low;
  glm::dvec3 sky = kZenith + haze * (kHorizon - kZenith);
  const double cosine = glm::dot(towards, sun);
  const double glow = std::max(0.0, cosine);
  const double glow4 = glow * glow * glow * glow;
  sky += glow4 * glow4 * glow4 * glow4 * glm::dvec3(0.9, 0.8, 0.6);
  const double inside = (cosine - cosine_of_rim) / (1.0 - cosine_of_rim);
  return inside > 0.0 ? sky + inside * kSun : sky;
}

}  // namespace

LatLongImage analytic_sky(int height) {
  constexpr int largest = 32768;
  if (height < 1 || height > largest) {
    throw Error(ErrorCode::invalid_argument,
                "the sky's height is " + std::to_string(height) + "; it must be from 1 to " + std::to_string(largest));
  }
  LatLongImage image{2 * height, height, {}};
  image.pixels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(height) * 3);
  const glm::dvec3 sun = direction(kSunAzimuthTurns, kSunElevationTurns);
  const double cosine_of_rim = tables::sine_cosine_of_turns(kSunRadiusTurns).cosine;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const glm::dvec3 towards = direction(0.5 - (column + 0.5) / image.width, 0.25 - (row + 0.5) / (2.0 * height));
      const glm::dvec3 rgb = radiance(towards, sun, cosine_of_rim);
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(rgb[c]));
    }
  }
  return image;
}

}  // namespace welkin
