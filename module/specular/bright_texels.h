// Texels so bright that they are kept out of the harmonics.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "simd/kernels.h"
#include "specular/clean_source.h"
#include "welkin/control.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::specular {

struct BrightTexel {
  int row = 0;
  int column = 0;
  std::array<float, 3> rest{};    ///< what is left in the picture
  std::array<float, 3> excess{};  ///< radiance that is taken out
  float peak = 0.0F;              ///< what it gives to its own place through the lobe
};

/// Texels that are, or are part of, light so bright that float harmonics would lose what is dark beside it: at most
/// `most`, by what they give. `source` is a lat-long, `alpha` the narrowest lobe's.
[[nodiscard]] std::vector<BrightTexel> find_bright_texels(const CleanSource& source, double alpha, std::size_t most,
                                                          const Control& control);

/// Them as lights without extent for one mip's `add_lobes`: as many a texel as it takes to stand for its area.
[[nodiscard]] std::vector<simd::LobeLight> lobe_lights(const std::vector<BrightTexel>& texels, int width, int height,
                                                       double alpha);

/// Adds what was taken out to an environment's coefficients.
void add_harmonics(const std::vector<BrightTexel>& texels, int width, int height, SphericalHarmonics& harmonics);

}  // namespace welkin::specular
