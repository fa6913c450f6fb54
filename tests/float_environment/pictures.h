// Small pictures that the calls read.
#pragma once

#include "support/test_environments.h"
#include "support/values_of.h"
#include "welkin/image.h"

namespace welkin::test {

inline LatLongImage small_lat_long() { return {32, 16, make_lat_long(Content::sun_disc, 32, 16, 71).pixels}; }
inline Cubemap small_cubemap() { return {12, make_cubemap(Content::high_range, 12, 3, 72).pixels}; }

/// The same picture in denormals, which a thread may take for zero.
template <class Image>
Image faint(Image image) {
  for (float& value : values_of(image)) value *= 1e-42F;
  return image;
}

}  // namespace welkin::test
