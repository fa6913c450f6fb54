// An environment on rings of latitude, as transforms take it.
#pragma once

#include <cstddef>
#include <vector>

#include "platform/memory.h"
#include "projection/sanitized_pixels.h"
#include "reflections/bright_texels.h"
#include "reflections/halved_faces.h"
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

/// Returns a source's rows without `bright`, which go by rows. Those that have any are copied, and no others: a
/// panorama may have hundreds of megabytes.
[[nodiscard]] SourceRows rows_without(const std::vector<BrightTexel>& bright,
                                      const projection::SanitizedSource& source);

/// A cubemap's rows as a lat-long of 2 rows x rows texels with the same harmonics, by a `RingTable`. The same bits on
/// any number of threads. Throws `Error` (cancelled).
[[nodiscard]] Rings rings_of_cubemap(const std::vector<const float*>& faces, int rows, const Control& control);

/// `source` without `bright`, which go by rows: of a lat-long the caller's own rows but for those with bright texels; a
/// cubemap on `rows` rings.
[[nodiscard]] Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             int rows, const Control& control);

/// A bound on what the rings of a cubemap of `size` take in addition to themselves, halved faces and a `RingTable` that
/// has yet to be made included.
[[nodiscard]] std::size_t cube_rings_bytes(int size, int face_size, int rows);

}  // namespace welkin::reflections
