// Smaller levels of a cubemap, for minification: no light is changed but for its sharpness.
#pragma once

#include <span>

#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/export.h"
#include "welkin/image_view.h"

namespace WELKIN_EXPORT welkin {

enum class MipFilter {
  box,          ///< the plain mean of the texels below: what graphics APIs do
  solid_angle,  ///< their mean by solid angle: keeps the sphere's total radiance on every level
};

/// Copies `source` to level 0 and fills the levels below from it, each from the one above. Odd sizes: a texel below
/// covers 1 / its size of the face, cut texels count by the part (for solid_angle: the solid angle) that is covered.
/// `levels` 0: down to 1 texel. Cost: bounded by memory. The same bits on any number of threads and instruction set.
/// Throws `Error`: invalid_argument (view, levels), cancelled.
[[nodiscard]] CubemapChain build_mips(const CubemapView& source, MipFilter filter = MipFilter::solid_angle,
                                      int levels = 0, const Control& control = {});

/// The same where level 0 of `chain` is filled already.
void fill_mips(CubemapChain& chain, MipFilter filter, const Control& control = {});

}  // namespace welkin
