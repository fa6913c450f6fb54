// OpenEXR's cube faces, turned to Welkin's.
#pragma once

#include <memory>

#include "codec/row_source.h"

namespace welkin::codec {

/// Wraps a reader of a vertical strip with faces of `size` x `size` in the frames of OpenEXR's envmap
/// attribute; the result reads the same strip in the frames of `CubemapView`.
///
/// Both have the faces in the same order, and on each face one axis the other way round:
///
/// | face | OpenEXR's u, v | Welkin's u, v | so |
/// |---|---|---|---|
/// | +X | +z, -y | -z, -y | columns mirrored |
/// | -X | -z, -y | +z, -y | columns mirrored |
/// | +Y | +x, -z | +x, +z | rows mirrored |
/// | -Y | +x, +z | +x, -z | rows mirrored |
/// | +Z | -x, -y | +x, -y | columns mirrored |
/// | -Z | +x, -y | -x, -y | columns mirrored |
[[nodiscard]] std::unique_ptr<RowReader> reframe_openexr_cube(std::unique_ptr<RowReader> reader, int size);

}  // namespace welkin::codec
