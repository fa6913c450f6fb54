// Filtered importance sampling, as other tools prefilter reflections (Krivanek and Colbert, Real-time Shading with
// Filtered Importance Sampling, 2008; Karis, Real Shading in Unreal Engine 4, 2013): what the library is compared with.
#pragma once

#include <vector>

#include "welkin/image.h"

namespace welkin::report {

/// Name that its measurements have as those of a peer.
inline constexpr const char* kSamplingPeer = "plain C++";

/// Prefilters a chain: mip 0 has `size` texels along an edge, mip k the perceptual roughness `roughness[k]`; where that
/// is 0 the mip is the source's. Each texel reads one list of `samples` directions in the source's own mips,
/// trilinearly and without seams. Plain C++ on all threads that Welkin works with.
[[nodiscard]] Cubemap importance_sampled(const LatLongView& source, int size, const std::vector<double>& roughness,
                                         int samples);

}  // namespace welkin::report
