// An environment in memory, where more is asked of it than one pass over its rows.
#pragma once

#include <cstdint>
#include <optional>

#include "welkin/directional_light.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"

namespace welkin::tool {

struct Pixels {
  bool is_cubemap = false;
  LatLongImage lat_long;
  CubemapImage cubemap;
};

/// A copy of what was read.
[[nodiscard]] Pixels pixels_of(const Environment& environment);

/// Puts `largest` in the place of +infinity and 0 in that of -infinity: a sun that overflowed has a value then.
/// How many there were.
std::uint64_t replace_infinities(Pixels& pixels, float largest);

[[nodiscard]] std::optional<Sun> take_out_sun(Pixels& pixels, const SunOptions& options);

/// The same in what was read, infinities being 65504, the largest half.
[[nodiscard]] std::optional<Sun> take_out_sun(Environment& environment, const SunOptions& options);

/// Calls `function` with the view of whichever it is.
template <typename Function>
auto with_view(const Pixels& pixels, const Function& function) {
  return pixels.is_cubemap ? function(pixels.cubemap.view()) : function(pixels.lat_long.view());
}

}  // namespace welkin::tool
