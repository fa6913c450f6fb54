// A made-up sky that packers and encoders have as much to do with as with a photograph.
#pragma once

#include "welkin/image.h"

namespace welkin::perf {

struct SkyPictureOptions {
  double grain = 0.1;    ///< noise from 0 to this, beside a sky of 1
  double ripples = 0.1;  ///< of fine clouds
  bool tinted = false;   ///< colours change from place to place, and grain is grey: else all has one colour
  double sun = 0.0;      ///< radiance of a disc of four texels; 0: none
};

/// A sky over ground with clouds, 1024 x 512.
[[nodiscard]] LatLongImage sky_picture(const SkyPictureOptions& options = {});

}  // namespace welkin::perf
