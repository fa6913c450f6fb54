// The arrangement of the sphere in an image.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "files/row_source.h"
#include "welkin/environment_file.h"

namespace welkin::files {

/// Fills in `info.layout` and `info.layout_reason` from the request, else from the header, else from the shape: 2:1 is
/// a lat-long, 1:6 and 6:1 are strips, 4:3 and 3:4 crosses. 1:1 can only be one of six files: `open_row_source` checks
/// for the other five.
///
/// A lat-long that is requested or that the header states is accepted at any ratio; faces must still be square. Needs
/// `info.path`, `width` and `height`. Throws `Error` (unsupported_file) if nothing decides, if a strip or cross does
/// not have its shape, or if the image is larger than the views of `image.h` can be.
void decide_layout(EnvironmentInfo& info, Layout asked_for, std::optional<Layout> stated_by_header);

/// Throws `Error` (unsupported_file) for a square image that `decide_layout` took for a face. `reason` says why it is
/// not one: usually a missing face.
[[noreturn]] void refuse_square(const EnvironmentInfo& info, const std::string& reason);

/// Returns the texels along a face's edge in an image of this shape and layout; 0 for a lat-long, and where the shape
/// is not the layout's. Six files count as the strip that they make up.
[[nodiscard]] int face_size(Layout layout, int width, int height) noexcept;

// The positions of a cube's six faces in an image.

/// One face's position in an image, in units of a face's edge.
struct FacePlacement {
  int column = 0;
  int row = 0;
  bool mirrored_columns = false;  ///< the image's left column is the face's last one
  bool mirrored_rows = false;     ///< the image's top row is the face's last one
};

/// A layout: an image of `columns` x `rows` faces, blank elsewhere. Faces in the order of `CubemapView`, mirrored
/// against its frames as each placement states.
struct CubePlacement {
  int columns = 0;
  int rows = 0;
  std::array<FacePlacement, 6> faces{};
};

/// Returns the placement of a cube's layout. Six files count as the vertical strip that they make up.
///
///     horizontal cross      vertical cross
///         +Y                    +Y
///      -X +Z +X -Z           -X +Z +X
///         -Y                    -Y
///                               -Z  (rotated by 180 degrees)
///
/// Wherever two faces touch in a cross, they touch on the cube too. Throws `Error` (invalid_argument) for
/// automatic and lat_long.
[[nodiscard]] const CubePlacement& cube_placement(Layout layout);

/// Returns the vertical strip that OpenEXR's envmap attribute calls "cube": faces in the same order, and on each one
/// axis reversed (ImfEnvmap.h, CubeMap::pixelPosition).
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

/// A row of a face within a row of the image.
struct FaceSegment {
  int face = 0;
  int face_row = 0;
  int first_column = 0;   ///< of the image; as many columns follow as a face has
  bool mirrored = false;  ///< image column first_column + i is face column size - 1 - i, not i
};

/// The segments of one row of the image, from left to right: 1 to 6.
struct RowSegments {
  std::array<FaceSegment, 6> segments{};
  std::size_t count = 0;

  [[nodiscard]] const FaceSegment* begin() const noexcept { return segments.data(); }
  [[nodiscard]] const FaceSegment* end() const noexcept { return segments.data() + count; }
};

/// Returns a row's segments. `size`: texels along a face's edge; `image_row`: in [0, rows x size).
[[nodiscard]] RowSegments row_segments(const CubePlacement& placement, int size, int image_row) noexcept;

/// Copies `size` RGB texels, in reverse order if `mirrored`: from an image to a face, or back.
void copy_segment(const float* from, float* to, int size, bool mirrored) noexcept;

/// Adds a channel per letter.
void add_channels(EnvironmentInfo& info, std::string_view names, ChannelType type);

// Shared by the readers of files with levels and elements: KTX2, KTX, DDS, .env.

/// Throws `Error` (unsupported_file) for a missing level. Needs `info.path`.
void require_level(const EnvironmentInfo& info, int levels, int level);
/// Throws `Error` (unsupported_file) for an element that the file does not have.
void require_element(const std::filesystem::path& path, int elements, int element);

/// Fills in layout and sizes for a file whose format states six faces: a vertical strip of the requested level. `size`:
/// texels along an edge of level 0. Needs `info.path` and `info.format`. Throws `Error`: unsupported_file for another
/// layout, or a missing level.
void settle_cube(EnvironmentInfo& info, int size, int levels, const ReadOptions& options);

}  // namespace welkin::files
