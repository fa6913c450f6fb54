#include "probes/probe_arrays.h"

#include <string>

#include "image/pixels.h"
#include "platform/text.h"
#include "projection/sanitizer.h"
#include "welkin/core.h"

namespace welkin::probes {
namespace {

constexpr int kMaxAlong = 2048;  // texels of a three-dimensional texture that every graphics API takes
constexpr std::size_t kMaxProbes = std::size_t{1} << 24U;

void require_length(const char* name, std::size_t is, std::size_t must_be) {
  if (is == must_be) return;
  refuse("BakedProbes: " + std::string(name) + " has " + std::to_string(is) + " values; it must have " +
         std::to_string(must_be));
}

}  // namespace

void check_grid(const ProbeGrid& grid) {
  constexpr const char* axes[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string along = std::string(" along ") + axes[axis];
    image::require_range(("probes of a grid" + along).c_str(), grid.counts[static_cast<std::size_t>(axis)], 1,
                         kMaxAlong);
    // Floats square values within these bounds without an overflow.
    platform::require_between("ProbeGrid: spacing" + along, grid.spacing[axis], 1e-9, 1e12);
    platform::require_between("ProbeGrid: origin" + along, grid.origin[axis], -kFarthest, kFarthest);
  }
  if (grid.size() > kMaxProbes) {
    refuse("ProbeGrid: has " + std::to_string(grid.size()) + " probes; up to " + std::to_string(kMaxProbes) +
           " are baked together");
  }
}

void check_options(const ProbeOptions& options, bool with_depths) {
  projection::check_options(options.projection);
  image::require_range("bands of probes", options.projection.bands, 1, kMaxBands);
  platform::require_between("ProbeOptions: near_share", options.near_share, 0.0, 1e6);
  platform::require_between("ProbeOptions: valid_share", options.valid_share, 0.0, 1.0);
  platform::require_between("ProbeOptions: distance_limit", options.distance_limit, 0.0, 1e30);
  image::require_range("distance_size of probes", options.distance_size, 0, 64);
  image::require_range("distance_power of probes", options.distance_power, 1, 1024);
  image::require_range("dilation_passes of probes", options.dilation_passes, 0, 1024);
  image::require_range("environment_bands of probes", options.environment_bands, 0, kMaximumBands + 1 - kMaxBands);
  if (options.environment_bands > 0 && !with_depths) {
    refuse("ProbeOptions: environment_bands is " + std::to_string(options.environment_bands) +
           ", but there are no depths, which show where a probe sees the environment; pass them, or 0");
  }
}

void check_arrays(const BakedProbes& probes) {
  check_grid(probes.grid);
  image::require_range("bands of probes", probes.bands, 1, kMaxBands);
  image::require_range("distance_size of probes", probes.distance_size, 0, 64);
  image::require_range("sky_bands of probes", probes.sky_bands, 0, kMaximumBands);
  const std::size_t count = probes.grid.size();
  require_length("coefficients", probes.coefficients.size(), count * squared(probes.bands));
  require_length("validity", probes.validity.size(), count);
  require_length("passes", probes.passes.size(), count);
  require_length("distances", probes.distances.size(), count * distance_floats(probes));
  require_length("sky", probes.sky.size(), count * squared(probes.sky_bands));
  if (!probes.offsets.empty()) require_length("offsets", probes.offsets.size(), count);
}

}  // namespace welkin::probes
