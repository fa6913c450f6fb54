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

/// Six packed RGB faces, one after the other.
struct PackedFaces {
  [[nodiscard]] CubemapView view() const;
  /// Returns the rows, face after face.
  [[nodiscard]] std::vector<const float*> rows() const;

  int size = 0;
  const float* rgb = nullptr;
  platform::AlignedBuffer<float> owned{};  ///< holds them where the caller's own would not do
};

/// Returns a cubemap without `bright`, which go by rows, its faces halved until they have `size` texels along an edge.
[[nodiscard]] PackedFaces faces_without(const std::vector<BrightTexel>& bright,
                                        const projection::SanitizedSource& source, int size, const Control& control);
/// Returns faces halved until they have `size` texels along an edge.
[[nodiscard]] PackedFaces halved(const PackedFaces& faces, int size, const Control& control);

/// A packed RGB float cubemap as a lat-long of 2 rows x rows texels with the same harmonics, by a `RingTable`. The same
/// bits on any number of threads. Throws `Error` (cancelled).
[[nodiscard]] Rings rings_of_cubemap(const CubemapView& source, int rows, const Control& control);

/// `source` without `bright`, which go by rows: of a lat-long the caller's own rows but for those with bright texels; a
/// cubemap on `rows` rings.
[[nodiscard]] Rings rings_of(const projection::SanitizedSource& source, const std::vector<BrightTexel>& bright,
                             int rows, const Control& control);

/// A bound on what the rings of a cubemap of `size` take in addition to themselves, halved faces and a `RingTable` that
/// has yet to be made included.
[[nodiscard]] std::size_t cube_rings_bytes(int size, int face_size, int rows);

}  // namespace welkin::reflections
