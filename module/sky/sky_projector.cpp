#include <array>
#include <string>
#include <utility>

#include "jobs/floating_point_scope.h"
#include "sky/sky_projection.h"
#include "sky/sky_projector_access.h"
#include "sky/vertical_harmonics.h"
#include "welkin/error.h"
#include "welkin/sky_harmonics.h"

namespace welkin {

struct SkyProjector::Prepared {
  sky::SkyProjection projection;
};

SkyProjector::SkyProjector(SkyView view, const SkyHarmonicsOptions& options) {
  const jobs::FloatingPointScope environment;
  prepared_ = std::make_shared<const Prepared>(Prepared{sky::SkyProjection(std::move(view), options)});
}

void SkyProjector::project(const glm::dvec3& sun, std::span<glm::dvec3> coefficients) const {
  const sky::SkyProjection& projection = prepared_->projection;
  const int bands = projection.options().bands;
  sky::check_room(coefficients.size(), bands);
  const jobs::FloatingPointScope environment;
  const sky::SunAngles angles = sky::sun_angles(sun);
  std::array<glm::dvec3, sky::even_count(kMaximumBands)> even;
  projection.project(angles, even);
  sky::turn_even(even, bands, angles, coefficients);
}

SphericalHarmonics SkyProjector::project(const glm::dvec3& sun) const {
  SphericalHarmonics result(options().bands);
  project(sun, result.coefficients());
  return result;
}

int SkyProjector::directions() const noexcept { return prepared_->projection.directions(); }
const SkyView& SkyProjector::view() const noexcept { return prepared_->projection.view(); }
const SkyHarmonicsOptions& SkyProjector::options() const noexcept { return prepared_->projection.options(); }

const sky::SkyProjection& SkyProjectorAccess::projection(const SkyProjector& projector) noexcept {
  return projector.prepared_->projection;
}

namespace sky {

void check_room(std::size_t room, int bands) {
  const auto needed = static_cast<std::size_t>(bands) * static_cast<std::size_t>(bands);
  if (room >= needed) return;
  throw Error(ErrorCode::invalid_argument, "sky harmonics: room for " + std::to_string(room) + " coefficients; " +
                                               std::to_string(bands) + " bands have " + std::to_string(needed));
}

}  // namespace sky
}  // namespace welkin
