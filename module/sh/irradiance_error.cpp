// The irradiance of the first bands beside the direct one.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "sh/basis.h"
#include "tables/trigonometry.h"
#include "welkin/error.h"
#include "welkin/irradiance.h"

namespace welkin {
namespace {

constexpr int kMostNormals = 100'000;

/// Points of equal area: equal steps in height, each turned by the golden angle from the one before.
std::vector<glm::dvec3> spiral(int count) {
  if (count < 1 || count > kMostNormals) {
    throw Error(ErrorCode::invalid_argument,
                std::to_string(count) + " normals; 1 to " + std::to_string(kMostNormals) + " are possible");
  }
  const double golden = 0.5 * (3.0 - std::sqrt(5.0));  // of a turn
  std::vector<glm::dvec3> normals;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    const double ring = std::sqrt((1.0 - y) * (1.0 + y));
    const tables::SineCosine azimuth = tables::sine_cosine_of_turns(golden * i);
    normals.emplace_back(ring * azimuth.sine, y, ring * azimuth.cosine);
  }
  return normals;
}

double ratio(double difference, double whole) {
  if (difference == 0.0) return 0.0;
  return whole > 0.0 ? difference / whole : std::numeric_limits<double>::infinity();
}

std::vector<IrradianceError> errors_at(const std::vector<glm::dvec3>& normals, const std::vector<glm::dvec3>& truth,
                                       const SphericalHarmonics& radiance) {
  const auto bands = static_cast<std::size_t>(radiance.bands());
  const SphericalHarmonics irradiance = irradiance_from_radiance(radiance);
  std::vector<double> basis(irradiance.coefficients().size());
  std::vector<IrradianceError> errors(bands);
  std::vector<double> squares(bands);
  double truth_squares = 0.0;
  for (std::size_t n = 0; n < normals.size(); ++n) {
    sh::evaluate_basis(normals[n].x, normals[n].y, normals[n].z, radiance.bands(), basis.data());
    const double size = glm::length(truth[n]);
    truth_squares += size * size;
    glm::dvec3 sum(0.0);
    for (std::size_t l = 0; l < bands; ++l) {
      for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) sum += basis[k] * irradiance.coefficients()[k];
      const double difference = glm::length(sum - truth[n]);
      squares[l] += difference * difference;
      if (difference >= errors[l].maximum) {
        errors[l].maximum = difference;
        errors[l].worst_normal = normals[n];
      }
      errors[l].relative = std::max(errors[l].relative, ratio(difference, size));
    }
  }
  const double truth_rms = std::sqrt(truth_squares / static_cast<double>(normals.size()));
  for (std::size_t l = 0; l < bands; ++l) {
    errors[l].bands = static_cast<int>(l) + 1;
    errors[l].rms = ratio(std::sqrt(squares[l] / static_cast<double>(normals.size())), truth_rms);
    errors[l].maximum = ratio(errors[l].maximum, truth_rms);
  }
  return errors;
}

}  // namespace

std::vector<IrradianceError> irradiance_errors(const CubemapView& cubemap, const SphericalHarmonics& radiance,
                                               int normals, const ProjectionOptions& options, const Control& control) {
  const std::vector<glm::dvec3> directions = spiral(normals);
  return errors_at(directions, direct_irradiance(cubemap, directions, options, control), radiance);
}

std::vector<IrradianceError> irradiance_errors(const LatLongView& lat_long, const SphericalHarmonics& radiance,
                                               int normals, const ProjectionOptions& options, const Control& control) {
  const std::vector<glm::dvec3> directions = spiral(normals);
  return errors_at(directions, direct_irradiance(lat_long, directions, options, control), radiance);
}

}  // namespace welkin
