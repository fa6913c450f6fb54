// The truth at chosen directions.
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "image/check_views.h"
#include "specular/lobe_integrals.h"
#include "welkin/error.h"
#include "welkin/specular.h"

namespace welkin {
namespace {

constexpr std::size_t kMostDirections = 10'000'000;
constexpr double kLeastAlpha = 1e-6;

std::vector<glm::dvec3> unit_directions(const std::vector<glm::dvec3>& directions) {
  if (directions.empty() || directions.size() > kMostDirections) {
    throw Error(ErrorCode::invalid_argument, std::to_string(directions.size()) + " directions; 1 to " +
                                                 std::to_string(kMostDirections) + " are possible");
  }
  std::vector<glm::dvec3> units;
  for (const glm::dvec3& direction : directions) {
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw Error(ErrorCode::invalid_argument,
                  "direction " + std::to_string(units.size()) + " has no length that could be made 1");
    }
    units.push_back(direction / length);
  }
  return units;
}

template <class View>
std::vector<glm::dvec3> reference(const View& view, double roughness, const std::vector<glm::dvec3>& directions,
                                  const Control& control) {
  image::check_view(view);
  if (!(roughness >= 0.0 && roughness <= 1.0)) {
    throw Error(ErrorCode::invalid_argument, "roughness " + std::to_string(roughness) + " is not from 0 to 1");
  }
  const std::vector<glm::dvec3> units = unit_directions(directions);
  const specular::CleanSource source(view, {}, {control.stop, {}});
  const double alpha = roughness * roughness;
  if (alpha >= kLeastAlpha) return specular::integrate_lobes(source, alpha, units, control);
  std::vector<glm::dvec3> values;
  values.reserve(units.size());
  for (const glm::dvec3& unit : units) values.push_back(specular::radiance_towards(source, unit));
  return values;
}

}  // namespace

std::vector<glm::dvec3> reference_specular(const LatLongView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  return reference(source, roughness, directions, control);
}

std::vector<glm::dvec3> reference_specular(const CubemapView& source, double roughness,
                                           const std::vector<glm::dvec3>& directions, const Control& control) {
  return reference(source, roughness, directions, control);
}

}  // namespace welkin
