// Resampling into memory that is there already.
#pragma once

#include <array>

#include "welkin/control.h"
#include "welkin/cubemap_chain.h"
#include "welkin/image_view.h"
#include "welkin/resampling.h"

namespace welkin::image {

/// Writes what `to_cubemap` without a turn returns to six faces of `size` x `size` RGB floats, packed. The view and the
/// size are checked already. Throws `Error` (cancelled).
void fill_cubemap(const LatLongView& source, int size, const std::array<float*, 6>& faces, ResampleFilter filter,
                  const Control& control);

/// The same into level 0 of a chain.
void fill_cubemap(const LatLongView& source, CubemapChain& chain, ResampleFilter filter, const Control& control);

/// `chain` if it has `size` and `levels`, else a new one that has, its pixels not initialised.
[[nodiscard]] CubemapChain shaped(CubemapChain chain, int size, int levels);

/// The six faces of a level.
[[nodiscard]] std::array<float*, 6> faces_of(CubemapChain& chain, int level) noexcept;

}  // namespace welkin::image
