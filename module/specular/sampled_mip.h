// Filtered importance sampling of one mip.
#pragma once

#include <array>

#include "specular/padded_cube.h"
#include "specular/sampled_taps.h"
#include "welkin/control.h"

namespace welkin::specular {

/// Writes the taps' weighted sum about the direction of each texel's centre to six packed RGB faces. The same bits on
/// any number of threads and instruction set. Throws `Error` (cancelled).
void sample_mip(const PaddedCube& source, const std::vector<Tap>& taps, int size, const std::array<float*, 6>& faces,
                const Control& control);

}  // namespace welkin::specular
