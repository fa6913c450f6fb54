// Texels so bright that they are kept out of the harmonics.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "projection/sanitized_pixels.h"
#include "reflections/lobe_kernels.h"
#include "welkin/core.h"

namespace welkin::reflections {

struct BrightTexel {
  int row = 0;
  int column = 0;
  std::array<float, 3> rest{};    ///< what is left in the picture
  std::array<float, 3> excess{};  ///< radiance that is taken out
  float peak = 0.0F;              ///< what it gives to its own place through the lobe
};

/// Texels that are, or are part of, light so bright that float harmonics would lose what is dark beside it: at most
/// `most`, by what they give. `source` is a lat-long, `alpha` the narrowest lobe's.
[[nodiscard]] std::vector<BrightTexel> find_bright_texels(const projection::SanitizedSource& source, double alpha,
                                                          std::size_t most, const Control& control);

/// Them as lights without extent for one mip's `add_lobes`: as many a texel as it takes to stand for its area.
[[nodiscard]] std::vector<LobeLight> lobe_lights(const std::vector<BrightTexel>& texels, int width, int height,
                                                 double alpha);

// Lights without extent, blurred by a lobe, added to the faces of a cubemap.

/// Adds to each texel of six packed RGB faces of `size` x `size` the light that `lights` (of `lobe_lights`) give in the
/// direction of its centre. The same bits on any number of threads and instruction set. Throws `Error` (cancelled).
void add_lobe_lights(std::span<const LobeLight> lights, double alpha, int size, const std::array<float*, 6>& faces,
                     const Control& control);

}  // namespace welkin::reflections
