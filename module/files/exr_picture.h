// Which of an OpenEXR part's channels make the picture.
#pragma once

#include <ImfChannelList.h>
#include <ImfHeader.h>

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <string>

#include "platform/file.h"
#include "welkin/environment_file.h"

namespace welkin::files {

struct ExrChannels {
  enum class Kind {
    colour,            ///< names: red, green, blue
    luminance,         ///< names[0]: Y
    luminance_chroma,  ///< names: RY, Y, BY; one of the chroma channels may be absent
  };
  Kind kind = Kind::colour;
  std::array<std::string, 3> names{};
};

/// A layer is what stands before a channel's last dot: "env" of "env.R", "a.b" of "a.b.R". Views other than the
/// default one of a multi-view file are named the same way ("left.R"), and are layers here.
///
/// A layer is a picture if it has R, G and B (also written r g b, red green blue, Red Green Blue, as compositors do)
/// or else Y, perhaps with RY and BY. X, Y and Z together are a vector, as renderers write for normals and positions,
/// and no picture. Alpha, depth and the like are read past; colour is taken as it is, premultiplied or not.

/// Whether there is a picture in `layer` (in any, if that is empty): one in colour, or any other.
[[nodiscard]] bool holds_picture(const Imf::ChannelList& channels, const std::string& layer, bool in_colour);

/// Fills in `info.channels` and `info.layers` and chooses: the layer that is asked for; else the channels without
/// one; else the only layer in colour; else the only layer. Needs `info.path`.
/// uint is read as the numbers that it states, as half and float are.
/// Throws `Error` (unsupported_file) naming what there is and, if layers are to choose from, --layer.
[[nodiscard]] ExrChannels choose_exr_channels(EnvironmentInfo& info, const Imf::ChannelList& channels,
                                              const std::string& layer);

// What an OpenEXR header promises, checked before any pixel memory is made for it.

/// The largest block of scanlines or tile, uncompressed and with all channels, that is decoded. 65536 texels
/// of four float channels at DWAB's 256 scanlines take half of it.
inline constexpr std::uint64_t kMaximumUnitBytes = std::uint64_t{512} << 20U;

/// One part, layer and level of a scanline or tiled file. The picture is `info.width` x `info.height`; what is
/// stored is data_width x data_height, and usually the same rectangle.
struct ExrPicture {
  EnvironmentInfo info;  ///< complete, layout included
  int part = 0;
  bool tiled = false;
  int level = 0;  ///< (level, level) of a mip or rip map
  ExrChannels channels;
  std::optional<glm::dmat3> to_rec709;
  bool prefiltered = false;  ///< an attribute speaks of roughness
  bool cube_frames = false;  ///< a strip whose faces are turned as OpenEXR's envmap attribute means them
  int first_column = 0;      ///< the data window's left and top, in the file's coordinates
  int first_row = 0;
  int data_width = 0;  ///< at the level
  int data_height = 0;
  int column_offset = 0;  ///< of the picture's (0, 0) in the stored texels; negative if that is not stored
  int row_offset = 0;
  int unit_rows = 1;              ///< rows that decode together, at most the data's height
  std::uint64_t unit_bytes = 0;   ///< of one block of scanlines or tile, uncompressed, all channels
  std::uint64_t table_bytes = 0;  ///< of all parts' headers and tables of offsets, which every reader holds

  [[nodiscard]] bool is_framed() const noexcept {
    return column_offset != 0 || row_offset != 0 || data_width != info.width || data_height != info.height;
  }
};

/// Reads and checks all of a file's headers and chooses part, layer, level and window. `file` stands at its beginning.
/// Throws as `inspect_environment`.
[[nodiscard]] ExrPicture inspect_exr(platform::ByteFile& file, const ReadOptions& options);

// Which rectangle of an OpenEXR file is the picture.

/// The picture's rectangle and that of the stored texels, in one frame of coordinates: x right, y down, both
/// inclusive. Texels of the picture that are not stored are black.
struct ExrWindows {
  Imath::Box2i picture;
  Imath::Box2i data;
};

/// The picture is the data window, wherever it lies, unless the file says that it is a frame around or inside of it:
/// the display window is the picture if
/// - the header has no envmap attribute, which makes the data window the map (ImfEnvmap.h), and no mip chain, which
///   belongs to the data window,
/// - the windows differ in size and overlap,
/// - it has the shape of a layout (2:1, 1:6, 6:1, 4:3, 3:4): of the one that is asked for, if one is, and
/// - the data window has not the shape of another layout, if none is asked for.
/// So overscan is cut off and a cropped render is put back in its place; either is said in `info.notes`.
///
/// Both windows are then at most kMaximumWidth x kMaximumHeight, and of a picture above 16384 x 8192 texels at least
/// a 64th is stored, so that a few bytes cannot make hours of work.
/// Throws `Error`: corrupt_file for an empty data window, unsupported_file for what is too large.
[[nodiscard]] ExrWindows choose_exr_windows(EnvironmentInfo& info, const Imf::Header& header, bool has_levels,
                                            Layout asked_for);

}  // namespace welkin::files
