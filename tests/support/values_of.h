// The floats of an image of either kind, for tests that take both.
#pragma once

#include <span>

#include "welkin/image.h"

namespace welkin::test {

inline std::span<float> values_of(LatLongImage& image) { return image.pixels; }
inline std::span<const float> values_of(const LatLongImage& image) { return image.pixels; }
inline std::span<float> values_of(Cubemap& image) { return image.pixels(); }
inline std::span<const float> values_of(const Cubemap& image) { return image.pixels(); }

}  // namespace welkin::test
