// Texels so bright that they are kept out of the harmonics.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "welkin/core.h"

namespace welkin::reflections {

struct BrightTexel {
  int row = 0;  ///< of a cubemap counted face after face
  int column = 0;
  std::array<float, 3> rest{};    ///< what is left in the picture
  std::array<float, 3> excess{};  ///< radiance that is taken out
  double steradians = 0.0;
};

/// Texels that are, or are part of, light so bright that float harmonics, and harmonics that end, would lose what is
/// dark beside it: at most `most`, the brightest. `alpha` is the narrowest lobe's. By row and column. Throws
/// `Error` (cancelled).
[[nodiscard]] std::vector<BrightTexel> find_bright_texels(const projection::SanitizedSource& source, double alpha,
                                                          std::size_t most, const Control& control);
inline constexpr std::size_t kMostBright = 1U << 16U;  ///< for spectral mips

/// The source's pixels with what is left of them.
[[nodiscard]] std::vector<float> pixels_without(const std::vector<BrightTexel>& texels,
                                                const projection::SanitizedSource& source);

}  // namespace welkin::reflections
