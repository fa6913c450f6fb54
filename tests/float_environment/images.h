// Small images that the calls read, and the options to bake them.
#pragma once

#include <array>

#include "support/test_environments.h"
#include "support/values_of.h"
#include "welkin/bake.h"
#include "welkin/image.h"

namespace welkin::test {

inline LatLongImage small_lat_long() { return {32, 16, make_lat_long(Content::sun_disc, 32, 16, 71).pixels}; }
inline Cubemap small_cubemap() { return {12, make_cubemap(Content::high_range, 12, 3, 72).pixels}; }

/// Returns views of images of both layouts.
inline std::array<EnvironmentView, 2> views_of(const Cubemap& cube, const LatLongImage& wide) {
  return {cube.view(), wide.view()};
}

inline BakeOptions small_bake() {
  BakeOptions options{.specular = PrefilterOptions{.size = 8, .roughness = {0.0, 0.3, 0.9}}};
  options.irradiance->size = 3;
  options.brdf = BrdfTableOptions{.width = 5, .height = 3};
  return options;
}

/// Returns the image scaled to denormals, which a thread may flush to zero.
template <class Image>
Image faint(Image image) {
  for (float& value : values_of(image)) value *= 1e-42F;
  return image;
}

}  // namespace welkin::test
