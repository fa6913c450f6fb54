#include "estimates/sky_probe.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <memory>

#include "estimates/budget.h"
#include "welkin/error.h"

namespace welkin::estimates {

void check_suns(std::span<const glm::dvec3> suns) {
  if (suns.empty()) throw Error(ErrorCode::invalid_argument, "no sun is named; an estimate needs at least one");
  for (const glm::dvec3& sun : suns) {
    const double square = glm::dot(sun, sun);
    if (square > 0.0 && std::isfinite(square)) continue;
    throw Error(ErrorCode::invalid_argument, "a direction towards the sun is not finite or has no length");
  }
}

double worst_difference(std::span<const SphericalHarmonics> a, std::span<const SphericalHarmonics> b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, relative_difference(a[k], b[k]));
  return worst;
}

std::vector<SphericalHarmonics> light_of(const SkyTables& tables, const SkyProbe& probe) {
  // The view wants to share its tables; it does not outlive this call, nor does the pointer own them.
  const std::shared_ptr<const SkyTables> borrowed(std::shared_ptr<const void>(), &tables);
  const SkyProjector projector(SkyView(borrowed, probe.altitude_m));
  std::vector<SphericalHarmonics> lights;
  for (const glm::dvec3& sun : probe.suns) lights.push_back(projector.project(sun));
  return lights;
}

}  // namespace welkin::estimates
