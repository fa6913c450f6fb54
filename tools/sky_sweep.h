// `welkin sky --sweep`: a day as a strip of pictures.
#pragma once

#include <string>

#include "tools/sky_model.h"

namespace welkin::tool {

enum class SweepView {
  fisheye,   ///< the sky above: zenith in the middle, horizon at the rim, the sun's azimuth up
  panorama,  ///< half way round, the sun's azimuth in the middle, from a little below the horizon to the zenith
};

struct SweepOptions {
  std::string path;
  double first_degrees = 90.0;  ///< sun elevation of the first tile
  double last_degrees = -18.0;
  int tiles = 16;
  int size = 192;  ///< height of a tile, pixels
  SweepView view = SweepView::panorama;
};

/// Draws and writes the picture, a PNG, and a text beside it that says of each tile where the sun stands and how bright
/// the sky is; returns the text. Throws `Error`: file_access if one of them would be written over a file that is read.
[[nodiscard]] std::string write_sweep(const SkyParameters& parameters, const SweepOptions& options,
                                      const Control& control);

/// Sun elevations of the tiles, degrees to a tenth: closer together about the horizon, where the sky changes fast.
[[nodiscard]] std::vector<double> sweep_elevations(const SweepOptions& options);

}  // namespace welkin::tool
