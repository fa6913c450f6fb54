#include "welkin/scene_needs.h"

#include <string>

#include "estimates/budget.h"
#include "image/check_views.h"
#include "welkin/error.h"
#include "welkin/spherical_harmonics.h"

namespace welkin {

void check(const SceneNeeds& needs) {
  image::require_range("diffuse_bands", needs.diffuse_bands, 0, kMaximumBands);
  if (needs.error_budget) estimates::check_budget({.relative = *needs.error_budget});
  if (!needs.glossy) return;
  const RoughnessRange& range = *needs.glossy;
  if (range.least >= 0.0 && range.least <= range.greatest && range.greatest <= 1.0) return;
  throw Error(ErrorCode::invalid_argument, "glossy materials' roughness is from " + std::to_string(range.least) +
                                               " to " + std::to_string(range.greatest) + "; it must rise, from 0 to 1");
}

}  // namespace welkin
