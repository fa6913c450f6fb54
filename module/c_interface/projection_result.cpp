#include "c_interface/projection_result.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "c_interface/error_status.h"
#include "c_interface/versioned_struct.h"

namespace welkin::c_interface {
namespace {

void write_triple(const glm::dvec3& rgb, double* target) {
  for (int channel = 0; channel < 3; ++channel) target[channel] = rgb[channel];
}

}  // namespace

void require_room(const welkin_projection* projection, int bands) {
  const std::size_t size = stated_size(projection, sizeof(welkin_projection), alignof(welkin_projection), "projection");
  const auto count = static_cast<std::size_t>(std::clamp(bands, 1, kMaximumBands));
  const std::size_t needed = offsetof(welkin_projection, coefficients) + 3 * count * count * sizeof(double);
  if (size < needed) {
    refuse("projection->struct_size is " + std::to_string(size) + "; " + std::to_string(count) + " bands need " +
           std::to_string(needed));
  }
}

void write_projection(welkin_projection* projection, const Projection& light) {
  require_room(projection, light.radiance.bands());
  welkin_projection values{};
  values.bands = light.radiance.bands();
  const ProjectionDiagnostics& diagnostics = light.diagnostics;
  values.texels = diagnostics.texels;
  values.nans_replaced = diagnostics.nans_replaced;
  values.infinities_replaced = diagnostics.infinities_replaced;
  values.negatives_replaced = diagnostics.negatives_replaced;
  values.texels_clamped = diagnostics.texels_clamped;
  write_triple(diagnostics.flux_before_clamp, values.flux_before_clamp);
  write_triple(diagnostics.flux, values.flux);
  values.error_estimate = diagnostics.error_estimate;
  double* place = values.coefficients;
  for (const glm::dvec3& rgb : light.radiance.coefficients()) {
    write_triple(rgb, place);
    place += 3;
  }
  write_struct(projection, values, "projection");
}

}  // namespace welkin::c_interface
