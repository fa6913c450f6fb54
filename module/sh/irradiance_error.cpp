// The irradiance of the first bands beside the direct one.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "sh/basis.h"
#include "sh/spiral.h"
#include "welkin/irradiance.h"

namespace welkin {
namespace {

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
  const std::vector<glm::dvec3> directions = sh::spiral(normals);
  return errors_at(directions, direct_irradiance(cubemap, directions, options, control), radiance);
}

std::vector<IrradianceError> irradiance_errors(const LatLongView& lat_long, const SphericalHarmonics& radiance,
                                               int normals, const ProjectionOptions& options, const Control& control) {
  const std::vector<glm::dvec3> directions = sh::spiral(normals);
  return errors_at(directions, direct_irradiance(lat_long, directions, options, control), radiance);
}

}  // namespace welkin
