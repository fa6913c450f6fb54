// Lights without extent, blurred by a lobe, added to the faces of a cubemap.
#pragma once

#include <array>
#include <span>

#include "simd/kernels.h"
#include "welkin/control.h"

namespace welkin::specular {

/// Adds to each texel of six packed RGB faces of `size` x `size` the light that `lights` (of `lobe_lights`) give in the
/// direction of its centre. The same bits on any number of threads and instruction set. Throws `Error` (cancelled).
void add_lobe_lights(std::span<const simd::LobeLight> lights, double alpha, int size,
                     const std::array<float*, 6>& faces, const Control& control);

}  // namespace welkin::specular
