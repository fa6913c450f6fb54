// What a source of light looks like from outside: all that a plan needs to know of its pixels.
#pragma once

#include <cstdint>
#include <string>

#include "welkin/export.h"
#include "welkin/image_view.h"

namespace WELKIN_EXPORT welkin {

/// Size and format of pixels that are not there yet, for plans.
struct SourceShape {
  bool cubemap = false;                       ///< or a lat-long
  int columns = 0;                            ///< of a lat-long, or of a face
  int rows = 0;                               ///< of a lat-long, or of six faces
  PixelFormat format = PixelFormat::rgb_f32;  ///< of the pixels

  /// How many texels there are.
  [[nodiscard]] std::uint64_t texels() const noexcept {
    return static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  }
  /// "lat-long 1024 x 512", "cubemap of 256"
  [[nodiscard]] std::string words() const;

  friend bool operator==(const SourceShape&, const SourceShape&) = default;
};

/// Throw `Error` (invalid_argument) for a view that no call would accept.
[[nodiscard]] SourceShape shape_of(const LatLongView& view);
[[nodiscard]] SourceShape shape_of(const CubemapView& view);

}  // namespace welkin
