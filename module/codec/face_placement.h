// Where the six faces of a cube lie in a picture.
#pragma once

#include <array>
#include <cstddef>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// One face's place in a picture, counted in edges of a face.
struct FacePlacement {
  int column = 0;
  int row = 0;
  bool mirrored_columns = false;  ///< the picture's left column is the face's last one
  bool mirrored_rows = false;     ///< the picture's top row is the face's last one
};

/// A layout: a picture of `columns` x `rows` faces, blank where none lies. Faces in the order of `CubemapView`,
/// turned against its frames as each placement says.
struct CubePlacement {
  int columns = 0;
  int rows = 0;
  std::array<FacePlacement, 6> faces{};
};

/// The placement of a cube's layout. Six files are taken as the vertical strip that they make up.
///
///     horizontal cross      vertical cross
///         +Y                    +Y
///      -X +Z +X -Z           -X +Z +X
///         -Y                    -Y
///                               -Z  (turned by half a turn)
///
/// Wherever two faces touch in a cross, they touch on the cube too. Throws `Error` (invalid_argument) for
/// automatic and lat_long.
[[nodiscard]] const CubePlacement& cube_placement(Layout layout);

/// The vertical strip that OpenEXR's envmap attribute means by "cube": faces in the same order, and on each one axis
/// the other way round (ImfEnvmap.h, CubeMap::pixelPosition).
///
/// | face | OpenEXR's u, v | CubemapView's u, v | so |
/// |---|---|---|---|
/// | +X | +z, -y | -z, -y | columns mirrored |
/// | -X | -z, -y | +z, -y | columns mirrored |
/// | +Y | +x, -z | +x, +z | rows mirrored |
/// | -Y | +x, +z | +x, -z | rows mirrored |
/// | +Z | -x, -y | +x, -y | columns mirrored |
/// | -Z | +x, -y | -x, -y | columns mirrored |
[[nodiscard]] const CubePlacement& openexr_cube_placement() noexcept;

/// A row of a face where it lies in a row of the picture.
struct FaceSegment {
  int face = 0;
  int face_row = 0;
  int first_column = 0;   ///< of the picture; as many follow as a face has
  bool mirrored = false;  ///< picture column first_column + i is face column size - 1 - i, not i
};

/// The segments of one row of the picture, from left to right: 1 to 6.
struct RowSegments {
  std::array<FaceSegment, 6> segments{};
  std::size_t count = 0;

  [[nodiscard]] const FaceSegment* begin() const noexcept { return segments.data(); }
  [[nodiscard]] const FaceSegment* end() const noexcept { return segments.data() + count; }
};

/// `size`: texels along a face's edge; `picture_row`: in [0, rows x size).
[[nodiscard]] RowSegments row_segments(const CubePlacement& placement, int size, int picture_row) noexcept;

/// Copies `size` RGB texels, in the other order if `mirrored`: from a picture to a face, or back.
void copy_segment(const float* from, float* to, int size, bool mirrored) noexcept;

}  // namespace welkin::codec
