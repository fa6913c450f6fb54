// What the command bakes and projects where no file is named, as the library makes it.
#pragma once

#include <memory>

#include "welkin/image.h"
#include "welkin/sky_view.h"

namespace welkin::test {

inline LatLongImage built_in_sky() {
  SkyTableOptions options;
  options.heights = 8;
  options.view_zeniths = 64;
  options.sun_zeniths = 16;
  const SkyView view(std::make_shared<const SkyTables>(precompute_sky(earth(), options)), 0.0);
  return sky_lat_long(view, sun_direction(40.0, 25.0), 512, {.sun_disc = true});
}

}  // namespace welkin::test
