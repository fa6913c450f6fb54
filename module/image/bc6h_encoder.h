// BC6H of pictures, the faces of cubemaps among them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

/// One level of pictures in blocks.
struct Bc6hPictures {
  std::vector<std::uint8_t> blocks;  ///< of one picture after the other, rows of blocks from the top
  double estimated_error = 0.0;      ///< as `Bc6hLevel` has it
};

struct Bc6hPictureLevels {
  std::vector<Bc6hPictures> levels;
  std::uint64_t values_clamped = 0;
};

/// Encodes the pictures of each level, which have the same size within a level. Otherwise as `encode_bc6h`. Throws
/// `Error`: invalid_argument (the effort), cancelled.
[[nodiscard]] Bc6hPictureLevels encode_bc6h_pictures(std::span<const std::vector<LatLongView>> levels,
                                                     const Bc6hOptions& options, const Control& control);

}  // namespace welkin::image
