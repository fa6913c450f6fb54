// An environment that is computed and not read.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "tools/sky_report.h"
#include "tools/source.h"
#include "welkin/control.h"
#include "welkin/directional_light.h"
#include "welkin/image.h"

namespace welkin::tool {

struct ComputedPicture {
  LatLongImage image;
  Source source;
  SkyReport sky;
  std::optional<Sun> sun;  ///< that is not in the image, Welkin's axes
};

using ComputePicture = std::function<ComputedPicture(const Control&)>;

}  // namespace welkin::tool
