#include "sh/check_arguments.h"

#include <cmath>
#include <string>

#include "welkin/error.h"

namespace welkin::sh {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

}  // namespace

void check_options(const ProjectionOptions& options) {
  image::require_range("bands", options.bands, 1, kMaximumBands);
  image::require_range("target_size", options.target_size, 0, kLargestFace);
  if (!options.clamp) return;
  const float maximum = options.clamp->maximum;
  if (!(maximum > 0.0F) || std::isinf(maximum)) {
    refuse("the clamp's maximum is " + std::to_string(maximum) + "; it must be above 0 and finite (no clamp is off)");
  }
}

}  // namespace welkin::sh
