// Where filtered importance sampling looks, and how blurred: one list for all texels of a mip.
#pragma once

#include <vector>

namespace welkin::specular {

/// One sample in the frame whose z axis is the texel's direction.
struct Tap {
  float x, y, z;  ///< unit
  float weight;   ///< the list's sum is 1
  float level;    ///< of the source's mip chain, fractions too, 0 or above
};

/// Half vectors by GGX's distribution at a Hammersley set, reflected; taps below the horizon are left out. A tap's
/// level is where a texel covers four times the solid angle that falls to the tap, 1 / (samples pdf), pdf = D / 4
/// (Krivanek and Colbert, Real-time Shading with Filtered Importance Sampling, 2008; the further level is their
/// factor against noise). `level_size`: texels along an edge of level 0. 0 < alpha <= 1, 1 <= samples.
[[nodiscard]] std::vector<Tap> make_taps(double alpha, int samples, int level_size, int levels);

}  // namespace welkin::specular
