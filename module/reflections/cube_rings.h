// An environment on rings of latitude, as transforms take it.
#pragma once

#include <cstddef>
#include <vector>

#include "platform/memory.h"
#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "transform/picture_rows.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::reflections {

/// The environment as the transform reads it: a lat-long of sanitized pixels, its bright texels taken out.
struct Rings {
  transforms::PictureRows view;
  platform::AlignedBuffer<float> owned{};  ///< holds the rows where the caller's own would not do

  [[nodiscard]] std::size_t bytes() const noexcept { return owned.bytes(); }
};

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels with the same harmonics, by a `RingTable`. The same
/// bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

/// `source` without `bright`, which go by rows: of a lat-long the caller's own rows but for those with bright texels; a
/// cubemap on `rows` rings, its faces reduced to `face_size` first unless that is 0.
[[nodiscard]] Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             int rows, const Control& control, int face_size = 0);

/// A bound on what a cubemap's rings take in addition to themselves, a `RingTable` that has yet to be made included.
[[nodiscard]] std::size_t cube_rings_bytes(int face_size, int rows);

}  // namespace welkin::reflections
