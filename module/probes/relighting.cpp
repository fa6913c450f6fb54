// Another environment for probes that were captured, and windows over what they hold.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "jobs/many.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
namespace {

using probes::for_each_probe;

constexpr const char* kChannels[] = {"red", "green", "blue"};

/// What a coefficient of the visibility adds to those of the radiance: [sky_bands^2][bands^2], the products of the
/// environment with each basis function.
std::vector<dvec3> transfer_of(const SphericalHarmonics& environment, int sky_bands, int bands) {
  std::vector<dvec3> transfer;
  for (std::size_t k = 0; k < probes::squared(sky_bands); ++k) {
    SphericalHarmonics one(sky_bands);
    one.coefficients()[k] = dvec3(1.0);
    const SphericalHarmonics seen = resized(product(one, environment, bands), bands);
    transfer.insert(transfer.end(), seen.coefficients().begin(), seen.coefficients().end());
  }
  return transfer;
}

/// The bound on coefficients: no sum of their products overflows, and it is far above the largest float.
constexpr double kLargestCoefficient = 1e100;

/// Throws `Error` (invalid_argument) that names the first coefficient that is not finite or out of range.
void check_environment(const char* which, const SphericalHarmonics& environment) {
  for (int l = 0; l < environment.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      for (int c = 0; c < 3; ++c) {
        const double value = environment.at(l, m)[c];
        if (std::abs(value) <= kLargestCoefficient) continue;
        throw Error(ErrorCode::invalid_argument, std::string("relight: coefficient (") + std::to_string(l) + ", " +
                                                     std::to_string(m) + ") of `" + which + "` is " +
                                                     platform::number_text(value) + " in " + kChannels[c] +
                                                     "; it must be a number from -1e100 to 1e100");
      }
    }
  }
}

}  // namespace

void relight(BakedProbes& probes, const SphericalHarmonics& from, const SphericalHarmonics& to, int dilation_passes,
             const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  check_environment("from", from);
  check_environment("to", to);
  if (probes.sky_bands < probes.bands) {
    throw Error(ErrorCode::invalid_argument,
                "the probes do not know where they see the environment; bake them with depths and environment_bands "
                "of ProbeOptions");
  }
  const int environment_bands = probes.sky_bands - probes.bands + 1;
  const SphericalHarmonics change = resized(add(to, scale(from, dvec3(-1.0))), environment_bands);
  const std::size_t functions = probes::squared(probes.bands);
  const std::size_t sky = probes::squared(probes.sky_bands);
  const std::vector<dvec3> transfer = transfer_of(change, probes.sky_bands, probes.bands);
  BakedProbes relit = probes;
  for_each_probe(probes.grid.size(), static_cast<std::int64_t>(functions * sky), jobs::part_of(control, 0.0, 0.95),
                 [&](std::size_t probe) {
                   const double* seen = probes.sky.data() + probe * sky;
                   dvec3* light = relit.coefficients.data() + probe * functions;
                   for (std::size_t k = 0; k < sky; ++k) {
                     for (std::size_t f = 0; f < functions; ++f) light[f] += seen[k] * transfer[k * functions + f];
                   }
                 });
  dilate(relit, dilation_passes, jobs::part_of(control, 0.95, 1.0));
  probes = std::move(relit);
}

BakedProbes windowed(const BakedProbes& probes, Window window, double width, const Control& control) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  BakedProbes result = probes;
  const std::size_t functions = probes::squared(probes.bands);
  for_each_probe(probes.grid.size(), 100'000, control, [&](std::size_t probe) {
    SphericalHarmonics radiance(probes.bands);
    std::copy_n(probes.coefficients.data() + probe * functions, functions, radiance.coefficients().begin());
    const WindowResult done = jobs::naming_probe(probe, [&] { return apply_window(radiance, window, width); });
    platform::ranges::copy(done.radiance.coefficients(),
                           result.coefficients.begin() + static_cast<std::ptrdiff_t>(probe * functions));
  });
  return result;
}

}  // namespace welkin
