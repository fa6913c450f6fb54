// How much a report measures.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "welkin/sky_tables.h"

namespace welkin::report {

/// Sizes and budgets. Errors depend on the sizes, so reports are compared within a scale.
struct Scale {
  std::string name;
  double budget_seconds = 0.0;  ///< of repeats, a measurement
  int lat_long_width = 0;       ///< of the environment, twice its height
  int cube_size = 0;            ///< of the cubemap that is projected
  int chain_size = 0;           ///< of the specular chain from a file
  int probes = 0;               ///< places at which a prefiltered mip is compared with the truth, an error estimate's n
  int most_samples = 0;         ///< of the sampled prefilter
  int most_bands = 0;           ///< of the irradiance
  int largest_table = 0;        ///< edge of the largest BRDF table
  int table_truth = 0;          ///< edge of the BRDF table that others are compared with
  std::vector<double> sun_elevations{};  ///< degrees
  int sky_zeniths = 0;                   ///< of the truth's quadrature, on either side of the horizon
  int sky_azimuths = 0;                  ///< over half the circle
  std::vector<SkyTableOptions>
      sky_tables{};  ///< from coarse to fine; the last one is the view whose harmonics are taken
  bool peers = true;
};

/// tiny: seconds, for tests. quick: under a minute on two cores. full: minutes.
/// Throws `Error` (invalid_argument) for other names.
[[nodiscard]] const Scale& scale(const std::string& name);

/// "tiny", "quick", "full"
[[nodiscard]] std::vector<std::string> scale_names();

}  // namespace welkin::report
